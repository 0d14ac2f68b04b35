/* Keys and sections of CiA 306 as the Python package canopen (objectdictionary/eds.py)
 * reads them; it is the peer that checks these files in the tests. */
#include "sim_host/nodes/eds_writer.h"

#include <string.h>

#include "hal/bus/bytes.h"

enum {
    OBJECT_DOMAIN = 2,
    OBJECT_VAR = 7,
    OBJECT_ARRAY = 8,
    OBJECT_RECORD = 9,
    MANUFACTURER_FIRST = 0x2000,
    MANUFACTURER_LAST = 0x5FFF,
    BUILD_IDENTITY = 0x2030 /* of the controller: differs with every build */
};

/* ---- what the dictionaries hold ----------------------------------------------- */

/* The dictionaries one after the other: all are sorted and do not overlap. */
static const struct co_entry *entry_at(const struct co_device *device, unsigned at,
                                       const void **base)
{
    const struct co_dictionary *dictionary = device->dictionaries;
    while (at >= dictionary->count) {
        at -= dictionary->count;
        dictionary++;
    }
    *base = dictionary->base;
    return &dictionary->entries[at];
}

static unsigned entry_count(const struct co_device *device)
{
    unsigned count = 0;
    for (unsigned i = 0; i < CO_DICTIONARIES; i++) {
        count += device->dictionaries[i].count;
    }
    return count;
}

/* Number of entries with the index of the one at `at`, from there on. */
static unsigned group_size(const struct co_device *device, unsigned at)
{
    const void *base;
    const uint16_t index = entry_at(device, at, &base)->index;
    unsigned size = 0;
    while (at + size < entry_count(device) && entry_at(device, at + size, &base)->index == index) {
        size++;
    }
    return size;
}

enum list { LIST_MANDATORY, LIST_OPTIONAL, LIST_MANUFACTURER };

static enum list list_of(uint16_t index)
{
    if (index == 0x1000 || index == 0x1001 || index == 0x1018) {
        return LIST_MANDATORY;
    }
    return index >= MANUFACTURER_FIRST && index <= MANUFACTURER_LAST ? LIST_MANUFACTURER
                                                                     : LIST_OPTIONAL;
}

/* ---- sections ------------------------------------------------------------------- */

static void write_head(FILE *stream, const struct co_device *device, const struct eds_text *text)
{
    const struct co_comm *comm = &device->comm;
    fprintf(stream,
            "[FileInfo]\nFileName=%s\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n"
            "Description=%s\nCreationTime=12:00AM\nCreationDate=01-01-2026\nCreatedBy=afo eds\n"
            "ModificationTime=12:00AM\nModificationDate=01-01-2026\nModifiedBy=afo eds\n\n",
            text->file_name, text->description);
    fprintf(stream,
            "[DeviceInfo]\nVendorName=AFO\nVendorNumber=0x%08X\nProductName=%s\n"
            "ProductNumber=0x%08X\nRevisionNumber=0x%08X\nOrderCode=\n",
            comm->vendor, comm->name, comm->product, comm->revision);
    static const unsigned rates[] = {10, 20, 50, 125, 250, 500, 800, 1000};
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        fprintf(stream, "BaudRate_%u=%d\n", rates[i], rates[i] == 1000 ? 1 : 0);
    }
    fprintf(stream,
            "SimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=8\nDynamicChannelsSupported=0\n"
            "GroupMessaging=0\nNrOfRXPDO=%d\nNrOfTXPDO=%d\nLSS_Supported=0\n\n",
            comm->rpdo_count, comm->tpdo_count);
    fputs("[DummyUsage]\n", stream);
    for (unsigned type = 1; type <= 7; type++) {
        fprintf(stream, "Dummy%04X=1\n", type);
    }
    fprintf(stream, "\n[Comments]\nLines=1\nLine1=Written by afo eds from the object dictionary\n");
}

static void write_list(FILE *stream, const struct co_device *device, const char *title,
                       enum list list)
{
    const void *base;
    unsigned count = 0;
    for (unsigned at = 0; at < entry_count(device); at += group_size(device, at)) {
        count += list_of(entry_at(device, at, &base)->index) == list ? 1 : 0;
    }
    fprintf(stream, "\n[%s]\nSupportedObjects=%u\n", title, count);
    unsigned number = 0;
    for (unsigned at = 0; at < entry_count(device); at += group_size(device, at)) {
        const struct co_entry *entry = entry_at(device, at, &base);
        if (list_of(entry->index) == list) {
            fprintf(stream, "%u=0x%04X\n", ++number, entry->index);
        }
    }
}

