/* What the firmware makes of the drives' readings beside the controller: sparing them by temperature, supply and
 * warnings, watching that they obey, and watching a tool that writes to them. Readings are of any value, frames of
 * any content. */
#include "firmware/drive_care.h"
#include "firmware/drive_watch.h"
#include "firmware/tool_watch.h"
#include "tests/proof/arbitrary.h"

static struct controller controller;
static struct controller_objects objects;
static struct co_device device;
static struct network network;
static struct bring_up bring_up;
static struct tool_watch tool_watch;
static struct drive_watch drive_watch;

/* A drive that tells anything. */
static void any_read(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    (void)context;
    (void)leg;
    reading->precompression_m = any_float;
    reading->force_N = any_float;
    reading->state = (enum drive_state)any_u32;
    reading->latch = (enum latch_state)any_u32;
    reading->age_ticks = any_u16;
    reading->warning = any_bool();
    reading->has_temperature = any_bool();
    reading->has_supply = any_bool();
    reading->temperature_degC = any_float;
    reading->supply_V = any_float;
}

static const struct sea_drives_ops any_drives_ops = {.read = any_read};
static const struct sea_drives any_drives = {&any_drives_ops, NULL, NULL};

static void choose_leg(struct device_leg *leg)
{
    leg->protocol = (enum device_protocol)any_u32;
    leg->temperature_warn_degC = Frama_C_float_interval(0.0f, 300.0f);
    leg->temperature_stop_degC = Frama_C_float_interval(0.0f, 300.0f);
    leg->supply_min_V = Frama_C_float_interval(0.0f, 1000.0f);
    leg->supply_max_V = Frama_C_float_interval(0.0f, 1000.0f);
    leg->unload = (enum device_unload)any_u32;
}

static void watch(const struct derate_limits limit[SIDE_COUNT])
{
    struct sea_request request[SIDE_COUNT];
    struct can_msg message;
    struct control_params params;
    params.leg_length_m = Frama_C_float_interval(0.1f, 1.5f);
    params.sea_tolerance_m = Frama_C_float_interval(0.00001f, 0.05f);
    request[SIDE_LEFT] = request[SIDE_RIGHT] =
        (struct sea_request){any_float, any_bool(), any_bool()};
    any_message(&message);
    switch (any_u8 % 8) {
    case 0:
        drive_care_update(&controller, limit, &any_drives, any_u32, any_bool(), &device);
        break;
    case 1:
        drive_care_show(&objects, &controller.derate, &any_drives);
        break;
    case 2:
        (void)drive_watch_update(&drive_watch, &any_drives, (enum supervisor_state)any_u32, request,
                                 &params);
        break;
    case 3:
        (void)tool_watch_receive(&tool_watch, &network, &bring_up, &message, &objects);
        break;
    case 4:
        (void)tool_watch_find_stuck(&tool_watch, &any_drives, request,
                                    Frama_C_float_interval(0.1f, 1.5f));
        break;
    case 5:
        bring_up.configured = any_u8;
        tool_watch_distrust(&tool_watch, (unsigned)Frama_C_interval(0, NETWORK_NODES - 1), any_u16);
        break;
    default:
        tool_watch_end_tick(&tool_watch, &bring_up, &any_drives, any_bool());
        break;
    }
}

void proof_drive_watchers(void)
{
    struct device_description description;
    struct derate_limits limit[SIDE_COUNT];
    choose_leg(&description.leg[SIDE_LEFT]);
    choose_leg(&description.leg[SIDE_RIGHT]);
    derate_init(&controller.derate);
    network_init(&network);
    drive_care_init(limit, &objects, &description);
    for (;;) {
        watch(limit);
        //@ assert share: 0 <= controller.derate.share <= 1;
    }
}
