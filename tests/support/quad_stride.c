#include "tests/support/quad_stride.h"

typedef __float128 quad;

/* ---- Elementary functions ------------------------------------------------------------------- */

static quad quad_abs(quad x)
{
    return x < 0 ? -x : x;
}

static quad quad_sqrt(quad x)
{
    quad y = (quad)__builtin_sqrt((double)x);
    if (!(y > 0)) {
        return y;
    }
    for (int i = 0; i < 3; i++) {
        y = (y + x / y) / 2;
    }
    return y;
}

/* Series at x/8, doubled three times. */
static void quad_sincos(quad x, quad *s, quad *c)
{
    const quad z = x / 8, square = z * z;
    quad term = z, sine = z;
    for (int k = 2; quad_abs(term) > quad_abs(sine) * (quad)1e-36 && k < 80; k += 2) {
        term = -term * square / (quad)(k * (k + 1));
        sine += term;
    }
    /* versine 1 - cos: keeps its digits where cos is near 1 */
    term = square / 2;
    quad versine = term;
    for (int k = 3; quad_abs(term) > versine * (quad)1e-36 && k < 80; k += 2) {
        term = -term * square / (quad)(k * (k + 1));
        versine += term;
    }
    for (int i = 0; i < 3; i++) {
        const quad cosine = 1 - versine;
        versine = 2 * sine * sine;
        sine = 2 * sine * cosine;
    }
    *s = sine;
    *c = 1 - versine;
}

/* The angle whose sine is s and cosine c, within (-pi/2, pi/2): Newton from double's start. */
static quad quad_angle(quad s, quad c)
{
    quad a = (quad)__builtin_atan2((double)s, (double)c);
    for (int i = 0; i < 3; i++) {
        quad sa, ca;
        quad_sincos(a, &sa, &ca);
        a += s * ca - c * sa;
    }
    return a;
}

/* ---- Extrapolation ---------------------------------------------------------------------------- */

#define STATES 4
#define COLUMNS 10

typedef void rates_fn(const void *context, const quad *y, quad *dy);

struct system {
    rates_fn *rates;
    const void *context;
    int count;
};

/* Gragg's modified midpoint rule with n (even) substeps of one step h. */
static void midpoint(const struct system *system, const quad *y, quad h, int n, quad *end)
{
    const quad sub = h / n;
    quad before[STATES], here[STATES], slope[STATES];
    system->rates(system->context, y, slope);
    for (int i = 0; i < system->count; i++) {
        before[i] = y[i];
        here[i] = y[i] + sub * slope[i];
    }
    for (int k = 1; k < n; k++) {
        system->rates(system->context, here, slope);
        for (int i = 0; i < system->count; i++) {
            const quad after = before[i] + 2 * sub * slope[i];
            before[i] = here[i];
            here[i] = after;
        }
    }
    system->rates(system->context, here, slope);
    for (int i = 0; i < system->count; i++) {
        end[i] = (here[i] + before[i] + sub * slope[i]) / 2;
    }
}

static void advance(const struct system *system, const quad *y, quad h, quad *end)
{
    quad table[COLUMNS][STATES];
    for (int j = 0; j < COLUMNS; j++) {
        const int n = 2 * (j + 1);
        midpoint(system, y, h, n, table[j]);
        for (int k = j - 1; k >= 0; k--) {
            const int m = 2 * (k + 1);
            const quad factor = (quad)(m * m) / (quad)(n * n - m * m);
            for (int i = 0; i < system->count; i++) {
                table[k][i] = table[k + 1][i] + (table[k + 1][i] - table[k][i]) * factor;
            }
        }
    }
    for (int i = 0; i < system->count; i++) {
        end[i] = table[0][i];
    }
}

/* weight . y - offset, the event. */
struct event {
    int weight[STATES];
    quad offset;
};

static quad event_value(const struct event *event, const quad *y, int count, int with_offset)
{
    quad value = with_offset ? -event->offset : 0;
    for (int i = 0; i < count; i++) {
        value += event->weight[i] * y[i];
    }
    return value;
}

