#include <string.h>

#include "model/real.h"
#include "sim_host/batch/atlas.h"
#include "sim_host/batch/batch.h"

#define GRAVITY 9.80665 /* of the normalised walker: M = 1, l = 1 */
#define START_PUSH 0.05 /* here the paper's walker has the gait that everything is followed from */
#define HOMOTOPY_STEPS 60
#define NEWTON_STEPS 8
#define KICK 1e-4 /* relative: beside the gait, to leave it if it is unstable */
#define TRANSIENT 500
#define RECORDED 192
#define LONGEST_PERIOD 64
#define SAME 1e-5    /* rad/s: returns as close as this count as the same */
#define SETTLED 1e-9 /* a stride that changes nothing: a stable period-1 gait is reached */

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

/* Newton on x = G(x) for all rows side by side, from rows->gait. is_known: found. */
static void find_gaits(struct rows *rows, double push)
{
    const struct batch_settings settings = {.accuracy = 1e-9};
    struct batch_item items[ATLAS_PLANE_ROWS];
    struct batch_slopes slopes[ATLAS_PLANE_ROWS];
    double error[ATLAS_PLANE_ROWS];
    for (int step = 0; step < NEWTON_STEPS; step++) {
        struct batch_job job = job_of(rows, items);
        job.slopes = slopes;
        items_at(rows, push, items);
        batch_run(&settings, &job);
        for (int r = 0; r < rows->count; r++) {
            double change[3], residual[3];
            error[r] = 1.0;
            if (items[r].fault != 0) {
                continue;
            }
            error[r] = 0.0;
            for (int i = 0; i < 3; i++) {
                residual[i] = items[r].apex[i] - rows->gait[r][i];
                error[r] += real_abs(residual[i]);
                for (int j = 0; j < 3; j++) {
                    slopes[r].by_apex[i][j] = (i == j ? 1.0 : 0.0) - slopes[r].by_apex[i][j];
                }
            }
            if (solve(slopes[r].by_apex, residual, change)) {
                for (int i = 0; i < 3; i++) {
                    rows->gait[r][i] += change[i];
                }
            }
        }
    }
    for (int r = 0; r < rows->count; r++) {
        rows->is_known[r] = error[r] < 1e-7;
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

/* What is seen of the rows' walks: speed and swing angle at the last RECORDED apexes. */
struct watch {
    double speed[ATLAS_PLANE_ROWS][RECORDED], swing[ATLAS_PLANE_ROWS][RECORDED];
    double last[ATLAS_PLANE_ROWS][3];
    int is_settled[ATLAS_PLANE_ROWS];
};

static int look(void *context, size_t index, struct batch_item *item,
                const struct batch_slopes *slopes)
{
    struct watch *watch = context;
    (void)slopes;
    double change = 0.0;
    for (int i = 0; i < 3; i++) {
        change += real_abs(item->apex[i] - watch->last[index][i]);
        watch->last[index][i] = item->apex[i];
    }
    watch->is_settled[index] = item->fault == 0 && change < SETTLED;
    const int64_t record = item->strides - 1 - TRANSIENT;
    if (record >= 0 && record < RECORDED) {
        watch->speed[index][record] = -item->apex[0];
        watch->swing[index][record] = item->apex[1];
    }
    return watch->is_settled[index];
}

static unsigned char period_of(const struct watch *watch, int row)
{
    for (int period = 1; period <= LONGEST_PERIOD; period++) {
        int is_same = 1;
        for (int i = period; i < RECORDED && is_same; i++) {
            is_same = real_abs(watch->speed[row][i] - watch->speed[row][i - period]) < SAME &&
                      real_abs(watch->swing[row][i] - watch->swing[row][i - period]) < SAME;
        }
        if (is_same) {
            return (unsigned char)period;
        }
    }
    return ATLAS_APERIODIC;
}

/* Lets each row walk from beside its gait; byte[r * stride] receives what became of it. */
static void walk(const struct rows *rows, double push, unsigned char *byte, size_t stride)
{
    static _Thread_local struct watch watch;
    const struct batch_settings settings = {.accuracy = 1e-9};
    struct batch_item items[ATLAS_PLANE_ROWS];
    struct batch_job job = job_of(rows, items);
    job.strides = TRANSIENT + RECORDED;
    job.stride_done = look;
    job.context = &watch;
    items_at(rows, push, items);
    memset(&watch, 0, sizeof watch);
    for (int r = 0; r < rows->count; r++) {
        items[r].apex[0] *= 1.0 + KICK;
        items[r].fault = !rows->is_known[r];
    }
    batch_run(&settings, &job);
    for (int r = 0; r < rows->count; r++) {
        const unsigned char seen = watch.is_settled[r] ? 1 : period_of(&watch, r);
        byte[(size_t)r * stride] = items[r].fault != 0 ? ATLAS_NO_GAIT : seen;
    }
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
    find_first_gaits(&start, plane, first);
    for (int way = 1; way >= -1; way -= 2) {
        struct rows rows = start;
        for (int c = way > 0 ? middle : middle - 1; c >= 0 && c < plane->push.count; c += way) {
            follow(&rows, atlas_at(&plane->push, c));
            walk(&rows, atlas_at(&plane->push, c), byte + c, columns);
        }
    }
    return 0;
}

struct chunks_job atlas_plane_job(struct atlas_plane *plane, const char *path)
{
    const double numbers[] = {1.0, /* of this way to compute it */
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
