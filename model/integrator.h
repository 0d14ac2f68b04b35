/* Fixed-step explicit Runge-Kutta integration, and landing exactly on an event.
 *
 * Time-invariant systems only (y' = f(y)): all the walker's phases are. No allocation, no state
 * between calls: many walkers may be integrated at once.
 */
#ifndef MODEL_INTEGRATOR_H
#define MODEL_INTEGRATOR_H

#include "model/real.h"

/* A phase's state; in double also its sensitivities to six quantities, with room. */
#ifdef REAL_IS_DOUBLE
#define ODE_MAX_STATES 40
#else
#define ODE_MAX_STATES 4
#endif

/* rates = f(state); must not keep or change anything, and takes arguments where state is any finite value. */
typedef void ode_rates_fn(const void *context, const real *state, real *rates);

struct ode {
    ode_rates_fn *rates;
    const void *context;
    int count; /* of states, 1..ODE_MAX_STATES */
};

/* One step of a method, h_s seconds long (any sign), from `state` to `next` (count values each; may be
 * the same array). Cannot fail; non-finite values pass through. */
typedef void ode_method(const struct ode *ode, real h_s, const real *state, real *next);

/* Midpoint: two evaluations, order 2; for steps so short that h^3 / 24 of the third derivative does not
 * matter, as 1 ms of walking.
 * RK4: four evaluations a step, for small steps and for float.
 * RK8: Cooper and Verner's eleven evaluations (1972), exact coefficients in sqrt(21); the cheapest
 * of those measured for 1e-9 and better (tests/model has the measurement). A program that does not
 * name it does not contain its code. */
#define ode_midpoint REAL_SYMBOL(ode_midpoint)
#define ode_rk4 REAL_SYMBOL(ode_rk4)
#define ode_rk8 REAL_SYMBOL(ode_rk8)
ode_method ode_midpoint, ode_rk4, ode_rk8;
#define ODE_MIDPOINT ode_midpoint
#define ODE_RK4 ode_rk4
#define ODE_RK8 ode_rk8

/* An event: value = offset + sum weight[i] * state[i]; it happens where value crosses zero.
 * Linear functions serve all the walker's events. */
struct ode_event {
    real weight[4]; /* of the first four states; unused ones 0 */
    real offset;
};

struct ode_landing {
    real step_s;    /* from the start state to the event */
    int iterations; /* re-steps taken, at most ODE_MAX_LANDING_STEPS */
};
#define ODE_MAX_LANDING_STEPS 60

#define ode_event_value REAL_SYMBOL(ode_event_value)
#define ode_land REAL_SYMBOL(ode_land)

/* One step by a method: reads better where the method is a value. */
static inline void ode_step(const struct ode *ode, ode_method *method, real h_s, const real *state,
                            real *next)
{
    method(ode, h_s, state, next);
}

/* Value of the event function for a state, or its rate of change for the state's rates with offset 0. */
real ode_event_value(const struct ode_event *event, const real *state);

/* Finds the step in [0, h_s] at which the event happens, and the state there.
 * Precondition: event values at `state` and at `end` (the state after a step of h_s) differ in sign
 * or one of them is zero. Safeguarded Newton on re-steps from `state`; when it is near, one short step from
 * there, and the last correction, below the square root of the precision, to first order. In double the time is good to 1e-12 s.
 * `landed` receives count values. Bounded: ODE_MAX_LANDING_STEPS re-steps (3 is usual). */
struct ode_landing ode_land(const struct ode *ode, ode_method *method,
                            const struct ode_event *event, const real *state, real h_s,
                            const real *end, real *landed);

#endif
