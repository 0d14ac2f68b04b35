/* The basin: from which share of a box of apex states does the law bring the walker to the gait it was told?
 * And of the states it loses: from how many does no sequence of push-offs at all survive three strides? */
#include <math.h>
#include <stdlib.h>

#include "sim_host/laws/laws.h"
#include "sim_host/plant/rng.h"
#include "sim_host/study/pool.h"

enum {
    CHUNK = 250,
    STEPS = 80,
    DEFAULT_SAMPLES = 2000,
    HOPELESS_EVERY = 10,
    TREE_DEPTH = 3,
    TREE_WIDTH = 40
};

/* Box of apex states in the paper's units: stance rate, swing angle, swing rate. */
static const double box_low[3] = {-1.45, -0.5, 0.2}, box_high[3] = {-0.05, 0.2, 5.2};
static const double speeds[] = {0.4, 0.6, 0.8};

struct count {
    int reached, survived, lost_tried, hopeless;
};

struct basin {
    const struct laws_options *options;
    enum laws_entrant entrant;
    double speed_rad_s;
    int samples;
    struct count *chunk;
};

static bool arrived(const struct laws_walk *walk, const double gait[3])
{
    return fabs(walk->apex[0] - gait[0]) < 0.002 * fabs(gait[0]) &&
           fabs(walk->apex[1] - gait[1]) < 0.002 && fabs(walk->apex[2] - gait[2]) < 0.002 * gait[2];
}

/* Some push-off of TREE_WIDTH leads on from here for `depth` strides. */
static bool some_way(const struct laws_bench *bench, const double apex[3], int depth)
{
    const double low = (double)bench->params.r0_min_m, high = (double)bench->params.r0_max_m;
    for (int i = 0; i < TREE_WIDTH; i++) {
        struct laws_stride stride;
        const double share = (double)i / (TREE_WIDTH - 1);
        const int fault = laws_stride(&bench->truth, bench->accuracy, apex,
                                      low + (high - low) * share * share, 0.0, 0.0, &stride);
        if (fault == 0 && (depth == 1 || some_way(bench, stride.next, depth - 1))) {
            return true;
        }
    }
    return false;
}

static void try_state(const struct basin *basin, const struct laws_bench *bench,
                      const double apex[3], bool look_for_a_way, struct count *count)
{
    struct laws_walk walk;
    double gait[3];
    const double r0_m = laws_bench_gait(bench, basin->speed_rad_s, gait);
    laws_walk_start(bench, &walk, apex, r0_m, basin->speed_rad_s);
    for (int k = 0; k < STEPS; k++) {
        if (laws_walk_step(bench, &walk, basin->speed_rad_s, NULL, 0.0, 0.0) != 0) {
            if (look_for_a_way) {
                count->lost_tried++;
                count->hopeless += some_way(bench, apex, TREE_DEPTH) ? 0 : 1;
            }
            return;
        }
        if (k > 3 && arrived(&walk, gait)) {
            break;
        }
    }
    count->survived++;
    count->reached += fabs(walk.apex[0] - gait[0]) < 0.01 * basin->speed_rad_s ? 1 : 0;
}

static void compute(void *context, int chunk)
{
    struct basin *basin = (struct basin *)context;
    const struct laws_bench bench = laws_entrant_bench(basin->options, basin->entrant);
    const double unit = laws_speed_unit(basin->options);
    struct rng rng;
    rng_init(&rng, basin->options->seed, (uint64_t)chunk); /* the same states for every law */
    for (int i = 0; i < CHUNK && chunk * CHUNK + i < basin->samples; i++) {
        double apex[3];
        for (int k = 0; k < 3; k++) {
            apex[k] = box_low[k] + (box_high[k] - box_low[k]) * rng_uniform(&rng);
            apex[k] *= k == 1 ? 1.0 : unit;
        }
        try_state(basin, &bench, apex,
                  basin->entrant == ENTRANT_PREDICTIVE && i % HOPELESS_EVERY == 0,
                  &basin->chunk[chunk]);
    }
}

static void print(const struct basin *basin, double paper_speed, FILE *csv)
{
    const int chunks = (basin->samples + CHUNK - 1) / CHUNK;
    struct count sum = {0};
    for (int i = 0; i < chunks; i++) {
        sum.reached += basin->chunk[i].reached;
        sum.survived += basin->chunk[i].survived;
        sum.lost_tried += basin->chunk[i].lost_tried;
        sum.hopeless += basin->chunk[i].hopeless;
    }
    const double n = basin->samples, share = sum.reached / n;
    const double error = sqrt(share * (1.0 - share) / n);
    printf("  %-13s %.1f rad/s: reached %7.3f %% +- %.3f, still walking %7.3f %%",
           laws_entrant_names[basin->entrant], paper_speed, 100.0 * share, 100.0 * error,
           100.0 * sum.survived / n);
    if (sum.lost_tried > 0) {
        printf("; of the lost ones %.0f %% (%d of %d) survive 3 strides by no r0",
               100.0 * sum.hopeless / sum.lost_tried, sum.hopeless, sum.lost_tried);
    }
    printf("\n");
    if (csv != NULL) {
        fprintf(csv, "%s,%.1f,%d,%d,%d,%d,%d\n", laws_entrant_names[basin->entrant], paper_speed,
                basin->samples, sum.reached, sum.survived, sum.lost_tried, sum.hopeless);
    }
    fflush(stdout);
}

int laws_basin(const struct laws_options *options)
{
    bool failed;
    FILE *csv =
        laws_csv(options, "basin",
                 "law,speed_rad_s,samples,reached,survived,lost_examined,hopeless", &failed);
    struct basin basin = {.options = options,
                          .samples = options->samples > 0 ? options->samples : DEFAULT_SAMPLES};
    const int chunks = (basin.samples + CHUNK - 1) / CHUNK;
    basin.chunk = calloc((size_t)chunks, sizeof *basin.chunk);
    failed = failed || basin.chunk == NULL;
    printf(
        "  box: stance rate %g..%g rad/s, swing angle %g..%g rad, swing rate %g..%g rad/s; %d states\n",
        box_low[0], box_high[0], box_low[1], box_high[1], box_low[2], box_high[2], basin.samples);
    for (int e = 0; e < ENTRANTS && !failed; e++) {
        if (!options->entrant[e] || e == ENTRANT_RAMP) { /* from the gait's own command: no ramp */
            continue;
        }
        for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0] && !failed; i++) {
            const struct pool_jobs jobs = {0, chunks, options->threads, &basin, compute, laws_take};
            basin.entrant = (enum laws_entrant)e;
            basin.speed_rad_s = speeds[i] * laws_speed_unit(options);
            for (int k = 0; k < chunks; k++) {
                basin.chunk[k] = (struct count){0};
            }
            failed = pool_run(&jobs) != 1;
            print(&basin, speeds[i], csv);
        }
    }
    free(basin.chunk);
    return laws_csv_close(csv) != 0 || failed ? -1 : 0;
}
