#include "sim_host/study/observer/observed_walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/study/observer/estimators.h"

/* The walker's own swing is near 0.7 Hz; a filter for its legs as gait labs use it. */
#define BUTTERWORTH_HZ 10.0

enum { TICKS_A_STEP_MAX = TICKS_OF_MS(4000) };

struct truth {
    double time_s[GAIT_EVENT_KINDS]; /* of the newest event of each kind; < 0 = already seen */
    double speed, swing_angle, swing_rate;
    enum side side;
};

/* A walk under way. */
struct session {
    struct loop loop;
    struct truth truth;
    struct naive_estimator naive[SIDE_COUNT];
    int passed, settle;
    double sum, squares;
    int counted;
    struct observed_walk *walk;
};

static bool counts(const struct session *session)
{
    return session->passed > session->settle;
}

static void add_error(struct speed_errors *errors, double error)
{
    errors->rms += error * error;
    errors->mean += error;
    errors->worst = fmax(errors->worst, fabs(error));
    errors->count++;
}

static void see_truth(struct session *session, const struct walk_event *event)
{
    struct truth *truth = &session->truth;
    struct plant_truth now;
    int kind;
    switch (event->kind) {
    case WALK_EVENT_APEX:
        kind = GAIT_APEX;
        break;
    case WALK_EVENT_HEEL_STRIKE:
        kind = GAIT_HEEL_STRIKE;
        break;
    case WALK_EVENT_LIFT_OFF:
        kind = GAIT_LIFT_OFF;
        break;
    default:
        return;
    }
    if (truth->time_s[kind] >= 0.0 && counts(session)) {
        session->walk->event[kind].missed++;
    }
    truth->time_s[kind] = event->time_s;
    if (kind == GAIT_APEX) {
        plant_truth(&session->loop.nodes.plant, &now);
        const double back_s = now.time_s - event->time_s;
        const enum side swing = side_other(event->side);
        truth->side = event->side;
        truth->speed = event->value;
        truth->swing_angle = now.leg_angle_rad[swing] - back_s * now.leg_rate_rad_s[swing];
        truth->swing_rate = now.leg_rate_rad_s[swing];
        session->passed++;
        if (counts(session)) {
            session->sum += event->value;
            session->squares += event->value * event->value;
            session->counted++;
        }
    }
}

static void see_apex(struct session *session, const struct gait_state *gait)
{
    struct observed_walk *walk = session->walk;
    const struct truth *truth = &session->truth;
    const double speed = (double)gait->event[GAIT_APEX].speed_rad_s;
    const double angle = (double)gait->apex.swing_angle_rad - truth->swing_angle;
    const double rate = (double)gait->apex.swing_rate_rad_s - truth->swing_rate;
    add_error(&walk->observer, speed / truth->speed - 1.0);
    walk->swing_angle_rms_rad += angle * angle;
    walk->swing_rate_rms_rad_s += rate * rate;
    walk->confidence += (double)gait->apex.confidence;
}

static void see_events(struct session *session)
{
    const struct gait_state *gait = &session->loop.rig.task.controller.observer.state;
    const double now_s = (double)(session->loop.tick - 1) * (TICK_PERIOD_US / 1e6);
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        const struct gait_event *event = &gait->event[kind];
        double *truth_s = &session->truth.time_s[kind];
        if (!event->happened) {
            continue;
        }
        if (*truth_s < 0.0 || (kind == GAIT_APEX && event->side != session->truth.side)) {
            session->walk->false_apexes += kind == GAIT_APEX;
            continue;
        }
        if (counts(session)) {
            struct event_errors *errors = &session->walk->event[kind];
            /* SYNCs count from 1, and a tick's samples are one SYNC old. */
            const double error = ((double)event->tick - 2.0) * (TICK_PERIOD_US / 1e6) -
                                 (double)event->before_tick_s - *truth_s;
            errors->rms_s += error * error;
            errors->worst_s = fmax(errors->worst_s, fabs(error));
            errors->delay_s += now_s - *truth_s;
            errors->count++;
            if (kind == GAIT_APEX) {
                see_apex(session, gait);
            }
        }
        *truth_s = -1.0;
    }
}

/* The same samples, judged the naive way; the truth is the newest apex of that leg. */
static void see_naive(struct session *session)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        bool plain, filtered;
        const struct sensor_sample *sample = &session->loop.nodes.sample[side];
        struct naive_estimator *naive = &session->naive[side];
        naive_estimator_update(naive, sample->leg_angle_rad, TICK_PERIOD_US / 1e6, &plain,
                               &filtered);
        const bool mine = session->truth.side == (enum side)side && counts(session);
        if (plain && mine) {
            add_error(&session->walk->plain, naive->plain_rad_s / session->truth.speed - 1.0);
        }
        if (filtered && mine) {
            add_error(&session->walk->filtered, naive->filtered_rad_s / session->truth.speed - 1.0);
        }
    }
}

static void finish_errors(struct speed_errors *errors)
{
    if (errors->count > 0) {
        errors->rms = sqrt(errors->rms / errors->count);
        errors->mean /= errors->count;
    }
}

static void finish(struct session *session)
{
    struct observed_walk *walk = session->walk;
    const double n = walk->observer.count > 0 ? (double)walk->observer.count : 1.0;
    finish_errors(&walk->observer);
    finish_errors(&walk->plain);
    finish_errors(&walk->filtered);
    walk->swing_angle_rms_rad = sqrt(walk->swing_angle_rms_rad / n);
    walk->swing_rate_rms_rad_s = sqrt(walk->swing_rate_rms_rad_s / n);
    walk->confidence /= n;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        struct event_errors *errors = &walk->event[kind];
        if (errors->count > 0) {
            errors->rms_s = sqrt(errors->rms_s / errors->count);
            errors->delay_s /= errors->count;
        }
    }
    if (session->counted > 0) {
        const double mean = session->sum / session->counted;
        walk->mean_speed_rad_s = mean;
        walk->speed_spread =
            sqrt(fmax(0.0, session->squares / session->counted - mean * mean)) / mean;
    }
    walk->steps = session->passed;
}

int observed_walk_run(const struct loop_config *config, int steps, int settle,
                      struct observed_walk *walk, char *message)
{
    struct session *session = (struct session *)calloc(1, sizeof *session);
    struct walk_event event;
    if (session == NULL) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
        return -1;
    }
    *walk = (struct observed_walk){0};
    session->walk = walk;
    session->settle = settle;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        session->truth.time_s[kind] = -1.0;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        naive_estimator_init(&session->naive[side], BUTTERWORTH_HZ, 1000.0);
    }
    if (loop_init(&session->loop, config, NULL, message) != 0) {
        free(session);
        return -1;
    }
    long patience = TICKS_A_STEP_MAX;
    while (session->passed < steps && patience-- > 0) {
        loop_tick(&session->loop);
        while (plant_next_event(&session->loop.nodes.plant, &event)) {
            see_truth(session, &event);
            patience = TICKS_A_STEP_MAX;
        }
        see_events(session);
        see_naive(session);
        const enum walk_fault fault = plant_fault(&session->loop.nodes.plant);
        if (fault != WALK_FAULT_NONE) {
            walk->fell = true;
            snprintf(walk->fault, sizeof walk->fault, "%s", walk_fault_name(fault));
            break;
        }
    }
    finish(session);
    loop_free(&session->loop);
    free(session);
    return 0;
}
