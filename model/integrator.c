#include "model/integrator.h"

/* S: sqrt(21), in which the method's coefficients are exact. */
#define S REAL(4.58257569495584000659)
#define RK8_STAGES 11

/* weight = (a + b sqrt(21)) / c, a constant of the compiler. */
#define W(a, b, c) ((REAL(a) + REAL(b) * S) / REAL(c))

/* point = state + h sum, for each state; k1, k2, ... are the stages' slopes. */
#define STAGE(stage, sum)                \
    for (int i = 0; i < n; i++) {        \
        point[i] = state[i] + h * (sum); \
    }                                    \
    ode->rates(ode->context, point, k[stage])

/* Cooper, Verner (1972), SIAM J. Numer. Anal. 9, 389: eleven stages, order eight. Written out, and
 * with n a constant wherever it is inlined: a table of coefficients costs half as much again. */
static inline __attribute__((always_inline)) void rk8_body(const struct ode *ode, real h,
                                                           const real *state, real *next,
                                                           const int n)
{
    real k[RK8_STAGES][ODE_MAX_STATES];
    real point[ODE_MAX_STATES];

    ode->rates(ode->context, state, k[0]);
    STAGE(1, W(1.0, 0.0, 2.0) * k[0][i]);
    STAGE(2, W(1.0, 0.0, 4.0) * k[0][i] + W(1.0, 0.0, 4.0) * k[1][i]);
    STAGE(3, W(1.0, 0.0, 7.0) * k[0][i] + W(-7.0, -3.0, 98.0) * k[1][i] +
                 W(21.0, 5.0, 49.0) * k[2][i]);
    STAGE(4, W(11.0, 1.0, 84.0) * k[0][i] + W(18.0, 4.0, 63.0) * k[2][i] +
                 W(21.0, -1.0, 252.0) * k[3][i]);
    STAGE(5, W(5.0, 1.0, 48.0) * k[0][i] + W(9.0, 1.0, 36.0) * k[2][i] +
                 W(-231.0, 14.0, 360.0) * k[3][i] + W(63.0, -7.0, 80.0) * k[4][i]);
    STAGE(6, W(10.0, -1.0, 42.0) * k[0][i] + W(-432.0, 92.0, 315.0) * k[2][i] +
                 W(633.0, -145.0, 90.0) * k[3][i] + W(-504.0, 115.0, 70.0) * k[4][i] +
                 W(63.0, -13.0, 35.0) * k[5][i]);
    STAGE(7, W(1.0, 0.0, 14.0) * k[0][i] + W(14.0, -3.0, 126.0) * k[4][i] +
                 W(13.0, -3.0, 63.0) * k[5][i] + W(1.0, 0.0, 9.0) * k[6][i]);
    STAGE(8, W(1.0, 0.0, 32.0) * k[0][i] + W(91.0, -21.0, 576.0) * k[4][i] +
                 W(11.0, 0.0, 72.0) * k[5][i] + W(-385.0, -75.0, 1152.0) * k[6][i] +
                 W(63.0, 13.0, 128.0) * k[7][i]);
    STAGE(9, W(1.0, 0.0, 14.0) * k[0][i] + W(1.0, 0.0, 9.0) * k[4][i] +
                 W(-733.0, -147.0, 2205.0) * k[5][i] + W(515.0, 111.0, 504.0) * k[6][i] +
                 W(-51.0, -11.0, 56.0) * k[7][i] + W(132.0, 28.0, 245.0) * k[8][i]);
    STAGE(10, W(-42.0, 7.0, 18.0) * k[4][i] + W(-18.0, 28.0, 45.0) * k[5][i] +
                  W(-273.0, -53.0, 72.0) * k[6][i] + W(301.0, 53.0, 72.0) * k[7][i] +
                  W(28.0, -28.0, 45.0) * k[8][i] + W(49.0, -7.0, 18.0) * k[9][i]);
    for (int i = 0; i < n; i++) {
        const real outer = REAL(9.0) * (k[0][i] + k[10][i]);
        const real inner = REAL(49.0) * (k[7][i] + k[9][i]);
        next[i] = state[i] + h / REAL(180.0) * (outer + inner + REAL(64.0) * k[8][i]);
    }
}

static void rk8_step(const struct ode *ode, real h, const real *state, real *next)
{
    switch (ode->count) {
    case 2:
        rk8_body(ode, h, state, next, 2);
        break;
    case 4:
        rk8_body(ode, h, state, next, 4);
        break;
    default:
        rk8_body(ode, h, state, next, ode->count);
        break;
    }
}

static void rk4_step(const struct ode *ode, real h, const real *state, real *next)
{
    real a[ODE_MAX_STATES], b[ODE_MAX_STATES], c[ODE_MAX_STATES], d[ODE_MAX_STATES],
        point[ODE_MAX_STATES];
    const int n = ode->count;
    const real half = REAL(0.5) * h;

    ode->rates(ode->context, state, a);
    for (int i = 0; i < n; i++) {
        point[i] = state[i] + half * a[i];
    }
    ode->rates(ode->context, point, b);
    for (int i = 0; i < n; i++) {
        point[i] = state[i] + half * b[i];
    }
    ode->rates(ode->context, point, c);
    for (int i = 0; i < n; i++) {
        point[i] = state[i] + h * c[i];
    }
    ode->rates(ode->context, point, d);
    for (int i = 0; i < n; i++) {
        next[i] = state[i] + h / REAL(6.0) * (a[i] + REAL(2.0) * (b[i] + c[i]) + d[i]);
    }
}

