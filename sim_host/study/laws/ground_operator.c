#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/ground.h"

enum {
    CELLS_MAX = 100000,
    TABLE_SIZE = 524288,
    DRAWS = 15,
    CELLS_AT_ONCE = 1024,
    ITERATIONS = 800,
    FALLEN = -1,
    RISE_PUSHES = 400
};
/* Size of a cell in the paper's units: small against the basin (0.1 and more), large against 1e-6. */
static const double cell_size[3] = {0.01, 0.005, 0.04};

struct mesh {
    const struct law_setup *setup;
    double speed_rad_s, unit;
    double (*apex)[3];                    /* of each cell's representative */
    int (*next)[DRAWS];                   /* cell after each draw of the ground */
    int64_t *key;                         /* of cells */
    int *slot;                            /* hash table: cell + 1, 0 = empty */
    double slope_rad[DRAWS], rise[DRAWS]; /* equally likely */
    int cells;
    bool full;
};

static void set_draws(struct mesh *mesh, double most, double step_share, bool heights)
{
    for (int i = 0; i < DRAWS; i++) {
        const double rise = most * (2.0 * i + 1.0 - DRAWS) / DRAWS;
        mesh->rise[i] = heights ? rise : 0.0;
        mesh->slope_rad[i] = heights ? 0.0 : atan(rise / step_share);
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
    const double r0_m = law_setup_gait(mesh->setup, mesh->speed_rad_s, gait);
    laws_walk_start(mesh->setup, &walk, apex, r0_m, mesh->speed_rad_s);
    return laws_walk_answer(mesh->setup, &walk, mesh->speed_rad_s, apex);
}

/* The strides of `count` cells from `first` on, over every draw of the ground. */
static int stride_cells(const struct mesh *mesh, int first, int count, struct batch_item *items)
{
    const struct batch_walker walker = laws_batch_walker(&mesh->setup->truth);
    const struct batch_settings settings = {0};
    const struct batch_job job = {.walkers = &walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = (size_t)count * DRAWS,
                                  .strides = 1};
    for (int c = 0; c < count; c++) {
        const double *apex = mesh->apex[first + c];
        const double r0_m = answer(mesh, apex);
        for (int i = 0; i < DRAWS; i++) {
            items[c * DRAWS + i] = (struct batch_item){.apex = {apex[0], apex[1], apex[2]},
                                                       .push_m = r0_m,
                                                       .slope_rad = mesh->slope_rad[i],
                                                       .height_rise = mesh->rise[i]};
        }
    }
    return batch_run(&settings, &job) == BATCH_OK ? 0 : -1;
}

/* Every cell reached, its transitions computed. Cells are made in the order in which they are reached, however
 * many are walked from at a time. Returns 0, or -1 without memory. */
static int explore(struct mesh *mesh)
{
    double gait[3];
    struct batch_item *items = calloc((size_t)CELLS_AT_ONCE * DRAWS, sizeof *items);
    int status = items == NULL ? -1 : 0;
    (void)law_setup_gait(mesh->setup, mesh->speed_rad_s, gait);
    (void)cell_of(mesh, gait);
    for (int first = 0; first < mesh->cells && status == 0;) {
        const int left = mesh->cells - first;
        const int count = left < CELLS_AT_ONCE ? left : CELLS_AT_ONCE;
        status = stride_cells(mesh, first, count, items);
        for (int i = 0; i < count * DRAWS && status == 0; i++) {
            mesh->next[first + i / DRAWS][i % DRAWS] =
                items[i].fault == 0 ? cell_of(mesh, items[i].apex) : FALLEN;
        }
        first += count;
    }
    free(items);
    return status;
}

/* One step of the ground on the distribution p, by way of q: p becomes the distribution of those who are still
 * up (all zero when nobody is); returns the share that falls. */
static double step(const struct mesh *mesh, double *p, double *q)
{
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
    return fallen / (fallen + rest);
}

/* From the gait on: the expected number of steps is the sum of the chances to be still up before each. The
 * distribution of those who are up comes to rest on the way (power iteration), and from then on the rest of the
 * sum is geometric. The chance to fall is summed itself, not got as 1 - lambda. */
static void count_steps(const struct mesh *mesh, double *p, double *q,
                        struct ground_operator_result *result)
{
    double chance = 1.0, up = 1.0;
    result->mean_steps = 0.0;
    for (int i = 0; i < mesh->cells; i++) {
        p[i] = i == 0 ? 1.0 : 0.0;
    }
    for (int iteration = 0; iteration < ITERATIONS && up > 1e-15; iteration++) {
        const double before = chance;
        chance = step(mesh, p, q);
        result->mean_steps += up;
        up *= 1.0 - chance;
        if (iteration > 200 && fabs(chance - before) <= 1e-9 * before) {
            break;
        }
    }
    result->mean_steps += chance > 0.0 ? up / chance : (double)INFINITY;
    result->settled_steps = chance > 0.0 ? 1.0 / chance : (double)INFINITY;
}

int ground_operator(const struct law_setup *setup, double speed_rad_s, double rise_most,
                    double step_share, bool heights, struct ground_operator_result *result)
{
    struct mesh mesh = {.setup = setup, .speed_rad_s = speed_rad_s};
    mesh.unit = __builtin_sqrt(setup->truth.gravity_m_s2 / 9.80665 / setup->truth.leg_length_m);
    mesh.apex = calloc(CELLS_MAX, sizeof *mesh.apex);
    mesh.next = calloc(CELLS_MAX, sizeof *mesh.next);
    mesh.key = calloc(CELLS_MAX, sizeof *mesh.key);
    mesh.slot = calloc(TABLE_SIZE, sizeof *mesh.slot);
    double *p = calloc(CELLS_MAX, sizeof *p), *q = calloc(CELLS_MAX, sizeof *q);
    const bool room = mesh.apex != NULL && mesh.next != NULL && mesh.key != NULL &&
                      mesh.slot != NULL && p != NULL && q != NULL;
    set_draws(&mesh, rise_most, step_share, heights);
    const bool explored = room && explore(&mesh) == 0;
    if (explored) {
        count_steps(&mesh, p, q, result);
        result->cells = mesh.cells;
        result->full = mesh.full;
    }
    free(mesh.apex);
    free(mesh.next);
    free(mesh.key);
    free(mesh.slot);
    free(p);
    free(q);
    return explored ? 0 : -1;
}

static double largest_rise(const struct law_setup *setup, const double apex[3], double r0_m)
{
    struct laws_stride stride;
    double low = 0.0, high = 0.2;
    if (laws_stride(&setup->truth, setup->accuracy, apex, r0_m, 0.0, 0.0, &stride) != 0) {
        return 0.0;
    }
    while (high - low > 1e-6) {
        const double middle = 0.5 * (low + high);
        const int fault =
            laws_stride(&setup->truth, setup->accuracy, apex, r0_m, 0.0, middle, &stride);
        *(fault == 0 ? &low : &high) = middle;
    }
    return low;
}

void ground_rise_survived(const struct law_setup *setup, double speed_rad_s,
                          struct ground_rise *rise)
{
    const struct gait_walker *body = &setup->truth;
    const double low_m = (double)setup->params.r0_min_m, high_m = (double)setup->params.r0_max_m;
    double apex[3];
    struct laws_stride stride;
    const double r0_m = law_setup_gait(setup, speed_rad_s, apex);
    *rise = (struct ground_rise){.climbed = 0.5 * speed_rad_s * speed_rad_s * body->leg_length_m /
                                            body->gravity_m_s2,
                                 .own_push = largest_rise(setup, apex, r0_m)};
    for (int i = 0; i <= RISE_PUSHES; i++) {
        const double push_m = low_m + (high_m - low_m) * i / RISE_PUSHES;
        const double largest = largest_rise(setup, apex, push_m);
        if (largest > rise->any_push) {
            rise->any_push = largest;
            rise->any_push_m = push_m;
        }
    }
    (void)laws_stride(body, setup->accuracy, apex, rise->any_push_m, 0.0, 0.0, &stride);
    rise->level_speed = stride.fault == 0 ? -stride.next[0] : 0.0;
}
