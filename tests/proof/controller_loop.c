/* The whole controller in an endless loop, under any input whatever.
 *
 * In every tick each measurement is any float, each count and state any value of its type. Every
 * parameter is anywhere within the range that control_params_validate() enforces, and may be
 * another one in every tick: more than a device does, where settings move by a ramp.
 * PROOF_EQUATION_16: that law alone, without a gait branch. Else: any law, with one.
 */
#include "controller/controller.h"
#include "tests/proof/arbitrary.h"

/* The range of a length that the controller may command: over all parameters, the largest r0_max
 * and a tenth of the longest leg. The limit of one device follows from its own parameters. */
#define COMMAND_MOST_M 0.750001f
#define SMALLEST_POSITIVE 1.4e-45f
#define LARGEST 3.40282347e38f

static struct gait_branch branch;
static struct control_params params;
static struct controller controller;

static float positive(void)
{
    return Frama_C_float_interval(SMALLEST_POSITIVE, LARGEST);
}

static float finite(void)
{
    return Frama_C_float_interval(-LARGEST, LARGEST);
}

static void choose_table(struct speed_table *table)
{
    table->count = (uint32_t)Frama_C_interval(4, SPEED_TABLE_MAX);
    table->r0_min_m = positive();
    table->r0_step_m = positive();
    for (int i = 0; i < SPEED_TABLE_MAX; i++) {
        table->speed_rad_s[i] = positive();
    }
}

static void choose_branch(void)
{
    branch.count = (uint32_t)Frama_C_interval(GAIT_BRANCH_MIN, GAIT_BRANCH_MAX);
    branch.speed_min_rad_s = positive();
    branch.speed_step_rad_s = positive();
    branch.r0_weight = Frama_C_float_interval(0.0f, LARGEST);
    branch.travel_weight = positive();
    for (int i = 0; i < GAIT_BRANCH_MAX; i++) {
        struct gait_branch_point *point = &branch.point[i];
        point->r0_m = positive();
        point->swing_angle_rad = finite();
        point->swing_rate_rad_s = finite();
        for (int k = 0; k < GAIT_BRANCH_COSTS; k++) {
            point->cost[k] = finite();
        }
        for (int k = 0; k < 3; k++) {
            point->lqr_gain[k] = finite();
            point->deadbeat_gain[k] = finite();
        }
    }
}

#define CHOOSE(field, unit, minimum, maximum, meaning) \
    params.field = Frama_C_float_interval((float)(minimum), (float)(maximum));
static void choose_params(void)
{
    CONTROL_PARAM_TABLE(CHOOSE)
#ifdef PROOF_EQUATION_16
    params.law = (real)LAW_PROPORTIONAL;
    params.branch = NULL;
#else
    params.branch = &branch;
#endif
    choose_table(&params.table);
}

static void choose_leg(struct leg_measurement *leg)
{
    leg->leg_angle_rad = any_float;
    leg->ankle_extension_m = any_float;
    leg->age_ticks = any_u16;
    leg->foot = (enum foot_contact)any_u32;
}

static void choose_sea(struct sea_measurement *sea)
{
    sea->precompression_m = any_float;
    sea->state = (enum drive_state)any_u32;
    sea->age_ticks = any_u16;
    sea->latch = (enum latch_state)any_u32;
    sea->force_N = any_float;
    sea->force_age_ticks = any_u16;
    sea->absent = any_bool();
    sea->contact = (enum foot_contact)any_u32;
}

static void choose_input(struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        choose_leg(&input->leg[side]);
        choose_sea(&input->sea[side]);
    }
    input->desired_speed_rad_s = any_float;
    input->nodes_operational = any_bool();
    input->node_error = any_bool();
    input->emergency_stop = any_bool();
    input->foreign_node = any_bool();
    input->parameters_corrupt = any_bool();
    input->walk_requested = any_bool();
    input->wearer_pressed = any_bool();
    input->node_written = any_bool();
    input->node_changed = any_bool();
    input->reset_requested = any_bool();
    input->zero_requested = any_bool();
    input->motion.order = any_u8;
    input->motion.renewal = any_u8;
    input->motion.kind = (enum motion_kind)any_u32;
    input->motion.side = (enum side)Frama_C_interval(SIDE_LEFT, SIDE_RIGHT);
    input->motion.share = any_float;
    input->motion.seconds = any_float;
    input->motion.frequency_Hz = any_float;
}

/* Within the ranges of hal/devices/device_keys.h; the readings are anything. */
static void choose_drives(struct derate_limits limit[SIDE_COUNT],
                          struct derate_reading reading[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        limit[side].temperature_warn_degC = Frama_C_float_interval(0.0f, 300.0f);
        limit[side].temperature_stop_degC = Frama_C_float_interval(0.0f, 300.0f);
        limit[side].supply_min_V = Frama_C_float_interval(0.0f, 1000.0f);
        limit[side].supply_max_V = Frama_C_float_interval(0.0f, 1000.0f);
        reading[side].heard = any_bool();
        reading[side].has_temperature = any_bool();
        reading[side].has_supply = any_bool();
        reading[side].warning = any_bool();
        reading[side].temperature_degC = any_float;
        reading[side].supply_V = any_float;
    }
}

/* What leaves the controller, whatever came in. */
static void check(const struct controller_output *output)
{
    //@ assert state: SUPERVISOR_INIT <= output->state < SUPERVISOR_STATES;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_request *request = &output->sea[side];
        //@ assert finite: \is_finite(request->precompression_m);
        //@ assert within: -COMMAND_MOST_M <= request->precompression_m <= COMMAND_MOST_M;
    }
}

void proof_controller_loop(void)
{
    struct controller_input input;
    struct controller_output output;
    struct derate_limits limit[SIDE_COUNT];
    struct derate_reading reading[SIDE_COUNT];
    choose_branch();
    choose_params();
    if (controller_init(&controller, &params) != CONTROL_PARAMS_OK) {
        return;
    }
    input.tick = any_u32;
    for (;;) {
        choose_branch();
        choose_params();
        choose_input(&input);
        controller_update(&controller, &input, &output);
        check(&output);
        choose_drives(limit, reading);
        (void)controller_bear(&controller, limit, reading, input.tick);
        input.tick++;
    }
}
