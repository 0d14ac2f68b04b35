/* The basin: from which share of a box of apex states does the law bring the walker to the gait it was told? And
 * what is there to reach: the share of the box from which any sequence of push-offs can walk on for ever, between
 * an inner and an outer bound (viability_kernel.h). */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/laws.h"
#include "sim_host/study/laws/walks.h"
#include "sim_host/study/pool.h"

enum { CHUNK = 250, STEPS = 80, DEFAULT_SAMPLES = 2000, MANY_SAMPLES = 100000 };

static const double speeds[] = {0.4, 0.6, 0.8};

struct count {
    int reached, survived;
    int viability_inner, viability_outer; /* of the same states */
    int beyond; /* reached from outside the outer bound: none, or the bound is wrong */
    bool failed;
};

struct basin {
    const struct laws_options *options;
    enum law_case law_case;
    double speed_rad_s;
    int samples;
    struct viability_grid grid;
    unsigned char *inner, *outer; /* sets of viable nodes */
    struct count *chunk;
};

/* The walks of one chunk. */
struct chunk_walks {
    const struct basin *basin;
    struct law_setup setup;
    double gait[3];
    struct laws_course course[CHUNK];
    bool may[CHUNK]; /* begins within the outer bound */
    struct count *count;
};

static bool arrived(const struct laws_walk *walk, const double gait[3])
{
    return fabs(walk->apex[0] - gait[0]) < 0.002 * fabs(gait[0]) &&
           fabs(walk->apex[1] - gait[1]) < 0.002 && fabs(walk->apex[2] - gait[2]) < 0.002 * gait[2];
}

static void look(void *context, size_t i, struct laws_ahead *ahead)
{
    const struct chunk_walks *walks = (const struct chunk_walks *)context;
    (void)i;
    ahead->desired_rad_s = walks->basin->speed_rad_s;
}

static int count_end(void *context, size_t i, const struct laws_walk *walk)
{
    struct chunk_walks *walks = (struct chunk_walks *)context;
    if (walk->stride.fault != 0) {
        return 1;
    }
    const bool there = walk->steps > 4 && arrived(walk, walks->gait);
    if (!there && walk->steps < STEPS) {
        return 0;
    }
    walks->count->survived++;
    if (fabs(walk->apex[0] - walks->gait[0]) < 0.01 * walks->basin->speed_rad_s) {
        walks->count->reached++;
        walks->count->beyond += walks->may[i] ? 0 : 1;
    }
    return 1;
}

/* Whether push-offs could keep it up from there, by both bounds. */
static void bound(struct chunk_walks *walks, int i, const double apex[3])
{
    const struct basin *basin = walks->basin;
    struct viability_state state;
    const bool strikes = viability_after_apex(&walks->setup.truth, apex, &state);
    walks->may[i] = strikes && viability_has(&basin->grid, VIABILITY_OUTER, basin->outer, &state);
    walks->count->viability_outer += walks->may[i] ? 1 : 0;
    walks->count->viability_inner +=
        strikes && viability_has(&basin->grid, VIABILITY_INNER, basin->inner, &state) ? 1 : 0;
}

static void compute(void *context, int chunk)
{
    struct basin *basin = (struct basin *)context;
    struct chunk_walks *walks = calloc(1, sizeof *walks);
    struct rng rng;
    int count = 0;
    if (walks == NULL) {
        basin->chunk[chunk].failed = true;
        return;
    }
    walks->basin = basin;
    walks->setup = law_case_setup(basin->options, basin->law_case);
    walks->count = &basin->chunk[chunk];
    const double r0_m = law_setup_gait(&walks->setup, basin->speed_rad_s, walks->gait);
    rng_init(&rng, basin->options->seed, (uint64_t)chunk); /* the same states for every law */
    for (; count < CHUNK && chunk * CHUNK + count < basin->samples; count++) {
        struct laws_course *course = &walks->course[count];
        double apex[3];
        laws_draw_apex(basin->options, &rng, apex);
        bound(walks, count, apex);
        course->setup = &walks->setup;
        laws_walk_start(&walks->setup, &course->walk, apex, r0_m, basin->speed_rad_s);
    }
    basin->chunk[chunk].failed =
        laws_walks_run(walks->course, (size_t)count, STEPS, look, count_end, walks, 1) != 0;
    free(walks);
}

