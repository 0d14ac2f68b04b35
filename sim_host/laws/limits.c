/* What is possible at all: from each steady gait, every push-off of a fine grid is tried at every step, and
 * the states reached are gathered in cells of what is left of a state after the collision (two numbers: the
 * inter-leg angle and the ankle's rate), one true trajectory a cell. A jump counts as settled at the first
 * step from which some push-offs keep the speed within 1 % of the target: tried by the laws themselves. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/laws/laws.h"
#include "sim_host/study/pool.h"

enum {
    SPEEDS = 9,
    PUSHES = 48,
    NODES_MAX = 20000,
    GRID_A = 400,
    GRID_W = 400,
    STEPS_MAX = 60,
    TAIL = 12
};
#define MOST_ANGLE 2.0
#define MOST_RATE 1.6 /* sqrt(g l) / paper's */
#define SHARE 0.01

struct node {
    double apex[3], r0_m;
    int step;
};

struct search {
    const struct laws_options *options;
    int least[SPEEDS][SPEEDS]; /* steps; 0 = none found */
    int reached[SPEEDS], deepest[SPEEDS];
    bool failed[SPEEDS], full[SPEEDS];
};

static double speed_of(const struct laws_options *options, int index)
{
    return (0.2 + 0.1 * index) * laws_speed_unit(options);
}

/* From this node on, one of the laws keeps the speed within SHARE of the target. */
static bool stays(const struct laws_options *options, const struct node *node, double target)
{
    static const enum laws_entrant tails[] = {ENTRANT_PREDICTIVE, ENTRANT_DLQR, ENTRANT_DEADBEAT};
    if (fabs(-node->apex[0] - target) > SHARE * target) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        const struct laws_bench bench = laws_entrant_bench(options, tails[i]);
        struct laws_walk walk;
        int k = 0;
        laws_walk_start(&bench, &walk, node->apex, node->r0_m, target);
        while (k < TAIL && laws_walk_step(&bench, &walk, target, NULL, 0.0, 0.0) == 0 &&
               fabs(-walk.apex[0] - target) <= SHARE * target) {
            k++;
        }
        if (k == TAIL) {
            return true;
        }
    }
    return false;
}

static void judge(struct search *search, int from, const struct node *node)
{
    for (int to = 0; to < SPEEDS; to++) {
        if (search->least[from][to] == 0 &&
            stays(search->options, node, speed_of(search->options, to))) {
            search->least[from][to] =
                node->step + 1; /* settled from this apex on, counted from 1 */
        }
    }
}

static int cell_of(const struct laws_stride *s, double rate_unit)
{
    const int a = (int)(s->after_collision[0] / MOST_ANGLE * GRID_A);
    const int w = (int)(s->after_collision[1] / (MOST_RATE * rate_unit) * GRID_W);
    return a >= 0 && a < GRID_A && w >= 0 && w < GRID_W ? a * GRID_W + w : -1;
}

static void explore(struct search *search, int from, struct node *nodes, unsigned char *seen)
{
    const struct laws_bench *bench = &search->options->bench;
    const double low = (double)bench->params.r0_min_m, high = (double)bench->params.r0_max_m;
    const double rate_unit = laws_speed_unit(search->options) * bench->truth.leg_length_m;
    int count = 1;
    nodes[0].r0_m = laws_bench_gait(bench, speed_of(search->options, from), nodes[0].apex);
    nodes[0].step = 0;
    judge(search, from, &nodes[0]);
    for (int n = 0; n < count && nodes[n].step < STEPS_MAX; n++) {
        for (int i = 0; i < PUSHES; i++) {
            const double share = (double)i / (PUSHES - 1);
            const double r0_m = low + (high - low) * share * sqrt(share);
            struct laws_stride stride, probe;
            if (laws_stride(&bench->truth, LAWS_COARSE, nodes[n].apex, r0_m, 0.0, 0.0, &stride) !=
                0) {
                continue;
            }
            /* Where the next apex leads is known after its own collision. */
            (void)laws_stride(&bench->truth, LAWS_COARSE, stride.next, low, 0.0, 0.0, &probe);
            const int cell = cell_of(&probe, rate_unit);
            if (cell < 0 || probe.step_length_m <= 0.0 || seen[cell] != 0) {
                continue;
            }
            if (count == NODES_MAX) {
                search->full[from] = true;
                continue;
            }
            seen[cell] = 1;
            struct node *node = &nodes[count++];
            *node = (struct node){
                {stride.next[0], stride.next[1], stride.next[2]}, r0_m, nodes[n].step + 1};
            judge(search, from, node);
            search->deepest[from] = node->step;
        }
    }
    search->reached[from] = count;
}

static void compute(void *context, int from)
{
    struct search *search = (struct search *)context;
    struct node *nodes = malloc(NODES_MAX * sizeof *nodes);
    unsigned char *seen = calloc(GRID_A * GRID_W, 1);
    search->failed[from] = nodes == NULL || seen == NULL;
    if (!search->failed[from]) {
        explore(search, from, nodes, seen);
    }
    free(nodes);
    free(seen);
}

int laws_limits(const struct laws_options *options)
{
    bool failed;
    FILE *csv = laws_csv(options, "limits", "from_rad_s,to_rad_s,least_steps", &failed);
    struct search *search = calloc(1, sizeof *search);
    failed = failed || search == NULL;
    if (!failed) {
        search->options = options;
        const struct pool_jobs jobs = {0, SPEEDS, options->threads, search, compute, laws_take};
        failed = pool_run(&jobs) != 1;
        printf(
            "  least steps to settle within 1 %%, any push-offs within %.4g..%.4g m, map\n  from\\to ",
            (double)options->bench.params.r0_min_m, (double)options->bench.params.r0_max_m);
        for (int j = 0; j < SPEEDS; j++) {
            printf("%6.1f", 0.2 + 0.1 * j);
        }
        printf("   states reached\n");
    }
    for (int i = 0; i < SPEEDS && !failed; i++) {
        failed = search->failed[i];
        printf("  %6.1f  ", 0.2 + 0.1 * i);
        for (int j = 0; j < SPEEDS; j++) {
            printf("%6d", search->least[i][j]);
            if (csv != NULL) {
                fprintf(csv, "%.1f,%.1f,%d\n", 0.2 + 0.1 * i, 0.2 + 0.1 * j, search->least[i][j]);
            }
        }
        printf("   %d in %d steps%s\n", search->reached[i], search->deepest[i],
               search->full[i] ? " (more than there is room for)" : "");
    }
    free(search);
    return laws_csv_close(csv) != 0 || failed ? -1 : 0;
}
