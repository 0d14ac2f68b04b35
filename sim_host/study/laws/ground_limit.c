/* How far any law can get on uneven ground (study/terrain_ground.h), and how much of that the flown ones reach.
 *
 * Every foothold lies within +-10 mm (on a leg of 1 m) of the one before, evenly drawn; walks begin in the gait of the
 * commanded speed. First at any speed: the chance to be still up after 500 steps. Then with the mean speed of the
 * walk at most a tenth above the command, at rising prices on speed: each price's value is an estimate between
 * nodes (from above, by the best corners, it says nothing on these grids: thousands of steps), and the law made from it walks
 * on the map itself: where its mean speed is within the limit its steps are a bound from below. Beside them eq. (16) and the predictive law on the same footholds. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/laws.h"
#include "sim_host/study/map/terrain_ground.h"
#include "sim_host/study/pool.h"

enum { DEFAULT_WALKS = 100, STEPS_MOST = 500, ROUNDS_MOST = 150, PRICES = 2, SPEEDS = 3 };
#define RISE_MOST 0.010
#define SPEED_LIMIT 1.1 /* of the command */
static const double speeds[SPEEDS] = {0.4, 0.6, 0.8};
/* 0: none. At 0.8 rad/s laws that serve the command do not fall at all. */
static const double prices[SPEEDS][PRICES] = {{2.0, 4.0}, {8.0, 15.0}, {0.0, 0.0}};

struct study {
    const struct laws_options *options;
    struct terrain_table table;
    int walks;
    FILE *csv;
};

/* ---- walks ----------------------------------------------------------------------------------- */

/* One walker's law: made from a value, or one that is flown (value NULL). */
struct walking {
    const struct study *study;
    const struct terrain_value *value;
    struct law_setup setup;
    double speed_rad_s;
    struct walked {
        int steps;
        bool fell;
        double speed_sum;
    } * walked;
};

static int step_by_value(const struct walking *walking, struct laws_walk *walk, double rise)
{
    const struct control_params *params = &walking->setup.params;
    double worth;
    walk->r0_m = terrain_law(&walking->study->table, walking->value, walk->apex,
                             (double)params->r0_min_m, (double)params->r0_max_m, &worth);
    const int fault = laws_stride(&walking->setup.truth, walking->setup.accuracy, walk->apex,
                                  walk->r0_m, 0.0, rise, &walk->stride);
    for (int i = 0; i < 3; i++) {
        walk->apex[i] = walk->stride.next[i];
    }
    return fault;
}

static void walk_once(void *context, int w)
{
    const struct walking *walking = (const struct walking *)context;
    struct walked *walked = &walking->walked[w];
    struct laws_walk walk;
    struct rng rng;
    double apex[3];
    const double r0_m = law_setup_gait(&walking->setup, walking->speed_rad_s, apex);
    laws_walk_start(&walking->setup, &walk, apex, r0_m, walking->speed_rad_s);
    rng_init(&rng, walking->study->options->seed + (uint64_t)w, 75);
    *walked = (struct walked){0, false, 0.0};
    while (walked->steps < STEPS_MOST && !walked->fell) {
        const double rise = RISE_MOST * (2.0 * rng_uniform(&rng) - 1.0);
        walked->fell =
            (walking->value != NULL ? step_by_value(walking, &walk, rise)
                                    : laws_walk_step(&walking->setup, &walk, walking->speed_rad_s,
                                                     NULL, 0.0, rise)) != 0;
        walked->steps++;
        walked->speed_sum -= walked->fell ? 0.0 : walk.apex[0];
    }
}

/* Steps per fall, share still up at the end, mean speed over the command. */
static bool walk_all(const struct study *study, const char *name, const struct terrain_value *value,
                     const struct law_setup *setup, double speed)
{
    struct walking walking = {study, value, *setup, speed * laws_speed_unit(study->options),
                              malloc((size_t)study->walks * sizeof *walking.walked)};
    const struct pool_jobs jobs = {0,        study->walks, study->options->threads,
                                   &walking, walk_once,    laws_count_part};
    long steps = 0;
    int falls = 0;
    double sum = 0.0;
    if (walking.walked == NULL || pool_run(&jobs) != 1) {
        free(walking.walked);
        return false;
    }
    for (int w = 0; w < study->walks; w++) {
        steps += walking.walked[w].steps;
        falls += walking.walked[w].fell ? 1 : 0;
        sum += walking.walked[w].speed_sum;
    }
    free(walking.walked);
    const double strides = steps > falls ? (double)(steps - falls) : 1.0; /* none: no speed, 0 */
    const double mean = sum / strides / walking.speed_rad_s;
    const double per_fall = falls > 0 ? (double)steps / falls : (double)INFINITY;
    printf("      %-24s walked: %8.1f steps a fall, %5.1f %% up after %d, mean speed %.2f\n", name,
           per_fall, 100.0 * (study->walks - falls) / study->walks, STEPS_MOST, mean);
    if (study->csv != NULL) {
        fprintf(study->csv, "%.1f,walked,%s,%.6g,%.6g,%ld,%d,%.4f\n", speed, name,
                value != NULL ? value->goal.price : 0.0, per_fall, steps, falls, mean);
    }
    (void)fflush(stdout);
    return true;
}

