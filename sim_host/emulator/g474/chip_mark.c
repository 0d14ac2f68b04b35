#include "sim_host/emulator/g474/chip_mark.h"

#include <stdlib.h>

#include "hal/bus/frame_table.h"
#include "hal/sync_pulse.h"

enum {
    COMMANDS = 0x2000,
    COMMANDS_MARK = 7,
    MARKS = 40,
    BETWEEN_TICKS = 17, /* longer than a pulse */
    PULSE_TOLERANCE_US = 1
};

static void note(struct chip_marks *marks, uint32_t delay_us, uint32_t pulse_us)
{
    const bool first = marks->count == 0;

    marks->count++;
    marks->delay_us[0] = first || delay_us < marks->delay_us[0] ? delay_us : marks->delay_us[0];
    marks->delay_us[1] = delay_us > marks->delay_us[1] ? delay_us : marks->delay_us[1];
    marks->pulse_us[0] = first || pulse_us < marks->pulse_us[0] ? pulse_us : marks->pulse_us[0];
    marks->pulse_us[1] = pulse_us > marks->pulse_us[1] ? pulse_us : marks->pulse_us[1];
}

static void mark(struct chip_session *session, struct sdo_upload *tool, uint32_t number)
{
    const struct chip_timer *timer = &session->chip.timer;
    const uint64_t pulses = timer->pulses;

    if (sdo_write(tool, COMMANDS, COMMANDS_MARK, number, 4) != SDO_UPLOAD_DONE) {
        chip_session_complain(session, "the image takes no mark (0x2000:7)");
        return;
    }
    chip_session_pass(session, BETWEEN_TICKS);
    if (timer->pulses != pulses + 1 || timer->fell_ns < timer->rose_ns) {
        chip_session_complain(session, "a mark gives no pulse at PA1, or more than one");
        return;
    }
    const uint64_t asked_ns = session->bridge.asked_ns;
    note(&session->marks, (uint32_t)((timer->rose_ns - asked_ns) / 1000u),
         (uint32_t)((timer->fell_ns - timer->rose_ns + 500u) / 1000u));
    if (timer->rose_ns < asked_ns || session->marks.delay_us[1] > (uint32_t)TICK_PERIOD_US) {
        chip_session_complain(session, "a pulse comes later than a tick behind its mark");
    } else if (abs((int)session->marks.pulse_us[0] - (int)SYNC_PULSE_US) > PULSE_TOLERANCE_US ||
               abs((int)session->marks.pulse_us[1] - (int)SYNC_PULSE_US) > PULSE_TOLERANCE_US) {
        chip_session_complain(session, "a pulse is too short or too long");
    }
}

void chip_mark_run(struct chip_session *session, struct sdo_upload *tool)
{
    for (uint32_t i = 0; i < (uint32_t)MARKS && session->trouble[0] == '\0'; i++) {
        chip_bridge_pass(&session->bridge, i * (uint32_t)TICK_PERIOD_US * 1000u / (uint32_t)MARKS);
        mark(session, tool, i + 1u);
    }
}
