#include "sim_host/emulator/g474/chip_cuts.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/emulator/g474/chip_session.h"
#include "sim_host/log/sdo_upload.h"

enum {
    STANDBY_TICKS = 3000,
    STORE_CONTROL = 0x1010,
    RESTORE_CONTROL = 0x1011,
    IDENTITY = 0x2030,
    IDENTITY_PARAMS = 3,
    EXIT_GOOD_CUT = 0,
    EXIT_BAD_CUT = 1
};
/* CiA 301, clauses 7.5.2.13 and 7.5.2.14. */
#define SAVE_SIGNATURE 0x65766173u
#define LOAD_SIGNATURE 0x64616F6Cu

static struct sdo_upload tool_of(struct chip_session *session)
{
    return (struct sdo_upload){.bus = &session->tool,
                               .node = NODE_CONTROLLER,
                               .wait = chip_session_wait,
                               .context = session};
}

static bool read_params_crc(struct chip_session *session, uint32_t *crc)
{
    struct sdo_upload tool = tool_of(session);
    uint8_t bytes[4];
    size_t length;

    const bool read = sdo_upload(&tool, IDENTITY, IDENTITY_PARAMS, bytes, sizeof bytes, &length) ==
                          SDO_UPLOAD_DONE &&
                      length == sizeof bytes;
    *crc = read ? bytes_get_u32(bytes) : 0;
    return read;
}

/* Before each operation; the copy returns from here and meets its end in the operation. */
static void before_operation(void *context)
{
    struct chip_session *session = context;
    struct flash_model *flash = &session->chip.flash_registers;
    struct chip_cuts *cuts = &session->cuts;
    int status = 0;

    if (cuts->operations++ % cuts->every != 0) {
        return;
    }
    fflush(NULL);
    const pid_t copy = fork();
    if (copy == 0) {
        cuts->in_copy = true;
        cuts->at = cuts->operations - 1;
        flash->power_fails_at = flash->operations;
        flash->on_operation = NULL;
        return;
    }
    cuts->tried++;
    if (copy < 0 || waitpid(copy, &status, 0) != copy || !WIFEXITED(status) ||
        WEXITSTATUS(status) != EXIT_GOOD_CUT) {
        cuts->bad++;
    }
}

static enum sdo_upload_result ask(struct chip_session *session)
{
    struct sdo_upload tool = tool_of(session);

    return session->fault == CHIP_FAULT_SAVE_CUT
               ? sdo_write(&tool, STORE_CONTROL, 1, SAVE_SIGNATURE, 4)
               : sdo_write(&tool, RESTORE_CONTROL, 1, LOAD_SIGNATURE, 4);
}

void chip_cuts_run(struct chip_session *session)
{
    struct chip_cuts *cuts = &session->cuts;
    struct flash_model *flash = &session->chip.flash_registers;
    const uint32_t resets = session->chip.resets;

    chip_session_pass(session, STANDBY_TICKS);
    session->crash_known = true; /* the tool's queue is read from here on */
    if (!read_params_crc(session, &cuts->params_crc)) {
        chip_session_complain(session, "the image does not tell which settings it has");
        return;
    }
    const uint32_t before = flash->operations;
    if (cuts->every == 0) {
        flash->power_fails_at = before + cuts->at;
    } else {
        flash->on_operation = before_operation;
        flash->operation_context = session;
    }
    const enum sdo_upload_result result = ask(session);
    flash->on_operation = NULL;
    cuts->hit = session->chip.resets != resets;
    if (!cuts->hit && (result != SDO_UPLOAD_DONE || flash->operations == before)) {
        chip_session_complain(session, "the image did not do what it was asked");
    }
    cuts->operations = flash->operations - before;
    flash->power_fails_at = UINT32_MAX;
    if (!cuts->hit) {
        chip_power_cycle(&session->chip);
    }
    session->bridge.state = UINT8_MAX; /* until it says something */
}

bool chip_cuts_kept_settings(struct chip_session *session)
{
    uint32_t crc;
    return read_params_crc(session, &crc) && crc == session->cuts.params_crc;
}

void chip_cuts_end(struct chip_session *session)
{
    if (!session->cuts.in_copy) {
        return;
    }
    if (!session->reached || session->chip.finding_count > 0) {
        fprintf(stderr, "power cut in operation %u: %s\n", session->cuts.at,
                session->trouble[0] != '\0' ? session->trouble : session->chip.findings[0]);
        _exit(EXIT_BAD_CUT);
    }
    _exit(EXIT_GOOD_CUT);
}
