#include "model/integrator.h"

/* S: sqrt(21), in which the method's coefficients are exact. */
#define S REAL(4.58257569495584000659)
#define RK8_STAGES 11

struct rk8_row {
    int count; /* stages that enter */
    struct {
        int stage;
        real weight;
    } term[6];
};

/* Cooper, Verner (1972), SIAM J. Numer. Anal. 9, 389: eleven stages, order eight. */
static const struct rk8_row rk8_rows[RK8_STAGES] = {
    {0, {{0, REAL(0.0)}}},
    {1, {{0, REAL(1.0) / REAL(2.0)}}},
    {2, {{0, REAL(1.0) / REAL(4.0)}, {1, REAL(1.0) / REAL(4.0)}}},
    {3,
     {{0, REAL(1.0) / REAL(7.0)},
      {1, (REAL(-7.0) - REAL(3.0) * S) / REAL(98.0)},
      {2, (REAL(21.0) + REAL(5.0) * S) / REAL(49.0)}}},
    {3,
     {{0, (REAL(11.0) + S) / REAL(84.0)},
      {2, (REAL(18.0) + REAL(4.0) * S) / REAL(63.0)},
      {3, (REAL(21.0) - S) / REAL(252.0)}}},
    {4,
     {{0, (REAL(5.0) + S) / REAL(48.0)},
      {2, (REAL(9.0) + S) / REAL(36.0)},
      {3, (REAL(-231.0) + REAL(14.0) * S) / REAL(360.0)},
      {4, (REAL(63.0) - REAL(7.0) * S) / REAL(80.0)}}},
    {5,
     {{0, (REAL(10.0) - S) / REAL(42.0)},
      {2, (REAL(-432.0) + REAL(92.0) * S) / REAL(315.0)},
      {3, (REAL(633.0) - REAL(145.0) * S) / REAL(90.0)},
      {4, (REAL(-504.0) + REAL(115.0) * S) / REAL(70.0)},
      {5, (REAL(63.0) - REAL(13.0) * S) / REAL(35.0)}}},
    {4,
     {{0, REAL(1.0) / REAL(14.0)},
      {4, (REAL(14.0) - REAL(3.0) * S) / REAL(126.0)},
      {5, (REAL(13.0) - REAL(3.0) * S) / REAL(63.0)},
      {6, REAL(1.0) / REAL(9.0)}}},
    {5,
     {{0, REAL(1.0) / REAL(32.0)},
      {4, (REAL(91.0) - REAL(21.0) * S) / REAL(576.0)},
      {5, REAL(11.0) / REAL(72.0)},
      {6, (REAL(-385.0) - REAL(75.0) * S) / REAL(1152.0)},
      {7, (REAL(63.0) + REAL(13.0) * S) / REAL(128.0)}}},
    {6,
     {{0, REAL(1.0) / REAL(14.0)},
      {4, REAL(1.0) / REAL(9.0)},
      {5, (REAL(-733.0) - REAL(147.0) * S) / REAL(2205.0)},
      {6, (REAL(515.0) + REAL(111.0) * S) / REAL(504.0)},
      {7, (REAL(-51.0) - REAL(11.0) * S) / REAL(56.0)},
      {8, (REAL(132.0) + REAL(28.0) * S) / REAL(245.0)}}},
    {6,
     {{4, (REAL(-42.0) + REAL(7.0) * S) / REAL(18.0)},
      {5, (REAL(-18.0) + REAL(28.0) * S) / REAL(45.0)},
      {6, (REAL(-273.0) - REAL(53.0) * S) / REAL(72.0)},
      {7, (REAL(301.0) + REAL(53.0) * S) / REAL(72.0)},
      {8, (REAL(28.0) - REAL(28.0) * S) / REAL(45.0)},
      {9, (REAL(49.0) - REAL(7.0) * S) / REAL(18.0)}}},
};

static void rk8_step(const struct ode *ode, real h, const real *state, real *next)
{
    real slope[RK8_STAGES][ODE_MAX_STATES];
    real point[ODE_MAX_STATES];
    const int n = ode->count;

    ode->rates(ode->context, state, slope[0]);
    for (int s = 1; s < RK8_STAGES; s++) {
        const struct rk8_row *row = &rk8_rows[s];
        for (int i = 0; i < n; i++) {
            real sum = REAL(0.0);
            for (int t = 0; t < row->count; t++) {
                sum += row->term[t].weight * slope[row->term[t].stage][i];
            }
            point[i] = state[i] + h * sum;
        }
        ode->rates(ode->context, point, slope[s]);
    }
    for (int i = 0; i < n; i++) {
        const real outer = REAL(9.0) * (slope[0][i] + slope[10][i]);
        const real inner = REAL(49.0) * (slope[7][i] + slope[9][i]);
        next[i] = state[i] + h / REAL(180.0) * (outer + inner + REAL(64.0) * slope[8][i]);
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
        const real correction = -value / slope;
        const int done = real_abs(correction) <= small + event_noise_s(event, here, slope);
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