/* Moves y to the event that lies within a step h; returns the time to it. */
static quad land(const struct system *system, const struct event *event, quad h, quad *y)
{
    quad end[STATES] = {0}, slope[STATES];
    const quad v0 = event_value(event, y, system->count, 1);
    advance(system, y, h, end);
    quad t = h * v0 / (v0 - event_value(event, end, system->count, 1));
    for (int i = 0; i < 12; i++) {
        advance(system, y, t, end);
        system->rates(system->context, end, slope);
        const quad change =
            event_value(event, end, system->count, 1) / event_value(event, slope, system->count, 0);
        t -= change;
        if (quad_abs(change) < (quad)1e-22) {
            break;
        }
    }
    advance(system, y, t, y);
    return t;
}

/* ---- The walker from its definition ------------------------------------------------------------- */

struct walker_q {
    quad M, m, l, k, g;
};

/* A point's coordinate with its first and second derivatives by (ts, tn, r). */
struct coordinate {
    quad d[3], dd[3][3];
};

struct point_q {
    struct coordinate x, y;
};

static void add_leg(struct point_q *p, int angle, quad s, quad c, quad length, int is_stance)
{
    /* x += length sin, y += length cos; the stance leg's length grows with r */
    p->x.d[angle] += length * c;
    p->y.d[angle] -= length * s;
    p->x.dd[angle][angle] -= length * s;
    p->y.dd[angle][angle] -= length * c;
    if (is_stance) {
        p->x.d[2] += s;
        p->y.d[2] += c;
        p->x.dd[angle][2] += c;
        p->x.dd[2][angle] += c;
        p->y.dd[angle][2] -= s;
        p->y.dd[2][angle] -= s;
    }
}

enum { HIP, STANCE_LEG, SWING_LEG, SWING_TOE, POINTS };

static void points_of(const struct walker_q *w, const quad q[3], struct point_q point[POINTS])
{
    quad ss, cs, sn, cn;
    quad_sincos(q[0], &ss, &cs);
    quad_sincos(q[1], &sn, &cn);
    for (int p = 0; p < POINTS; p++) {
        point[p] = (struct point_q){0};
        add_leg(&point[p], 0, ss, cs, p == STANCE_LEG ? q[2] + w->l / 2 : q[2] + w->l, 1);
    }
    add_leg(&point[SWING_LEG], 1, sn, cn, -w->l / 2, 0);
    add_leg(&point[SWING_TOE], 1, sn, cn, -w->l, 0);
}

/* Gauss with pivoting, in place; b becomes the solution. */
static void solve(int n, quad a[5][5], quad b[5])
{
    for (int i = 0; i < n; i++) {
        int best = i;
        for (int r = i + 1; r < n; r++) {
            best = quad_abs(a[r][i]) > quad_abs(a[best][i]) ? r : best;
        }
        for (int c = 0; c < n; c++) {
            const quad swap = a[i][c];
            a[i][c] = a[best][c];
            a[best][c] = swap;
        }
        const quad swap = b[i];
        b[i] = b[best];
        b[best] = swap;
        for (int r = i + 1; r < n; r++) {
            const quad factor = a[r][i] / a[i][i];
            for (int c = i; c < n; c++) {
                a[r][c] -= factor * a[i][c];
            }
            b[r] -= factor * b[i];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int c = i + 1; c < n; c++) {
            b[i] -= a[i][c] * b[c];
        }
        b[i] /= a[i][i];
    }
}

static quad mass_of(const struct walker_q *w, int point)
{
    return point == HIP ? w->M : (point == SWING_TOE ? 0 : w->m);
}

/* Mass matrix, and generalised force of gravity and motion (without the spring's), at q with rates v. */
static void dynamics(const struct walker_q *w, const quad q[3], const quad v[3], quad mass[5][5],
                     quad force[5], struct point_q point[POINTS])
{
    points_of(w, q, point);
    for (int i = 0; i < 3; i++) {
        force[i] = 0;
        for (int j = 0; j < 3; j++) {
            mass[i][j] = 0;
        }
    }
    for (int p = 0; p < POINTS; p++) {
        const quad m = mass_of(w, p);
        const struct coordinate *axis[2] = {&point[p].x, &point[p].y};
        for (int a = 0; a < 2; a++) {
            quad curving = a == 1 ? w->g : 0; /* acceleration that is there without any of q'' */
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) {
                    curving += axis[a]->dd[i][j] * v[i] * v[j];
                }
            }
            for (int i = 0; i < 3; i++) {
                force[i] -= m * axis[a]->d[i] * curving;
                for (int j = 0; j < 3; j++) {
                    mass[i][j] += m * axis[a]->d[i] * axis[a]->d[j];
                }
            }
        }
    }
}

