#include "sim_host/study/laws/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/loop/loop.h"
#include "sim_host/plant/rng.h"
#include "sim_host/study/laws/walks.h"
#include "sim_host/study/pool.h"

static double slope_at(const struct session_config *config, int step)
{
    if (config->slope_ramp_rad <= 0.0) {
        return config->slope_rad;
    }
    const double gone = config->slope_ramp_rad * (step + 1);
    return fabs(config->slope_rad) < gone ? config->slope_rad : copysign(gone, config->slope_rad);
}

/* Ground between two footholds, drawn per step: an incline, or the foothold's height. */
struct terrain {
    struct rng rng;
    double step_share; /* steady step length over leg length */
};

static void terrain_init(struct terrain *terrain, const struct law_setup *setup,
                         const struct session_config *config)
{
    struct laws_stride stride;
    double apex[3];
    const double r0_m = law_setup_gait(setup, config->to_rad_s, apex);
    (void)laws_stride(&setup->truth, LAWS_COARSE, apex, r0_m, 0.0, 0.0, &stride);
    terrain->step_share = stride.step_length_m / setup->truth.leg_length_m;
    rng_init(&terrain->rng, config->seed, 71);
}

static double draw_rise(struct terrain *terrain, const struct session_config *config)
{
    return config->rise_most * (2.0 * rng_uniform(&terrain->rng) - 1.0);
}

/* ---- on the map ------------------------------------------------------------------------- */

/* All walks of a call; a walk's setup is its own, for its body may be. */
struct map_walk {
    const struct session_config *config;
    struct session_result *result;
    struct law_setup setup;
    struct terrain terrain;
    struct rng rng;
    int strides; /* answered */
};

static void look(void *context, size_t i, struct laws_ahead *ahead)
{
    struct map_walk *walk = (struct map_walk *)context + i;
    const struct session_config *config = walk->config;
    for (int k = 0; k < 3; k++) {
        ahead->seen[k] *= 1.0 + config->noise_rms * rng_normal(&walk->rng);
    }
    const double rise = draw_rise(&walk->terrain, config);
    const double incline = config->heights ? 0.0 : atan(rise / walk->terrain.step_share);
    ahead->desired_rad_s = config->to_rad_s;
    ahead->slope_rad = slope_at(config, walk->strides++) + incline;
    ahead->rise = config->heights ? rise : 0.0;
}

static int record_stride(void *context, size_t i, const struct laws_walk *walk)
{
    const struct map_walk *mine = (const struct map_walk *)context + i;
    struct session_result *result = mine->result;
    result->fallbacks += walk->law.used_fallback ? 1 : 0;
    if (walk->stride.fault != 0) {
        result->fell = true;
        result->reason = laws_fault_name(walk->stride.fault);
        return 1;
    }
    if (result->step != NULL) {
        result->step[result->steps] =
            (struct session_step){-walk->apex[0], walk->r0_m, walk->stride.step_length_m};
    }
    result->steps++;
    return result->steps >= mine->config->steps;
}

static void start_on_map(const struct laws_options *options, struct map_walk *walk,
                         struct laws_course *course)
{
    const struct session_config *config = walk->config;
    double apex[3];
    walk->setup = law_case_setup(options, config->law_case);
    if (config->truth != NULL) {
        walk->setup.truth = subject_gait_walker(config->truth);
    }
    rng_init(&walk->rng, config->seed, 72);
    terrain_init(&walk->terrain, &walk->setup, config);
    const double r0_m = law_setup_gait(&walk->setup, config->from_rad_s, apex);
    struct gait_point own; /* a body that differs starts in its own gait of this r0 */
    if (config->truth != NULL &&
        gait_curve(&walk->setup.truth, r0_m, 0.0, 1, &own, NULL) == GAIT_CURVE_OK) {
        memcpy(apex, own.apex, sizeof apex);
    }
    course->setup = &walk->setup;
    laws_walk_start(&walk->setup, &course->walk, apex, r0_m, config->from_rad_s);
}

