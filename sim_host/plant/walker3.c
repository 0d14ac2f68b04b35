#include "sim_host/plant/walker3.h"

#include "model/trig.h"

#include <stddef.h>

/* Everything that depends on the configuration only. e points up a leg, t is the
 * direction in which its upper end moves when the angle grows. */
struct geometry {
    double sin_s, cos_s, sin_n, cos_n;
    double sin_d, cos_d; /* of theta_s - theta_n */
    double hip_m;        /* L = l + r */
    double centre_m;     /* s = r + l/2 */
    double half_m;       /* l/2 */
};

static struct geometry geometry_of(const struct walker3_params *params,
                                   const struct walker3_state *state)
{
    struct geometry at;
    trig_sincos_f64(state->q[WALKER3_STANCE], &at.sin_s, &at.cos_s);
    trig_sincos_f64(state->q[WALKER3_SWING], &at.sin_n, &at.cos_n);
    at.sin_d = at.sin_s * at.cos_n - at.cos_s * at.sin_n;
    at.cos_d = at.cos_s * at.cos_n + at.sin_s * at.sin_n;
    at.half_m = 0.5 * params->leg_length_m;
    at.hip_m = params->leg_length_m + state->q[WALKER3_ANKLE];
    at.centre_m = at.half_m + state->q[WALKER3_ANKLE];
    return at;
}

/* Mass matrix from the kinetic energy of the three points; symmetric, [0][2] is 0. */
struct mass_matrix {
    double m00, m01, m11, m12, m22;
};

static struct mass_matrix mass_of(const struct walker3_params *params, const struct geometry *at)
{
    const double m = params->leg_mass_kg;
    const double above = params->hip_mass_kg + m; /* what hangs at the hip */
    struct mass_matrix mass;
    mass.m00 = above * at->hip_m * at->hip_m + m * at->centre_m * at->centre_m;
    mass.m01 = -m * at->half_m * at->hip_m * at->cos_d;
    mass.m11 = m * at->half_m * at->half_m;
    mass.m12 = -m * at->half_m * at->sin_d;
    mass.m22 = above + m;
    return mass;
}

static void mass_times(const struct mass_matrix *mass, const double x[3], double out[3])
{
    out[0] = mass->m00 * x[0] + mass->m01 * x[1];
    out[1] = mass->m01 * x[0] + mass->m11 * x[1] + mass->m12 * x[2];
    out[2] = mass->m12 * x[1] + mass->m22 * x[2];
}

/* Solves mass * out = rhs; the matrix is symmetric and positive definite. The
 * swing leg is eliminated last, for it alone couples to both others. */
static void mass_solve(const struct mass_matrix *mass, const double rhs[3], double out[3])
{
    const double to_stance = mass->m01 / mass->m00;
    const double to_ankle = mass->m12 / mass->m22;
    const double pivot = mass->m11 - to_stance * mass->m01 - to_ankle * mass->m12;
    out[1] = (rhs[1] - to_stance * rhs[0] - to_ankle * rhs[2]) / pivot;
    out[0] = (rhs[0] - mass->m01 * out[1]) / mass->m00;
    out[2] = (rhs[2] - mass->m12 * out[1]) / mass->m22;
}

/* Generalised gravity, centrifugal and Coriolis forces, and the ankle's. */
static void applied_forces(const struct walker3_params *params, const struct geometry *at,
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

/* Rows of the swing toe's Jacobian, x and y. */
static void toe_jacobian(const struct walker3_params *params, const struct geometry *at,
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

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The one direction in which both toes stay where they are. */
static void free_direction(const double row_x[3], const double row_y[3], double n[3])
{
    n[0] = row_x[1] * row_y[2] - row_x[2] * row_y[1];
    n[1] = row_x[2] * row_y[0] - row_x[0] * row_y[2];
    n[2] = row_x[0] * row_y[1] - row_x[1] * row_y[0];
}

/* Minimum-norm solution of row_x . p = bx, row_y . p = by. */
static void particular(const double row_x[3], const double row_y[3], double bx, double by,
                       double p[3])
{
    const double xx = dot3(row_x, row_x), xy = dot3(row_x, row_y), yy = dot3(row_y, row_y);
    const double determinant = xx * yy - xy * xy;
    const double cx = (yy * bx - xy * by) / determinant;
    const double cy = (xx * by - xy * bx) / determinant;
    for (int i = 0; i < WALKER3_DOF; i++) {
        p[i] = cx * row_x[i] + cy * row_y[i];
    }
}

/* Multipliers of the toe rows from J^T lambda = rest, rest in the rows' span. */
static void toe_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                            double lambda[2])
{
    const double xx = dot3(row_x, row_x), xy = dot3(row_x, row_y), yy = dot3(row_y, row_y);
    const double bx = dot3(row_x, rest), by = dot3(row_y, rest);
    const double determinant = xx * yy - xy * xy;
    lambda[0] = (yy * bx - xy * by) / determinant;
    lambda[1] = (xx * by - xy * bx) / determinant;
}

/* The same when the ankle is locked too: J^T lambda + (0, 0, lock) = rest. */
static void locked_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                               double lambda[2], double *lock)
{
    const double determinant = row_x[0] * row_y[1] - row_x[1] * row_y[0];
    lambda[0] = (rest[0] * row_y[1] - rest[1] * row_y[0]) / determinant;
    lambda[1] = (row_x[0] * rest[1] - row_x[1] * rest[0]) / determinant;
    *lock = rest[2] - row_x[2] * lambda[0] - row_y[2] * lambda[1];
}

