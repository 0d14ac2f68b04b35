#include "firmware/drive_watch.h"

#include <float.h>

/* One telegram that says otherwise does not outweigh the others. Returns true when the drive
 * must be stopped. */
static bool count_disobedience(uint8_t *ticks, bool disobeys)
{
    if (disobeys) {
        (*ticks)++;
    } else if (*ticks > 0) {
        (*ticks)--;
    }
    if (*ticks < DRIVE_WATCH_STOP_TICKS) {
        return false;
    }
    *ticks = 0;
    return true;
}

/* The power is away until this is counted down to the limit, whatever the state is by then. */
static bool count_hold(struct drive_watch *watch)
{
    if (watch->powered_ticks < DRIVE_WATCH_POWER_TICKS) {
        return false;
    }
    watch->powered_ticks =
        watch->powered_ticks > DRIVE_WATCH_POWER_TICKS ? (uint16_t)(watch->powered_ticks - 1u) : 0;
    return true;
}

/* Up while a drive is not known to be off, down while all are: one telegram does not outweigh the others. At its
 * end the hold is added. */
static void count_powered(struct drive_watch *watch, bool off)
{
    if (!off) {
        if (++watch->powered_ticks >= DRIVE_WATCH_POWER_TICKS) {
            watch->powered_ticks = DRIVE_WATCH_POWER_TICKS + DRIVE_WATCH_HOLD_TICKS;
        }
    } else if (!count_hold(watch) && watch->powered_ticks > 0) {
        watch->powered_ticks--;
    }
}

/* A drive needs its torque while it is led to an empty spring. It is led while it follows a target that moves, or
 * unloads, however slowly; how long that may take is the supervisor's. One that answers and holds its spring is not. */
static bool is_led(struct drive_watch *watch, enum side leg, const struct sea_drive_reading *drive,
                   const struct sea_request *request, const struct control_params *params)
{
    const float reading_m = drive->precompression_m, target_m = request->precompression_m;
    const bool follows =
        target_m > 0.0f && reading_m - target_m <= DRIVE_WATCH_BEHIND_RATIO * params->leg_length_m;
    const bool moves =
        watch->nearest_m[leg] - reading_m >= DRIVE_WATCH_STILL_RATIO * params->leg_length_m;
    const bool slack = reading_m <= params->sea_tolerance_m;
    if (follows || moves || slack) {
        watch->nearest_m[leg] = reading_m;
        watch->still_ticks[leg] = 0;
    } else if (watch->still_ticks[leg] < DRIVE_WATCH_LED_TICKS) {
        watch->still_ticks[leg]++;
    }
    return drive->age_ticks <= DRIVE_WATCH_HEARD_TICKS &&
           watch->still_ticks[leg] < DRIVE_WATCH_LED_TICKS;
}

unsigned drive_watch_update(struct drive_watch *watch, const struct sea_drives *drives,
                            enum supervisor_state state,
                            const struct sea_request request[SIDE_COUNT],
                            const struct control_params *params)
{
    unsigned to_stop = 0;
    bool off = true;
    if (state != SUPERVISOR_UNLOADING && state != SUPERVISOR_FAULT) {
        if (!count_hold(watch)) {
            watch->powered_ticks = 0;
        }
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            (void)count_disobedience(&watch->disobeys[leg], false);
        }
        watch->stops = false;
        return 0;
    }
    if (!watch->stops) { /* whatever a drive reads first is nearer */
        watch->stops = true;
        watch->still_ticks[SIDE_LEFT] = watch->still_ticks[SIDE_RIGHT] = 0;
        watch->nearest_m[SIDE_LEFT] = watch->nearest_m[SIDE_RIGHT] = FLT_MAX;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)leg, &drive);
        const bool heard = drive.age_ticks <= DRIVE_WATCH_STOP_TICKS;
        const bool led = state == SUPERVISOR_UNLOADING &&
                         is_led(watch, (enum side)leg, &drive, &request[leg], params);
        const bool is_off = drive.state == DRIVE_DISABLED || drive.state == DRIVE_FAULT;
        off = off && heard && (led || is_off);
        /* What a silent one said last may be of before it was switched off and on. */
        const bool disobeys = heard && state == SUPERVISOR_FAULT && drive.state == DRIVE_ENABLED;
        if (count_disobedience(&watch->disobeys[leg], disobeys)) {
            to_stop |= 1u << leg;
        }
    }
    count_powered(watch, off);
    return to_stop;
}
