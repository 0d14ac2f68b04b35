/* The SEAs on a person who cannot be moved: the recording leads, forces are felt only. */
#include <stddef.h>

#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/walk_internal.h"

/* Recording's time at a plant time: it stands still before recording_start_tick. */
static double recording_s(const struct plant *plant, uint64_t tick)
{
    const uint64_t start = plant->config.recording_start_tick;
    return tick <= start ? 0.0
                         : (double)(tick - start) * plant->config.tick_s + plant->motion.shift_s;
}

static double plant_time_of_s(const struct plant *plant, double recorded_s)
{
    return recorded_s - plant->motion.shift_s +
           (double)plant->config.recording_start_tick * plant->config.tick_s;
}

/* Heel strikes and toe-offs of the samples that this tick reaches. */
static void pass_contacts(struct plant *plant, size_t from, size_t to)
{
    const struct recording *recording = &plant->recording;
    for (size_t i = from + 1; i <= to && recording->has_contact; i++) {
        const struct recording_sample *now = &recording->samples[i], *before = now - 1;
        const double time_s = plant_time_of_s(plant, now->time_s);
        for (int k = 0; k < SIDE_COUNT; k++) {
            const enum side side = (enum side)k;
            if (now->contact[side] && !before->contact[side]) {
                walk_post(&plant->walk, WALK_EVENT_HEEL_STRIKE, side, time_s,
                          now->leg_angle_rad[side]);
            } else if (!now->contact[side] && before->contact[side]) {
                walk_post(&plant->walk, WALK_EVENT_TOE_OFF, side, time_s, now->leg_angle_rad[side]);
            }
        }
    }
}

/* The recorded leg passes the vertical while its foot is on the ground. */
static void pass_apex(struct plant *plant, const struct recorded_person_state *next)
{
    const struct recorded_person_state *now = &plant->person;
    for (int k = 0; k < SIDE_COUNT; k++) {
        const double from = now->leg_angle_rad[k], to = next->leg_angle_rad[k];
        if (from > 0.0 && to <= 0.0 && (next->contact[k] || !plant->recording.has_contact)) {
            const double part = from / (from - to);
            const double rate =
                now->leg_rate_rad_s[k] + part * (next->leg_rate_rad_s[k] - now->leg_rate_rad_s[k]);
            walk_post(&plant->walk, WALK_EVENT_APEX, (enum side)k,
                      plant_now_s(plant) + part * plant->config.tick_s, -rate);
        }
    }
}

static void run_actuator(struct plant *plant, enum side side,
                         const struct recorded_person_state *next)
{
    struct sea *sea = &plant->sea[side];
    const double period_s = sea->params.drive_period_s;
    const int periods = (int)(plant->config.tick_s / period_s + 0.5);
    const double start_m = plant->person.ankle_m[side];
    const double step_m = (next->ankle_m[side] - start_m) / (double)periods;
    for (int i = 0; i < periods; i++) {
        const double ankle_m = start_m + (double)i * step_m;
        plant_run_latch(plant, side, ankle_m, plant_now_s(plant) + (double)i * period_s);
        sea_drive_period(sea, ankle_m);
        const double before_N = sea_ankle_force_N(sea, ankle_m);
        sea_finish_period(sea);
        const double after_N = sea_ankle_force_N(sea, ankle_m + step_m);
        plant->person_work_J[side] += 0.5 * (before_N + after_N) * step_m;
    }
}

void plant_advance_recorded_person(struct plant *plant)
{
    const size_t from = plant->recording_cursor;
    struct recorded_person_state next;
    if (plant->tick + 1 > plant->config.recording_start_tick && plant->motion.rate != 1.0) {
        plant->motion.shift_s += (plant->motion.rate - 1.0) * plant->config.tick_s;
    }
    recorded_person_at(&plant->recording, recording_s(plant, plant->tick + 1),
                       &plant->recording_cursor, &next);
    person_motion_apply(&plant->motion, plant->config.tick_s, &plant->person, &next);
    pass_apex(plant, &next);
    pass_contacts(plant, from, plant->recording_cursor);
    plant_run_switches(plant, plant->recording.has_contact);
    for (int side = 0; side < SIDE_COUNT; side++) {
        run_actuator(plant, (enum side)side, &next);
    }
    plant->person = next;
}
