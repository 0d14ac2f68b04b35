#include <stddef.h>

#include "sim_host/plant/walker3_internal.h"

/* Generalised gravity, centrifugal and Coriolis forces, and the ankle's. */
static void applied_forces(const struct walker3_params *params, const struct walker3_at *at,
                           const struct walker3_state *state, double ankle_force_N, double out[3])
{
    const double m = params->leg_mass_kg, g = params->gravity_m_s2;
    const double above = params->hip_mass_kg + m;
    const double w = state->dq[WALKER3_STANCE], u = state->dq[WALKER3_SWING];
    const double coriolis = 2.0 * state->dq[WALKER3_ANKLE] * w;
    const double arm = above * at->hip_m + m * at->centre_m;
    const double swing = m * at->half_m;
    out[0] = arm * (g * at->sin_s - coriolis) + swing * at->hip_m * u * u * at->sin_d;
    out[1] = swing * (coriolis * at->cos_d - at->hip_m * w * w * at->sin_d - g * at->sin_n);
    out[2] = arm * w * w - (above + m) * g * at->cos_s - swing * u * u * at->cos_d + ankle_force_N;
}

/* Minimum-norm solution of row_x . p = bx, row_y . p = by. */
static void particular(const double row_x[3], const double row_y[3], double bx, double by,
                       double p[3])
{
    const double xx = walker3_dot(row_x, row_x), xy = walker3_dot(row_x, row_y),
                 yy = walker3_dot(row_y, row_y);
    const double determinant = xx * yy - xy * xy;
    const double cx = (yy * bx - xy * by) / determinant;
    const double cy = (xx * by - xy * bx) / determinant;
    for (int i = 0; i < WALKER3_DOF; i++) {
        p[i] = cx * row_x[i] + cy * row_y[i];
    }
}

/* Ground force on the stance toe: what all masses' acceleration needs beyond gravity
 * and the other toe's force. */
static void stance_force(const struct walker3_params *params, const struct walker3_at *at,
                         const struct walker3_state *state, const double ddq[3],
                         const double swing_toe_N[2], double out[2])
{
    const double m = params->leg_mass_kg;
    const double above = params->hip_mass_kg + m;
    const double w = state->dq[WALKER3_STANCE], u = state->dq[WALKER3_SWING];
    const double arm = above * at->hip_m + m * at->centre_m;
    const double inward = -arm * w * w;
    const double coriolis = 2.0 * (above + m) * state->dq[WALKER3_ANKLE] * w;
    const double swing = m * at->half_m * u * u;
    double linear[2];
    walker3_momentum(params, at, ddq, linear);
    out[0] =
        linear[0] + inward * at->sin_s + coriolis * at->cos_s + swing * at->sin_n - swing_toe_N[0];
    out[1] = linear[1] + inward * at->cos_s - coriolis * at->sin_s + swing * at->cos_n +
             (above + m) * params->gravity_m_s2 - swing_toe_N[1];
}

static int in_range(double x, double low, double high)
{
    return x >= low && x <= high; /* false for NaN */
}

enum walker3_param_error walker3_params_check(const struct walker3_params *params)
{
    if (!in_range(params->hip_mass_kg, 1e-6, 1e4)) {
        return WALKER3_BAD_HIP_MASS;
    }
    if (!in_range(params->leg_mass_kg, 1e-6, 1e3)) {
        return WALKER3_BAD_LEG_MASS;
    }
    if (!in_range(params->leg_length_m, 0.05, 10.0)) {
        return WALKER3_BAD_LEG_LENGTH;
    }
    if (!in_range(params->gravity_m_s2, 0.1, 100.0)) {
        return WALKER3_BAD_GRAVITY;
    }
    return WALKER3_PARAMS_OK;
}

void walker3_hip(const struct walker3_params *params, const struct walker3_state *state,
                 double hip_m[2])
{
    const struct walker3_at at = walker3_geometry(params, state);
    hip_m[0] = at.hip_m * at.sin_s;
    hip_m[1] = at.hip_m * at.cos_s;
}

void walker3_toe(const struct walker3_params *params, const struct walker3_state *state,
                 double swing_extension_m, double toe_m[2])
{
    const struct walker3_at at = walker3_geometry(params, state);
    const double leg = params->leg_length_m + swing_extension_m;
    toe_m[0] = at.hip_m * at.sin_s - leg * at.sin_n;
    toe_m[1] = at.hip_m * at.cos_s - leg * at.cos_n;
}

void walker3_toe_velocity(const struct walker3_params *params, const struct walker3_state *state,
                          double swing_extension_m, double toe_m_s[2])
{
    const struct walker3_at at = walker3_geometry(params, state);
    double row_x[3], row_y[3];
    walker3_toe_rows(params, &at, swing_extension_m, row_x, row_y);
    toe_m_s[0] = walker3_dot(row_x, state->dq);
    toe_m_s[1] = walker3_dot(row_y, state->dq);
}

double walker3_kinetic_J(const struct walker3_params *params, const struct walker3_state *state)
{
    const struct walker3_at at = walker3_geometry(params, state);
    const struct walker3_mass_matrix mass = walker3_mass(params, &at);
    double p[3];
    walker3_mass_times(&mass, state->dq, p);
    return 0.5 * walker3_dot(p, state->dq);
}

double walker3_potential_J(const struct walker3_params *params, const struct walker3_state *state)
{
    const struct walker3_at at = walker3_geometry(params, state);
    const double m = params->leg_mass_kg;
    const double moment = (params->hip_mass_kg + m) * at.hip_m * at.cos_s +
                          m * at.centre_m * at.cos_s - m * at.half_m * at.cos_n;
    return params->gravity_m_s2 * moment;
}