/* ---- values ---------------------------------------------------------------------------------- */

static bool solve(const struct study *study, double speed, enum terrain_side side,
                  const struct terrain_goal *goal, bool walks)
{
    const struct law_setup *setup = &study->options->setup;
    struct terrain_value value;
    double apex[3], worth;
    char name[48];
    (void)law_setup_gait(setup, speed * laws_speed_unit(study->options), apex);
    if (terrain_solve(&study->table, side, goal, apex, ROUNDS_MOST, study->options->threads,
                      &value) != 0) {
        return false;
    }
    (void)terrain_law(&study->table, &value, apex, 0.0, HUGE_VAL, &worth);
    if (goal->question == TERRAIN_CHANCE) {
        (void)snprintf(name, sizeof name, "any speed");
        printf("    %s, %s: up after %d steps %.1f %%%s\n", name,
               side == TERRAIN_OUTER ? "at most" : "about", value.rounds, 100.0 * worth,
               value.settled ? ", and for ever" : "");
    } else {
        (void)snprintf(name, sizeof name, "price %g", goal->price);
        printf("    mean speed at most %.2f, %s: %.1f steps (%d rounds%s)\n",
               goal->limit_rad_s / laws_speed_unit(study->options), name, worth, value.rounds,
               value.settled ? "" : ", not at rest");
    }
    if (study->csv != NULL) {
        fprintf(study->csv, "%.1f,%s,%s,%.6g,%.6g,%d,%d,\n", speed,
                side == TERRAIN_OUTER ? "outer" : "middle", name, goal->price, worth, value.rounds,
                value.settled);
    }
    const bool done = !walks || walk_all(study, name, &value, setup, speed);
    terrain_value_free(&value);
    return done;
}

static bool study_speed(const struct study *study, int v)
{
    const double speed = speeds[v];
    const struct terrain_goal any = {TERRAIN_CHANCE, 0.0, 1.0};
    bool done = true;
    printf("  %.1f rad/s\n", speed);
    for (int e = 0; e < LAW_CASES && done; e++) {
        if (study->options->law_case[e] && e != LAW_CASE_RAMP) {
            const struct law_setup setup = law_case_setup(study->options, (enum law_case)e);
            done = walk_all(study, law_case_names[e], NULL, &setup, speed);
        }
    }
    done = done && solve(study, speed, TERRAIN_OUTER, &any, false) &&
           solve(study, speed, TERRAIN_MIDDLE, &any, true);
    for (int p = 0; p < PRICES && prices[v][p] > 0.0 && done; p++) {
        const struct terrain_goal goal = {TERRAIN_STEPS, prices[v][p],
                                          SPEED_LIMIT * speed * laws_speed_unit(study->options)};
        done = solve(study, speed, TERRAIN_MIDDLE, &goal, true);
    }
    return done;
}

static struct terrain_range range_of(const struct laws_options *options, int fineness)
{
    const double unit = laws_speed_unit(options);
    const struct control_params *params = &options->setup.params;
    return (struct terrain_range){
        .speed = {0.0, 1.6 * unit, 2.0, 55 * fineness + 1},
        .angle = {-0.6, 0.3, 1.0, 30 * fineness + 1},
        .swing = {-1.0 * unit, 3.6 * unit, 1.0, 40 * fineness + 1},
        .legs = {0.1, 1.5, 1.0, 56 * fineness + 1},
        .ankle = {0.0, 0.36, 1.0, 45 * fineness + 1},
        .push = {(double)params->r0_min_m, (double)params->r0_max_m, 2.0, 96},
        .rises = 15,
        .rise_most = RISE_MOST};
}

/* All speeds, or the slowest alone on a grid twice as fine each way: how far the bounds have still to go. */
static bool study_on_grid(struct study *study, int fineness)
{
    const struct terrain_goal any = {TERRAIN_CHANCE, 0.0, 1.0};
    const struct gait_walker walker = subject_gait_walker(&study->options->subject);
    const struct terrain_range range = range_of(study->options, fineness);
    if (terrain_make(&study->table, &walker, &range, study->options->threads) != 0) {
        return false;
    }
    bool done = true;
    if (fineness == 1) {
        for (int v = 0; v < SPEEDS && done; v++) {
            done = study_speed(study, v);
        }
    } else {
        printf("  %.1f rad/s, %d times as many nodes a side\n", speeds[0], fineness);
        done = solve(study, speeds[0], TERRAIN_OUTER, &any, false) &&
               solve(study, speeds[0], TERRAIN_MIDDLE, &any, false);
    }
    terrain_free(&study->table);
    return done;
}

int laws_ground_limit(const struct laws_options *options)
{
    struct study study = {.options = options,
                          .walks = options->samples > 0 ? options->samples : DEFAULT_WALKS};
    struct output_file file;
    bool failed;
    study.csv = laws_csv(options, "ground-limit",
                         "speed_rad_s,what,law,price,value,steps,falls,mean_speed", &file, &failed);
    if (!failed) {
        printf(
            "  footholds within +-10 mm on a leg of 1 m; %d walks of at most %d steps each; speeds over the "
            "command\n",
            study.walks, STEPS_MOST);
        failed = !study_on_grid(&study, 1) || !study_on_grid(&study, 2);
    }
    return laws_csv_close(options, &file, failed);
}
