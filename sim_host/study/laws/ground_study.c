/* Uneven ground: every foothold lies higher or lower than the one before, uniformly within +- size, drawn anew
 * at each heel strike (as Byl and Tedrake 2009 draw it), with straight ground from foothold to foothold or with
 * nothing between them; what the toe does in mid-swing is ignored, as on level ground. Mean steps to failure
 * counted directly, and by the transfer operator, which also serves where nothing falls any more. Beside
 * them what a single rise does to the steady gaits: where the energy at the apex sets the limit. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/ground.h"
#include "sim_host/study/laws/session.h"
#include "sim_host/study/pool.h"

enum { MAP_WALKS = 200, MAP_STEPS = 500, CHAIN_WALKS = 20, CHAIN_STEPS = 200 };
static const double sizes_mm[] = {5.0, 10.0, 20.0}; /* on a leg of 1 m */
static const double speeds[] = {0.4, 0.6, 0.8};
enum {
    SIZES = sizeof sizes_mm / sizeof sizes_mm[0],
    SPEEDS = sizeof speeds / sizeof speeds[0],
    KINDS = 2,
    CELLS = KINDS * SPEEDS * SIZES /* of one law */
};
static const char *const kinds[KINDS] = {"straight", "heights"};

struct cell_result {
    long steps;
    int falls;
    bool failed;
    struct ground_operator_result operator;
};

struct study {
    const struct laws_options *options;
    int walks;
    struct cell_result cell[LAW_CASES][CELLS]; /* by kind, then speed, then size */
};

/* The ramp makes no difference at one speed. */
static bool wanted(const struct study *study, int e)
{
    return study->options->law_case[e] && e != LAW_CASE_RAMP;
}

/* What a cell is about. */
struct ground_case {
    bool heights;
    double speed_rad_s, rise; /* at most, leg lengths */
};

static struct ground_case case_of(const struct study *study, int cell)
{
    const double unit = laws_speed_unit(study->options);
    return (struct ground_case){cell / (SPEEDS * SIZES) == 1, speeds[cell / SIZES % SPEEDS] * unit,
                                0.001 * sizes_mm[cell % SIZES]};
}

/* Walk w of every cell meets the ground of seed + w. */
static struct session_config session_of(const struct study *study, int e, int cell, int w)
{
    const struct ground_case what = case_of(study, cell);
    return (struct session_config){.law_case = (enum law_case)e,
                                   .from_rad_s = what.speed_rad_s,
                                   .to_rad_s = what.speed_rad_s,
                                   .steps = study->options->chain ? CHAIN_STEPS : MAP_STEPS,
                                   .rise_most = what.rise,
                                   .heights = what.heights,
                                   .seed = study->options->seed + (uint64_t)w};
}

/* Counts the steps of all walks under one law. */
static int count_walks(struct study *study, int e)
{
    const int count = CELLS * study->walks;
    struct session_config *configs = calloc((size_t)count, sizeof *configs);
    struct session_result *results = calloc((size_t)count, sizeof *results);
    int status = -1;
    if (configs == NULL || results == NULL) {
        fprintf(stderr, "afo study laws: out of memory; take fewer --samples\n");
    } else {
        for (int i = 0; i < count; i++) {
            configs[i] = session_of(study, e, i / study->walks, i % study->walks);
        }
        status = session_run(study->options, configs, count, results);
        for (int i = 0; i < count; i++) {
            struct cell_result *cell = &study->cell[e][i / study->walks];
            cell->steps += results[i].steps + (results[i].fell ? 1 : 0);
            cell->falls += results[i].fell ? 1 : 0;
        }
    }
    free(configs);
    free(results);
    return status;
}

static void compute_operator(void *context, int i)
{
    struct study *study = (struct study *)context;
    const int e = i / CELLS;
    struct cell_result *cell = &study->cell[e][i % CELLS];
    if (!wanted(study, e)) {
        return;
    }
    const struct law_setup setup = law_case_setup(study->options, (enum law_case)e);
    const struct ground_case what = case_of(study, i % CELLS);
    struct laws_stride stride;
    double apex[3];
    const double r0_m = law_setup_gait(&setup, what.speed_rad_s, apex);
    (void)laws_stride(&setup.truth, LAWS_COARSE, apex, r0_m, 0.0, 0.0, &stride);
    cell->failed = ground_operator(&setup, what.speed_rad_s, what.rise,
                                   stride.step_length_m / setup.truth.leg_length_m, what.heights,
                                   &cell->operator) != 0;
}

