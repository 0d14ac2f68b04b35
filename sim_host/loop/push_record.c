#include "sim_host/loop/push_record.h"

#include <math.h>
#include <string.h>

/* The spring counts as loaded from this share of its target on. */
#define LOADED_SHARE 0.95

double push_mean_of(const struct push_mean *mean)
{
    return mean->count > 0 ? mean->sum / (double)mean->count : (double)NAN;
}

static void add(struct push_mean *mean, double value)
{
    mean->sum += value;
    mean->count++;
}

static void begin_stride(struct push_leg_record *leg, double time_s, bool counts)
{
    leg->now.counts = counts;
    leg->now.strike_s = time_s;
    leg->now.toe_off_s = leg->now.other_s = leg->now.loaded_s = -1.0;
    leg->now.release_s = leg->now.end_s = -1.0;
    leg->now.torque_Nm = leg->now.power_W = 0.0;
}

void push_record_init(struct push_record *record, const struct loop *loop)
{
    memset(record, 0, sizeof *record);
    record->has_lever = loop->config.plant.kind != PLANT_WALKER;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct push_leg_record *leg = &record->leg[side];
        leg->ankle_least_m = HUGE_VAL;
        leg->ankle_most_m = -HUGE_VAL;
        leg->lowest_V = HUGE_VAL;
        leg->hottest_degC = -HUGE_VAL;
        begin_stride(leg, -1.0, false);
    }
}

/* The stride is over: now the shares of its events are known. */
static void end_stride(struct push_leg_record *leg, double time_s)
{
    const double stride_s = time_s - leg->now.strike_s;
    if (!leg->now.counts || leg->now.strike_s < 0.0) {
        return;
    }
    leg->stances++;
    if (leg->now.release_s < 0.0) {
        return;
    }
    leg->pushes++;
    add(&leg->torque_Nm, leg->now.torque_Nm);
    add(&leg->power_W, leg->now.power_W);
    add(&leg->work_J, leg->last_work_J - leg->now.work_from_J);
    add(&leg->release_share, (leg->now.release_s - leg->now.strike_s) / stride_s);
    if (leg->now.loaded_s >= 0.0) {
        add(&leg->load_share, (leg->now.loaded_s - leg->now.strike_s) / stride_s);
    }
    if (leg->now.end_s >= 0.0) {
        add(&leg->end_share, (leg->now.end_s - leg->now.strike_s) / stride_s);
    }
}

static void strike(struct push_record *record, enum side side, double time_s)
{
    struct push_leg_record *leg = &record->leg[side], *other = &record->leg[side_other(side)];
    end_stride(leg, time_s);
    begin_stride(leg, time_s, leg->now.counts);
    if (other->now.other_s < 0.0) {
        other->now.other_s = time_s;
    }
}

void push_record_event(struct push_record *record, const struct walk_event *event)
{
    struct push_leg_record *leg = &record->leg[event->side];
    switch (event->kind) {
    case WALK_EVENT_HEEL_STRIKE:
        strike(record, event->side, event->time_s);
        break;
    case WALK_EVENT_TOE_OFF:
        leg->now.toe_off_s = event->time_s;
        break;
    case WALK_EVENT_RELEASE:
        leg->now.release_s = event->time_s;
        leg->now.work_from_J = leg->last_work_J;
        break;
    case WALK_EVENT_LIFT_OFF:
        leg->now.end_s = event->time_s;
        break;
    default:
        break;
    }
}

/* Newton metres per newton of spring where the ankle is; 1 without a lever. */
static double lever_m(const struct push_record *record, const struct loop *loop, enum side side,
                      double ankle_m)
{
    return record->has_lever ? plant_ankle_lever_m(&loop->nodes.plant, side, ankle_m) : 1.0;
}

static void take_push(struct push_leg_record *leg, double torque_Nm, double power_W)
{
    if (leg->now.release_s >= 0.0) {
        leg->now.torque_Nm = fmax(leg->now.torque_Nm, torque_Nm);
        leg->now.power_W = fmax(leg->now.power_W, power_W);
    }
    leg->most_torque_Nm = fmax(leg->most_torque_Nm, torque_Nm);
}

