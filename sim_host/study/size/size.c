#include "sim_host/study/size/size.h"

#include <math.h>
#include <string.h>

#include "controller/actuation/sea_reference.h"
#include "model/tick.h"
#include "sim_host/plant/sea.h"
#include "sim_host/study/size/ankle_curve.h"

static const double TICK_S = TICK_PERIOD_US / 1e6;

/* From here on after toe-off, and up to here after heel strike, the ankle is to be free. */
#define FREE_AFTER_S 0.05
#define FREE_UNTIL_SHARE 0.3

/* No thermal state of a drive that is asked for an hour changes in a second. */
#define HOUR_S 3600

const char *size_limit_name(enum size_limit limit)
{
    static const char *const names[SIZE_LIMITS] = {
        "peak current", "continuous current", "winding", "voltage",
        "motor speed",  "supply current",     "latch",   "time to load"};
    return (unsigned)limit < SIZE_LIMITS ? names[limit] : "unknown";
}

/* Half a stride at the slowest cadence, ticks. */
enum { HALF_STRIDE_MOST = 3001 };

/* One leg that walks. */
struct leg {
    const struct size_setup *setup;
    struct size_row *row;
    struct sea sea;
    struct sea_reference reference;
    double stride_s, time_s;
    double ankle_m;
    double loaded_share, work_J, peak_Nm, peak_W; /* of this stride */
    bool counts, armed, pushed;
    /* What it drew in each tick of the last half stride: the other leg draws it now. */
    double drawn_W[HALF_STRIDE_MOST];
    int half_ticks, drawn_at;
};

static double share_of(const struct leg *leg)
{
    return leg->time_s / leg->stride_s - floor(leg->time_s / leg->stride_s + 1e-9);
}

static double extension_m(const struct leg *leg, double time_s)
{
    const double way_m =
        sea_config_way_at_m(&leg->setup->config, ankle_curve_rad(time_s / leg->stride_s));
    return way_m > 0.0 ? way_m : 0.0;
}

static double lever_now_m(const struct leg *leg)
{
    return sea_config_lever_at_m(&leg->setup->config, ankle_curve_rad(leg->time_s / leg->stride_s));
}

static void begin_stride(struct leg *leg)
{
    leg->loaded_share = 2.0;
    leg->work_J = leg->peak_Nm = leg->peak_W = 0.0;
    leg->pushed = false;
    if (leg->sea.latch == SEA_LATCH_CLOSED) {
        sea_reference_begin_loading(&leg->reference, leg->setup->params.start_r0_m);
        sea_reference_set_target(&leg->reference, leg->setup->params.start_r0_m);
    }
}

static void end_stride(struct leg *leg)
{
    struct size_row *row = leg->row;
    if (!leg->counts || !leg->pushed) {
        return;
    }
    row->pushes++;
    row->work_J += leg->work_J;
    row->peak_torque_Nm += leg->peak_Nm;
    row->peak_power_W += leg->peak_W;
}

/* What the controller does at a tick. */
static void control(struct leg *leg, double share)
{
    struct sea_output out;
    struct sea *sea = &leg->sea;
    sea_read(sea, leg->ankle_m, &out);
    const bool over =
        sea->latch != SEA_LATCH_CLOSED &&
        (share >= ANKLE_CURVE_TOE_OFF || (leg->pushed && leg->ankle_m >= out.reported_position_m));
    if (over || (sea->latch == SEA_LATCH_CLOSED && share >= ANKLE_CURVE_TOE_OFF)) {
        sea_reference_unload(&leg->reference);
    }
    const struct sea_request request =
        sea_reference_update(&leg->reference, &leg->setup->params, (real)out.reported_position_m);
    leg->armed = request.latch_armed && share > 0.35 && share < ANKLE_CURVE_TOE_OFF;
    if (request.latch_armed && leg->loaded_share > 1.0) {
        leg->loaded_share = share;
    }
    const struct sea_command command = {SEA_POSITION, (double)request.precompression_m, leg->armed};
    sea_set_command(sea, &command, leg->time_s);
}

