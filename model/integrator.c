#include "model/integrator.h"

/* With n a constant wherever it is inlined, the loops are unrolled: this runs in every tick. */
static inline __attribute__((always_inline)) void rk4_body(const struct ode *ode, real h,
                                                           const real *state, real *next,
                                                           const int n)
{
    real a[ODE_MAX_STATES], b[ODE_MAX_STATES], c[ODE_MAX_STATES], d[ODE_MAX_STATES],
        point[ODE_MAX_STATES];
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

static inline __attribute__((always_inline)) void midpoint_body(const struct ode *ode, real h,
                                                                const real *state, real *next,
                                                                const int n)
{
    real slope[ODE_MAX_STATES], point[ODE_MAX_STATES];
    const real half = REAL(0.5) * h;

    ode->rates(ode->context, state, slope);
    for (int i = 0; i < n; i++) {
        point[i] = state[i] + half * slope[i];
    }
    ode->rates(ode->context, point, slope);
    for (int i = 0; i < n; i++) {
        next[i] = state[i] + h * slope[i];
    }
}

void ode_midpoint(const struct ode *ode, real h, const real *state, real *next)
{
    switch (ode->count) {
    case 2:
        midpoint_body(ode, h, state, next, 2);
        break;
    case 4:
        midpoint_body(ode, h, state, next, 4);
        break;
    default:
        midpoint_body(ode, h, state, next, ode->count);
        break;
    }
}

void ode_rk4(const struct ode *ode, real h, const real *state, real *next)
{
    switch (ode->count) {
    case 2:
        rk4_body(ode, h, state, next, 2);
        break;
    case 4:
        rk4_body(ode, h, state, next, 4);
        break;
    default:
        rk4_body(ode, h, state, next, ode->count);
        break;
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

struct ode_landing ode_land(const struct ode *ode, ode_method *method,
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
            ode_rk4(ode, correction, here, here);
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