void walker3_accelerate(const struct walker3_params *params, const struct walker3_state *state,
                        const struct walker3_contact *contact, double ankle_force_N,
                        double ddq[WALKER3_DOF], struct walker3_forces *forces)
{
    const struct walker3_at at = walker3_geometry(params, state);
    const struct walker3_mass_matrix mass = walker3_mass(params, &at);
    double f[3], lock_N = 0.0, toe_N[2] = {0.0, 0.0};
    applied_forces(params, &at, state, ankle_force_N, f);
    if (!contact->swing_toe_pinned) {
        lock_N = walker3_single_support(&mass, f, contact->ankle_locked, ddq);
    } else {
        const double leg = params->leg_length_m + contact->swing_extension_m;
        const double w = state->dq[WALKER3_STANCE], u = state->dq[WALKER3_SWING];
        const double inward = at.hip_m * w * w, outward = leg * u * u;
        const double coriolis = 2.0 * state->dq[WALKER3_ANKLE] * w;
        double row_x[3], row_y[3], n[3], p[3], balance[3], rest[3];
        walker3_toe_rows(params, &at, contact->swing_extension_m, row_x, row_y);
        /* The toe's acceleration is J ddq + bias = 0. */
        particular(row_x, row_y, inward * at.sin_s - coriolis * at.cos_s - outward * at.sin_n,
                   inward * at.cos_s + coriolis * at.sin_s - outward * at.cos_n, p);
        if (contact->ankle_locked) {
            ddq[0] = ddq[1] = ddq[2] = 0.0;
        } else {
            double scaled[3];
            walker3_free_direction(row_x, row_y, n);
            walker3_mass_times(&mass, p, balance);
            walker3_mass_times(&mass, n, scaled);
            const double along =
                (walker3_dot(n, f) - walker3_dot(n, balance)) / walker3_dot(n, scaled);
            for (int i = 0; i < WALKER3_DOF; i++) {
                ddq[i] = p[i] + along * n[i];
            }
        }
        if (forces != NULL) {
            walker3_mass_times(&mass, ddq, rest);
            for (int i = 0; i < WALKER3_DOF; i++) {
                rest[i] -= f[i];
            }
            if (contact->ankle_locked) {
                walker3_locked_multipliers(row_x, row_y, rest, toe_N, &lock_N);
            } else {
                walker3_toe_multipliers(row_x, row_y, rest, toe_N);
            }
        }
    }
    if (forces != NULL) {
        forces->ankle_lock_N = lock_N;
        forces->swing_toe_N[0] = toe_N[0];
        forces->swing_toe_N[1] = toe_N[1];
        stance_force(params, &at, state, ddq, toe_N, forces->stance_toe_N);
    }
}

double walker3_ankle_force_N(const struct walker3_ankle *ankle, double tau_s, double extension_m)
{
    const double motor_m =
        ankle->position_m + tau_s * (ankle->speed_m_s + 0.5 * tau_s * ankle->acceleration_m_s2);
    double device_N = ankle->device_N_per_m * (motor_m - extension_m);
    double own_N = ankle->own_N_per_m * (ankle->own_rest_m - extension_m);
    if (device_N < 0.0 && !ankle->device_smooth) {
        device_N = 0.0;
    }
    if (own_N < 0.0) {
        own_N = 0.0;
    }
    return device_N + own_N;
}

/* state + step * (rates, accelerations of another stage) */
static void displace(const struct walker3_state *state, double step_s,
                     const struct walker3_state *stage, const double ddq[3],
                     struct walker3_state *out)
{
    for (int i = 0; i < WALKER3_DOF; i++) {
        out->q[i] = state->q[i] + step_s * stage->dq[i];
        out->dq[i] = state->dq[i] + step_s * ddq[i];
    }
}

void walker3_step(const struct walker3_params *params, const struct walker3_state *state,
                  const struct walker3_contact *contact, const struct walker3_ankle *ankle,
                  double tau_s, double step_s, struct walker3_state *next)
{
    static const double part[4] = {0.0, 0.5, 0.5, 1.0};
    static const double weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    struct walker3_state stage = *state, sum = *state;
    double ddq[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 4; k++) {
        if (k > 0) {
            struct walker3_state from = stage;
            displace(state, part[k] * step_s, &from, ddq, &stage);
        }
        double force_N = 0.0;
        if (!contact->ankle_locked) {
            force_N =
                walker3_ankle_force_N(ankle, tau_s + part[k] * step_s, stage.q[WALKER3_ANKLE]);
        }
        walker3_accelerate(params, &stage, contact, force_N, ddq, NULL);
        for (int i = 0; i < WALKER3_DOF; i++) {
            sum.q[i] += weight[k] * step_s * stage.dq[i];
            sum.dq[i] += weight[k] * step_s * ddq[i];
        }
    }
    *next = sum;
}

void walker3_swap_legs(struct walker3_state *state, double swing_extension_m)
{
    const double angle_rad = state->q[WALKER3_STANCE], rate_rad_s = state->dq[WALKER3_STANCE];
    state->q[WALKER3_STANCE] = state->q[WALKER3_SWING];
    state->dq[WALKER3_STANCE] = state->dq[WALKER3_SWING];
    state->q[WALKER3_SWING] = angle_rad;
    state->dq[WALKER3_SWING] = rate_rad_s;
    state->q[WALKER3_ANKLE] = swing_extension_m;
    state->dq[WALKER3_ANKLE] = 0.0;
}