static int run_on_map(const struct laws_options *options, const struct session_config *configs,
                      int count, struct session_result *results)
{
    struct map_walk *walks = calloc((size_t)count, sizeof *walks);
    struct laws_course *courses = calloc((size_t)count, sizeof *courses);
    int status = -1, strides = 0;
    if (walks == NULL || courses == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
    } else {
        for (int i = 0; i < count; i++) {
            walks[i].config = &configs[i];
            walks[i].result = &results[i];
            start_on_map(options, &walks[i], &courses[i]);
            strides = configs[i].steps > strides ? configs[i].steps : strides;
        }
        status = laws_walks_run(courses, (size_t)count, strides, look, record_stride, walks,
                                options->threads);
    }
    free(walks);
    free(courses);
    return status;
}

/* ---- through the chain ------------------------------------------------------------------ */

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
                       struct loop *loop, struct terrain *terrain, double *heights_m)
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
    terrain_init(terrain, &setup, config);
    if (config->heights) {
        for (int i = 0; i <= SESSION_STEPS_MAX; i++) {
            const double rise = i == 0 ? 0.0 : draw_rise(terrain, config);
            heights_m[i] = (i > 0 ? heights_m[i - 1] : 0.0) + rise * body->leg_length_m;
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

static int run_on_chain(const struct laws_options *options, const struct session_config *config,
                        struct session_result *result)
{
    struct loop *loop = malloc(sizeof *loop);
    double *heights_m = malloc((SESSION_STEPS_MAX + 1) * sizeof *heights_m);
    struct terrain terrain;
    double incline = 0.0;
    int status = -1;
    if (loop == NULL || heights_m == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
    } else if (start_chain(options, config, loop, &terrain, heights_m) == 0) {
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
                incline = atan(draw_rise(&terrain, config) / terrain.step_share);
            }
            maybe_push(&pusher, config, loop, apexes);
            const struct controller *controller = &loop->rig.task.controller;
            if (controller->last_step.number != step_number) {
                step_number = controller->last_step.number;
                result->fallbacks += controller->plan.law.used_fallback ? 1 : 0;
            }
            loop->nodes.plant.walk.params.slope_rad = slope_at(config, apexes) + incline;
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

struct chain_jobs {
    const struct laws_options *options;
    const struct session_config *configs;
    struct session_result *results;
};

static void compute_chain(void *context, int i)
{
    const struct chain_jobs *jobs = (const struct chain_jobs *)context;
    jobs->results[i].failed =
        run_on_chain(jobs->options, &jobs->configs[i], &jobs->results[i]) != 0;
}

int session_run(const struct laws_options *options, const struct session_config *configs, int count,
                struct session_result *results)
{
    for (int i = 0; i < count; i++) {
        struct session_step *const step = results[i].step;
        results[i] = (struct session_result){.reason = "", .step = step};
    }
    if (!options->chain) {
        return run_on_map(options, configs, count, results);
    }
    struct chain_jobs all = {options, configs, results};
    const int threads = count < options->threads ? count : options->threads;
    const struct pool_jobs jobs = {0, count, threads, &all, compute_chain, laws_count_part};
    int status = pool_run(&jobs) == 1 ? 0 : -1;
    for (int i = 0; i < count; i++) {
        status = results[i].failed ? -1 : status;
    }
    return status;
}

int session_records(const struct session_config *configs, int count, struct session_result *results)
{
    size_t steps = 1; /* of nothing calloc may give nothing */
    for (int i = 0; i < count; i++) {
        steps += (size_t)configs[i].steps;
    }
    results[0].step = calloc(steps, sizeof *results[0].step);
    if (results[0].step == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
        return -1;
    }
    for (int i = 1; i < count; i++) {
        results[i].step = results[i - 1].step + configs[i - 1].steps;
    }
    return 0;
}

void session_records_free(struct session_result *results)
{
    free(results[0].step);
    results[0].step = NULL;
}

int session_settled(const struct session_result *result, double target_rad_s, double share)
{
    int settled = 0;
    for (int k = 0; k < result->steps; k++) {
        if (fabs(result->step[k].speed_rad_s - target_rad_s) > share * target_rad_s) {
            settled = k + 1;
        }
    }
    return settled + 1;
}

double session_mean_speed(const struct session_result *result, int over)
{
    const int first = result->steps > over ? result->steps - over : 0;
    double sum = 0.0;
    for (int k = first; k < result->steps; k++) {
        sum += result->step[k].speed_rad_s;
    }
    return result->steps > first ? sum / (result->steps - first) : 0.0;
}
