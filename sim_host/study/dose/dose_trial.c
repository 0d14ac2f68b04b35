#include "sim_host/study/dose/dose_trial.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/loop.h"

static_assert((int)DOSE_MESSAGE_MAX >= (int)LOOP_MESSAGE_MAX, "a loop's message has room");

enum {
    LONGEST_STEP_MS = 3000, /* who takes longer has stopped walking */
    PUSH_MS = 200,
    AFTER_PUSH_MS = 8000
};
static const double PUSH_MOST_N = 400.0;

static int configure(const struct dose_trial *trial, struct loop_config *config, char *message)
{
    struct walk_options walk;
    struct sensing_options sensing;
    struct recording_options person;
    walk_options_init(&walk);
    walk.person_path = trial->person_path;
    walk.device_path = trial->device_path;
    walk.start_r0_m = trial->r0_m;
    walk.kp = 0.0; /* each push is the prescribed one */
    walk.person = true;
    sensing_options_init(&sensing);
    sensing.seed = trial->seed;
    recording_options_init(&person);
    person.by_reflexes = true;
    person.without_device = trial->without_device;
    if (sensing_options_configure(&sensing, &walk, NULL, config, message) != 0 ||
        recording_options_apply(&person, config, message) != 0) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        config->plant.sea[side].release_latency_s += trial->late_s;
    }
    return 0;
}

/* ---- what is measured ------------------------------------------------------------------ */

/* Sums from the walk's begin to a moment. */
struct sums {
    double time_s, way_m, work_J[JOINT_COUNT], device_J;
};

static struct sums sums_of(const struct plant *plant)
{
    struct sums sums = {.time_s = plant_walked_s(plant),
                        .way_m = plant->reflex.body.q[MULTIBODY_X]};
    for (int side = 0; side < SIDE_COUNT; side++) {
        sums.device_J += plant->person_work_J[side];
        for (int joint = 0; joint < JOINT_COUNT; joint++) {
            sums.work_J[joint] += plant->reflex.muscle_positive_work_J[side][joint];
        }
    }
    return sums;
}

/* Activation, summed over the ticks measured. */
struct activation {
    double all, soleus;
    uint32_t ticks;
};

static void add_activation(const struct plant *plant, struct activation *sum)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct muscle_state *muscle = plant->reflex.muscle[side];
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            sum->all += muscle[i].activation / (SIDE_COUNT * MUSCLE_COUNT);
        }
        sum->soleus += muscle[MUSCLE_SOL].activation / SIDE_COUNT;
    }
    sum->ticks++;
}

static void measure(const struct sums *from, const struct sums *to, uint32_t steps,
                    const struct activation *activation, struct dose_result *result)
{
    const double way_m = to->way_m - from->way_m, time_s = to->time_s - from->time_s;
    result->speed_m_s = way_m / time_s;
    result->cadence_per_min = 60.0 * steps / time_s;
    result->ankle_J_m = (to->work_J[JOINT_ANKLE] - from->work_J[JOINT_ANKLE]) / way_m;
    result->knee_J_m = (to->work_J[JOINT_KNEE] - from->work_J[JOINT_KNEE]) / way_m;
    result->hip_J_m = (to->work_J[JOINT_HIP] - from->work_J[JOINT_HIP]) / way_m;
    result->device_J_m = (to->device_J - from->device_J) / way_m;
    result->activation = activation->all / activation->ticks;
    result->soleus = activation->soleus / activation->ticks;
}

/* Whoever takes no step for so long has stopped walking. */
struct progress {
    uint32_t steps;
    uint64_t last_step_tick;
};

static bool walks_on(struct progress *progress, const struct loop *loop)
{
    const struct plant *plant = &loop->nodes.plant;
    if (plant_steps(plant) != progress->steps) {
        progress->steps = (uint32_t)plant_steps(plant);
        progress->last_step_tick = loop->tick;
    }
    return plant_fault(plant) == WALK_FAULT_NONE &&
           loop->tick <= progress->last_step_tick + TICKS_OF_MS(LONGEST_STEP_MS);
}

/* Walks the steps; the second half of them is measured, from foothold to foothold. */
static void walk_steps(const struct dose_trial *trial, struct loop *loop,
                       struct dose_result *result)
{
    const struct plant *plant = &loop->nodes.plant;
    const uint32_t half = trial->steps / 2;
    struct activation activation = {0.0, 0.0, 0};
    struct sums from = {0};
    struct progress progress = {.last_step_tick = plant->config.recording_start_tick};
    if (trial->steps == 0) {
        return;
    }
    while (result->steps < trial->steps) {
        loop_tick(loop);
        if (result->steps >= half) {
            add_activation(plant, &activation);
        }
        result->fell = !walks_on(&progress, loop);
        if (progress.steps != result->steps && progress.steps == half) {
            from = sums_of(plant);
        }
        result->steps = progress.steps;
        if (result->fell) {
            return;
        }
    }
    const struct sums to = sums_of(plant);
    measure(&from, &to, trial->steps - half, &activation, result);
}

/* ---- the margin ------------------------------------------------------------------------ */

static bool survives(struct loop *loop, const struct loop *saved, double push_N)
{
    const double tick_s = saved->config.plant.tick_s;
    memcpy(loop, saved, sizeof *loop);
    struct progress progress = {(uint32_t)plant_steps(&loop->nodes.plant), loop->tick};
    for (uint32_t tick = 0; tick < TICKS_OF_MS(AFTER_PUSH_MS); tick++) {
        if (tick < TICKS_OF_MS(PUSH_MS)) {
            plant_push(&loop->nodes.plant, -push_N * tick_s, 0.0); /* forward is -x */
        }
        loop_tick(loop);
        if (!walks_on(&progress, loop)) {
            return false;
        }
    }
    return true;
}

/* By bisection, as if whoever survives a push survived every smaller one. */
static double margin_N(struct loop *loop, const struct loop *saved, double step_N)
{
    int low = 0, high = (int)(PUSH_MOST_N / step_N) + 1;
    if (!survives(loop, saved, 0.0)) {
        return 0.0;
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (survives(loop, saved, middle * step_N)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low * step_N;
}

int dose_trial_run(const struct dose_trial *trial, struct dose_result *result, char *message)
{
    struct loop_config *config = (struct loop_config *)malloc(sizeof *config);
    struct loop *loop = (struct loop *)malloc(sizeof *loop);
    struct loop *saved = (struct loop *)malloc(sizeof *saved);
    int status = -1;
    *result = (struct dose_result){0};
    if (config == NULL || loop == NULL || saved == NULL) {
        snprintf(message, DOSE_MESSAGE_MAX, "out of memory");
    } else if (configure(trial, config, message) == 0 &&
               loop_init(loop, config, NULL, message) == 0) {
        walk_steps(trial, loop, result);
        if (!result->fell && trial->push_step_N > 0.0) {
            memcpy(saved, loop, sizeof *saved);
            result->push_margin_N = margin_N(loop, saved, trial->push_step_N);
        }
        loop_free(loop);
        status = 0;
    }
    free(saved);
    free(loop);
    free(config);
    return status;
}