/* All that is counted. Returns 0, or -1. */
static int run(struct study *study)
{
    for (int e = 0; e < LAW_CASES; e++) {
        if (wanted(study, e) && count_walks(study, e) != 0) {
            return -1;
        }
    }
    const int operators = study->options->chain ? 0 : LAW_CASES * CELLS;
    const struct pool_jobs jobs = {0,     operators,        study->options->threads,
                                   study, compute_operator, laws_count_part};
    int status = pool_run(&jobs) == 1 ? 0 : -1;
    for (int i = 0; i < operators; i++) {
        if (study->cell[i / CELLS][i % CELLS].failed) {
            fprintf(stderr, "afo study laws: out of memory\n");
            status = -1;
        }
    }
    return status;
}

static void print(const struct study *study, int e, int kind, int v, FILE *csv)
{
    printf("  %-13s %-8s %.1f rad/s:", law_case_names[e], kinds[kind], speeds[v]);
    for (int s = 0; s < SIZES; s++) {
        const struct cell_result *c = &study->cell[e][(kind * SPEEDS + v) * SIZES + s];
        const double direct = c->falls > 0 ? (double)c->steps / c->falls : (double)INFINITY;
        if (c->falls > 0) {
            printf(" %9.1f", direct);
        } else {
            printf(" >%8ld", c->steps);
        }
        if (!study->options->chain) {
            printf(" (%8.3g%s %8.3g)", c->operator.mean_steps, c->operator.full ? "!" : ",",
                   c->operator.settled_steps);
        }
        if (csv != NULL) {
            fprintf(csv, "%s,%s,%.1f,%g,%ld,%d,%.6g,%.6g,%d,%d\n", law_case_names[e], kinds[kind],
                    speeds[v], sizes_mm[s], c->steps, c->falls, c->operator.mean_steps,
                    c->operator.settled_steps, c->operator.cells, c->operator.full);
        }
    }
    printf("\n");
}

static void print_rises(const struct laws_options *options)
{
    const double unit = laws_speed_unit(options),
                 leg_mm = 1e3 * options->subject.person.leg_length_m;
    for (int v = 0; v < SPEEDS; v++) {
        struct ground_rise rise;
        ground_rise_survived(&options->setup, speeds[v] * unit, &rise);
        printf(
            "  %.1f rad/s: v^2 l/(2 g) = %.1f mm; one rise survived by the gait's own push-off: %.1f mm, "
            "by any: %.1f mm\n    (r0 = %.4f m, which on level ground leads to %.2f rad/s)\n",
            speeds[v], leg_mm * rise.climbed, leg_mm * rise.own_push, leg_mm * rise.any_push,
            rise.any_push_m, rise.level_speed / unit);
    }
}

int laws_ground(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    FILE *csv =
        laws_csv(options, "ground",
                 "law,kind,speed_rad_s,size_mm,steps,falls,operator_steps,settled_steps,cells,full",
                 &file, &failed);
    struct study *study = calloc(1, sizeof *study);
    failed = failed || study == NULL;
    if (!failed) {
        study->options = options;
        const int usual = options->chain ? CHAIN_WALKS : MAP_WALKS;
        study->walks = options->samples > 0 ? options->samples : usual;
        failed = run(study) != 0;
    }
    if (!failed) {
        printf(
            "  mean steps to failure on rises within +-5, 10, 20 mm on a leg of 1 m;\n"
            "  counted over %d walks of at most %d steps%s\n",
            study->walks, options->chain ? CHAIN_STEPS : MAP_STEPS,
            options->chain
                ? ""
                : " (by the transfer operator: from the gait on, who has long walked;\n"
                  "  ! = more states than the mesh has room for: not to be used; what a law learns from step to "
                  "step,\n  as the predictive one does of the ground, the operator leaves out)");
        print_rises(options);
    }
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        for (int i = 0; i < KINDS * SPEEDS && wanted(study, e); i++) {
            print(study, e, i / SPEEDS, i % SPEEDS, csv);
        }
    }
    free(study);
    return laws_csv_close(options, &file, failed);
}