static const char *access_name(unsigned access)
{
    if ((access & CO_CONST) != 0) {
        return "const";
    }
    if ((access & CO_READ) == 0) {
        return "wo";
    }
    if ((access & CO_WRITE) == 0) {
        return "ro";
    }
    return "rw";
}

static bool has_default(const struct co_entry *entry)
{
    if (entry->index == BUILD_IDENTITY || entry->index == 0x100A || entry->type == CO_DOMAIN) {
        return false;
    }
    return (entry->access & (CO_CONST | CO_WRITE)) != 0 || (entry->access & CO_ADD_NODE) != 0;
}

static void write_value(FILE *stream, const struct co_entry *entry, const void *base)
{
    uint8_t bytes[CO_VALUE_MAX];
    const unsigned length = co_od_load(entry, base, bytes);
    if (entry->type == CO_VISIBLE_STRING) {
        fwrite(bytes, 1, length, stream);
    } else if (entry->type == CO_REAL32) {
        const uint32_t bits = bytes_get_u32(bytes);
        float value;
        memcpy(&value, &bits, sizeof value);
        fprintf(stream, "%.9g", (double)value);
    } else {
        const long long number = co_od_number(entry, bytes);
        const bool as_hex = entry->type == CO_UNSIGNED32 && entry->index < MANUFACTURER_FIRST;
        fprintf(stream, as_hex ? "0x%llX" : "%lld", number);
    }
}

static void write_limit(FILE *stream, const char *key, const struct co_entry *entry, int32_t limit)
{
    if (entry->type == CO_REAL32) {
        fprintf(stream, "%s=%.9g\n", key, (double)limit / 1000.0);
    } else {
        fprintf(stream, "%s=%ld\n", key, (long)limit);
    }
}

static void write_variable(FILE *stream, const struct co_entry *entry, const void *base)
{
    fprintf(stream, "ParameterName=%s\nObjectType=0x%X\nDataType=0x%04X\nAccessType=%s\n",
            entry->name, entry->type == CO_DOMAIN ? OBJECT_DOMAIN : OBJECT_VAR, entry->type,
            access_name(entry->access));
    if (entry->low <= entry->high) {
        write_limit(stream, "LowLimit", entry, entry->low);
        write_limit(stream, "HighLimit", entry, entry->high);
    }
    fputs("DefaultValue=", stream);
    if (has_default(entry)) {
        write_value(stream, entry, base);
    }
    fprintf(stream, "\nPDOMapping=%d\n",
            (entry->access & ((unsigned)CO_MAP_RX | CO_MAP_TX)) != 0 ? 1 : 0);
}

static void write_object(FILE *stream, const struct co_device *device, unsigned at)
{
    const void *base;
    const struct co_entry *entry = entry_at(device, at, &base);
    const unsigned size = group_size(device, at);
    if (size == 1 && entry->sub == 0) {
        fprintf(stream, "\n[%04X]\n", entry->index);
        write_variable(stream, entry, base);
        return;
    }
    const void *unused;
    bool same_type = true;
    for (unsigned i = 2; i < size; i++) {
        same_type = same_type && entry_at(device, at + i, &unused)->type ==
                                     entry_at(device, at + 1, &unused)->type;
    }
    const bool is_record = !same_type || entry->index == 0x1018 || entry->index == 0x1200 ||
                           (entry->index >= 0x1400 && entry->index < 0x1B00);
    fprintf(stream, "\n[%04X]\nParameterName=%s\nObjectType=0x%X\nSubNumber=%u\n", entry->index,
            entry->name, is_record ? OBJECT_RECORD : OBJECT_ARRAY, size);
    for (unsigned i = 0; i < size; i++) {
        const struct co_entry *sub = entry_at(device, at + i, &base);
        fprintf(stream, "\n[%04Xsub%X]\n", sub->index, sub->sub);
        if (sub->sub == 0) {
            struct co_entry count = *sub;
            count.name = "Highest sub-index supported";
            write_variable(stream, &count, base);
        } else {
            write_variable(stream, sub, base);
        }
    }
}

bool eds_write(FILE *stream, const struct co_device *device, const struct eds_text *text)
{
    write_head(stream, device, text);
    write_list(stream, device, "MandatoryObjects", LIST_MANDATORY);
    write_list(stream, device, "OptionalObjects", LIST_OPTIONAL);
    write_list(stream, device, "ManufacturerObjects", LIST_MANUFACTURER);
    for (unsigned at = 0; at < entry_count(device); at += group_size(device, at)) {
        write_object(stream, device, at);
    }
    return fflush(stream) == 0 && ferror(stream) == 0;
}
