/* Signs that frames which were on the bus are not in the log. A recorder that is too slow loses them in
 * bursts (candump: the socket's receive buffer), and what the control task then makes of the rest cannot
 * be what was recorded. A node that was really silent leaves the same signs; but then the digest that the
 * controller tells next agrees, and they are forgotten. */
#include <assert.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/log/replay_internal.h"

/* The digest is told every SLOW_PDO_TICKS: a sign explains a difference for so long. */
enum {
    SIGN_LASTS_TICKS = SLOW_PDO_TICKS + 10,
    STEP_BYTE = 6,
    PAUSE_PERIODS = 8,
    PERIODS_MIN = 16,
    EVEN_SHARE = 10
};

#define SENT_EVERY_SYNC(kind) ((#kind)[0] == 'S')
#define CYCLIC(name, id, bytes, period_us, deadline_us, node, kind) \
    {id, SENT_EVERY_SYNC(kind) && (id) != FRAME_SYNC},
static const struct {
    uint32_t id;
    bool is_cyclic;
} frames[] = {FRAME_TABLE(CYCLIC)};
#undef CYCLIC

enum { FRAMES = sizeof frames / sizeof frames[0] };
static_assert(FRAMES <= 64, "a bit for each");

/* The place of the frame in the table; FRAMES when it is not sent with every SYNC. */
static unsigned place_of(uint32_t id)
{
    unsigned at = 0;
    while (at < FRAMES && !(frames[at].is_cyclic && frames[at].id == id)) {
        at++;
    }
    return at;
}

static void note(struct replay *replay, const char *what, uint32_t id, unsigned long line)
{
    struct replay_gaps *gaps = &replay->gaps;
    if (gaps->has_sign) {
        return; /* the first one is where it began */
    }
    gaps->has_sign = true;
    gaps->sign_tick = replay->ticks;
    snprintf(gaps->sign, sizeof gaps->sign, "before line %lu %s %03X", line, what, id);
}

/* Twice between two SYNCs: one SYNC at least is missing. Not at all, and it came before: it is itself. */
static void look_at_cycle(struct replay *replay, unsigned long sync_line)
{
    struct replay_gaps *gaps = &replay->gaps;
    uint64_t present = 0;
    for (unsigned i = 0; i < replay->next_count; i++) {
        const struct replay_frame *frame = &replay->next[i];
        const unsigned place = place_of(frame->message.id);
        if (place < FRAMES && !frame->foreign) {
            if ((present >> place & 1) != 0) {
                note(replay, "a SYNC is missing: since the last one there is a second",
                     frame->message.id, frame->line);
            }
            present |= UINT64_C(1) << place;
        }
    }
    for (unsigned place = 0; place < FRAMES; place++) {
        if ((gaps->present & ~present) >> place & 1) {
            note(replay, "the cycle has no frame", frames[place].id, sync_line);
        }
    }
    gaps->present = present;
}

/* The steps are counted in the telemetry. */
static void look_at_steps(struct replay *replay)
{
    struct replay_gaps *gaps = &replay->gaps;
    for (unsigned i = 0; i < replay->next_count; i++) {
        const struct can_msg *message = &replay->next[i].message;
        if (message->id != FRAME_TELEMETRY || message->length != FRAME_BYTES_TELEMETRY) {
            continue;
        }
        const uint8_t step = message->data[STEP_BYTE];
        if (gaps->step_seen && (uint8_t)(step - gaps->step) > 1) {
            note(replay, "the step number jumps in", message->id, replay->next[i].line);
        }
        gaps->step_seen = true;
        gaps->step = step;
    }
}

/* Longer than any period should be: half as much again where they are even (by the clock, or simulated),
 * many times where they are not (lock-step, where somebody may have been waited for). */
static bool is_pause(const struct replay_gaps *gaps, uint64_t period_us)
{
    const bool even = EVEN_SHARE * gaps->mean_deviation_us < gaps->mean_period_us;
    return gaps->periods >= PERIODS_MIN &&
           (even ? 2 * period_us > 3 * gaps->mean_period_us
                 : period_us > PAUSE_PERIODS * (gaps->mean_period_us + 1));
}

static uint64_t average(uint64_t mean, uint64_t value)
{
    return (15 * mean + value) / 16;
}

/* Time counts only where nothing else was found. */
static void look_at_time(struct replay *replay, unsigned long line, uint64_t time_us)
{
    struct replay_gaps *gaps = &replay->gaps;
    const uint64_t period_us =
        gaps->sync_us != 0 && time_us > gaps->sync_us ? time_us - gaps->sync_us : 0;
    gaps->sync_us = time_us;
    if (period_us == 0) {
        return;
    }
    if (is_pause(gaps, period_us)) {
        gaps->pause_us = period_us;
        gaps->pause_line = line;
        gaps->pause_tick = replay->ticks;
        return;
    }
    const uint64_t mean_us = gaps->mean_period_us;
    const uint64_t off_us = period_us > mean_us ? period_us - mean_us : mean_us - period_us;
    gaps->mean_period_us = gaps->periods == 0 ? period_us : average(mean_us, period_us);
    gaps->mean_deviation_us = gaps->periods == 0 ? 0 : average(gaps->mean_deviation_us, off_us);
    gaps->periods++;
}

void replay_gaps_look(struct replay *replay, unsigned long line, uint64_t time_us)
{
    if (replay->running) {
        look_at_cycle(replay, line);
        look_at_steps(replay);
        look_at_time(replay, line, time_us);
    } else {
        replay->gaps = (struct replay_gaps){.sync_us = time_us};
    }
}

void replay_gaps_agreed(struct replay *replay, uint64_t told_tick)
{
    struct replay_gaps *gaps = &replay->gaps;
    if (told_tick > gaps->sign_tick + 1) {
        gaps->has_sign = false;
    }
    if (told_tick > gaps->pause_tick + 1) {
        gaps->pause_us = 0;
    }
}

bool replay_gaps_explain(const struct replay *replay, char *text, size_t size)
{
    const struct replay_gaps *gaps = &replay->gaps;
    /* A frame that only may differ is known to when the next digest is told. */
    const uint64_t found_tick = replay->suspects > 0 ? replay->suspected_tick : replay->ticks;
    if (gaps->has_sign && found_tick <= gaps->sign_tick + SIGN_LASTS_TICKS) {
        snprintf(text, size, "frames are missing from the log: %s", gaps->sign);
        return true;
    }
    if (gaps->pause_us != 0 && found_tick <= gaps->pause_tick + SIGN_LASTS_TICKS) {
        snprintf(text, size,
                 "frames are missing from the log, it seems: before line %lu it is silent for "
                 "%.3f s, where a period is %.3f ms",
                 gaps->pause_line, (double)gaps->pause_us / 1e6,
                 (double)gaps->mean_period_us / 1e3);
        return true;
    }
    return false;
}