static void feel(struct leg *leg, double way_m, double period_s)
{
    struct size_row *row = leg->row;
    const double share = share_of(leg);
    const double force_N = sea_ankle_force_N(&leg->sea, leg->ankle_m);
    const double torque_Nm = force_N * lever_now_m(leg);
    const double since_s = (share - ANKLE_CURVE_TOE_OFF) * leg->stride_s;
    leg->work_J += force_N * way_m;
    leg->peak_Nm = fmax(leg->peak_Nm, torque_Nm);
    leg->peak_W = fmax(leg->peak_W, force_N * way_m / period_s);
    if (leg->counts && (since_s > FREE_AFTER_S || share < FREE_UNTIL_SHARE)) {
        row->swing_Nm = fmax(row->swing_Nm, fabs(torque_Nm));
    }
}

static void run_latch(struct leg *leg)
{
    struct sea *sea = &leg->sea;
    if (sea->release_pending && sea->release_time_s <= leg->time_s && sea_release_now(sea)) {
        leg->pushed = true;
        if (leg->counts) {
            leg->row->release_share = share_of(leg);
            leg->row->push_V = sea->built.motor.bus_V;
        }
    }
    if (sea->latch == SEA_LATCH_RELEASED && sea->position_m <= leg->ankle_m) {
        sea_lift_off(sea);
    }
    (void)sea_reclose(sea, 0.0);
}

/* The other leg is the same half a stride later, on the same battery. */
static void share_battery(struct leg *leg, double drawn_J)
{
    const double other_W = leg->drawn_W[leg->drawn_at];
    leg->drawn_W[leg->drawn_at] = drawn_J / TICK_S;
    leg->drawn_at = (leg->drawn_at + 1) % leg->half_ticks;
    if (leg->setup->config.supply_shared >= 0.5) {
        leg->sea.built.motor.other_W = other_W;
    }
}

static void tick(struct leg *leg, double before_share)
{
    struct sea *sea = &leg->sea;
    const double share = share_of(leg);
    const double period_s = sea->params.drive_period_s;
    const int periods = (int)(TICK_S / period_s + 0.5);
    const double before_J = sea->built.motor.supplied_J;
    if (share < before_share) {
        end_stride(leg);
        begin_stride(leg);
    }
    control(leg, share);
    if (before_share < ANKLE_CURVE_OTHER_STRIKE && share >= ANKLE_CURVE_OTHER_STRIKE) {
        leg->row->spare_s = fmin(leg->row->spare_s, (share - leg->loaded_share) * leg->stride_s);
        sea_other_foot_contact(sea, leg->time_s);
    }
    for (int i = 0; i < periods; i++) {
        const double next_m = extension_m(leg, leg->time_s + period_s);
        run_latch(leg);
        sea_drive_period(sea, leg->ankle_m);
        sea_finish_period(sea);
        feel(leg, next_m - leg->ankle_m, period_s);
        leg->ankle_m = next_m;
        leg->time_s += period_s;
    }
    share_battery(leg, sea->built.motor.supplied_J - before_J);
}

/* The winding after an hour of this current, its resistance with its temperature. */
static double hour_degC(const struct sea_config *config, double rms_A)
{
    struct sea_motor motor;
    sea_motor_init(&motor, config);
    for (int i = 0; i < HOUR_S * 10; i++) {
        const double ohm =
            config->resistance_ohm * (1.0 + config->resistance_per_K * (motor.winding_degC - 25.0));
        sea_motor_warm(&motor, config, rms_A * rms_A * ohm, 0.1);
        if (motor.winding_degC > SIZE_HOTTEST_DEGC) {
            break; /* runs away: hotter than anything bears */
        }
    }
    return motor.winding_degC;
}

