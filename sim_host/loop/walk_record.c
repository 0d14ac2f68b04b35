#include "sim_host/loop/walk_record.h"

#include <math.h>
#include <stdlib.h>

bool walk_record_init(struct walk_record *record, uint32_t capacity, double origin_s)
{
    *record = (struct walk_record){.capacity = capacity};
    gait_record_init(&record->gait, origin_s);
    record->rows = (struct walk_row *)calloc(capacity, sizeof *record->rows);
    return record->rows != NULL;
}

void walk_record_free(struct walk_record *record)
{
    gait_record_free(&record->gait);
    free(record->rows);
    record->rows = NULL;
}

static void add_row(struct walk_record *record, const struct walk_event *event)
{
    if (record->count == 0) {
        record->first_apex_s = event->time_s;
    }
    if (record->count < record->capacity) {
        record->rows[record->count] = (struct walk_row){.number = record->count + 1,
                                                        .side = event->side,
                                                        .time_s = event->time_s,
                                                        .apex_speed_rad_s = event->value,
                                                        .heel_strike_s = (double)NAN,
                                                        .toe_off_s = (double)NAN,
                                                        .push_off_J = (double)NAN,
                                                        .margin_m = (double)NAN};
        record->count++;
    }
}

/* A leg leaves the ground: it ends the stance that the last or the last but one row is of. */
static void take_toe_off(struct walk_record *record, const struct walk_event *event)
{
    for (uint32_t back = 0; back < 2 && back < record->count; back++) {
        struct walk_row *row = &record->rows[record->count - 1 - back];
        if (row->side == event->side) {
            if (!(row->toe_off_s == row->toe_off_s)) {
                row->toe_off_s = event->time_s;
            }
            return;
        }
    }
}

/* The event has a walker's step length; of a person it has the leg's angle. */
static double step_length_m(const struct plant *plant, const struct walk_event *event)
{
    struct plant_truth truth;
    if (plant->config.kind == PLANT_WALKER) {
        return event->value;
    }
    plant_truth(plant, &truth);
    return walking_step_length_m(plant->config.walk.body.leg_length_m, event->value,
                                 truth.leg_angle_rad[side_other(event->side)]);
}

static void take_strike(struct walk_record *record, const struct walk_event *event,
                        const struct plant *plant)
{
    struct walk_row *row = &record->rows[record->count - 1];
    row->step_length_m = step_length_m(plant, event);
    row->heel_strike_s = event->time_s;
    if (plant->config.kind == PLANT_WALKER && record->pose.leg_length_m > 0.0) {
        struct walking_pose pose = record->pose; /* and on to the very moment */
        pose.stance_rad += pose.stance_rad_s * (event->time_s - record->pose_s);
        pose.swing_rad += pose.swing_rad_s * (event->time_s - record->pose_s);
        row->margin_m = walking_margin_m(&pose);
    }
}

static void take_work(struct walk_record *record, const struct walk_step *step)
{
    for (uint32_t back = 0; back < 2 && back < record->count; back++) {
        struct walk_row *row = &record->rows[record->count - 1 - back];
        if (row->time_s == step->apex_time_s) {
            row->push_off_J = step->push_off_J;
        }
    }
}

/* The walker as it is now, for the heel strike that may come before the next tick. */
static void keep_pose(struct walk_record *record, const struct plant *plant)
{
    const struct walker3_params *body = &plant->config.walk.body;
    struct plant_truth truth;
    plant_truth(plant, &truth);
    if (truth.phase == WALK_SINGLE && !truth.is_person) {
        record->pose_s = truth.time_s;
        const enum side swing = truth.stance == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
        record->pose = (struct walking_pose){
            .hip_mass_kg = body->hip_mass_kg,
            .leg_mass_kg = body->leg_mass_kg,
            .leg_length_m = body->leg_length_m,
            .gravity_m_s2 = body->gravity_m_s2,
            .stance_rad = truth.leg_angle_rad[truth.stance],
            .swing_rad = truth.leg_angle_rad[swing],
            .stance_rad_s = truth.leg_rate_rad_s[truth.stance],
            .swing_rad_s = truth.leg_rate_rad_s[swing],
        };
    }
}

/* The controller reports an apex some ticks after it happened: it belongs to the
 * last row of that side that has none yet. */
static void match_step(struct walk_record *record, const struct step_record *step)
{
    record->apexes[step->side]++;
    for (uint32_t back = 0; back < 2 && back < record->count; back++) {
        struct walk_row *row = &record->rows[record->count - 1 - back];
        if (row->side == step->side && !row->measured) {
            row->measured = true;
            row->measured_speed_rad_s = (double)step->measured_speed_rad_s;
            row->command_rad_s = (double)step->commanded_speed_rad_s;
            row->r0_m = (double)step->r0_m;
            row->used_fallback = step->used_fallback;
            return;
        }
    }
    record->unmatched++;
}

int walk_record_take(struct walk_record *record, struct loop *loop)
{
    const bool walker = loop->nodes.plant.config.kind == PLANT_WALKER;
    struct walk_event event;
    struct walk_step step;
    int kind = -1;
    if (!record->push_begun) {
        push_record_init(&record->push, loop);
        record->push_begun = true;
    }
    while (plant_next_event(&loop->nodes.plant, &event)) {
        kind = (int)event.kind;
        gait_record_truth(&record->gait, &event);
        push_record_event(&record->push, &event);
        if (event.kind == WALK_EVENT_APEX) {
            add_row(record, &event);
        } else if (event.kind == WALK_EVENT_HEEL_STRIKE && record->count > 0) {
            take_strike(record, &event, &loop->nodes.plant);
        } else if (event.kind == (walker ? WALK_EVENT_LIFT_OFF : WALK_EVENT_TOE_OFF)) {
            take_toe_off(record, &event);
        }
    }
    while (plant_next_step(&loop->nodes.plant, &step)) {
        take_work(record, &step);
    }
    if (walker) {
        keep_pose(record, &loop->nodes.plant);
    }
    gait_record_take(&record->gait, loop);
    push_record_take(&record->push, loop);
    if (loop->rig.task.output.new_step) {
        loop->rig.task.output.new_step = false; /* taken */
        match_step(record, &loop->rig.task.controller.last_step);
    }
    return kind;
}

struct walk_summary walk_record_summary(const struct walk_record *record, uint32_t over)
{
    struct walk_summary summary = {.over = record->count < over ? record->count : over};
    double sum = 0.0;
    for (uint32_t i = record->count - summary.over; i < record->count; i++) {
        const double speed = record->rows[i].apex_speed_rad_s;
        sum += speed;
        if (i == record->count - summary.over || speed < summary.least_rad_s) {
            summary.least_rad_s = speed;
        }
        if (speed > summary.greatest_rad_s) {
            summary.greatest_rad_s = speed;
        }
    }
    summary.mean_rad_s = summary.over > 0 ? sum / summary.over : 0.0;
    return summary;
}
