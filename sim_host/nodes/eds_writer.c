/* Keys and sections of CiA 306 as the Python package canopen (objectdictionary/eds.py)
 * reads them; it is the peer that checks these files in the tests. */
#include "sim_host/nodes/eds_writer.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/devices/device_description.h"

enum {
    OBJECT_DOMAIN = 2,
    OBJECT_VAR = 7,
    OBJECT_ARRAY = 8,
    OBJECT_RECORD = 9,
    MANUFACTURER_FIRST = 0x2000,
    MANUFACTURER_LAST = 0x5FFF
};

/* What a default of the data sheet says. */
enum default_kind {
    DEFAULT_NONE,    /* measured, or not the same in every device of the type */
    DEFAULT_FIXED,   /* this value */
    DEFAULT_BY_NODE, /* goes with the node's number: CiA 306, $NODEID */
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
        fprintf(stream, "BaudRate_%u=%d\n", rates[i], rates[i] * 1000U == BUS_BITRATE ? 1 : 0);
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

/* Constant is what every device of the type has. */
static const char *access_name(unsigned access, enum default_kind kind)
{
    if ((access & CO_CONST) != 0 && kind != DEFAULT_NONE) {
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

/* The value as it is read over the bus. */
static unsigned load(struct co_device *device, const struct co_entry *entry, const void *base,
                     uint8_t *bytes)
{
    memset(bytes, 0, CO_VALUE_MAX);
    device->hooks.reading(device, entry);
    return co_od_load(entry, base, bytes);
}

static enum default_kind default_kind(const struct eds_subject *subject, unsigned at)
{
    uint8_t own[CO_VALUE_MAX], others[CO_VALUE_MAX];
    const void *base, *other_base;
    const struct co_entry *entry = entry_at(subject->device, at, &base);
    const int node = subject->device->config.node_id;
    const int other_node = subject->other->config.node_id;
    (void)entry_at(subject->other, at, &other_base);
    if (entry->type == CO_DOMAIN ||
        (entry->access & ((unsigned)CO_CONST | CO_WRITE | CO_ADD_NODE)) == 0) {
        return DEFAULT_NONE;
    }
    if ((entry->access & CO_ADD_NODE) != 0) {
        return DEFAULT_BY_NODE;
    }
    if (entry->index >= DEVICE_INDEX_COMMON && entry->index <= DEVICE_INDEX_RIGHT) {
        return DEFAULT_NONE; /* of the device that hangs on this bus */
    }
    const unsigned length = load(subject->device, entry, base, own);
    if (load(subject->other, entry, other_base, others) == length &&
        memcmp(own, others, sizeof own) == 0) {
        return DEFAULT_FIXED;
    }
    return entry->type == CO_UNSIGNED32 && entry->index < MANUFACTURER_FIRST &&
                   co_od_number(entry, others) - co_od_number(entry, own) == other_node - node
               ? DEFAULT_BY_NODE
               : DEFAULT_NONE;
}

static void write_value(FILE *stream, struct co_device *device, const struct co_entry *entry,
                        const void *base, enum default_kind kind)
{
    uint8_t bytes[CO_VALUE_MAX];
    const unsigned length = load(device, entry, base, bytes);
    if (kind == DEFAULT_BY_NODE) {
        fprintf(stream, "$NODEID+0x%llX",
                (unsigned long long)(co_od_number(entry, bytes) - device->config.node_id));
    } else if (entry->type == CO_VISIBLE_STRING) {
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

static void write_variable(FILE *stream, const struct eds_subject *subject, unsigned at,
                           const char *name)
{
    const void *base;
    const struct co_entry *entry = entry_at(subject->device, at, &base);
    const enum default_kind kind = default_kind(subject, at);
    fprintf(stream, "ParameterName=%s\nObjectType=0x%X\nDataType=0x%04X\nAccessType=%s\n", name,
            entry->type == CO_DOMAIN ? OBJECT_DOMAIN : OBJECT_VAR, entry->type,
            access_name(entry->access, kind));
    if (entry->low <= entry->high) {
        write_limit(stream, "LowLimit", entry, entry->low);
        write_limit(stream, "HighLimit", entry, entry->high);
    }
    fputs("DefaultValue=", stream);
    if (kind != DEFAULT_NONE) {
        write_value(stream, subject->device, entry, base, kind);
    }
    fprintf(stream, "\nPDOMapping=%d\n",
            (entry->access & ((unsigned)CO_MAP_RX | CO_MAP_TX)) != 0 ? 1 : 0);
}

static void write_object(FILE *stream, const struct eds_subject *subject, unsigned at)
{
    const struct co_device *device = subject->device;
    const void *base;
    const struct co_entry *entry = entry_at(device, at, &base);
    const unsigned size = group_size(device, at);
    if (size == 1 && entry->sub == 0) {
        fprintf(stream, "\n[%04X]\n", entry->index);
        write_variable(stream, subject, at, entry->name);
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
        write_variable(stream, subject, at + i,
                       sub->sub == 0 ? "Highest sub-index supported" : sub->name);
    }
}

/* A reader of the file takes an equals sign for the end of a key, a semicolon for a remark. */
static bool is_plain(const char *text)
{
    return strpbrk(text, "=;\r\n") == NULL;
}

static bool can_be_written(const struct co_device *device, const struct eds_text *text)
{
    bool can = is_plain(text->file_name) && is_plain(text->description);
    for (unsigned at = 0; at < entry_count(device); at++) {
        const void *base;
        can = can && is_plain(entry_at(device, at, &base)->name);
    }
    return can;
}

bool eds_write(FILE *stream, const struct eds_subject *subject, const struct eds_text *text)
{
    const struct co_device *device = subject->device;
    if (!can_be_written(device, text)) {
        return false;
    }
    write_head(stream, device, text);
    write_list(stream, device, "MandatoryObjects", LIST_MANDATORY);
    write_list(stream, device, "OptionalObjects", LIST_OPTIONAL);
    write_list(stream, device, "ManufacturerObjects", LIST_MANUFACTURER);
    for (unsigned at = 0; at < entry_count(device); at += group_size(device, at)) {
        write_object(stream, subject, at);
    }
    return fflush(stream) == 0 && ferror(stream) == 0;
}
