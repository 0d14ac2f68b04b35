/* Uneven ground: every foothold lies higher or lower than the one before, uniformly within +- size, drawn anew
 * at each heel strike (as Byl and Tedrake 2009 draw it), with straight ground from foothold to foothold or with
 * nothing between them; what the toe does in mid-swing is ignored, as on level ground. Mean steps to failure
 * counted directly, and by the transfer operator, which also serves where nothing falls any more. Beside
 * them what a single rise does to the steady gaits: where the energy at the apex sets the limit. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/laws/ground.h"
#include "sim_host/laws/session.h"
#include "sim_host/study/pool.h"

enum { DEFAULT_WALKS = 20, MAP_STEPS = 500, CHAIN_STEPS = 200 };
static const double sizes_mm[] = {5.0, 10.0, 20.0}; /* on a leg of 1 m */
static const double speeds[] = {0.4, 0.6, 0.8};
enum {
    SIZES = sizeof sizes_mm / sizeof sizes_mm[0],
    SPEEDS = sizeof speeds / sizeof speeds[0],
    KINDS = 2
};
static const char *const kinds[KINDS] = {"straight", "heights"};

struct cell_result {
    long steps;
    int falls, failed;
    struct ground_operator_result operator;
};

struct study {
    const struct laws_options *options;
    int walks;
    struct cell_result cell[ENTRANTS][KINDS][SPEEDS][SIZES];
};

/* The ramp makes no difference at one speed. */
static bool wanted(const struct study *study, int e)
{
    return study->options->entrant[e] && e != ENTRANT_RAMP;
}

static void compute(void *context, int i)
{
    struct study *study = (struct study *)context;
    const int e = i / (KINDS * SPEEDS * SIZES), kind = i / (SPEEDS * SIZES) % KINDS,
              v = i / SIZES % SPEEDS, s = i % SIZES;
    struct cell_result *cell = &study->cell[e][kind][v][s];
    const double speed = speeds[v] * laws_speed_unit(study->options), rise = 0.001 * sizes_mm[s];
    struct session_result *result = malloc(sizeof *result);
    if (result == NULL) {
        cell->failed = 1;
        return;
    }
    for (int w = 0; w < study->walks && wanted(study, e) && !cell->failed; w++) {
        const struct session_config config = {.entrant = (enum laws_entrant)e,
                                              .from_rad_s = speed,
                                              .to_rad_s = speed,
                                              .steps =
                                                  study->options->chain ? CHAIN_STEPS : MAP_STEPS,
                                              .rise_most = rise,
                                              .heights = kind == 1,
                                              .seed = study->options->seed + (uint64_t)w};
        cell->failed = session_run(study->options, &config, result) != 0;
        cell->steps += result->steps + (result->fell ? 1 : 0);
        cell->falls += result->fell ? 1 : 0;
    }
    if (wanted(study, e) && !study->options->chain && !cell->failed) {
        const struct laws_bench bench = laws_entrant_bench(study->options, (enum laws_entrant)e);
        struct laws_stride stride;
        double apex[3];
        const double r0_m = laws_bench_gait(&bench, speed, apex);
        (void)laws_stride(&bench.truth, LAWS_COARSE, apex, r0_m, 0.0, 0.0, &stride);
        cell->failed =
            ground_operator(&bench, speed, rise, stride.step_length_m / bench.truth.leg_length_m,
                            kind == 1, &cell->operator) != 0;
    }
    free(result);
}

static void print(const struct study *study, int e, int kind, int v, FILE *csv)
{
    printf("  %-13s %-8s %.1f rad/s:", laws_entrant_names[e], kinds[kind], speeds[v]);
    for (int s = 0; s < SIZES; s++) {
        const struct cell_result *c = &study->cell[e][kind][v][s];
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
            fprintf(csv, "%s,%s,%.1f,%g,%ld,%d,%.6g,%.6g,%d,%d\n", laws_entrant_names[e],
                    kinds[kind], speeds[v], sizes_mm[s], c->steps, c->falls, c->operator.mean_steps,
                    c->operator.settled_steps, c->operator.cells, c->operator.full);
        }
    }
    printf("\n");
}

static void print_rises(const struct laws_options *options)
{
    const double unit = laws_speed_unit(options), leg_mm = 1e3 * options->subject.leg_length_m;
    for (int v = 0; v < SPEEDS; v++) {
        struct ground_rise rise;
        ground_rise_survived(&options->bench, speeds[v] * unit, &rise);
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
        study->walks = options->samples > 0 ? options->samples : DEFAULT_WALKS;
        const struct pool_jobs jobs = {
            0, ENTRANTS * KINDS * SPEEDS * SIZES, options->threads, study, compute, laws_take};
        failed = pool_run(&jobs) != 1;
        printf("  mean steps to failure on rises within +-5, 10, 20 mm on a leg of 1 m;\n"
               "  counted over %d walks of at most %d steps%s\n",
               study->walks, options->chain ? CHAIN_STEPS : MAP_STEPS,
               options->chain
                   ? ""
                   : " (by the transfer operator: from the gait on, who has long walked;\n"
                     "  ! = more states than the mesh has room for: not to be used)");
        print_rises(options);
    }
    for (int e = 0; e < ENTRANTS && !failed; e++) {
        for (int i = 0; i < KINDS * SPEEDS && wanted(study, e); i++) {
            print(study, e, i / SPEEDS, i % SPEEDS, csv);
            for (int s = 0; s < SIZES; s++) {
                failed = failed || study->cell[e][i / SPEEDS][i % SPEEDS][s].failed;
            }
        }
    }
    free(study);
    return laws_csv_close(&file, failed);
}
