#include "sim_host/plant/sea_internal.h"

#include "model/tick.h"

/* Cyclic synchronous position: a new target is reached linearly over one tick. */
static const double INTERPOLATION_S = TICK_PERIOD_US / 1e6;

/* Low-pass of the differentiated encoder, per drive period. */
static const double SPEED_FILTER = 0.3;

/* Speed the position loop may ask for, in limits of the reference's. */
static const double LOOP_SPEED_RATIO = 1.1;

static double clamp(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static bool is_finite(double x)
{
    return x - x == 0.0;
}

int32_t sea_m_to_counts(const struct sea_params *params, double position_m)
{
    const double counts = position_m * params->counts_per_m;
    if (!(counts > -2147483648.0)) {
        return INT32_MIN;
    }
    if (counts >= 2147483647.0) {
        return INT32_MAX;
    }
    return (int32_t)(counts < 0.0 ? counts - 0.5 : counts + 0.5);
}

double sea_counts_to_m(const struct sea_params *params, int32_t counts)
{
    return (double)counts / params->counts_per_m;
}

/* What the drive knows of its motor: the encoder, in true coordinates. */
static double encoder_m(const struct sea *sea)
{
    return sea_counts_to_m(&sea->params, sea_m_to_counts(&sea->params, sea->position_m));
}

void sea_init(struct sea *sea, const struct sea_params *params, uint64_t seed)
{
    *sea = (struct sea){.params = *params};
    sea->command.mode = SEA_TORQUE_OFF;
    sea->latch = SEA_LATCH_CLOSED;
    sea->temperature_degC = params->ambient_degC;
    sea->since_command_s = INTERPOLATION_S;
    if (params->as_built) {
        sea_built_init(&sea->built, &params->built);
        sea->temperature_degC = params->built.ambient_degC;
    }
    rng_init(&sea->rng, seed, 0x5EA);
}

static double goal_m(const struct sea *sea, double *speed_m_s)
{
    const double done = sea->since_command_s / INTERPOLATION_S;
    const double way_m = sea->target_to_m - sea->target_from_m;
    /* The way's last period still moves: a stream of targets must not stop the reference once a
     * tick. Only a target that fails to come does. */
    if (sea->since_command_s > INTERPOLATION_S + 0.5 * sea->params.drive_period_s) {
        *speed_m_s = 0.0;
        return sea->target_to_m;
    }
    *speed_m_s = way_m / INTERPOLATION_S;
    return sea->target_from_m + way_m * done;
}

/* A drive that begins to follow starts from where its motor is. */
static void start_from_here(struct sea *sea)
{
    sea->measured_m = encoder_m(sea);
    sea->measured_speed_m_s = sea->speed_m_s;
    sea_loop_start(&sea->built.loop, sea->position_m, sea->speed_m_s);
    sea->reference_m = sea->measured_m;
    sea->reference_speed_m_s = sea->speed_m_s;
    sea->target_from_m = sea->target_to_m = sea->measured_m;
    sea->integral_N = 0.0;
}

void sea_set_command(struct sea *sea, const struct sea_command *command, double now_s)
{
    const enum sea_mode before = sea->command.mode;
    const double target_m = command->target_position_m - sea->params.zero_offset_m;
    sea->command = *command;
    sea->target_clamped = false;
    if (command->mode != before && before == SEA_TORQUE_OFF) {
        start_from_here(sea);
    }
    if (command->mode == SEA_POSITION) {
        double unused;
        sea->target_from_m = goal_m(sea, &unused);
        if (is_finite(target_m)) {
            /* The drive's software limits count in what it reports. */
            const double low_m = sea->params.stroke_min_m - sea->params.zero_offset_m;
            const double high_m = sea->params.stroke_max_m - sea->params.zero_offset_m;
            sea->target_to_m = clamp(target_m, low_m, high_m);
            sea->target_clamped = target_m < low_m || target_m > high_m;
        } else {
            sea->target_clamped = true;
        }
        sea->since_command_s = 0.0;
        if (sea->params.as_built) {
            sea_loop_target(&sea->built.loop, sea->target_to_m);
        }
        if (sea->params.ideal_motor) {
            sea->position_m =
                clamp(sea->target_to_m, sea->params.end_stop_min_m, sea->params.end_stop_max_m);
        }
    }
    if (!command->latch_armed) {
        sea->release_pending = false;
    } else if (sea->params.release_on == SEA_RELEASE_COMMAND) {
        sea_schedule_release(sea, now_s);
    }
}

/* Moves the reference towards the goal within the speed and acceleration limits:
 * it brakes so that it can stop at the goal. */
static void advance_reference(struct sea *sea, double target_m, double target_speed_m_s)
{
    const struct sea_params *p = &sea->params;
    const double h = p->drive_period_s;
    const double off_m = target_m - sea->reference_m;
    const double braking_m_s = __builtin_sqrt(2.0 * p->acceleration_limit_m_s2 * magnitude(off_m));
    double wanted_m_s =
        clamp(target_speed_m_s + off_m / INTERPOLATION_S, -p->speed_limit_m_s, p->speed_limit_m_s);
    if (magnitude(wanted_m_s - target_speed_m_s) > braking_m_s) {
        wanted_m_s = clamp(target_speed_m_s + (off_m < 0.0 ? -braking_m_s : braking_m_s),
                           -p->speed_limit_m_s, p->speed_limit_m_s);
    }
    const double change_m_s =
        clamp(wanted_m_s - sea->reference_speed_m_s, -p->acceleration_limit_m_s2 * h,
              p->acceleration_limit_m_s2 * h);
    sea->reference_m += h * (sea->reference_speed_m_s + 0.5 * change_m_s);
    sea->reference_speed_m_s += change_m_s;
    sea->reference_acceleration_m_s2 = change_m_s / h;
}

static void advance_goal(struct sea *sea)
{
    const double h = sea->params.drive_period_s;
    if (sea->command.mode == SEA_UNLOAD) {
        /* To what the drive believes is zero: a wrong zero offset stays a load. */
        const double zero_m = -sea->params.zero_offset_m;
        const double step_m = sea->params.unload_rate_m_s * h;
        double unused;
        const double from_m = goal_m(sea, &unused);
        sea->target_to_m = clamp(zero_m, from_m - step_m, from_m + step_m);
        sea->target_from_m = sea->target_to_m;
        sea->since_command_s = INTERPOLATION_S;
    } else {
        sea->since_command_s += h;
    }
}

/* The drive's loop: stiffness and damping of the chosen bandwidth, an integral
 * that stops while the force is at its limit, feed-forward of the inertia. */
static double loop_force_N(struct sea *sea)
{
    const struct sea_params *p = &sea->params;
    const double w = p->loop_bandwidth_rad_s;
    const double stiffness = p->motor_mass_kg * w * w;
    const double off_m = sea->reference_m - sea->measured_m;
    const double off_m_s = sea->reference_speed_m_s - sea->measured_speed_m_s;
    const double damping = 2.0 * p->loop_damping * p->motor_mass_kg * w;
    double direct_N =
        stiffness * off_m + damping * off_m_s + p->motor_mass_kg * sea->reference_acceleration_m_s2;
    /* The same as a cascade: the position loop asks for a speed, and that has its limit, so
     * that a motor far off (it had no force for a while) does not rush. */
    const double asked_m_s = sea->reference_speed_m_s + stiffness * off_m / damping;
    if (magnitude(asked_m_s) > LOOP_SPEED_RATIO * p->speed_limit_m_s) {
        const double limit_m_s = LOOP_SPEED_RATIO * p->speed_limit_m_s;
        direct_N = damping * (clamp(asked_m_s, -limit_m_s, limit_m_s) - sea->measured_speed_m_s);
    }
    const double wanted_N = direct_N + sea->integral_N;
    const double force_N = clamp(wanted_N, -p->force_limit_N, p->force_limit_N);
    sea->force_limited = force_N != wanted_N;
    if (!sea->force_limited || wanted_N * off_m < 0.0) {
        sea->integral_N += stiffness * p->loop_integral_rad_s * off_m * p->drive_period_s;
        sea->integral_N = clamp(sea->integral_N, -p->force_limit_N, p->force_limit_N);
    }
    return force_N;
}

/* Acceleration of the motor under its net force; Coulomb friction holds it at rest
 * and does not turn it round within one period. */
static double motion_under(struct sea *sea, double net_N)
{
    const struct sea_params *p = &sea->params;
    const double h = p->drive_period_s, v = sea->speed_m_s;
    double friction_N = p->viscous_N_per_m_s * v;
    if (v == 0.0) {
        if (magnitude(net_N) <= p->coulomb_N) {
            sea->friction_N = net_N;
            return 0.0;
        }
        friction_N = net_N > 0.0 ? p->coulomb_N : -p->coulomb_N;
    } else {
        friction_N += v > 0.0 ? p->coulomb_N : -p->coulomb_N;
    }
    double acceleration = (net_N - friction_N) / p->motor_mass_kg;
    if (v * (v + acceleration * h) < 0.0) {
        acceleration = -v / h;
    }
    sea->friction_N = net_N - p->motor_mass_kg * acceleration;
    return acceleration;
}

static void ideal_period(struct sea *sea)
{
    const double goal = sea->command.mode == SEA_TORQUE_OFF ? 0.0 : sea->target_to_m;
    sea->position_m = clamp(goal, sea->params.end_stop_min_m, sea->params.end_stop_max_m);
    sea->speed_m_s = sea->acceleration_m_s2 = 0.0;
    sea->motor_force_N = sea->spring_force_N;
    sea->measured_m = encoder_m(sea);
}

/* The motor's way over the period, as the constant acceleration that ends where it does. */
static void built_period(struct sea *sea, double ankle_m)
{
    static const enum sea_loop_mode modes[] = {[SEA_TORQUE_OFF] = SEA_LOOP_OFF,
                                               [SEA_POSITION] = SEA_LOOP_FOLLOW,
                                               [SEA_UNLOAD] = SEA_LOOP_UNLOAD};
    struct sea_built *built = &sea->built;
    const double h = sea->params.drive_period_s;
    built->spring_scale = sea_spring_scale(sea);
    sea_built_period(built, modes[sea->command.mode], sea->latch == SEA_LATCH_CLOSED,
                     sea_output_of(sea, ankle_m));
    sea->motor_force_N = built->next.force_N;
    sea->friction_N = built->next.friction_N;
    sea->force_limited = built->loop.current_limited || built->next.voltage_limited;
    sea->acceleration_m_s2 =
        2.0 * (built->next.position_m - sea->position_m - h * sea->speed_m_s) / (h * h);
}

void sea_drive_period(struct sea *sea, double ankle_m)
{
    double target_speed_m_s;
    sea->spring_force_N = sea_spring_force_now_N(sea, ankle_m);
    sea_hold(sea);
    if (sea->params.ideal_motor) {
        advance_goal(sea);
        ideal_period(sea);
        return;
    }
    if (sea->params.as_built) {
        built_period(sea, ankle_m);
        return;
    }
    const double measured_m = encoder_m(sea);
    const double raw_m_s = (measured_m - sea->measured_m) / sea->params.drive_period_s;
    sea->measured_speed_m_s += SPEED_FILTER * (raw_m_s - sea->measured_speed_m_s);
    sea->measured_m = measured_m;
    advance_goal(sea);
    if (sea->command.mode == SEA_TORQUE_OFF) {
        sea->motor_force_N = 0.0;
        sea->force_limited = false;
    } else {
        const double target_m = goal_m(sea, &target_speed_m_s);
        advance_reference(sea, target_m, target_speed_m_s);
        sea->motor_force_N = loop_force_N(sea);
    }
    sea->acceleration_m_s2 = motion_under(sea, sea->motor_force_N - sea->spring_force_N);
}

double sea_position_at_m(const struct sea *sea, double tau_s)
{
    return sea->position_m + tau_s * (sea->speed_m_s + 0.5 * tau_s * sea->acceleration_m_s2);
}

double sea_speed_at_m_s(const struct sea *sea, double tau_s)
{
    return sea->speed_m_s + tau_s * sea->acceleration_m_s2;
}

static void finish_built(struct sea *sea)
{
    const struct sea_motor *now = &sea->built.motor;
    const double before_J = now->load_J + now->friction_J, from_J = sea->motor_work_J;
    sea_built_finish(&sea->built);
    sea->position_m = now->position_m;
    sea->speed_m_s = now->speed_m_s;
    sea->acceleration_m_s2 = 0.0;
    sea->at_end_stop = now->at_end_stop;
    sea->temperature_degC = now->winding_degC;
    sea->friction_loss_J = now->friction_J;
    sea->motor_work_J += now->load_J + now->friction_J - before_J;
    if (sea->motor_work_J > from_J) {
        sea->motor_positive_work_J += sea->motor_work_J - from_J;
    }
}

void sea_finish_period(struct sea *sea)
{
    const struct sea_params *p = &sea->params;
    if (p->as_built) {
        finish_built(sea);
        return;
    }
    const double h = p->drive_period_s;
    const double from_m = sea->position_m;
    sea->position_m = sea_position_at_m(sea, h);
    sea->speed_m_s = sea_speed_at_m_s(sea, h);
    sea->at_end_stop = false;
    if (sea->position_m >= p->end_stop_max_m && sea->speed_m_s >= 0.0 && !p->ideal_motor) {
        sea->position_m = p->end_stop_max_m;
        sea->at_end_stop = true;
    } else if (sea->position_m <= p->end_stop_min_m && sea->speed_m_s <= 0.0 && !p->ideal_motor) {
        sea->position_m = p->end_stop_min_m;
        sea->at_end_stop = true;
    }
    if (sea->at_end_stop) {
        sea->speed_m_s = 0.0;
    }
    /* The next period's acceleration is not known yet: extrapolation stops here. */
    sea->acceleration_m_s2 = 0.0;
    const double way_m = sea->position_m - from_m;
    const double work_J = sea->motor_force_N * way_m;
    sea->motor_work_J += work_J;
    if (work_J > 0.0) {
        sea->motor_positive_work_J += work_J;
    }
    sea->friction_loss_J += sea->friction_N * way_m;
    const double load = sea->motor_force_N / p->rated_force_N;
    sea->temperature_degC +=
        (load * load * p->thermal_rise_K + p->ambient_degC - sea->temperature_degC) *
        (h / p->thermal_time_s);
}

void sea_read(const struct sea *sea, double ankle_m, struct sea_output *output)
{
    const struct sea_params *p = &sea->params;
    const double power_W = sea->motor_force_N * sea->speed_m_s;
    const double current_A = magnitude(sea->motor_force_N) / p->force_per_current_N_A;
    output->position_m = sea->position_m;
    output->position_counts = sea_m_to_counts(p, sea->position_m + p->zero_offset_m);
    output->reported_position_m = sea_counts_to_m(p, output->position_counts);
    output->speed_m_s = sea->speed_m_s;
    output->motor_force_N = sea->motor_force_N;
    output->torque_per_mille = 1000.0 * sea->motor_force_N / p->rated_force_N;
    output->spring_force_N = sea_spring_force_now_N(sea, ankle_m);
    output->ankle_force_N = sea_ankle_force_N(sea, ankle_m);
    output->latch = sea->latch;
    output->armed = sea->command.latch_armed;
    output->release_pending = sea->release_pending;
    output->target_clamped = sea->target_clamped;
    output->force_limited = sea->force_limited;
    output->at_end_stop = sea->at_end_stop;
    output->unloaded = output->spring_force_N <= 0.01 * p->spring_N_per_m * p->stroke_max_m;
    output->latch_slipping = sea->slipping;
    output->current_A = sea->built.motor.current_A;
    output->temperature_degC = sea->temperature_degC;
    if (p->as_built) {
        output->dc_link_V = sea->built.motor.bus_V;
        return;
    }
    /* Copper loss and mechanical power come through the source's resistance. */
    output->dc_link_V = p->dc_link_V;
    if (p->dc_link_V > 0.0) {
        const double supply_A = (power_W > 0.0 ? power_W / p->dc_link_V : 0.0) + 0.01 * current_A;
        output->dc_link_V -= p->dc_link_ohm * supply_A;
    }
}
