#include "sim_host/devices/eds_gate.h"

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

enum {
    SDO_DOWNLOAD = 1, /* command specifiers of a client, CiA 301, 7.2.4.3 */
    SDO_UPLOAD = 2,
    SDO_ABORT = 0x80,
    SDO_REQUEST = 0x600,
    SDO_ANSWER = 0x580
};

static int bits_of(uint8_t type)
{
    switch (type) {
    case 0x02:
    case 0x05:
        return 8;
    case 0x03:
    case 0x06:
        return 16;
    case 0x04:
    case 0x07:
    case 0x08:
        return 32;
    case 0x10:
    case 0x16:
        return 24;
    default:
        return 0;
    }
}

/* What is written as a mapping entry: index, sub-index, length in bits. */
static uint32_t judge_mapping(const struct eds_file *eds, uint32_t entry, bool receives)
{
    const uint16_t index = (uint16_t)(entry >> 16);
    const int bits = (int)(entry & 0xFFu);
    if (index < EDS_DUMMY_TYPES) {
        return receives && eds->dummy[index] ? CO_ABORT_NONE : CO_ABORT_NOT_MAPPABLE;
    }
    const struct eds_object *object = eds_find(eds, index, (uint8_t)(entry >> 8));
    if (object == NULL) {
        return CO_ABORT_NO_OBJECT;
    }
    if (!object->mappable || (receives && !object->writable) || (!receives && !object->readable)) {
        return CO_ABORT_NOT_MAPPABLE;
    }
    return bits_of(object->type) == bits ? CO_ABORT_NONE : CO_ABORT_PDO_LENGTH;
}

/* An expedited value as the object's type has it. */
static int64_t value_of(const struct eds_object *object, const uint8_t *data)
{
    const uint32_t bits = bytes_get_u32(data);
    switch (object->type) {
    case 0x02:
        return (int8_t)(bits & 0xFFu);
    case 0x03:
        return (int16_t)(bits & 0xFFFFu);
    case 0x04:
        return (int32_t)bits;
    case 0x05:
        return bits & 0xFFu;
    case 0x06:
        return bits & 0xFFFFu;
    default:
        return bits;
    }
}

static uint32_t judge_write(const struct eds_file *eds, const struct eds_object *object,
                            const uint8_t *data)
{
    const bool rx_map = object->index >= 0x1600 && object->index < 0x1800;
    const bool tx_map = object->index >= 0x1A00 && object->index < 0x1C00;
    if (!object->writable) {
        return CO_ABORT_READ_ONLY;
    }
    if ((rx_map || tx_map) && object->sub > 0 && bytes_get_u32(data) != 0) {
        return judge_mapping(eds, bytes_get_u32(data), rx_map);
    }
    const int64_t value = value_of(object, data);
    if (object->has_high && value > object->high && object->high >= object->low) {
        return CO_ABORT_TOO_HIGH;
    }
    return object->has_low && value < object->low ? CO_ABORT_TOO_LOW : CO_ABORT_NONE;
}

static uint32_t judge(const struct eds_file *eds, const struct can_msg *request)
{
    const unsigned command = request->data[0] >> 5;
    const uint16_t index = bytes_get_u16(request->data + 1);
    if (command != SDO_DOWNLOAD && command != SDO_UPLOAD) {
        return CO_ABORT_NONE;
    }
    const struct eds_object *object = eds_find(eds, index, request->data[3]);
    if (object == NULL || (object->is_whole && object->type == 0)) {
        return eds_has_index(eds, index) ? CO_ABORT_NO_SUB : CO_ABORT_NO_OBJECT;
    }
    if (command == SDO_UPLOAD) {
        return object->readable ? CO_ABORT_NONE : CO_ABORT_WRITE_ONLY;
    }
    return judge_write(eds, object, request->data + 4);
}

bool eds_gate_refuses(const struct eds_file *eds, const struct can_msg *request,
                      struct can_msg *answer)
{
    if (request->id <= SDO_REQUEST || request->id > SDO_REQUEST + 127 || request->length != 8 ||
        request->flags != 0) {
        return false;
    }
    const uint32_t code = judge(eds, request);
    *answer = (struct can_msg){.id = request->id - SDO_REQUEST + SDO_ANSWER, .length = 8};
    answer->data[0] = SDO_ABORT;
    answer->data[1] = request->data[1];
    answer->data[2] = request->data[2];
    answer->data[3] = request->data[3];
    bytes_put_u32(answer->data + 4, code);
    return code != CO_ABORT_NONE;
}
