#include "controller/estimator/apex_fit.h"

#include "controller/signals.h"

enum { ROOT_STEPS = 3 };

struct cubic {
    real c0, c1, c2, c3; /* angle = c0 + c1 u + c2 u^2 + c3 u^3, u = ticks / window, -1..1 */
};

void apex_fit_begin(struct apex_sums *sums, real centre_rad)
{
    *sums = (struct apex_sums){centre_rad, REAL(0.0), REAL(0.0), REAL(0.0), 0};
}

void apex_fit_add(struct apex_sums *sums, uint32_t window, real after_rad, real before_rad)
{
    sums->pairs++;
    const real u = (real)sums->pairs * (REAL(1.0) / (real)window);
    const real u2 = u * u;
    const real sum = after_rad + before_rad;
    const real lean = (after_rad - before_rad) * u;
    sums->even0 += sum;
    sums->even2 += sum * u2;
    sums->odd1 += lean;
    sums->odd3 += lean * u2;
}

/* The sums of powers of u over -w..w come from Faulhaber's formulas with p = 1/w:
 *   sum u^2 = w (1 + p)(2 + p) / 3            sum u^4 = w (1 + p)(2 + p)(3 + 3p - p^2) / 15
 *   sum u^6 = w (1 + p)(2 + p)(3 + 6p - 3p^3 + p^4) / 21 */
static struct cubic solve(const struct apex_sums *sums, uint32_t window)
{
    const real w = (real)window;
    const real p = REAL(1.0) / w;
    const real common = w * (REAL(1.0) + p) * (REAL(2.0) + p);
    const real s0 = REAL(2.0) * w + REAL(1.0);
    const real s2 = common * (REAL(1.0) / REAL(3.0));
    const real s4 = common * (REAL(3.0) + p * (REAL(3.0) - p)) * (REAL(1.0) / REAL(15.0));
    const real s6 =
        common * (REAL(3.0) + p * (REAL(6.0) + p * p * (p - REAL(3.0)))) * (REAL(1.0) / REAL(21.0));
    const real even_det = s0 * s4 - s2 * s2;
    const real odd_det = s2 * s6 - s4 * s4;
    return (struct cubic){(s4 * sums->even0 - s2 * sums->even2) / even_det,
                          (s6 * sums->odd1 - s4 * sums->odd3) / odd_det,
                          (s0 * sums->even2 - s2 * sums->even0) / even_det,
                          (s2 * sums->odd3 - s4 * sums->odd1) / odd_det};
}

struct apex_fit apex_fit_solve(const struct apex_sums *sums, uint32_t window)
{
    const struct cubic c = solve(sums, window);
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

struct angle_fit apex_fit_other_leg(const struct apex_sums *sums, uint32_t window,
                                    real before_tick_s)
{
    const struct cubic c = solve(sums, window);
    const real window_s = (real)window * CONTROL_PERIOD_S;
    const real u = -before_tick_s / window_s;
    return (struct angle_fit){c.c0 + u * (c.c1 + u * (c.c2 + u * c.c3)),
                              (c.c1 + u * (REAL(2.0) * c.c2 + u * REAL(3.0) * c.c3)) / window_s};
}
