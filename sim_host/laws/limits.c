/* What is possible at all, whatever the law. On the map, every push-off within the law's limits.
 *
 * Survival: which share of the box of apex states can be walked on from for ever (viable.h), on grids of rising
 * fineness, from outside (no law can do more) and from inside.
 *
 * Jumps: the least steps until the speed can be kept within 1 % of the target: the states from which it can be kept
 * there for ever, then the fewest push-offs into them, both from outside: no law needs fewer. Beside it
 * what the predictive law needs, which is a walk that exists. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/laws/session.h"
#include "sim_host/study/viable.h"

enum { SPEEDS = 9, SAMPLES = 100000, WALK_STEPS = 150 };
#define SHARE 0.01

/* From grid to grid twice as many states a side; in between, twice as many push-offs. */
static const struct {
    int fineness, pushes;
} grids[] = {{2, 120}, {4, 120}, {8, 120}, {4, 480}};
enum { GRIDS = sizeof grids / sizeof grids[0] };

static double speed_of(const struct laws_options *options, int index)
{
    return (0.2 + 0.1 * index) * laws_speed_unit(options);
}

struct viable_range laws_viable_range(const struct laws_options *options, int fineness, int pushes)
{
    const struct control_params *params = &options->bench.params;
    return (struct viable_range){.legs_low_rad = 0.03,
                                 .legs_high_rad = 2.4,
                                 .rate_low = 0.0,
                                 .rate_high = 0.6,
                                 .r0_low_m = (double)params->r0_min_m,
                                 .r0_high_m = (double)params->r0_max_m,
                                 .legs = 100 * fineness,
                                 .rates = 60 * fineness,
                                 .pushes = pushes};
}

/* ---- survival ------------------------------------------------------------------------------ */

static int survival_on(const struct laws_options *options, const struct viable_grid *grid,
                       FILE *csv)
{
    unsigned char *outer = malloc((size_t)grid->nodes), *inner = malloc((size_t)grid->nodes);
    const int samples = options->samples > 0 ? options->samples : SAMPLES;
    int strikes = 0, can = 0, may = 0;
    struct rng rng;
    if (outer == NULL || inner == NULL) {
        free(outer);
        free(inner);
        return -1;
    }
    const int rounds = viable_kernel(grid, VIABLE_OUTER, 0.0, INFINITY, outer);
    (void)viable_kernel(grid, VIABLE_INNER, 0.0, INFINITY, inner);
    rng_init(&rng, options->seed, 74);
    for (int i = 0; i < samples; i++) {
        double apex[3];
        struct viable_state state;
        laws_draw_apex(options, &rng, apex);
        if (viable_after_apex(&grid->walker, apex, &state)) {
            strikes++;
            may += viable_has(grid, VIABLE_OUTER, outer, &state) ? 1 : 0;
            can += viable_has(grid, VIABLE_INNER, inner, &state) ? 1 : 0;
        }
    }
    printf(
        "  %3d x %3d states, %3d push-offs, at rest after %2d rounds: of %d states of the box %.2f %% come "
        "to a heel strike,\n    at least %.2f %% and at most %.2f %% can be walked on from for ever\n",
        grid->range.legs, grid->range.rates, grid->range.pushes, rounds, samples,
        100.0 * strikes / samples, 100.0 * can / samples, 100.0 * may / samples);
    if (csv != NULL) {
        fprintf(csv, "%d,%d,%d,%d,%d,%d,%d\n", grid->range.legs, grid->range.rates,
                grid->range.pushes, samples, strikes, can, may);
    }
    free(outer);
    free(inner);
    return 0;
}

/* ---- jumps --------------------------------------------------------------------------------- */

struct jump_limits {
    int least[SPEEDS][SPEEDS], law[SPEEDS][SPEEDS];
};

