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

void ode_rk8(const struct ode *ode, real h, const real *state, real *next)
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
