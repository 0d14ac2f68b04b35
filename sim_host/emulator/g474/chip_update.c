#include "sim_host/emulator/g474/chip_update.h"

#include <stdlib.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"
#include "sim_host/log/program_send.h"

enum {
    RESTART_WAITS = 4000,
    HARDWARE = PROGRAM_HEADER_OFFSET + 4,
    VERSION = PROGRAM_HEADER_OFFSET + 8,
    BUILD_ID = PROGRAM_HEADER_OFFSET + 12,
    CRC = PROGRAM_HEADER_OFFSET + 28
};

static void change(uint8_t *program, uint32_t at, int by)
{
    bytes_put_u32(program + at, bytes_get_u32(program + at) + (uint32_t)by);
}

/* The running program, as another build of it. Returns its CRC. */
static uint32_t make_program(uint8_t *program, size_t length, enum chip_fault fault)
{
    change(program, BUILD_ID, 1);
    change(program, VERSION, fault == CHIP_FAULT_UPDATE_OLDER ? -1 : 1);
    change(program, HARDWARE, fault == CHIP_FAULT_UPDATE_OTHER_BOARD ? 1 : 0);
    const uint32_t crc =
        crc32_update(crc32_update(CRC32_INIT, program, CRC), program + CRC + 4, length - CRC - 4);
    bytes_put_u32(program + CRC, crc);
    return crc;
}

static void expect_refusal(struct chip_session *session, int result, const char *message,
                           const char *words)
{
    if (result == 0) {
        chip_session_complain(session, "the image took a program that it must refuse");
    } else if (strstr(message, words) == NULL) {
        chip_session_complain(session, message);
    }
}

static void send_program(struct chip_session *session, struct program_send *send,
                         const uint8_t *program, size_t length, uint32_t crc)
{
    const int result = program_send(send, program, length, crc);

    switch (session->fault) {
    case CHIP_FAULT_UPDATE_OTHER_BOARD:
        expect_refusal(session, result, send->message, "for another board");
        break;
    case CHIP_FAULT_UPDATE_WALKING:
        expect_refusal(session, result, send->message, "only at standstill");
        break;
    case CHIP_FAULT_UPDATE_OLDER:
        expect_refusal(session, result, send->message, "older than the running");
        send->allow_older = true;
        if (program_send_start(send, crc) != 0) {
            chip_session_complain(session, send->message);
        } else {
            session->new_crc = crc;
        }
        break;
    default:
        if (result == 0) {
            session->new_crc = crc;
        } else if (session->fault == CHIP_FAULT_UPDATE) {
            chip_session_complain(session, send->message);
        }
        break;
    }
}

void chip_update_run(struct chip_session *session, struct sdo_upload *tool)
{
    struct program_send send = {.tool = tool, .restart_waits = RESTART_WAITS};
    const size_t length = chip_session_image_bytes(&session->chip);
    uint8_t *program = malloc(length);

    if (program == NULL || program_send_identify(&send, &session->old_crc) != 0) {
        chip_session_complain(session, program == NULL ? "out of memory" : send.message);
        free(program);
        return;
    }
    memcpy(program, session->chip.flash + CHIP_STARTER_BYTES, length);
    const uint32_t crc = make_program(program, length, session->fault);
    session->cut_crc = crc;
    if (session->fault == CHIP_FAULT_UPDATE_CUT) {
        const char *missing = chip_cuts_begin(&session->cuts, &session->chip);
        if (missing != NULL) {
            chip_session_complain(session, missing);
            free(program);
            return;
        }
    }
    send_program(session, &send, program, length, crc);
    if (session->fault == CHIP_FAULT_UPDATE_CUT) {
        chip_cuts_finish(&session->cuts);
        if (!session->cuts.hit && session->new_crc == 0) {
            chip_session_complain(session, send.message);
        }
    }
    free(program);
}

void chip_update_judge(struct chip_session *session, struct sdo_upload *tool)
{
    struct program_send send = {.tool = tool};
    uint32_t found = 0;

    if (program_send_identify(&send, &found) != 0) {
        chip_session_complain(session, send.message);
    } else if (session->new_crc != 0 ? found != session->new_crc
                                     : found != session->old_crc && found != session->cut_crc) {
        chip_session_complain(session, "another program runs than was ordered");
    } else if (session->fault != CHIP_FAULT_UPDATE_CUT && session->new_crc == 0 &&
               found != session->old_crc) {
        chip_session_complain(session, "a program runs that was refused");
    }
}
