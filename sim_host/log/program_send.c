#include "sim_host/log/program_send.h"

#include <stdio.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"

enum {
    STARTER_BYTES = 0x2000,
    PROGRAM_DATA = 0x1F50,
    PROGRAM_CONTROL = 0x1F51,
    PROGRAM_IDENTIFICATION = 0x1F56,
    FLASH_STATUS = 0x1F57,
    CONTROL_START = 1,
    CONTROL_START_OLDER = 0x80,
    STATUS_OTHER_BOARD = 1 << 16,
    STATUS_OLDER = 2 << 16
};

static bool read_header(const uint8_t *program, size_t bytes, struct program_header *header)
{
    const uint8_t *at = program + PROGRAM_HEADER_OFFSET;

    if (bytes < PROGRAM_HEADER_OFFSET + sizeof *header ||
        bytes_get_u32(at) != (uint32_t)PROGRAM_MAGIC) {
        return false;
    }
    header->magic = bytes_get_u32(at);
    header->hardware = bytes_get_u32(at + 4);
    header->version = bytes_get_u32(at + 8);
    header->build_id = bytes_get_u32(at + 12);
    header->length = bytes_get_u32(at + 16);
    header->crc = bytes_get_u32(at + 28);
    return header->length <= bytes;
}

const uint8_t *program_send_find(const uint8_t *file, size_t bytes, size_t *length,
                                 struct program_header *header)
{
    const uint8_t *program = file;

    if (!read_header(program, bytes, header)) {
        if (bytes < STARTER_BYTES ||
            !read_header(file + STARTER_BYTES, bytes - STARTER_BYTES, header)) {
            return NULL;
        }
        program += STARTER_BYTES;
    }
    *length = header->length;
    return program;
}

static int say(struct program_send *send, enum sdo_upload_result result, const char *what)
{
    const char *why = result == SDO_UPLOAD_SILENT      ? "it does not answer"
                      : result == SDO_UPLOAD_DISTURBED ? "another tool speaks with it"
                                                       : "its answer is too long";
    if (result == SDO_UPLOAD_ABORTED) {
        snprintf(send->message, sizeof send->message, "the controller refuses %s (%08x)", what,
                 (unsigned)send->tool->abort_code);
    } else {
        snprintf(send->message, sizeof send->message, "%s: %s", what, why);
    }
    return -1;
}

static enum sdo_upload_result read_u32(struct program_send *send, uint16_t index, uint32_t *value)
{
    uint8_t bytes[4] = {0};
    size_t length;
    const enum sdo_upload_result result =
        sdo_upload(send->tool, index, 1, bytes, sizeof bytes, &length);

    *value = bytes_get_u32(bytes);
    return result;
}

/* The status says more than the abort code. */
static int explain(struct program_send *send, enum sdo_upload_result result, const char *what)
{
    const uint32_t abort_code = send->tool->abort_code;
    uint32_t status = 0;

    if (result != SDO_UPLOAD_ABORTED || read_u32(send, FLASH_STATUS, &status) != SDO_UPLOAD_DONE) {
        return say(send, result, what);
    }
    send->tool->abort_code = abort_code;
    if (status == (uint32_t)STATUS_OTHER_BOARD) {
        snprintf(send->message, sizeof send->message,
                 "the image is for another board: make firmware builds one for each");
    } else if (status == (uint32_t)STATUS_OLDER) {
        snprintf(send->message, sizeof send->message,
                 "the image is older than the running program: --allow-downgrade takes it all "
                 "the same");
    } else if (abort_code == 0x08000022u) {
        snprintf(send->message, sizeof send->message,
                 "the controller takes a program only at standstill without torque");
    } else {
        snprintf(send->message, sizeof send->message,
                 "the controller refuses %s (abort %08x, flash status %08x)", what,
                 (unsigned)abort_code, (unsigned)status);
    }
    return -1;
}

int program_send_identify(struct program_send *send, uint32_t *crc)
{
    const enum sdo_upload_result result = read_u32(send, PROGRAM_IDENTIFICATION, crc);
    return result == SDO_UPLOAD_DONE ? 0 : say(send, result, "saying which program runs");
}

static int wait_for_program(struct program_send *send, uint32_t crc)
{
    for (unsigned waits = 0; waits < send->restart_waits; waits++) {
        uint32_t found = 0;
        if (read_u32(send, PROGRAM_IDENTIFICATION, &found) == SDO_UPLOAD_DONE && found == crc) {
            return 0;
        }
        (void)send->tool->wait(send->tool->context, 0);
    }
    snprintf(send->message, sizeof send->message,
             "the new program does not answer: look at LD2 and at the virtual COM port");
    return -1;
}

int program_send(struct program_send *send, const uint8_t *program, size_t length, uint32_t crc)
{
    const enum sdo_upload_result result =
        sdo_download(send->tool, PROGRAM_DATA, 1, program, length, send->told, send->told_context);

    return result == SDO_UPLOAD_DONE ? program_send_start(send, crc)
                                     : explain(send, result, "the image");
}

int program_send_start(struct program_send *send, uint32_t crc)
{
    const enum sdo_upload_result result = sdo_write(
        send->tool, PROGRAM_CONTROL, 1, send->allow_older ? CONTROL_START_OLDER : CONTROL_START, 1);
    if (result != SDO_UPLOAD_DONE) {
        return explain(send, result, "to start it");
    }
    return wait_for_program(send, crc);
}
