/* What is possible at all, whatever the law. On the map, every push-off within the law's limits.
 *
 * Survival: which share of the box of apex states can be walked on from for ever (viability_kernel.h), on grids of rising
 * fineness, from outside (no law can do more) and from inside.
 * The law's own figures for jumps need no such bound: they are walks that exist. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/laws.h"
#include "sim_host/study/map/viability_kernel.h"

enum { SAMPLES = 100000 };

/* From grid to grid twice as many states a side; in between, twice as many push-offs. */
static const struct {
    int fineness, pushes;
} grids[] = {{2, 120}, {4, 120}, {8, 120}};
enum { GRIDS = sizeof grids / sizeof grids[0] };

/* Asks both sets about the box's states. */
static void survival(const struct laws_options *options, const struct viability_grid *grid,
                     const unsigned char *outer, const unsigned char *inner, int rounds, FILE *csv)
{
    const int samples = options->samples > 0 ? options->samples : SAMPLES;
    int strikes = 0, can = 0, may = 0;
    struct rng rng;
    rng_init(&rng, options->seed, 74);
    for (int i = 0; i < samples; i++) {
        double apex[3];
        struct viability_state state;
        laws_draw_apex(options, &rng, apex);
        if (viability_after_apex(&grid->walker, apex, &state)) {
            strikes++;
            may += viability_has(grid, VIABILITY_OUTER, outer, &state) ? 1 : 0;
            can += viability_has(grid, VIABILITY_INNER, inner, &state) ? 1 : 0;
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
}

static int survival_on(const struct laws_options *options, const struct viability_grid *grid,
                       FILE *csv)
{
    unsigned char *outer = malloc((size_t)grid->nodes), *inner = malloc((size_t)grid->nodes);
    const bool room = outer != NULL && inner != NULL;
    const int rounds = room ? viability_kernel(grid, VIABILITY_OUTER, outer) : 0;
    const bool found = rounds > 0 && viability_kernel(grid, VIABILITY_INNER, inner) > 0;
    if (found) {
        survival(options, grid, outer, inner, rounds, csv);
    }
    free(outer);
    free(inner);
    return found ? 0 : -1;
}

int laws_limits(const struct laws_options *options)
{
    const struct gait_walker walker = subject_gait_walker(&options->subject);
    struct output_file file;
    bool failed;
    FILE *csv = laws_csv(options, "survival", "legs,rates,pushes,samples,strike,inner,outer", &file,
                         &failed);
    for (int i = 0; i < GRIDS && !failed; i++) {
        struct viability_grid grid;
        const struct viability_range range =
            laws_viability_range(options, grids[i].fineness, grids[i].pushes);
        failed = viability_make(&grid, &walker, &range, options->threads) != 0;
        if (!failed) {
            failed = survival_on(options, &grid, csv) != 0;
            (void)fflush(stdout);
            viability_free(&grid);
        }
        if (failed) {
            fprintf(stderr, "afo study laws: no memory for a grid of %d x %d states\n", range.legs,
                    range.rates);
        }
    }
    return laws_csv_close(options, &file, failed);
}
