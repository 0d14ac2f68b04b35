/* This file's law_of() stands in the place of controller/laws/law_table.c's: the same rows, and one more. */
#include "sim_host/python/own_law.h"

#include <stddef.h>

#include "controller/laws/law_table.h"
#include "controller/laws/step_law.h"

static _Thread_local struct own_law *in_use;

void own_law_use(struct own_law *law)
{
    in_use = law;
}

static real ask(struct step_law *law, const struct control_params *params, const struct apex *apex,
                real desired_rad_s)
{
    struct own_law *own = in_use;
    step_law_ramp_command(law, params, desired_rad_s);
    const struct afo_law_input input = {
        .step = law->steps,
        .speed_rad_s = (double)-apex->stance_rate_rad_s,
        .swing_angle_rad = (double)apex->swing_angle_rad,
        .swing_rate_rad_s = (double)apex->swing_rate_rad_s,
        .desired_rad_s = (double)desired_rad_s,
        .command_rad_s = (double)law->command_rad_s,
        .steady_r0_m = (double)speed_table_inverse(&params->table, law->command_rad_s),
        .r0_m = (double)law->r0_m,
        .r0_min_m = (double)params->r0_min_m,
        .r0_max_m = (double)params->r0_max_m,
        .r0_change_max_m = (double)params->r0_change_max_m,
    };
    const double answer = own->failed ? (double)law->r0_m : own->call(own->context, &input);
    own->failed |= !real_is_finite((real)answer);
    return own->failed ? law->r0_m : (real)answer;
}

static const struct law own_row = {.step = ask};

#define LAW_ENTRY(value, number, id, name) [value] = &LAW_ROW(id),
static const struct law *const rows[] = {LAW_TABLE(LAW_ENTRY)}; /* NULL between the numbers */
#undef LAW_ENTRY

const struct law *law_of(real number)
{
    if (in_use != NULL && in_use->call != NULL && number == (real)OWN_LAW_NUMBER) {
        return &own_row;
    }
    if (!(number >= REAL(0.0) && number <= (real)LAW_LARGEST)) {
        return NULL;
    }
    const unsigned i = (unsigned)number;
    return number == (real)i ? rows[i] : NULL;
}
