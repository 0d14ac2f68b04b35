#include <stdlib.h>
#include <string.h>

#include "model/real.h"
#include "sim_host/batch/atlas.h"
#include "sim_host/batch/batch.h"

#define GRAVITY 9.80665 /* of the normalised walker: M = 1, l = 1 */
#define START_PUSH 0.05 /* here the paper's walker has the gait that everything is followed from */
#define HOMOTOPY_STEPS 60
#define NEWTON_STEPS 8
#define KICK 1e-3 /* relative: beside the gait, to leave it if it is unstable */
#define TRANSIENT 500
#define RECORDED 160
#define LONGEST_PERIOD 64
#define SAME 1e-6 /* rad, rad/s: returns as close as this count as the same in a walk at rest */
#define SLOW \
    1e-3 /* and in one that still comes to rest, as it does slowly near a period doubling */
#define SETTLED 1e-9 /* what is nearer than this has come to rest: Newton, a gait, a cycle */
#define FOUND 1e-7   /* a gait as near as this to its next apex is one */

/* The rows of one chunk, each with its walker and the gait it follows. */
struct rows {
    int count;
    struct batch_walker walker[ATLAS_PLANE_ROWS];
    double gait[ATLAS_PLANE_ROWS][3],
        before[ATLAS_PLANE_ROWS][3]; /* at the last push-off, the one before */
    int is_known[ATLAS_PLANE_ROWS];
};

