/* Walks side by side on the batch engine against the same law on the scalar map, stride by stride: what the law
 * answered, bit for bit, and where the map went from there, which is another method of integration. */
#include "sim_host/study/laws/walks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/random/rng.h"
#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

enum { LAWS = 4, EACH = 24, COUNT = LAWS * EACH, STRIDES = 30 };

static const enum law_mode laws[LAWS] = {LAW_PROPORTIONAL, LAW_DLQR, LAW_DEADBEAT, LAW_PREDICTIVE};

/* Beside each course runs the same law on its own, told what the walk was told. */
struct witness {
    struct rng rng;
    struct laws_ahead ahead;
    struct laws_walk alone;
    double before[3]; /* the apex this stride begins at */
    int steps, fault;
    double farthest; /* of the scalar map's next apexes from the walk's */
    bool same_answers, same_faults;
};

struct trial {
    struct law_setup setup[LAWS];
    struct laws_course course[COUNT];
    struct witness witness[COUNT];
    size_t first; /* course that is the run's number 0 */
};

static void look(void *context, size_t number, struct laws_ahead *ahead)
{
    struct trial *trial = (struct trial *)context;
    const size_t i = trial->first + number;
    struct witness *w = &trial->witness[i];
    memcpy(w->before, ahead->seen, sizeof w->before);
    ahead->desired_rad_s = i % 3 == 0 ? 0.8 : 0.6;
    for (int k = 0; k < 3; k++) {
        ahead->seen[k] *= 1.0 + 1e-3 * rng_normal(&w->rng);
    }
    ahead->slope_rad = i % 2 == 0 ? 0.0 : 0.01 * (2.0 * rng_uniform(&w->rng) - 1.0);
    ahead->rise = i % 4 < 2 ? 0.0 : 0.005 * (2.0 * rng_uniform(&w->rng) - 1.0);
    w->ahead = *ahead;
}

static int assess(void *context, size_t number, const struct laws_walk *walk)
{
    struct trial *trial = (struct trial *)context;
    const size_t i = trial->first + number;
    struct witness *w = &trial->witness[i];
    struct law_setup *setup = &trial->setup[i / EACH];
    memcpy(w->alone.apex, w->before, sizeof w->alone.apex);
    const int fault = laws_walk_step(setup, &w->alone, w->ahead.desired_rad_s, w->ahead.seen,
                                     w->ahead.slope_rad, w->ahead.rise);
    w->same_answers = w->same_answers && memcmp(&w->alone.r0_m, &walk->r0_m, sizeof(double)) == 0;
    w->same_faults = w->same_faults && fault == walk->stride.fault;
    for (int k = 0; k < 3 && fault == 0; k++) {
        w->farthest = fmax(w->farthest, fabs(w->alone.apex[k] - walk->apex[k]));
    }
    w->farthest =
        fmax(w->farthest,
             fault == 0 ? fabs(w->alone.stride.step_length_m - walk->stride.step_length_m) : 0.0);
    w->steps++;
    w->fault = walk->stride.fault;
    return 0;
}

static struct trial *make(void)
{
    char message[SUBJECT_MESSAGE_MAX];
    struct subject subject;
    struct trial *trial = calloc(1, sizeof *trial);
    ck_assert_ptr_nonnull(trial);
    subject_default(&subject);
    for (int l = 0; l < LAWS; l++) {
        ck_assert_int_eq(law_setup_init(&trial->setup[l], &subject, laws[l], message), 0);
        trial->setup[l].accuracy = LAWS_FINE;
    }
    for (int i = 0; i < COUNT; i++) {
        const struct law_setup *setup = &trial->setup[i / EACH];
        struct witness *w = &trial->witness[i];
        double apex[3];
        const double r0_m = law_setup_gait(setup, 0.6, apex);
        trial->course[i].setup = setup;
        laws_walk_start(setup, &trial->course[i].walk, apex, r0_m, 0.6);
        *w = (struct witness){
            .alone = trial->course[i].walk, .same_answers = true, .same_faults = true};
        rng_init(&w->rng, 8, (uint64_t)i);
    }
    return trial;
}

START_TEST(every_stride_is_the_scalar_one)
{
    struct trial *trial = make();
    int steps[LAWS] = {0}, falls = 0;
    ck_assert_int_eq(laws_walks_run(trial->course, COUNT, STRIDES, look, assess, trial, 2), 0);
    for (int i = 0; i < COUNT; i++) {
        const struct witness *w = &trial->witness[i];
        ck_assert_msg(w->same_answers, "walk %d: another push-off", i);
        ck_assert_msg(w->same_faults, "walk %d: another fault", i);
        assert_close(w->farthest, 0.0, 3e-9, 0.0);
        ck_assert(w->fault != 0 || w->steps == STRIDES);
        ck_assert_int_eq(trial->course[i].walk.steps, w->steps);
        steps[i / EACH] += w->steps;
        falls += w->fault != 0;
    }
    ck_assert_int_gt(falls, 10); /* eq. (16) on that ground */
    ck_assert_int_gt(steps[0], 3 * EACH);
    ck_assert_int_gt(steps[3], STRIDES * EACH * 9 / 10);
    free(trial);
}
END_TEST

START_TEST(a_walk_does_not_depend_on_company_or_threads)
{
    struct trial *many = make(), *alone = make();
    ck_assert_int_eq(laws_walks_run(many->course, COUNT, STRIDES, look, assess, many, 3), 0);
    for (size_t i = 0; i < COUNT; i += 5) {
        alone->first = i;
        ck_assert_int_eq(laws_walks_run(&alone->course[i], 1, STRIDES, look, assess, alone, 1), 0);
        const struct laws_walk *a = &alone->course[i].walk, *b = &many->course[i].walk;
        ck_assert_int_eq(a->steps, b->steps);
        ck_assert_mem_eq(a->apex, b->apex, sizeof a->apex);
        ck_assert_int_eq(a->stride.fault, b->stride.fault);
    }
    free(many);
    free(alone);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("laws_walks");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, every_stride_is_the_scalar_one);
    tcase_add_test(tests, a_walk_does_not_depend_on_company_or_threads);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
