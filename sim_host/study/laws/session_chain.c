/* One walk of a session through the whole chain: bus, nodes, sensors, controller, SEA. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/loop/loop.h"
#include "sim_host/study/laws/session_internal.h"

/* What the last tick brought: the plant's apexes and finished steps. The first apex is the start. */
static void read_events(struct loop *loop, int steps, struct session_result *result, int *apexes)
{
    struct walk *walk = &loop->nodes.plant.walk;
    struct walk_event event;
    struct walk_step step;
    while (walk_next_event(walk, &event)) {
        if (event.kind == WALK_EVENT_FAULT) {
            result->fell = true;
            result->reason = walk_fault_name(walk->fault);
        } else if (event.kind == WALK_EVENT_APEX) {
            if (*apexes > 0 && *apexes <= steps) {
                if (result->step != NULL) {
                    result->step[*apexes - 1].speed_rad_s = event.value;
                }
                result->steps = *apexes;
            }
            (*apexes)++;
        }
    }
    while (walk_next_step(walk, &step)) {
        const int k = *apexes - 1;
        if (k >= 0 && k < steps && result->step != NULL) {
            result->step[k].r0_m = step.precompression_m;
            result->step[k].step_length_m = step.step_length_m;
        }
    }
}

/* Pushes once, when the share of the last stride's time has gone since the apex of that step. */
struct pusher {
    double apex_s, stride_s;
    int apexes;
    bool done;
};

static void maybe_push(struct pusher *pusher, const struct session_config *config,
                       struct loop *loop, int apexes)
{
    const double now_s = loop->nodes.plant.walk.time_s;
    if (apexes != pusher->apexes) {
        pusher->stride_s = now_s - pusher->apex_s;
        pusher->apex_s = now_s;
        pusher->apexes = apexes;
    }
    if (config->push_Ns != 0.0 && !pusher->done && apexes == config->push_step &&
        now_s >= pusher->apex_s + config->push_phase * pusher->stride_s) {
        plant_push(&loop->nodes.plant, -config->push_Ns, 0.0); /* forward is -x */
        pusher->done = true;
    }
}

static int start_chain(const struct laws_options *options, const struct session_config *config,
                       struct loop *loop, struct session_ground *ground, double *heights_m)
{
    char message[LOOP_MESSAGE_MAX];
    struct law_setup setup = law_case_setup(options, config->law_case);
    struct loop_config loop_config;
    double apex[3];
    const struct subject *body = config->truth != NULL ? config->truth : &options->subject;
    setup.params.start_r0_m = (real)law_setup_gait(&setup, config->from_rad_s, apex);
    if (loop_configure(&loop_config, body, &setup.params, config->to_rad_s, options->sensors,
                       config->seed, message) != 0) {
        fprintf(stderr, "afo study laws: %s\n", message);
        return -1;
    }
    session_ground_init(ground, &setup, config);
    if (config->heights) {
        for (int i = 0; i <= SESSION_STEPS_MAX; i++) {
            const double rise = i == 0 ? 0.0 : session_ground_rise(ground, config);
            heights_m[i] = (i > 0 ? heights_m[i - 1] : 0.0) + rise * body->person.leg_length_m;
        }
        loop_config.plant.heights_m = heights_m;
        loop_config.plant.heights_count = SESSION_STEPS_MAX + 1;
    }
    if (loop_init(loop, &loop_config, NULL, message) != 0) {
        fprintf(stderr, "afo study laws: %s\n", message);
        return -1;
    }
    return 0;
}

int session_run_chain(const struct laws_options *options, const struct session_config *config,
                      struct session_result *result)
{
    struct loop *loop = malloc(sizeof *loop);
    double *heights_m = malloc((SESSION_STEPS_MAX + 1) * sizeof *heights_m);
    struct session_ground ground;
    double incline = 0.0;
    int status = -1;
    if (loop == NULL || heights_m == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
    } else if (start_chain(options, config, loop, &ground, heights_m) == 0) {
        const uint64_t ticks_max = 6000u + 3000u * (uint64_t)config->steps;
        struct pusher pusher = {0.0, 0.0, 0, false};
        uint32_t step_number = 0;
        int apexes = 0;
        status = 0;
        for (uint64_t t = 0; t < ticks_max && !result->fell && result->steps < config->steps; t++) {
            loop_tick(loop);
            const int before = apexes;
            read_events(loop, config->steps, result, &apexes);
            if (apexes != before && !config->heights) {
                incline = atan(session_ground_rise(&ground, config) / ground.step_share);
            }
            maybe_push(&pusher, config, loop, apexes);
            const struct controller *controller = &loop->rig.task.controller;
            if (controller->last_step.number != step_number) {
                step_number = controller->last_step.number;
                result->fallbacks += controller->plan.law.used_fallback ? 1 : 0;
            }
            loop->nodes.plant.walk.params.slope_rad = session_slope_rad(config, apexes) + incline;
        }
        if (!result->fell && result->steps < config->steps) {
            result->fell = true;
            result->reason = "stopped";
        }
        loop_free(loop);
    }
    free(heights_m);
    free(loop);
    return status;
}