/* Solves a x = b; 0 when singular. Cramer's rule: three unknowns. */
static int solve(double a[3][3], const double b[3], double x[3])
{
    const double c0 = a[1][1] * a[2][2] - a[1][2] * a[2][1];
    const double c1 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
    const double c2 = a[1][0] * a[2][1] - a[1][1] * a[2][0];
    const double determinant = a[0][0] * c0 + a[0][1] * c1 + a[0][2] * c2;
    if (!(real_abs(determinant) > 1e-12)) {
        return 0;
    }
    for (int k = 0; k < 3; k++) {
        double m[3][3];
        memcpy(m, a, sizeof m);
        for (int i = 0; i < 3; i++) {
            m[i][k] = b[i];
        }
        x[k] = (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
               determinant;
    }
    return 1;
}

static struct batch_job job_of(const struct rows *rows, struct batch_item *items)
{
    const struct batch_job job = {.walkers = rows->walker,
                                  .walker_count = (uint32_t)rows->count,
                                  .items = items,
                                  .count = (size_t)rows->count,
                                  .strides = 1};
    return job;
}

static void items_at(const struct rows *rows, double push, struct batch_item *items)
{
    memset(items, 0, (size_t)rows->count * sizeof *items);
    for (int r = 0; r < rows->count; r++) {
        memcpy(items[r].apex, rows->gait[r], sizeof items[r].apex);
        items[r].push_m = push;
        items[r].walker = (uint32_t)r;
    }
}

/* One correction of a row's gait by what its stride told; returns how far off it was, 1 when it fell. */
static double correct(const struct batch_item *item, struct batch_slopes *slopes, double gait[3])
{
    double change[3], residual[3], error = 0.0;
    if (item->fault != 0) {
        return 1.0;
    }
    for (int i = 0; i < 3; i++) {
        residual[i] = item->apex[i] - gait[i];
        error += real_abs(residual[i]);
        for (int j = 0; j < 3; j++) {
            slopes->by_apex[i][j] = (i == j ? 1.0 : 0.0) - slopes->by_apex[i][j];
        }
    }
    if (solve(slopes->by_apex, residual, change)) {
        for (int i = 0; i < 3; i++) {
            gait[i] += change[i];
        }
    }
    return error;
}

/* Newton on x = G(x) for all rows side by side, from rows->gait. is_known: found. */
static void find_gaits(struct rows *rows, double push)
{
    const struct batch_settings settings = {.accuracy = 1e-9};
    struct batch_item items[ATLAS_PLANE_ROWS];
    struct batch_slopes slopes[ATLAS_PLANE_ROWS];
    double error[ATLAS_PLANE_ROWS];
    int is_over[ATLAS_PLANE_ROWS] = {0};
    for (int step = 0; step < NEWTON_STEPS; step++) {
        struct batch_job job = job_of(rows, items);
        job.slopes = slopes;
        items_at(rows, push, items);
        for (int r = 0; r < rows->count; r++) {
            items[r].fault = is_over[r];
        }
        batch_run(&settings, &job);
        for (int r = 0; r < rows->count; r++) {
            if (!is_over[r]) {
                error[r] = correct(&items[r], &slopes[r], rows->gait[r]);
                is_over[r] = items[r].fault != 0 || error[r] < SETTLED;
            }
        }
    }
    for (int r = 0; r < rows->count; r++) {
        rows->is_known[r] = error[r] < FOUND;
    }
}

/* From the paper's gait at START_PUSH to those of the rows' walkers. */
static void find_first_gaits(struct rows *rows, const struct atlas_plane *plane, size_t first_row)
{
    for (int step = 0; step <= HOMOTOPY_STEPS; step++) {
        const double share = (double)step / HOMOTOPY_STEPS;
        for (int r = 0; r < rows->count; r++) {
            static const double paper[3] = {-0.406960, -0.059569, 1.756768};
            const double wanted = GRAVITY * atlas_at(&plane->stiffness, (int)first_row + r);
            rows->walker[r] = (struct batch_walker){1.0, 0.01 + share * (plane->mass_ratio - 0.01),
                                                    1.0, 100.0 + share * (wanted - 100.0), GRAVITY};
            if (step == 0) {
                memcpy(rows->gait[r], paper, sizeof paper);
            }
        }
        find_gaits(rows, START_PUSH);
    }
    memcpy(rows->before, rows->gait, sizeof rows->gait);
}

/* Walks of many columns side by side: lanes whose walker has fallen or come to rest go on with the next. */
#define COLUMNS 64
#define WALKS (COLUMNS * ATLAS_PLANE_ROWS)

/* Starts and walks of up to COLUMNS columns; of each walk the last RECORDED apexes, in a ring. */
struct watch {
    size_t count;
    struct batch_item item[WALKS];
    unsigned char *byte[WALKS]; /* where what became of it belongs */
    double apex[WALKS][RECORDED][3];
};

/* How far an apex is from the one some strides before. */
static double change_over(const struct watch *watch, size_t walk, int64_t stride, int strides)
{
    const double *now = watch->apex[walk][stride % RECORDED];
    const double *then = watch->apex[walk][(stride - strides) % RECORDED];
    return real_abs(now[0] - then[0]) + real_abs(now[1] - then[1]) + real_abs(now[2] - then[2]);
}

/* Stops a walk that has come to rest: in a gait, or in a cycle whose period divides LONGEST_PERIOD. */
static int look(void *context, size_t index, struct batch_item *item,
                const struct batch_slopes *slopes)
{
    struct watch *watch = context;
    const int64_t n = item->strides;
    (void)slopes;
    if (item->fault != 0) {
        return 1;
    }
    memcpy(watch->apex[index][n % RECORDED], item->apex, sizeof item->apex);
    return (n > 1 && change_over(watch, index, n, 1) < SETTLED) ||
           (n > 2 * LONGEST_PERIOD && change_over(watch, index, n, LONGEST_PERIOD) < SETTLED);
}

/* The period of a walk of `strides` strides: of one that was stopped at rest its last period and one stride tell,
 * of a whole one the longest period. */
static unsigned char period_of(const struct watch *watch, size_t walk, int64_t strides)
{
    const int is_whole = strides == TRANSIENT + RECORDED;
    const double tolerance = is_whole ? SLOW : SAME;
    for (int period = 1; period <= LONGEST_PERIOD && period < strides; period++) {
        const int looks = is_whole ? LONGEST_PERIOD : period + 1;
        int is_same = 1;
        for (int i = 0; i < looks && i + period < strides && is_same; i++) {
            is_same = change_over(watch, walk, strides - i, period) < tolerance;
        }
        if (is_same) {
            return (unsigned char)period;
        }
    }
    return ATLAS_APERIODIC;
}

/* Lets the collected walkers walk, and says what became of each. */
static int walk_all(const struct rows *rows, struct watch *watch)
{
    const struct batch_settings settings = {.accuracy = 1e-9};
    struct batch_job job = job_of(rows, watch->item);
    job.count = watch->count;
    job.strides = TRANSIENT + RECORDED;
    job.stride_done = look;
    job.context = watch;
    const enum batch_error error = batch_run(&settings, &job);
    for (size_t i = 0; i < watch->count; i++) {
        const struct batch_item *item = &watch->item[i];
        *watch->byte[i] = item->fault != 0 ? ATLAS_NO_GAIT : period_of(watch, i, item->strides);
    }
    watch->count = 0;
    return error == BATCH_OK;
}

/* Collects each row's start beside its gait; byte[r * stride] is to receive what becomes of it. 0: an error. */
static int walk(const struct rows *rows, double push, struct watch *watch, unsigned char *byte,
                size_t stride)
{
    struct batch_item *items = &watch->item[watch->count];
    items_at(rows, push, items);
    for (int r = 0; r < rows->count; r++) {
        items[r].apex[0] *= 1.0 + KICK;
        items[r].fault = !rows->is_known[r];
        watch->byte[watch->count++] = byte + (size_t)r * stride;
    }
    return watch->count + ATLAS_PLANE_ROWS <= WALKS || walk_all(rows, watch);
}

/* Next push-off along the row: the gait extrapolated, then found. A row whose gait is lost stays where it was. */
static void follow(struct rows *rows, double push)
{
    double kept[ATLAS_PLANE_ROWS][3];
    memcpy(kept, rows->gait, sizeof kept);
    for (int r = 0; r < rows->count; r++) {
        for (int i = 0; i < 3; i++) {
            rows->gait[r][i] += kept[r][i] - rows->before[r][i];
        }
    }
    find_gaits(rows, push);
    for (int r = 0; r < rows->count; r++) {
        if (rows->is_known[r]) {
            memcpy(rows->before[r], kept[r], sizeof kept[r]);
        } else {
            memcpy(rows->gait[r], kept[r], sizeof kept[r]);
            memcpy(rows->before[r], kept[r], sizeof kept[r]);
        }
    }
}

int atlas_plane_compute(void *context, size_t chunk, void *result)
{
    const struct atlas_plane *plane = context;
    const size_t columns = (size_t)plane->push.count, first = chunk * ATLAS_PLANE_ROWS;
    const size_t left = (size_t)plane->stiffness.count - first;
    unsigned char *byte = result;
    struct rows start = {.count = left < ATLAS_PLANE_ROWS ? (int)left : ATLAS_PLANE_ROWS};
    int middle = 0;
    while (middle + 1 < plane->push.count && atlas_at(&plane->push, middle) < START_PUSH) {
        middle++;
    }
    struct watch *watch = malloc(sizeof *watch);
    if (watch == NULL) {
        return 1;
    }
    watch->count = 0;
    int is_good = 1;
    find_first_gaits(&start, plane, first);
    for (int way = 1; way >= -1; way -= 2) {
        struct rows rows = start;
        for (int c = way > 0 ? middle : middle - 1; c >= 0 && c < plane->push.count; c += way) {
            const double push = atlas_at(&plane->push, c);
            follow(&rows, push);
            is_good &= walk(&rows, push, watch, byte + c, columns);
        }
    }
    is_good &= walk_all(&start, watch);
    free(watch);
    return !is_good;
}

struct chunks_job atlas_plane_job(struct atlas_plane *plane, const char *path)
{
    const double numbers[] = {2.0, /* of this way to compute it */
                              plane->mass_ratio,
                              plane->push.from,
                              plane->push.to,
                              plane->stiffness.from,
                              plane->stiffness.to,
                              plane->stiffness.count};
    const size_t rows = (size_t)plane->stiffness.count;
    const struct chunks_job job = {.path = path,
                                   .key = chunks_key(CHUNKS_KEY_START, numbers, sizeof numbers),
                                   .count = (rows + ATLAS_PLANE_ROWS - 1) / ATLAS_PLANE_ROWS,
                                   .bytes = ATLAS_PLANE_ROWS * (size_t)plane->push.count,
                                   .compute = atlas_plane_compute,
                                   .context = plane};
    return job;
}
