/* Kinematics, mass matrix and constraint multipliers of the three points. */
#include "sim_host/plant/walker3_internal.h"

#include "model/trig.h"

struct walker3_at walker3_geometry(const struct walker3_params *params,
                                   const struct walker3_state *state)
{
    struct walker3_at at;
    trig_sincos_f64(state->q[WALKER3_STANCE], &at.sin_s, &at.cos_s);
    trig_sincos_f64(state->q[WALKER3_SWING], &at.sin_n, &at.cos_n);
    at.sin_d = at.sin_s * at.cos_n - at.cos_s * at.sin_n;
    at.cos_d = at.cos_s * at.cos_n + at.sin_s * at.sin_n;
    at.half_m = 0.5 * params->leg_length_m;
    at.hip_m = params->leg_length_m + state->q[WALKER3_ANKLE];
    at.centre_m = at.half_m + state->q[WALKER3_ANKLE];
    return at;
}

struct walker3_mass_matrix walker3_mass(const struct walker3_params *params,
                                        const struct walker3_at *at)
{
    const double m = params->leg_mass_kg;
    const double above = params->hip_mass_kg + m; /* what hangs at the hip */
    struct walker3_mass_matrix mass;
    mass.m00 = above * at->hip_m * at->hip_m + m * at->centre_m * at->centre_m;
    mass.m01 = -m * at->half_m * at->hip_m * at->cos_d;
    mass.m11 = m * at->half_m * at->half_m;
    mass.m12 = -m * at->half_m * at->sin_d;
    mass.m22 = above + m;
    return mass;
}

void walker3_mass_times(const struct walker3_mass_matrix *mass, const double x[3], double out[3])
{
    out[0] = mass->m00 * x[0] + mass->m01 * x[1];
    out[1] = mass->m01 * x[0] + mass->m11 * x[1] + mass->m12 * x[2];
    out[2] = mass->m12 * x[1] + mass->m22 * x[2];
}

/* Solves mass * out = rhs; the matrix is symmetric and positive definite. The
 * swing leg is eliminated last, for it alone couples to both others. */
static void mass_solve(const struct walker3_mass_matrix *mass, const double rhs[3], double out[3])
{
    const double to_stance = mass->m01 / mass->m00;
    const double to_ankle = mass->m12 / mass->m22;
    const double pivot = mass->m11 - to_stance * mass->m01 - to_ankle * mass->m12;
    out[1] = (rhs[1] - to_stance * rhs[0] - to_ankle * rhs[2]) / pivot;
    out[0] = (rhs[0] - mass->m01 * out[1]) / mass->m00;
    out[2] = (rhs[2] - mass->m12 * out[1]) / mass->m22;
}

void walker3_toe_rows(const struct walker3_params *params, const struct walker3_at *at,
                      double swing_extension_m, double row_x[3], double row_y[3])
{
    const double leg = params->leg_length_m + swing_extension_m;
    row_x[0] = at->hip_m * at->cos_s;
    row_x[1] = -leg * at->cos_n;
    row_x[2] = at->sin_s;
    row_y[0] = -at->hip_m * at->sin_s;
    row_y[1] = leg * at->sin_n;
    row_y[2] = at->cos_s;
}

double walker3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void walker3_free_direction(const double row_x[3], const double row_y[3], double n[3])
{
    n[0] = row_x[1] * row_y[2] - row_x[2] * row_y[1];
    n[1] = row_x[2] * row_y[0] - row_x[0] * row_y[2];
    n[2] = row_x[0] * row_y[1] - row_x[1] * row_y[0];
}

void walker3_toe_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                             double lambda[2])
{
    const double xx = walker3_dot(row_x, row_x), xy = walker3_dot(row_x, row_y),
                 yy = walker3_dot(row_y, row_y);
    const double bx = walker3_dot(row_x, rest), by = walker3_dot(row_y, rest);
    const double determinant = xx * yy - xy * xy;
    lambda[0] = (yy * bx - xy * by) / determinant;
    lambda[1] = (xx * by - xy * bx) / determinant;
}

void walker3_locked_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                                double lambda[2], double *lock)
{
    const double determinant = row_x[0] * row_y[1] - row_x[1] * row_y[0];
    lambda[0] = (rest[0] * row_y[1] - rest[1] * row_y[0]) / determinant;
    lambda[1] = (row_x[0] * rest[1] - row_x[1] * rest[0]) / determinant;
    *lock = rest[2] - row_x[2] * lambda[0] - row_y[2] * lambda[1];
}

void walker3_momentum(const struct walker3_params *params, const struct walker3_at *at,
                      const double x[3], double out[2])
{
    const double m = params->leg_mass_kg;
    const double above = params->hip_mass_kg + m;
    const double turn = (above * at->hip_m + m * at->centre_m) * x[0];
    const double swing = -m * at->half_m * x[1];
    const double push = (above + m) * x[2];
    out[0] = turn * at->cos_s + swing * at->cos_n + push * at->sin_s;
    out[1] = -turn * at->sin_s - swing * at->sin_n + push * at->cos_s;
}

double walker3_single_support(const struct walker3_mass_matrix *mass, const double f[3],
                              bool locked, double ddq[3])
{
    if (!locked) {
        mass_solve(mass, f, ddq);
        return 0.0;
    }
    const double determinant = mass->m00 * mass->m11 - mass->m01 * mass->m01;
    ddq[0] = (mass->m11 * f[0] - mass->m01 * f[1]) / determinant;
    ddq[1] = (mass->m00 * f[1] - mass->m01 * f[0]) / determinant;
    ddq[2] = 0.0;
    return mass->m12 * ddq[1] - f[2];
}