static void summarise(struct leg *leg, double from_J)
{
    struct size_row *row = leg->row;
    const struct sea_built *built = &leg->sea.built;
    const struct sea_load *load = &built->load;
    const double pushes = row->pushes > 0 ? (double)row->pushes : 1.0;
    row->work_J /= pushes;
    row->peak_torque_Nm /= pushes;
    row->peak_power_W /= pushes;
    row->rms_A = sea_built_rms_A(built);
    row->peak_A = load->peak_current_A;
    row->reserve_V = load->voltage_limited_s > 0.0 ? 0.0 : load->least_voltage_V;
    row->lowest_bus_V = load->lowest_bus_V;
    row->peak_supply_A = load->peak_supply_A;
    row->mean_supply_W = (built->motor.supplied_J - from_J) / load->time_s;
    row->peak_speed_m_s = load->peak_speed_m_s;
    row->peak_spring_N = load->peak_spring_N;
    row->current_limited_s = load->current_limited_s / SIZE_STRIDES;
    row->voltage_limited_s = load->voltage_limited_s / SIZE_STRIDES;
    row->hour_degC = hour_degC(&leg->setup->config, row->rms_A);
}

void size_walk(const struct size_setup *setup, double cadence_1_min, struct size_row *row)
{
    struct sea_params params;
    struct leg leg = {.setup = setup, .row = row, .stride_s = 120.0 / cadence_1_min};
    memset(row, 0, sizeof *row);
    row->cadence_1_min = cadence_1_min;
    row->spare_s = leg.stride_s;
    leg.half_ticks = (int)(0.5 * leg.stride_s / TICK_S + 0.5);
    sea_params_as_built(&setup->config, &params);
    sea_init(&leg.sea, &params, setup->seed);
    sea_reference_init(&leg.reference, REAL(0.0));
    double before = 1.0, from_J = 0.0;
    const int settle_ticks = (int)((double)SIZE_SETTLE * leg.stride_s / TICK_S + 0.5);
    const int ticks = (int)((double)(SIZE_SETTLE + SIZE_STRIDES) * leg.stride_s / TICK_S + 0.5) + 1;
    for (int i = 0; i < ticks; i++) {
        const double share = share_of(&leg);
        if (i == settle_ticks) {
            sea_built_clear_load(&leg.sea.built);
            from_J = leg.sea.built.motor.supplied_J;
            row->spare_s = leg.stride_s;
            row->pushes = 0;
        }
        leg.counts = i >= settle_ticks + 1;
        tick(&leg, before);
        before = share;
    }
    summarise(&leg, from_J);
}

void size_shares(const struct size_setup *setup, const struct size_row *row,
                 double share[SIZE_LIMITS])
{
    const struct sea_config *config = &setup->config;
    const double load_s = ANKLE_CURVE_OTHER_STRIKE * 120.0 / row->cadence_1_min;
    share[SIZE_PEAK_CURRENT] = row->peak_A / config->current_peak_A;
    share[SIZE_RMS_CURRENT] = row->rms_A / config->current_continuous_A;
    share[SIZE_WINDING] =
        (row->hour_degC - config->ambient_degC) / (config->winding_max_degC - config->ambient_degC);
    share[SIZE_VOLTAGE] = 1.0 - row->reserve_V / config->supply_V;
    share[SIZE_SPEED] =
        row->peak_speed_m_s * sea_config_rad_per_m(config) / config->motor_speed_max_rad_s;
    share[SIZE_SUPPLY] = row->peak_supply_A / config->supply_current_max_A;
    share[SIZE_LATCH] = row->peak_spring_N / config->latch_holding_N;
    share[SIZE_TIME] = 1.0 - row->spare_s / load_s;
}

bool size_holds(const struct size_setup *setup, const struct size_row *row)
{
    double share[SIZE_LIMITS];
    bool within = row->pushes == SIZE_STRIDES;
    size_shares(setup, row, share);
    for (int i = 0; i < SIZE_LIMITS; i++) {
        within = within && share[i] <= 1.0;
    }
    return within;
}