/* Sum of mass times velocity, or of mass times the part of the acceleration that
 * is linear in ddq: both are the same map of their three-vector. */
static void momentum(const struct walker3_params *params, const struct geometry *at,
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

/* Ground force on the stance toe: what all masses' acceleration needs beyond gravity
 * and the other toe's force. */
static void stance_force(const struct walker3_params *params, const struct geometry *at,
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
    momentum(params, at, ddq, linear);
    out[0] = linear[0] + inward * at->sin_s + coriolis * at->cos_s + swing * at->sin_n -
             swing_toe_N[0];
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
    const struct geometry at = geometry_of(params, state);
    hip_m[0] = at.hip_m * at.sin_s;
    hip_m[1] = at.hip_m * at.cos_s;
}

void walker3_toe(const struct walker3_params *params, const struct walker3_state *state,
                 double swing_extension_m, double toe_m[2])
{
    const struct geometry at = geometry_of(params, state);
    const double leg = params->leg_length_m + swing_extension_m;
    toe_m[0] = at.hip_m * at.sin_s - leg * at.sin_n;
    toe_m[1] = at.hip_m * at.cos_s - leg * at.cos_n;
}

void walker3_toe_velocity(const struct walker3_params *params, const struct walker3_state *state,
                          double swing_extension_m, double toe_m_s[2])
{
    const struct geometry at = geometry_of(params, state);
    double row_x[3], row_y[3];
    toe_jacobian(params, &at, swing_extension_m, row_x, row_y);
    toe_m_s[0] = dot3(row_x, state->dq);
    toe_m_s[1] = dot3(row_y, state->dq);
}

double walker3_kinetic_J(const struct walker3_params *params, const struct walker3_state *state)
{
    const struct geometry at = geometry_of(params, state);
    const struct mass_matrix mass = mass_of(params, &at);
    double p[3];
    mass_times(&mass, state->dq, p);
    return 0.5 * dot3(p, state->dq);
}

double walker3_potential_J(const struct walker3_params *params, const struct walker3_state *state)
{
    const struct geometry at = geometry_of(params, state);
    const double m = params->leg_mass_kg;
    const double moment = (params->hip_mass_kg + m) * at.hip_m * at.cos_s +
                          m * at.centre_m * at.cos_s - m * at.half_m * at.cos_n;
    return params->gravity_m_s2 * moment;
}

/* Single support: ankle locked or free. Returns the locking force. */
static double single_support(const struct mass_matrix *mass, const double f[3], bool locked,
                             double ddq[3])
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

void walker3_accelerate(const struct walker3_params *params, const struct walker3_state *state,
                        const struct walker3_contact *contact, double ankle_force_N,
                        double ddq[WALKER3_DOF], struct walker3_forces *forces)
{
    const struct geometry at = geometry_of(params, state);
    const struct mass_matrix mass = mass_of(params, &at);
    double f[3], lock_N = 0.0, toe_N[2] = {0.0, 0.0};
    applied_forces(params, &at, state, ankle_force_N, f);
    if (!contact->swing_toe_pinned) {
        lock_N = single_support(&mass, f, contact->ankle_locked, ddq);
    } else {
        const double leg = params->leg_length_m + contact->swing_extension_m;
        const double w = state->dq[WALKER3_STANCE], u = state->dq[WALKER3_SWING];
        const double inward = at.hip_m * w * w, outward = leg * u * u;
        const double coriolis = 2.0 * state->dq[WALKER3_ANKLE] * w;
        double row_x[3], row_y[3], n[3], p[3], balance[3], rest[3];
        toe_jacobian(params, &at, contact->swing_extension_m, row_x, row_y);
        /* The toe's acceleration is J ddq + bias = 0. */
        particular(row_x, row_y, inward * at.sin_s - coriolis * at.cos_s - outward * at.sin_n,
                   inward * at.cos_s + coriolis * at.sin_s - outward * at.cos_n, p);
        if (contact->ankle_locked) {
            ddq[0] = ddq[1] = ddq[2] = 0.0;
        } else {
            double scaled[3];
            free_direction(row_x, row_y, n);
            mass_times(&mass, p, balance);
            mass_times(&mass, n, scaled);
            const double along = (dot3(n, f) - dot3(n, balance)) / dot3(n, scaled);
            for (int i = 0; i < WALKER3_DOF; i++) {
                ddq[i] = p[i] + along * n[i];
            }
        }
        if (forces != NULL) {
            mass_times(&mass, ddq, rest);
            for (int i = 0; i < WALKER3_DOF; i++) {
                rest[i] -= f[i];
            }
            if (contact->ankle_locked) {
                locked_multipliers(row_x, row_y, rest, toe_N, &lock_N);
            } else {
                toe_multipliers(row_x, row_y, rest, toe_N);
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
    const double motor_m = ankle->position_m +
                           tau_s * (ankle->speed_m_s + 0.5 * tau_s * ankle->acceleration_m_s2);
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
            force_N = walker3_ankle_force_N(ankle, tau_s + part[k] * step_s,
                                            stage.q[WALKER3_ANKLE]);
        }
        walker3_accelerate(params, &stage, contact, force_N, ddq, NULL);
        for (int i = 0; i < WALKER3_DOF; i++) {
            sum.q[i] += weight[k] * step_s * stage.dq[i];
            sum.dq[i] += weight[k] * step_s * ddq[i];
        }
    }
    *next = sum;
}

void walker3_collide(const struct walker3_params *params, struct walker3_state *state,
                     double swing_extension_m, struct walker3_impact *impact)
{
    const struct geometry at = geometry_of(params, state);
    const struct mass_matrix mass = mass_of(params, &at);
    double row_x[3], row_y[3], n[3], before[3], scaled[3], after[3];
    toe_jacobian(params, &at, swing_extension_m, row_x, row_y);
    free_direction(row_x, row_y, n);
    mass_times(&mass, state->dq, before);
    mass_times(&mass, n, scaled);
    /* The impulses act on the pinned directions only, so momentum along n stays. */
    const double along = dot3(n, before) / dot3(n, scaled);
    const bool clamped = along * n[WALKER3_ANKLE] < 0.0 && state->q[WALKER3_ANKLE] <= 0.0;
    for (int i = 0; i < WALKER3_DOF; i++) {
        after[i] = clamped ? 0.0 : along * n[i];
    }
    if (impact != NULL) {
        double change[3], difference[3], total[2], lock;
        for (int i = 0; i < WALKER3_DOF; i++) {
            difference[i] = after[i] - state->dq[i];
        }
        mass_times(&mass, difference, change);
        momentum(params, &at, difference, total);
        if (clamped) {
            locked_multipliers(row_x, row_y, change, impact->swing_toe_Ns, &lock);
        } else {
            toe_multipliers(row_x, row_y, change, impact->swing_toe_Ns);
        }
        impact->stance_toe_Ns[0] = total[0] - impact->swing_toe_Ns[0];
        impact->stance_toe_Ns[1] = total[1] - impact->swing_toe_Ns[1];
        mass_times(&mass, after, scaled);
        impact->lost_J = 0.5 * (dot3(before, state->dq) - dot3(scaled, after));
        impact->clamped = clamped;
    }
    for (int i = 0; i < WALKER3_DOF; i++) {
        state->dq[i] = after[i];
    }
}

void walker3_push(const struct walker3_params *params, struct walker3_state *state,
                  const struct walker3_contact *contact, const double impulse_Ns[2])
{
    const struct geometry at = geometry_of(params, state);
    const struct mass_matrix mass = mass_of(params, &at);
    const double px = impulse_Ns[0], py = impulse_Ns[1];
    const double f[3] = {at.hip_m * (at.cos_s * px - at.sin_s * py), 0.0,
                         at.sin_s * px + at.cos_s * py};
    double change[3];
    if (!contact->swing_toe_pinned) {
        (void)single_support(&mass, f, contact->ankle_locked, change);
    } else if (contact->ankle_locked) {
        return;
    } else {
        double row_x[3], row_y[3], n[3], scaled[3];
        toe_jacobian(params, &at, contact->swing_extension_m, row_x, row_y);
        free_direction(row_x, row_y, n);
        mass_times(&mass, n, scaled);
        const double along = dot3(n, f) / dot3(n, scaled);
        for (int i = 0; i < WALKER3_DOF; i++) {
            change[i] = along * n[i];
        }
    }
    for (int i = 0; i < WALKER3_DOF; i++) {
        state->dq[i] += change[i];
    }
}

void walker3_lock_ankle(const struct walker3_params *params, struct walker3_state *state,
                        const struct walker3_contact *contact)
{
    if (contact->swing_toe_pinned) {
        state->dq[0] = state->dq[1] = state->dq[2] = 0.0;
        return;
    }
    /* An impulse along r only: the momenta of the two angles stay. */
    const struct geometry at = geometry_of(params, state);
    const struct mass_matrix mass = mass_of(params, &at);
    double before[3];
    mass_times(&mass, state->dq, before);
    (void)single_support(&mass, before, true, state->dq);
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