/* Accelerations of the first n coordinates, the others held. */
static void single_support(const void *context, const quad *y, quad *dy)
{
    const quad q[3] = {y[0], y[1], 0}, v[3] = {y[2], y[3], 0};
    quad mass[5][5], force[5];
    struct point_q point[POINTS];
    dynamics(context, q, v, mass, force, point);
    /* A massless swing leg still swings: its row divided by its mass would be 0/0. */
    const struct walker_q *w = context;
    if (!(w->m > 0)) {
        quad ss, cs, sn, cn;
        quad_sincos(y[0], &ss, &cs);
        quad_sincos(y[1], &sn, &cn);
        mass[1][0] = -(cs * cn + ss * sn) / 2;
        mass[1][1] = (quad)1 / 4;
        force[1] = -((ss * cn - cs * sn) * y[2] * y[2] + w->g / w->l * sn) / 2;
    }
    solve(2, mass, force);
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = force[0];
    dy[3] = force[1];
}

/* Impact: the swing toe stops; (ts', tn', r') before in v, after in v. */
static void impact(const struct walker_q *w, const quad q[3], quad v[3])
{
    quad mass[5][5], force[5], system[5][5] = {{0}}, right[5] = {0};
    const quad rest[3] = {0, 0, 0};
    struct point_q point[POINTS];
    dynamics(w, q, rest, mass, force, point);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            system[i][j] = mass[i][j];
            right[i] += mass[i][j] * v[j];
        }
        system[i][3] = system[3][i] = point[SWING_TOE].x.d[i];
        system[i][4] = system[4][i] = point[SWING_TOE].y.d[i];
    }
    solve(5, system, right);
    for (int i = 0; i < 3; i++) {
        v[i] = right[i];
    }
}

struct chain_q {
    struct walker_q w;
    quad d, rest;
};

/* Configuration of the closed chain at r, and dq/dr. */
static void chain_of(const struct chain_q *c, quad r, quad q[3], quad slope[3],
                     struct point_q point[POINTS])
{
    const quad l1 = c->w.l + r, x = (c->d * c->d - c->w.l * c->w.l + l1 * l1) / (2 * c->d);
    const quad height = quad_sqrt(l1 * l1 - x * x);
    q[0] = -quad_angle(x / l1, height / l1);
    q[1] = quad_angle((c->d - x) / c->w.l, height / c->w.l);
    q[2] = r;
    points_of(&c->w, q, point);
    /* The swing toe stays: J_angles (ts', tn') = -J_r. */
    quad a[5][5] = {{point[SWING_TOE].x.d[0], point[SWING_TOE].x.d[1]},
                    {point[SWING_TOE].y.d[0], point[SWING_TOE].y.d[1]}};
    quad b[5] = {-point[SWING_TOE].x.d[2], -point[SWING_TOE].y.d[2]};
    solve(2, a, b);
    slope[0] = b[0];
    slope[1] = b[1];
    slope[2] = 1;
}

/* Lagrange's equations with both toes held by multipliers, the spring acting on r. y: r, r'. */
static void double_support(const void *context, const quad *y, quad *dy)
{
    const struct chain_q *c = context;
    quad q[3], slope[3], v[3], mass[5][5], force[5], system[5][5] = {{0}}, right[5];
    struct point_q point[POINTS];
    chain_of(c, y[0], q, slope, point);
    for (int i = 0; i < 3; i++) {
        v[i] = slope[i] * y[1];
    }
    dynamics(&c->w, q, v, mass, force, point);
    force[2] += c->w.k * (c->rest - y[0]);
    right[3] = right[4] = 0;
    for (int i = 0; i < 3; i++) {
        right[i] = force[i];
        for (int j = 0; j < 3; j++) {
            system[i][j] = mass[i][j];
            right[3] -= point[SWING_TOE].x.dd[i][j] * v[i] * v[j];
            right[4] -= point[SWING_TOE].y.dd[i][j] * v[i] * v[j];
        }
        system[i][3] = system[3][i] = point[SWING_TOE].x.d[i];
        system[i][4] = system[4][i] = point[SWING_TOE].y.d[i];
    }
    solve(5, system, right);
    dy[0] = y[1];
    dy[1] = right[2];
}

