#include "controller/apex_fit.h"

#include "controller/signals.h"

enum { ROOT_STEPS = 3 };

struct cubic {
    real c0, c1, c2, c3; /* angle = c0 + c1 u + c2 u^2 + c3 u^3, u = ticks / window, -1..1 */
};

static struct cubic fit_cubic(const real *angle_rad, uint32_t size, uint32_t centre, uint32_t window)
{
    const real per_window = REAL(1.0) / (real)window;
    const real middle = angle_rad[centre % size];
    real even0 = middle, even2 = REAL(0.0), odd1 = REAL(0.0), odd3 = REAL(0.0);
    real s2 = REAL(0.0), s4 = REAL(0.0), s6 = REAL(0.0);

    for (uint32_t n = 1; n <= window; n++) {
        const real u = (real)n * per_window;
        const real u2 = u * u;
        const real after = angle_rad[(centre + n) % size];
        const real before = angle_rad[(centre - n) % size];
        const real difference = after - before;
        const real sum = after + before;
        even0 += sum;
        even2 += sum * u2;
        odd1 += difference * u;
        odd3 += difference * u * u2;
        s2 += u2;
        s4 += u2 * u2;
        s6 += u2 * u2 * u2;
    }
    s2 *= REAL(2.0);
    s4 *= REAL(2.0);
    s6 *= REAL(2.0);
    const real s0 = REAL(2.0) * (real)window + REAL(1.0);
    const real even_det = s0 * s4 - s2 * s2;
    const real odd_det = s2 * s6 - s4 * s4;
    return (struct cubic){(s4 * even0 - s2 * even2) / even_det, (s6 * odd1 - s4 * odd3) / odd_det,
                          (s0 * even2 - s2 * even0) / even_det,
                          (s2 * odd3 - s4 * odd1) / odd_det};
}

struct apex_fit apex_fit_solve(const real *angle_rad, uint32_t size, uint32_t centre_tick,
                               uint32_t window)
{
    const struct cubic c = fit_cubic(angle_rad, size, centre_tick, window);
    real u = REAL(0.0);
    for (int i = 0; i < ROOT_STEPS; i++) {
        const real slope = c.c1 + u * (REAL(2.0) * c.c2 + u * REAL(3.0) * c.c3);
        if (!(slope < REAL(0.0))) {
            return (struct apex_fit){REAL(0.0), REAL(0.0)};
        }
        u -= (c.c0 + u * (c.c1 + u * (c.c2 + u * c.c3))) / slope;
        u = real_clamp(u, REAL(-1.0), REAL(1.0));
    }
    const real slope = c.c1 + u * (REAL(2.0) * c.c2 + u * REAL(3.0) * c.c3);
    const real window_s = (real)window * CONTROL_PERIOD_S;
    const real before_s = -u * window_s;
    return (struct apex_fit){before_s, -slope / window_s};
}

struct angle_fit apex_fit_other_leg(const real *angle_rad, uint32_t size, uint32_t centre_tick,
                                    uint32_t window, real before_tick_s)
{
    const struct cubic c = fit_cubic(angle_rad, size, centre_tick, window);
    const real window_s = (real)window * CONTROL_PERIOD_S;
    const real u = -before_tick_s / window_s;
    return (struct angle_fit){
        c.c0 + u * (c.c1 + u * (c.c2 + u * c.c3)),
        (c.c1 + u * (REAL(2.0) * c.c2 + u * REAL(3.0) * c.c3)) / window_s};
}
