#include "sim_host/study/person/tuning.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "firmware/version.h"
#include "sim_host/loop/loop.h"
#include "sim_host/study/person/objective.h"
#include "sim_host/study/person/tuning_file.h"
#include "sim_host/study/pool.h"

#define SCALE_LEAST 0.05
#define COUNTED_FROM_S 3.0

enum { SEEDS_A_GENERATION = 16, FRESH_SEEDS = 1000000000, HEAD_MAX = 512 };

/* ---- numbers and persons -------------------------------------------------------------------------------------- */

static void numbers_of(const struct person_muscles *muscles, double number[TUNING_NUMBERS])
{
    int i = 0;
#define NUMBER(name, published, unit, meaning) number[i++] = muscles->gains.name;
    REFLEX_GAINS(NUMBER)
#undef NUMBER
    number[i++] = muscles->start_speed_m_s;
    number[i] = muscles->start_lean_rad;
}

static void set_numbers(const struct tuning *tuning, const double *x,
                        struct person_muscles *muscles)
{
    double number[TUNING_NUMBERS];
    int i = 0;
    for (int k = 0; k < TUNING_NUMBERS; k++) {
        number[k] = x[k] * tuning->scale[k];
    }
#define NUMBER(name, published, unit, meaning) muscles->gains.name = number[i++];
    REFLEX_GAINS(NUMBER)
#undef NUMBER
    muscles->start_speed_m_s = number[i++];
    muscles->start_lean_rad = number[i];
}

void tuning_person(const struct tuning *tuning, struct person *person)
{
    *person = tuning->plan.subject.person;
    set_numbers(tuning, tuning->search.mean, &person->muscles);
}

/* ---- a generation --------------------------------------------------------------------------------------------- */

/* Several persons, who each walk with the same seeds. */
struct walks {
    const struct tuning *tuning;
    struct person_muscles muscles[CMA_LAMBDA_MOST];
    int each;
    uint64_t seed;
    double value[CMA_LAMBDA_MOST];
};

static double value_of_walk(const struct walks *walks, int who, int which)
{
    const struct tuning_plan *plan = &walks->tuning->plan;
    const struct person_muscles *muscles = &walks->muscles[who];
    struct gait_summary summary;
    char message[LOOP_MESSAGE_MAX];
    const struct person_walk walk = {.subject = &plan->subject,
                                     .gains = &muscles->gains,
                                     .start_speed_m_s = muscles->start_speed_m_s,
                                     .start_lean_rad = muscles->start_lean_rad,
                                     .worn = plan->worn,
                                     .r0_m = plan->r0_m,
                                     .until_s = plan->walk_s,
                                     .from_s = COUNTED_FROM_S,
                                     .noise_share = plan->noise_share,
                                     .seed = walks->seed + (uint64_t)which,
                                     .push_m_s = plan->push_m_s,
                                     .step_s = plan->step_s};
    if (person_walk_run(&walk, &summary, message) != 0) {
        return 2.0 * OBJECTIVE_FALL; /* such a person cannot be */
    }
    return objective_of(&summary, plan->walk_s);
}

/* The mean of the person's walks; who falls does not walk again, and the others are taken for the same. */
static void compute(void *context, int who)
{
    struct walks *walks = (struct walks *)context;
    double sum = 0.0;
    for (int i = 0; i < walks->each; i++) {
        const double value = value_of_walk(walks, who, i);
        if (value >= OBJECTIVE_FALL) {
            sum += value * (walks->each - i);
            break;
        }
        sum += value;
    }
    walks->value[who] = sum / walks->each;
}

static int run(struct walks *walks, int persons)
{
    const struct pool_jobs jobs = {.count = persons,
                                   .threads = walks->tuning->plan.jobs,
                                   .context = walks,
                                   .compute = compute};
    return pool_run(&jobs) == 1 ? 0 : -1;
}

/* What a tuning depends on, in one line. */
static void head_of(const struct tuning *tuning, char head[HEAD_MAX])
{
    const struct tuning_plan *plan = &tuning->plan;
    const struct person *body = &plan->subject.person;
    double sum = 0.0; /* of start and strengths, so that another person is noticed */
    for (int i = 0; i < TUNING_NUMBERS; i++) {
        sum += (i + 1) * tuning->scale[i];
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            sum += (1 + i + MUSCLE_COUNT * side) * body->muscles.strength[side][i];
        }
    }
    snprintf(head, HEAD_MAX,
             "afo tune-person 2 of build %08" PRIx32
             ": %.17g kg, %.17g m, person %.17g, device %.40s at %.17g m, seed %" PRIu64
             ", %d walks of %.17g s, noise %.17g, push %.17g, sigma %.17g, step %.17g",
             version_build_id(), person_walk_mass_kg(body), body->leg_length_m, sum,
             plan->worn ? plan->subject.device.name : "none", plan->r0_m, plan->seed, plan->walks,
             plan->walk_s, plan->noise_share, plan->push_m_s, plan->sigma, plan->step_s);
}

int tuning_begin(struct tuning *tuning, const struct tuning_plan *plan, char *message)
{
    double number[TUNING_NUMBERS], start[TUNING_NUMBERS];
    char head[HEAD_MAX];
    tuning->plan = *plan;
    numbers_of(&plan->subject.person.muscles, number);
    for (int i = 0; i < TUNING_NUMBERS; i++) {
        tuning->scale[i] = fmax(fabs(number[i]), SCALE_LEAST);
        start[i] = number[i] / tuning->scale[i];
    }
    cma_es_init(&tuning->search, TUNING_NUMBERS, start, plan->sigma, plan->seed);
    if (plan->state_path == NULL) {
        return 0;
    }
    head_of(tuning, head);
    return tuning_file_read(plan->state_path, head, &tuning->search, message, LOOP_MESSAGE_MAX);
}

int tuning_generation(struct tuning *tuning, double *mean_value, double *best_value, char *message)
{
    struct cma_es *search = &tuning->search;
    struct walks walks;
    const double *value = walks.value;
    walks.tuning = tuning;
    walks.each = tuning->plan.walks;
    walks.seed = tuning->plan.seed + (uint64_t)SEEDS_A_GENERATION * (uint64_t)search->generations;
    cma_es_ask(search);
    for (int k = 0; k < search->lambda; k++) {
        double x[CMA_MOST];
        cma_es_try(search, k, x);
        walks.muscles[k] = tuning->plan.subject.person.muscles;
        set_numbers(tuning, x, &walks.muscles[k]);
    }
    if (run(&walks, search->lambda) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
        return -1;
    }
    *mean_value = 0.0;
    *best_value = value[0];
    for (int k = 0; k < search->lambda; k++) {
        *mean_value += value[k] / search->lambda;
        *best_value = fmin(*best_value, value[k]);
    }
    cma_es_tell(search, value);
    if (tuning->plan.state_path == NULL) {
        return 0;
    }
    char head[HEAD_MAX];
    head_of(tuning, head);
    return tuning_file_write(tuning->plan.state_path, head, search, message, LOOP_MESSAGE_MAX);
}

int tuning_value(const struct tuning *tuning, int walks, double *value, char *message)
{
    struct walks fresh;
    fresh.tuning = tuning;
    fresh.each = walks;
    fresh.seed = tuning->plan.seed + FRESH_SEEDS;
    fresh.muscles[0] = tuning->plan.subject.person.muscles;
    set_numbers(tuning, tuning->search.mean, &fresh.muscles[0]);
    if (run(&fresh, 1) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
        return -1;
    }
    *value = fresh.value[0];
    return 0;
}