static struct count sum_up(const struct basin *basin)
{
    const int chunks = (basin->samples + CHUNK - 1) / CHUNK;
    struct count sum = {0};
    for (int i = 0; i < chunks; i++) {
        sum.reached += basin->chunk[i].reached;
        sum.survived += basin->chunk[i].survived;
        sum.viability_inner += basin->chunk[i].viability_inner;
        sum.viability_outer += basin->chunk[i].viability_outer;
        sum.beyond += basin->chunk[i].beyond;
        sum.failed = sum.failed || basin->chunk[i].failed;
    }
    return sum;
}

static void print(const struct basin *basin, const struct count *sum, double paper_speed, FILE *csv)
{
    const double n = basin->samples, share = sum->reached / n;
    const double error = sqrt(share * (1.0 - share) / n);
    printf("  %-13s %.1f rad/s: reached %7.3f %% +- %.3f, still walking %7.3f %%",
           law_case_names[basin->law_case], paper_speed, 100.0 * share, 100.0 * error,
           100.0 * sum->survived / n);
    printf("; of what can be walked on from at least %.2f %%\n",
           100.0 * sum->reached / sum->viability_outer);
    if (csv != NULL) {
        fprintf(csv, "%s,%.1f,%d,%d,%d,%d,%d,%d\n", law_case_names[basin->law_case], paper_speed,
                basin->samples, sum->reached, sum->survived, sum->viability_inner,
                sum->viability_outer, sum->beyond);
    }
    fflush(stdout);
}

/* The sets of viable states; the grid is finer where more states are asked about. */
static bool find_viability_kernel(struct basin *basin)
{
    const struct laws_options *options = basin->options;
    const struct gait_walker walker = subject_gait_walker(&options->subject);
    const struct viability_range range =
        laws_viability_range(options, basin->samples >= MANY_SAMPLES ? 8 : 2, 120);
    if (viability_make(&basin->grid, &walker, &range, options->threads) != 0) {
        return false;
    }
    basin->inner = malloc((size_t)basin->grid.nodes);
    basin->outer = malloc((size_t)basin->grid.nodes);
    return basin->inner != NULL && basin->outer != NULL &&
           viability_kernel(&basin->grid, VIABILITY_INNER, basin->inner) > 0 &&
           viability_kernel(&basin->grid, VIABILITY_OUTER, basin->outer) > 0;
}

static bool run(struct basin *basin, enum law_case law_case, double speed, FILE *csv)
{
    const int chunks = (basin->samples + CHUNK - 1) / CHUNK;
    const struct pool_jobs jobs = {0,     chunks,  basin->options->threads,
                                   basin, compute, laws_count_part};
    basin->law_case = law_case;
    basin->speed_rad_s = speed * laws_speed_unit(basin->options);
    for (int k = 0; k < chunks; k++) {
        basin->chunk[k] = (struct count){0};
    }
    if (pool_run(&jobs) != 1) {
        return false;
    }
    const struct count sum = sum_up(basin);
    if (!sum.failed) {
        print(basin, &sum, speed, csv);
    }
    return !sum.failed;
}

int laws_basin(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    FILE *csv =
        laws_csv(options, "basin",
                 "law,speed_rad_s,samples,reached,survived,viability_inner,viability_outer,beyond",
                 &file, &failed);
    struct basin basin = {.options = options,
                          .samples = options->samples > 0 ? options->samples : DEFAULT_SAMPLES};
    basin.chunk = calloc((size_t)(basin.samples + CHUNK - 1) / CHUNK, sizeof *basin.chunk);
    printf(
        "  box: stance rate %g..%g rad/s, swing angle %g..%g rad, swing rate %g..%g rad/s; %d states\n",
        laws_box_low[0], laws_box_high[0], laws_box_low[1], laws_box_high[1], laws_box_low[2],
        laws_box_high[2], basin.samples);
    fflush(stdout); /* what can be walked on from takes its time */
    if (!failed && (basin.chunk == NULL || !find_viability_kernel(&basin))) {
        fprintf(stderr,
                "afo study laws: no memory for the grid of states that can be walked on from\n");
        failed = true;
    }
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        if (!options->law_case[e] ||
            e == LAW_CASE_RAMP) { /* from the gait's own command: no ramp */
            continue;
        }
        for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0] && !failed; i++) {
            failed = !run(&basin, (enum law_case)e, speeds[i], csv);
        }
    }
    viability_free(&basin.grid);
    free(basin.inner);
    free(basin.outer);
    free(basin.chunk);
    return laws_csv_close(options, &file, failed);
}
