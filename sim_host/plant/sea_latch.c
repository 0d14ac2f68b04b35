/* The latch, and what a spring behind it does to the ankle. */
#include "sim_host/plant/sea_internal.h"

double sea_output_of(const struct sea *sea, double ankle_m)
{
    return sea->latch == SEA_LATCH_CLOSED ? sea->output_m : ankle_m;
}

/* Of the configured stiffness: a fault may have changed it. */
double sea_spring_scale(const struct sea *sea)
{
    return sea->params.spring_N_per_m / sea->built.spring_N_per_m;
}

double sea_spring_force_now_N(const struct sea *sea, double ankle_m)
{
    const double output_m = sea_output_of(sea, ankle_m);
    if (sea->params.as_built) {
        const double compression_m =
            sea_built_compression_m(&sea->built, sea->position_m, output_m);
        return sea_spring_scale(sea) *
               sea_built_force_N(&sea->built, sea->latch == SEA_LATCH_CLOSED, compression_m);
    }
    const double compression_m = sea->position_m - output_m;
    return compression_m > 0.0 ? sea->params.spring_N_per_m * compression_m : 0.0;
}

double sea_ankle_force_N(const struct sea *sea, double ankle_m)
{
    return sea->latch == SEA_LATCH_CLOSED ? 0.0 : sea_spring_force_now_N(sea, ankle_m);
}

void sea_spring_at(const struct sea *sea, double ankle_m, double *stiffness_N_per_m, double *play_m)
{
    *stiffness_N_per_m = sea->params.spring_N_per_m;
    *play_m = 0.0;
    if (sea->params.as_built) {
        const double compression_m = sea_built_compression_m(&sea->built, sea->position_m, ankle_m);
        sea_spring_line(&sea->built.pushing, compression_m, stiffness_N_per_m, play_m);
        *stiffness_N_per_m *= sea_spring_scale(sea);
        *play_m += sea->built.config.backlash_m;
    }
}

double sea_spring_energy_now_J(const struct sea *sea, double ankle_m)
{
    if (sea->params.as_built) {
        const double compression_m =
            sea_built_compression_m(&sea->built, sea->position_m, sea_output_of(sea, ankle_m));
        return sea_spring_scale(sea) *
               sea_built_energy_J(&sea->built, sea->latch == SEA_LATCH_CLOSED, compression_m);
    }
    const double force_N = sea_spring_force_now_N(sea, ankle_m);
    return sea->params.spring_N_per_m > 0.0 ? 0.5 * force_N * force_N / sea->params.spring_N_per_m
                                            : 0.0;
}

void sea_schedule_release(struct sea *sea, double now_s)
{
    if (sea->latch != SEA_LATCH_CLOSED || !sea->command.latch_armed || sea->release_pending) {
        return;
    }
    sea->release_pending = true;
    sea->release_time_s = now_s + sea->params.release_latency_s;
    if (sea->params.release_jitter_s > 0.0) {
        sea->release_time_s += sea->params.release_jitter_s * rng_uniform(&sea->rng);
    }
}

static double holding_N(const struct sea *sea)
{
    const double left = 1.0 - sea->params.wear_per_release * (double)sea->releases;
    return left > 0.0 ? sea->params.holding_N * left : 0.0;
}

/* What a closed latch does with a spring that is too strong for it. */
void sea_hold(struct sea *sea)
{
    const bool before = sea->slipping;
    sea->slipping = sea->latch == SEA_LATCH_CLOSED && sea->spring_force_N > holding_N(sea);
    if (sea->slipping && !before) {
        sea->overloads++;
    }
    if (sea->slipping && sea->params.slip_m_s > 0.0) {
        sea->output_m += sea->params.slip_m_s * sea->params.drive_period_s;
    } else if (sea->slipping) {
        sea->lets_go = true;
    }
}

void sea_other_foot_contact(struct sea *sea, double now_s)
{
    if (sea->params.release_on == SEA_RELEASE_CONTACT ||
        sea->params.release_on == SEA_RELEASE_CONTACT_OR_EXTENSION) {
        sea_schedule_release(sea, now_s);
    }
}

void sea_ankle_extends(struct sea *sea, double now_s)
{
    if (sea->params.release_on == SEA_RELEASE_EXTENSION ||
        sea->params.release_on == SEA_RELEASE_CONTACT_OR_EXTENSION) {
        sea_schedule_release(sea, now_s);
    }
}

bool sea_release_now(struct sea *sea)
{
    sea->release_pending = false;
    sea->lets_go = false;
    if (sea->latch != SEA_LATCH_CLOSED || sea->latch_fault == SEA_LATCH_STUCK_SHUT) {
        return false;
    }
    if (sea->params.as_built) {
        sea_built_release(&sea->built, sea->output_m);
    }
    sea->latch = SEA_LATCH_RELEASED;
    sea->output_m = 0.0;
    sea->home_s = 0.0;
    sea->releases++;
    return true;
}

void sea_lift_off(struct sea *sea)
{
    if (sea->latch == SEA_LATCH_RELEASED) {
        sea->latch = sea->params.ideal_foot ? SEA_LATCH_CLOSED : SEA_LATCH_SLACK;
    }
}

bool sea_reclose(struct sea *sea, double foot_m)
{
    if (sea->latch != SEA_LATCH_SLACK || foot_m > sea->params.reclose_m ||
        sea->position_m > sea->params.reclose_m || sea->latch_fault == SEA_LATCH_STUCK_OPEN) {
        sea->home_s = 0.0;
        return false;
    }
    sea->home_s += sea->params.drive_period_s;
    if (sea->home_s <= sea->params.reclose_s) {
        return false;
    }
    sea->latch = SEA_LATCH_CLOSED;
    sea->home_s = 0.0;
    return true;
}

void sea_set_latch_fault(struct sea *sea, enum sea_latch_fault fault)
{
    sea->latch_fault = fault;
    sea->lets_go = sea->latch == SEA_LATCH_CLOSED &&
                   (fault == SEA_LATCH_OPENS || fault == SEA_LATCH_STUCK_OPEN);
}

bool sea_lets_go(const struct sea *sea)
{
    return sea->lets_go;
}

bool sea_may_release(const struct sea *sea)
{
    return sea->latch == SEA_LATCH_CLOSED && sea->command.latch_armed;
}