static void take_freedom(struct push_leg_record *leg, double now_s, double torque_Nm)
{
    const double size_Nm = fabs(torque_Nm);
    if (!leg->now.counts || leg->now.strike_s < 0.0) {
        return;
    }
    if (leg->now.toe_off_s >= 0.0 && now_s > leg->now.toe_off_s + PUSH_RECORD_FREE_S) {
        leg->swing_Nm = fmax(leg->swing_Nm, size_Nm);
    } else if (leg->now.other_s < 0.0 && leg->now.toe_off_s < 0.0) {
        leg->stance_Nm = fmax(leg->stance_Nm, size_Nm);
    }
}

static void take_motor(struct push_leg_record *leg, const struct sea_output *out)
{
    leg->current_squares_A2 += out->current_A * out->current_A;
    leg->peak_A = fmax(leg->peak_A, fabs(out->current_A));
    leg->hottest_degC = fmax(leg->hottest_degC, out->temperature_degC);
    leg->lowest_V = fmin(leg->lowest_V, out->dc_link_V);
    leg->limited_ticks += out->force_limited ? 1 : 0;
    leg->ticks++;
}

static void take_leg(struct push_record *record, const struct loop *loop, enum side side,
                     const struct plant_truth *truth)
{
    struct push_leg_record *leg = &record->leg[side];
    const struct sea *sea = &loop->nodes.plant.sea[side];
    struct sea_output out;
    plant_sea_output(&loop->nodes.plant, side, &out);
    const double lever = lever_m(record, loop, side, truth->way_m[side]);
    const double torque_Nm = out.ankle_force_N * lever;
    const double target_m = sea->command.target_position_m;
    const double prescribed_m = (double)loop->rig.task.controller.springs.sea[side].target_m;
    if (loop->rig.task.output.state == SUPERVISOR_WALKING) {
        take_motor(leg, &out);
        leg->ankle_least_m = fmin(leg->ankle_least_m, truth->ankle_m[side]);
        leg->ankle_most_m = fmax(leg->ankle_most_m, truth->ankle_m[side]);
        leg->now.counts = leg->now.counts || leg->pushes > 0 || leg->now.release_s >= 0.0;
    } else {
        leg->now.counts = false;
    }
    if (leg->now.loaded_s < 0.0 && out.latch == SEA_LATCH_CLOSED && prescribed_m > 0.0 &&
        out.position_m >= LOADED_SHARE * prescribed_m && leg->now.release_s < 0.0) {
        leg->now.loaded_s = truth->time_s;
    }
    take_push(leg, torque_Nm, out.ankle_force_N * truth->way_rate_m_s[side]);
    take_freedom(leg, truth->time_s, torque_Nm);
    if (out.latch == SEA_LATCH_RELEASED) {
        double stiffness, play_m;
        const double end_m = plant_spring_end_m(&loop->nodes.plant, side);
        sea_spring_at(sea, end_m, &stiffness, &play_m);
        const double ideal_N = fmax(0.0, stiffness * (target_m - play_m - end_m));
        const double off_Nm = torque_Nm - ideal_N * lever;
        leg->track_squares_Nm2 += off_Nm * off_Nm;
        leg->track_ticks++;
    }
}

void push_record_take(struct push_record *record, const struct loop *loop)
{
    struct plant_truth truth;
    struct plant_energy energy;
    plant_truth(&loop->nodes.plant, &truth);
    plant_energy(&loop->nodes.plant, &energy);
    for (int i = 0; i < SIDE_COUNT; i++) {
        struct push_leg_record *leg = &record->leg[i];
        take_leg(record, loop, (enum side)i, &truth);
        leg->last_work_J = energy.device_work_J[i];
    }
}

double push_record_symmetry(const struct push_record *record)
{
    const double left = push_mean_of(&record->leg[SIDE_LEFT].work_J);
    const double right = push_mean_of(&record->leg[SIDE_RIGHT].work_J);
    return left < right ? left / right : right / left;
}

double push_record_track_Nm(const struct push_leg_record *leg)
{
    return leg->track_ticks > 0 ? sqrt(leg->track_squares_Nm2 / (double)leg->track_ticks)
                                : (double)NAN;
}

double push_record_rms_A(const struct push_leg_record *leg)
{
    return leg->ticks > 0 ? sqrt(leg->current_squares_A2 / (double)leg->ticks) : (double)NAN;
}
