/* Impulses: impact of a foot, a push, a heel that comes down. */
#include <stddef.h>

#include "sim_host/plant/walker3_internal.h"

void walker3_collide(const struct walker3_params *params, struct walker3_state *state,
                     double swing_extension_m, struct walker3_impact *impact)
{
    const struct walker3_at at = walker3_geometry(params, state);
    const struct walker3_mass_matrix mass = walker3_mass(params, &at);
    double row_x[3], row_y[3], n[3], before[3], scaled[3], after[3];
    walker3_toe_rows(params, &at, swing_extension_m, row_x, row_y);
    walker3_free_direction(row_x, row_y, n);
    walker3_mass_times(&mass, state->dq, before);
    walker3_mass_times(&mass, n, scaled);
    /* The impulses act on the pinned directions only, so momentum along n stays. */
    const double along = walker3_dot(n, before) / walker3_dot(n, scaled);
    const bool clamped = along * n[WALKER3_ANKLE] < 0.0 && state->q[WALKER3_ANKLE] <= 0.0;
    for (int i = 0; i < WALKER3_DOF; i++) {
        after[i] = clamped ? 0.0 : along * n[i];
    }
    if (impact != NULL) {
        double change[3], difference[3], total[2], lock;
        for (int i = 0; i < WALKER3_DOF; i++) {
            difference[i] = after[i] - state->dq[i];
        }
        walker3_mass_times(&mass, difference, change);
        walker3_momentum(params, &at, difference, total);
        if (clamped) {
            walker3_locked_multipliers(row_x, row_y, change, impact->swing_toe_Ns, &lock);
        } else {
            walker3_toe_multipliers(row_x, row_y, change, impact->swing_toe_Ns);
        }
        impact->stance_toe_Ns[0] = total[0] - impact->swing_toe_Ns[0];
        impact->stance_toe_Ns[1] = total[1] - impact->swing_toe_Ns[1];
        walker3_mass_times(&mass, after, scaled);
        impact->lost_J = 0.5 * (walker3_dot(before, state->dq) - walker3_dot(scaled, after));
        impact->clamped = clamped;
    }
    for (int i = 0; i < WALKER3_DOF; i++) {
        state->dq[i] = after[i];
    }
}

void walker3_push(const struct walker3_params *params, struct walker3_state *state,
                  const struct walker3_contact *contact, const double impulse_Ns[2])
{
    const struct walker3_at at = walker3_geometry(params, state);
    const struct walker3_mass_matrix mass = walker3_mass(params, &at);
    const double px = impulse_Ns[0], py = impulse_Ns[1];
    const double f[3] = {at.hip_m * (at.cos_s * px - at.sin_s * py), 0.0,
                         at.sin_s * px + at.cos_s * py};
    double change[3];
    if (!contact->swing_toe_pinned) {
        (void)walker3_single_support(&mass, f, contact->ankle_locked, change);
    } else if (contact->ankle_locked) {
        return;
    } else {
        double row_x[3], row_y[3], n[3], scaled[3];
        walker3_toe_rows(params, &at, contact->swing_extension_m, row_x, row_y);
        walker3_free_direction(row_x, row_y, n);
        walker3_mass_times(&mass, n, scaled);
        const double along = walker3_dot(n, f) / walker3_dot(n, scaled);
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
    const struct walker3_at at = walker3_geometry(params, state);
    const struct walker3_mass_matrix mass = walker3_mass(params, &at);
    double before[3];
    walker3_mass_times(&mass, state->dq, before);
    (void)walker3_single_support(&mass, before, true, state->dq);
}
