#include "sim_host/study/noisy_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/batch.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/random/rng.h"

enum { SECANT_STEPS = 12, SETTLE_STRIDES = 20 };
#define LEAST_R0_SHARE 0.002 /* of the leg */

static int gait_at_r0(double r0_m, struct gait_point *point)
{
    const struct gait_walker walker = gait_walker_of_paper();
    return gait_curve(&walker, r0_m, 0.0, 1, point, NULL) == GAIT_CURVE_OK;
}

/* The gait of a speed: v^2 rises nearly in proportion to r0, so the secant method in it is quick. */
static int gait_at_speed(double speed, struct gait_point *point)
{
    struct gait_point a, b;
    if (!gait_at_r0(0.05, &a) || !gait_at_r0(0.06, &b)) {
        return 0;
    }
    for (int i = 0; i < SECANT_STEPS; i++) {
        const double qa = a.speed_rad_s * a.speed_rad_s, qb = b.speed_rad_s * b.speed_rad_s;
        if (fabs(b.speed_rad_s - speed) < 1e-10 || qa == qb) {
            break;
        }
        double r0 = b.r0_m + (speed * speed - qb) * (b.r0_m - a.r0_m) / (qb - qa);
        r0 = fmin(0.298, fmax(0.005, r0));
        a = b;
        if (!gait_at_r0(r0, &b)) {
            return 0;
        }
    }
    *point = b;
    return fabs(b.speed_rad_s - speed) < 1e-6;
}

struct course {
    struct rng rng;
    double sum, squares;
    int counted;
};

struct walks {
    const struct noisy_law *law;
    double error_share;
    int strides;
    struct noisy_walk *walks;
    struct course *courses;
};

/* What the law answers to the speed it is told. */
static void answer(const struct walks *walks, struct course *course, struct batch_item *item)
{
    const struct noisy_law *law = walks->law;
    const double speed = -item->apex[0];
    const double measured = speed * (1.0 + walks->error_share * rng_normal(&course->rng));
    const double wanted = law->r0_m + law->kp_m_s_rad * (measured + law->gait[0]);
    item->push_m = fmax(wanted, LEAST_R0_SHARE * law->leg_length_m);
}

static int go_on(void *context, size_t index, struct batch_item *item,
                 const struct batch_slopes *slopes)
{
    struct walks *walks = context;
    struct course *course = &walks->courses[index];
    (void)slopes;
    walks->walks[index].walked = (int)item->strides;
    walks->walks[index].fell = item->fault != 0;
    if (item->fault != 0 || item->strides >= walks->strides) {
        return 1;
    }
    if (item->strides >= SETTLE_STRIDES) {
        const double speed = -item->apex[0];
        course->sum += speed;
        course->squares += speed * speed;
        course->counted++;
    }
    answer(walks, course, item);
    return 0;
}

static int run(struct walks *walks, struct batch_item *items, uint64_t seed, int threads,
               size_t count)
{
    const struct noisy_law *law = walks->law;
    const struct batch_walker walker = {law->hip_mass_kg, law->leg_mass_kg, law->leg_length_m,
                                        law->ankle_stiffness_N_m, law->gravity_m_s2};
    const struct batch_settings settings = {0};
    const struct batch_job job = {.walkers = &walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = count,
                                  .strides = walks->strides,
                                  .stride_done = go_on,
                                  .context = walks};
    for (size_t i = 0; i < count; i++) {
        walks->walks[i] = (struct noisy_walk){0};
        rng_init(&walks->courses[i].rng, seed, (uint64_t)i);
        memcpy(items[i].apex, law->gait, sizeof items[i].apex);
        answer(walks, &walks->courses[i], &items[i]);
    }
    if (batch_run_threads(&settings, &job, threads) != BATCH_OK) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        const struct course *c = &walks->courses[i];
        if (c->counted > 1) {
            const double mean = c->sum / c->counted;
            walks->walks[i].spread = sqrt(fmax(0.0, c->squares / c->counted - mean * mean)) / mean;
        }
    }
    return 0;
}

int noisy_map_walks(const struct noisy_law *law, double error_share, int strides, uint64_t seed,
                    int threads, struct noisy_walk *walks, size_t count)
{
    struct batch_item *items = calloc(count, sizeof *items);
    struct walks all = {.law = law,
                        .error_share = error_share,
                        .strides = strides,
                        .walks = walks,
                        .courses = calloc(count, sizeof *all.courses)};
    const int status =
        items == NULL || all.courses == NULL ? -1 : run(&all, items, seed, threads, count);
    free(items);
    free(all.courses);
    return status;
}

int noisy_map_walk(double speed_rad_s, double kp_m_s_rad, double error_share, int strides,
                   uint64_t seed, struct noisy_walk *walk)
{
    const struct gait_walker walker = gait_walker_of_paper();
    struct gait_point gait;
    if (!gait_at_speed(speed_rad_s, &gait)) {
        return -1;
    }
    const struct noisy_law law = {.hip_mass_kg = walker.hip_mass_kg,
                                  .leg_mass_kg = walker.leg_mass_kg,
                                  .leg_length_m = walker.leg_length_m,
                                  .ankle_stiffness_N_m = walker.ankle_stiffness_N_m,
                                  .gravity_m_s2 = walker.gravity_m_s2,
                                  .gait = {gait.apex[0], gait.apex[1], gait.apex[2]},
                                  .r0_m = gait.r0_m,
                                  .kp_m_s_rad = kp_m_s_rad};
    return noisy_map_walks(&law, error_share, strides, seed, 1, walk, 1);
}