static int law_needs(const struct laws_options *options, double from, double to)
{
    struct session_result *result = malloc(sizeof *result);
    struct laws_options on_map = *options;
    const struct session_config config = {.entrant = ENTRANT_PREDICTIVE,
                                          .from_rad_s = from,
                                          .to_rad_s = to,
                                          .steps = WALK_STEPS,
                                          .seed = options->seed};
    int steps = -1;
    on_map.chain = false;
    if (result != NULL && session_run(&on_map, &config, result) == 0 && !result->fell) {
        steps = session_settled(result, to, SHARE);
    }
    free(result);
    return steps;
}

static int find_jumps(const struct laws_options *options, const struct viable_grid *grid,
                      struct jump_limits *limits)
{
    unsigned char *target = malloc((size_t)grid->nodes), *steps = malloc((size_t)grid->nodes);
    const int status = target != NULL && steps != NULL ? 0 : -1;
    for (int to = 0; to < SPEEDS && status == 0; to++) {
        const double speed = speed_of(options, to);
        const double slow = (1.0 - SHARE) * speed, fast = (1.0 + SHARE) * speed;
        (void)viable_kernel(grid, VIABLE_OUTER, slow, fast, target);
        viable_steps(grid, target, slow, fast, steps);
        for (int from = 0; from < SPEEDS; from++) {
            double apex[3];
            struct viable_state state;
            (void)laws_bench_gait(&options->bench, speed_of(options, from), apex);
            limits->least[from][to] = viable_after_apex(&grid->walker, apex, &state)
                                          ? viable_least(grid, steps, &state)
                                          : 0;
            limits->law[from][to] = law_needs(options, speed_of(options, from), speed);
        }
    }
    free(target);
    free(steps);
    return status;
}

static void print_jumps(const struct jump_limits *limits, FILE *csv)
{
    int most_above = 0;
    printf("  steps to settle within 1 %%: no law needs fewer than / the predictive law needs\n"
           "  from\\to ");
    for (int j = 0; j < SPEEDS; j++) {
        printf("%8.1f", 0.2 + 0.1 * j);
    }
    for (int i = 0; i < SPEEDS; i++) {
        printf("\n  %6.1f  ", 0.2 + 0.1 * i);
        for (int j = 0; j < SPEEDS; j++) {
            const int least = limits->least[i][j], law = limits->law[i][j];
            printf("  %2d /%2d", least, law);
            most_above = law - least > most_above ? law - least : most_above;
            if (csv != NULL) {
                fprintf(csv, "%.1f,%.1f,%d,%d\n", 0.2 + 0.1 * i, 0.2 + 0.1 * j, least, law);
            }
        }
    }
    printf("\n  at most %d steps more than the least\n", most_above);
}

static int jumps_on(const struct laws_options *options, const struct viable_grid *grid)
{
    struct jump_limits limits;
    struct output_file file;
    bool failed;
    FILE *csv =
        laws_csv(options, "limits", "from_rad_s,to_rad_s,least_steps,law_steps", &file, &failed);
    failed = failed || find_jumps(options, grid, &limits) != 0;
    if (!failed) {
        print_jumps(&limits, csv);
    }
    return laws_csv_close(&file, failed);
}

int laws_limits(const struct laws_options *options)
{
    const struct gait_walker walker = subject_gait_walker(&options->subject);
    struct output_file file;
    bool failed;
    FILE *csv = laws_csv(options, "survival", "legs,rates,pushes,samples,strike,inner,outer", &file,
                         &failed);
    for (int i = 0; i < GRIDS && !failed; i++) {
        struct viable_grid grid;
        const struct viable_range range =
            laws_viable_range(options, grids[i].fineness, grids[i].pushes);
        failed = viable_make(&grid, &walker, &range, options->threads) != 0;
        if (!failed) {
            failed = survival_on(options, &grid, csv) != 0;
            (void)fflush(stdout);
            failed = failed || (i == GRIDS - 1 && jumps_on(options, &grid) != 0);
            viable_free(&grid);
        }
    }
    return laws_csv_close(&file, failed);
}
