#include <math.h>
#include <stdlib.h>

#include "sim_host/laws/ground.h"

enum { CELLS_MAX = 10000, TABLE_SIZE = 131072, DRAWS = 15, ITERATIONS = 800, FALLEN = -1 };
/* Size of a cell in the paper's units: small against the basin (0.1 and more), large against 1e-6. */
static const double cell_size[3] = {0.01, 0.005, 0.04};

struct mesh {
    const struct laws_bench *bench;
    double speed_rad_s, unit;
    double (*apex)[3];                    /* of each cell's representative */
    int (*next)[DRAWS];                   /* cell after each draw of the ground */
    int64_t *key;                         /* of cells */
    int *slot;                            /* hash table: cell + 1, 0 = empty */
    double slope_rad[DRAWS], rise[DRAWS]; /* equally likely */
    int cells;
    bool full;
};

static void set_draws(struct mesh *mesh, double most, double step_share, bool plateau)
{
    for (int i = 0; i < DRAWS; i++) {
        const double rise = most * (2.0 * i + 1.0 - DRAWS) / DRAWS;
        mesh->rise[i] = plateau ? rise : 0.0;
        mesh->slope_rad[i] = plateau ? 0.0 : atan(rise / step_share);
    }
}

static int64_t key_of(const struct mesh *mesh, const double apex[3])
{
    int64_t key = 0;
    for (int i = 0; i < 3; i++) {
        const double size = cell_size[i] * (i == 1 ? 1.0 : mesh->unit);
        key = key * 65536 + ((int64_t)floor(apex[i] / size) + 32768);
    }
    return key;
}

/* The cell of an apex, made if it is new. */
static int cell_of(struct mesh *mesh, const double apex[3])
{
    const int64_t key = key_of(mesh, apex);
    uint32_t at = (uint32_t)(((uint64_t)key * 0x9E3779B97F4A7C15u) >> 40) % TABLE_SIZE;
    while (mesh->slot[at] != 0) {
        const int cell = mesh->slot[at] - 1;
        if (mesh->key[cell] == key) {
            return cell;
        }
        at = (at + 1) % TABLE_SIZE;
    }
    if (mesh->cells == CELLS_MAX) {
        mesh->full = true;
        return FALLEN;
    }
    const int cell = mesh->cells++;
    mesh->slot[at] = cell + 1;
    mesh->key[cell] = key;
    for (int i = 0; i < 3; i++) {
        mesh->apex[cell][i] = apex[i];
    }
    return cell;
}

static double answer(const struct mesh *mesh, const double apex[3])
{
    struct laws_walk walk;
    double gait[3];
    const double r0_m = laws_bench_gait(mesh->bench, mesh->speed_rad_s, gait);
    laws_walk_start(mesh->bench, &walk, apex, r0_m, mesh->speed_rad_s);
    (void)laws_walk_step(mesh->bench, &walk, mesh->speed_rad_s, NULL, 0.0, 0.0);
    return walk.r0_m;
}

/* Every cell reached, its transitions computed. */
static void explore(struct mesh *mesh)
{
    double gait[3];
    (void)laws_bench_gait(mesh->bench, mesh->speed_rad_s, gait);
    (void)cell_of(mesh, gait);
    for (int cell = 0; cell < mesh->cells; cell++) {
        const double r0_m = answer(mesh, mesh->apex[cell]);
        for (int i = 0; i < DRAWS; i++) {
            struct laws_stride stride;
            const int fault =
                laws_stride(&mesh->bench->truth, mesh->bench->accuracy, mesh->apex[cell], r0_m,
                            mesh->slope_rad[i], mesh->rise[i], &stride);
            mesh->next[cell][i] = fault == 0 ? cell_of(mesh, stride.next) : FALLEN;
        }
    }
}

/* Power iteration on what has not fallen; the chance to fall is summed itself, not got as 1 - lambda. */
static double fall_chance(const struct mesh *mesh, double *p, double *q)
{
    double chance = 1.0;
    for (int i = 0; i < mesh->cells; i++) {
        p[i] = i == 0 ? 1.0 : 0.0;
    }
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        double fallen = 0.0, rest = 0.0;
        for (int i = 0; i < mesh->cells; i++) {
            q[i] = 0.0;
        }
        for (int i = 0; i < mesh->cells; i++) {
            for (int k = 0; k < DRAWS && p[i] > 0.0; k++) {
                const double flow = p[i] / DRAWS;
                if (mesh->next[i][k] == FALLEN) {
                    fallen += flow;
                } else {
                    q[mesh->next[i][k]] += flow;
                    rest += flow;
                }
            }
        }
        for (int i = 0; i < mesh->cells; i++) {
            p[i] = rest > 0.0 ? q[i] / rest : 0.0;
        }
        const bool at_rest = fabs(fallen - chance) <= 1e-9 * chance;
        chance = fallen;
        if ((at_rest && iteration > 200) || rest <= 0.0) {
            break;
        }
    }
    return chance;
}

int ground_operator(const struct laws_bench *bench, double speed_rad_s, double rise_most,
                    double step_share, bool plateau, struct ground_operator_result *result)
{
    struct mesh mesh = {.bench = bench, .speed_rad_s = speed_rad_s};
    mesh.unit = __builtin_sqrt(bench->truth.gravity_m_s2 / 9.80665 / bench->truth.leg_length_m);
    mesh.apex = calloc(CELLS_MAX, sizeof *mesh.apex);
    mesh.next = calloc(CELLS_MAX, sizeof *mesh.next);
    mesh.key = calloc(CELLS_MAX, sizeof *mesh.key);
    mesh.slot = calloc(TABLE_SIZE, sizeof *mesh.slot);
    double *p = calloc(CELLS_MAX, sizeof *p), *q = calloc(CELLS_MAX, sizeof *q);
    const bool room = mesh.apex != NULL && mesh.next != NULL && mesh.key != NULL &&
                      mesh.slot != NULL && p != NULL && q != NULL;
    if (room) {
        set_draws(&mesh, rise_most, step_share, plateau);
        explore(&mesh);
        const double chance = fall_chance(&mesh, p, q);
        result->mean_steps = chance > 0.0 ? 1.0 / chance : (double)INFINITY;
        result->cells = mesh.cells;
        result->full = mesh.full;
    }
    free(mesh.apex);
    free(mesh.next);
    free(mesh.key);
    free(mesh.slot);
    free(p);
    free(q);
    return room ? 0 : -1;
}