void ode_step(const struct ode *ode, enum ode_method method, real h_s, const real *state,
              real *next)
{
    if (method == ODE_RK8) {
        rk8_step(ode, h_s, state, next);
    } else {
        rk4_step(ode, h_s, state, next);
    }
}

real ode_event_value(const struct ode_event *event, const real *state)
{
    real value = event->offset;
    for (int i = 0; i < 4; i++) {
        if (event->weight[i] != REAL(0.0)) { /* systems of fewer than four states have none there */
            value += event->weight[i] * state[i];
        }
    }
    return value;
}

/* Value and slope of the event at a state. */
static void event_and_slope(const struct ode *ode, const struct ode_event *event, const real *state,
                            real *rates, real *value, real *slope)
{
    struct ode_event speed = *event;
    speed.offset = REAL(0.0);
    ode->rates(ode->context, state, rates);
    *value = ode_event_value(event, state);
    *slope = ode_event_value(&speed, rates);
}

/* Where the cubic through values and slopes at 0 and 1 (per unit of h) vanishes; a start for Newton only. */
static real cubic_root(real v0, real v1, real s0, real s1)
{
    real low = REAL(0.0), high = REAL(1.0);
    real u = v0 / (v0 - v1);
    const real c = s0, b = REAL(3.0) * (v1 - v0) - REAL(2.0) * s0 - s1,
               a = REAL(2.0) * (v0 - v1) + s0 + s1;
    for (int i = 0; i < 6; i++) {
        const real v = v0 + u * (c + u * (b + u * a));
        const real s = c + u * (REAL(2.0) * b + REAL(3.0) * u * a);
        if ((v < REAL(0.0)) == (v0 < REAL(0.0))) {
            low = u;
        } else {
            high = u;
        }
        const real newton = u - v / s;
        u = (newton > low && newton < high) ? newton : REAL(0.5) * (low + high);
    }
    return u;
}

/* Time by which rounding of the event's value can shift its zero. */
static real event_noise_s(const struct ode_event *event, const real *state, real slope)
{
    real size = real_abs(event->offset);
    for (int i = 0; i < 4; i++) {
        if (event->weight[i] != REAL(0.0)) {
            size += real_abs(event->weight[i] * state[i]);
        }
    }
    return REAL(4.0) * REAL_EPSILON * size / real_abs(slope);
}

static void move(const struct ode *ode, const real *state, const real *rates, real dt, real *moved)
{
    for (int i = 0; i < ode->count; i++) {
        moved[i] = state[i] + dt * rates[i];
    }
}

#define NEARLY REAL(2e-3) /* of a step: its fifth power is below rounding */

struct ode_landing ode_land(const struct ode *ode, enum ode_method method,
                            const struct ode_event *event, const real *state, real h_s,
                            const real *end, real *landed)
{
    /* One correction smaller than this is exact to rounding when taken to first order. */
#ifdef REAL_IS_DOUBLE
    const real small = REAL(1e-8) * real_abs(h_s);
#else
    const real small = REAL(2e-4) * real_abs(h_s);
#endif
    real rates[ODE_MAX_STATES], here[ODE_MAX_STATES];
    real v0, v1, s0, s1;
    event_and_slope(ode, event, state, rates, &v0, &s0);
    event_and_slope(ode, event, end, rates, &v1, &s1);
    struct ode_landing result = {h_s, 0};
    if (v1 == REAL(0.0)) {
        move(ode, end, rates, REAL(0.0), landed);
        return result;
    }
    real low = REAL(0.0), high = h_s;
    real step = v0 == REAL(0.0) ? REAL(0.0) : h_s * cubic_root(v0, v1, s0 * h_s, s1 * h_s);
    for (result.iterations = 1;; result.iterations++) {
        real value, slope;
        ode_step(ode, method, step, state, here);
        event_and_slope(ode, event, here, rates, &value, &slope);
        real correction = -value / slope;
        const real limit = small + event_noise_s(event, here, slope);
        if (real_abs(correction) > limit && real_abs(correction) <= NEARLY * real_abs(h_s)) {
            /* So near that a cheap step from here is exact to rounding: saves a re-step. */
            rk4_step(ode, correction, here, here);
            step += correction;
            event_and_slope(ode, event, here, rates, &value, &slope);
            correction = -value / slope;
        }
        const int done = real_abs(correction) <= limit;
        if (done || result.iterations == ODE_MAX_LANDING_STEPS) {
            const real last = done ? correction : REAL(0.0);
            move(ode, here, rates, last, landed);
            result.step_s = step + last;
            return result;
        }
        if ((value < REAL(0.0)) == (v0 < REAL(0.0))) {
            low = step;
        } else {
            high = step;
        }
        const real newton = step + correction;
        step = (newton > low && newton < high) ? newton : REAL(0.5) * (low + high);
    }
}