/* ---- The stride ---------------------------------------------------------------------------------- */

#define MAX_STEPS 4000

/* Steps until the event falls through zero; 0 when it does not. */
static int fly(const struct walker_q *w, const struct event *event, quad h, quad *y, quad *time)
{
    const struct system system = {single_support, w, 4};
    *time = 0;
    for (int i = 0; i < MAX_STEPS && y[2] < 0; i++) {
        quad next[STATES];
        advance(&system, y, h, next);
        if (event_value(event, y, 4, 1) > 0 && event_value(event, next, 4, 1) <= 0) {
            *time += land(&system, event, h, y);
            return y[2] < 0;
        }
        *time += h;
        for (int k = 0; k < 4; k++) {
            y[k] = next[k];
        }
    }
    return 0;
}

static int push(const struct chain_q *c, quad h, quad *y, quad *time)
{
    const struct system system = {double_support, c, 2};
    const struct event off = {{1, 0, 0, 0}, c->rest};
    *time = 0;
    for (int i = 0; i < MAX_STEPS && y[1] >= 0; i++) {
        quad next[STATES];
        advance(&system, y, h, next);
        if (!(next[0] < c->rest)) {
            *time += land(&system, &off, h, y);
            return y[1] > 0;
        }
        *time += h;
        y[0] = next[0];
        y[1] = next[1];
    }
    return 0;
}

static int stride_with_step(const struct walker_q *w, const double apex[3], quad rest, quad h,
                            quad out[6])
{
    const struct event strike = {{1, 1, 0, 0}, 0}, upright = {{1, 0, 0, 0}, 0};
    quad y[STATES] = {0, (quad)apex[1], (quad)apex[0], (quad)apex[2]};
    if (!fly(w, &strike, h, y, &out[3])) {
        return 0;
    }
    quad q[3] = {y[0], y[1], 0}, v[3] = {y[2], y[3], 0}, slope[3], s, unused;
    impact(w, q, v);
    quad_sincos(y[1], &s, &unused);
    const struct chain_q chain = {*w, 2 * w->l * s, rest};
    quad r[STATES] = {0, v[2] < 0 ? 0 : v[2]};
    if (!(chain.d > rest) || !push(&chain, h / 8, r, &out[4])) {
        return 0;
    }
    struct point_q point[POINTS];
    chain_of(&chain, r[0], q, slope, point);
    const quad off[STATES] = {q[1], q[0], slope[1] * r[1], slope[0] * r[1]};
    for (int i = 0; i < STATES; i++) {
        y[i] = off[i];
    }
    if (!(y[0] > 0) || !fly(w, &upright, h, y, &out[5])) {
        return 0;
    }
    out[0] = y[2];
    out[1] = y[1];
    out[2] = y[3];
    return 1;
}

struct quad_stride quad_stride(const struct quad_walker *walker, const double apex[3],
                               double push_m)
{
    const struct walker_q w = {(quad)walker->hip_mass_kg, (quad)walker->leg_mass_kg,
                               (quad)walker->leg_length_m, (quad)walker->ankle_stiffness_N_m,
                               (quad)walker->gravity_m_s2};
    const quad h = quad_sqrt(w.l / w.g) / 2;
    quad coarse[6] = {0}, fine[6] = {0};
    struct quad_stride result = {.whole = 0};
    if (!stride_with_step(&w, apex, (quad)push_m, h, coarse) ||
        !stride_with_step(&w, apex, (quad)push_m, h / 2, fine)) {
        return result;
    }
    result.whole = 1;
    for (int i = 0; i < 3; i++) {
        result.next[i] = (double)fine[i];
        result.times_s[i] = (double)fine[3 + i];
    }
    for (int i = 0; i < 6; i++) {
        const double change = (double)quad_abs(fine[i] - coarse[i]);
        result.change = change > result.change ? change : result.change;
    }
    return result;
}
