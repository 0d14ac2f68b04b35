/* Commissioning of the virtual device in a stand, with a person beside it; and twelve devices that are
 * not what their file says: each is found before a spring is loaded beyond 20 % of the rated force. */
#include "sim_host/commission/commission.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/frame_table.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

enum {
    WAITS_MAX = 400,
    START_TICKS = 1500,
    SWING_TICKS = 600,
    TAP_EVERY = 100,
    DUPLICATE_PORT = 6
};
#define SWING_RAD 0.3
#define LOAD_LIMIT_SHARE 0.20

/* What the person's hands are at. */
struct hands {
    enum commission_hand hand;
    enum side leg;
    unsigned ticks;
};

struct defect;

static struct loop loop;
static struct commission commission;
static struct hands hands;
static const struct defect *defect;
static struct drive_node twin; /* a second node with a number that is taken */
static double largest_load_N;  /* in either spring, so far */
static double largest_load_before_link_N;
static bool twin_runs, is_to_end;
static char *out_text;
static size_t out_size;

/* ---- twelve devices ---------------------------------------------------------------------- */

struct defect {
    const char *name;
    void (*build)(struct loop_config *config); /* before the nodes are built */
    void (*inject)(void);                      /* once they are */
    void (*hold)(void);                        /* after every tick: the node insists on it */
    enum commission_step found_in;
    const char *says;
};

static void hold_mode(void)
{
    loop.nodes.drive[SIDE_LEFT].objects.mode_display = 1;
}

static void inject_sign(void)
{
    loop.nodes.drive[SIDE_LEFT].config.inverted = true;
}

static void inject_swapped_sensors(void)
{
    loop.nodes.assembly.legs_swapped = true;
}

static void inject_torque_constant(void)
{
    loop.nodes.drive[SIDE_LEFT].config.rated_force_N *= 0.5;
}

static void hold_temperature_unit(void)
{
    struct drive_objects *objects = &loop.nodes.drive[SIDE_RIGHT].objects;
    objects->temperature_0_1_degC =
        (int16_t)(loop.nodes.drive[SIDE_RIGHT].feedback.temperature_degC);
}

static void poll_twin(void *context, uint64_t now_ns)
{
    (void)context;
    (void)drive_node_poll(&twin, now_ns);
}

static void inject_duplicate(void)
{
    const int port = sim_bus_attach(&loop.bus, "twin", poll_twin, NULL);
    struct drive_node_config config = loop.nodes.drive[SIDE_RIGHT].config;
    ck_assert_int_ge(port, 0);
    config.node_id = (uint8_t)loop.config.subject.device.description.leg[SIDE_LEFT].leg_sensor_node;
    /* powered a moment later, so that their heartbeats fall beside each other */
    ck_assert_int_eq(drive_node_init(&twin, &config, sim_bus_port(&loop.bus, port), 30000000), 0);
    twin_runs = true;
}

static void hold_no_consumer(void)
{
    loop.nodes.drive[SIDE_LEFT].device.comm.consumer[0] = 0;
}

static void inject_gear(void)
{
    loop.nodes.drive[SIDE_LEFT].config.counts_per_m /=
        2; /* it goes twice as far as the file says */
}

/* A screw with a tenth more pitch: each push would have 1.23 times the energy. */
static void inject_scale(void)
{
    uint32_t *counts_per_m = &loop.nodes.drive[SIDE_LEFT].config.counts_per_m;
    *counts_per_m -= *counts_per_m / 10u;
}

static void inject_slip(void)
{
    loop.nodes.plant.sea[SIDE_RIGHT].params.zero_offset_m = 0.01;
}

static void hold_latch_bit(void)
{
    loop.nodes.drive[SIDE_LEFT].objects.latch_closed = 1;
    loop.nodes.drive[SIDE_LEFT].feedback.latch_holds = true;
}

static void hold_no_rpdo_timer(void)
{
    for (int i = 0; i < 4; i++) {
        loop.nodes.drive[SIDE_RIGHT].device.comm.rpdo[0].event_ms = 0;
    }
}

static void inject_wrong_sheet(void)
{
    char path[] = "/tmp/afo-eds-XXXXXX", message[OBJECT_MESSAGE_MAX];
    const int file = mkstemp(path);
    static const char text[] =
        "[FileInfo]\nFileName=other.eds\n[DeviceInfo]\nVendorNumber=0x000000FB\n"
        "ProductNumber=0x00610000\n[MandatoryObjects]\nSupportedObjects=0\n";
    ck_assert_int_eq(write(file, text, sizeof text - 1), (int)sizeof text - 1);
    close(file);
    ck_assert_int_eq(commission_read_eds(&commission.expected[SIDE_LEFT], path, message), 0);
    unlink(path);
}

/* The drives' numbers are exchanged: the left one is wired to the right leg. */

static bool drives_are_crossed;

static void inject_crossed(void)
{
    drives_are_crossed = true;
}

/* All its objects are as they must be. It only does not do what they say: it holds what it has. */
static void hold_no_unload(void)
{
    struct drive_node *drive = &loop.nodes.drive[SIDE_RIGHT];
    if (drive->unloading) {
        drive->unloading = false;
        drive->state = DRIVE_OPERATION_ENABLED;
        drive->objects.error_code = 0;
    }
}

static const struct defect defects[] = {
    {"wrong mode", NULL, NULL, hold_mode, COMMISSION_IDENTIFY,
     "left drive, node 1, refused: object 0x6061:00 (mode of operation as it displays it): expected 8, found 1"},
    {"sign", NULL, inject_sign, NULL, COMMISSION_MOVES, "direction"},
    {"sides of the sensors", NULL, inject_swapped_sensors, NULL, COMMISSION_SENSORS, "exchanged"},
    {"torque constant doubled", NULL, inject_torque_constant, NULL, COMMISSION_MOVES,
     "torque constant"},
    {"temperature unit", NULL, NULL, hold_temperature_unit, COMMISSION_IDENTIFY, "0.1 degC"},
    {"duplicate id", NULL, inject_duplicate, NULL, COMMISSION_IDENTIFY,
     "two nodes have the number"},
    {"no heartbeat consumer", NULL, NULL, hold_no_consumer, COMMISSION_IDENTIFY, "heartbeat"},
    {"wrong gear", NULL, inject_gear, NULL, COMMISSION_MOVES, "gear"},
    {"scale of 0.9", NULL, inject_scale, NULL, COMMISSION_SPRING, "gear (counts_per_m)"},
    {"slipped encoder", NULL, inject_slip, NULL, COMMISSION_REST, "slipped"},
    {"latch bit stuck", NULL, NULL, hold_latch_bit, COMMISSION_LATCH, "never changed"},
    {"RPDO time-out missing", NULL, NULL, hold_no_rpdo_timer, COMMISSION_IDENTIFY,
     "expected 50 ms, found 0 ms; key of the device file: lacks = rpdo_timer"},
    {"wrong EDS", NULL, inject_wrong_sheet, NULL, COMMISSION_IDENTIFY, "data sheet"},
    {"sides of the drives", NULL, inject_crossed, NULL, COMMISSION_MOVES, "exchanged"},
};
enum { DEFECTS = sizeof defects / sizeof defects[0] };

/* ---- the stand and the person --------------------------------------------------------------- */

/* The foot is free: what is released flies out, comes back with its motor, and is held again. */
static void let_feet_go(void)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea *sea = &loop.nodes.plant.sea[side];
        if (sea->release_pending) {
            sea_release_now(sea);
        }
        sea_lift_off(sea);
        (void)sea_reclose(sea, 0.0);
    }
}

static double lean_rad; /* how the sensors are mounted */

/* Legs hang straight down; the person swings one of them. */
static void put_legs(void)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const bool swings = hands.hand == COMMISSION_HAND_SWING && (int)hands.leg == side;
        const double part =
            swings && hands.ticks < SWING_TICKS ? (double)hands.ticks / SWING_TICKS : 0.0;
        const int sensor = loop.nodes.assembly.legs_swapped ? 1 - side : side;
        leg_sensor_node_measure(&loop.nodes.sensor[sensor], lean_rad + SWING_RAD * part, 0.0);
    }
}

/* Whose wires the person's fingers reach. */
static bool feet_are_crossed, foot_is_dead, foot_is_reversed;

static void put_feet(void)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const int pressed = feet_are_crossed ? 1 - (int)hands.leg : (int)hands.leg;
        const bool down = hands.hand == COMMISSION_HAND_SWITCH && pressed == side && !foot_is_dead;
        leg_sensor_node_measure_foot(&loop.nodes.sensor[side],
                                     down != foot_is_reversed ? FOOT_DOWN : FOOT_UP);
    }
}

static void run_tick(void)
{
    struct sea_output output;
    loop_tick(&loop);
    let_feet_go();
    put_legs();
    put_feet();
    hands.ticks++;
    loop.rig.stop_pressed = hands.hand == COMMISSION_HAND_PRESS;
    if (hands.hand == COMMISSION_HAND_TAP && hands.ticks % TAP_EVERY == 0) {
        struct sea *other = &loop.nodes.plant.sea[1 - (int)hands.leg];
        if (sea_may_release(other)) {
            sea_other_foot_contact(other, loop.nodes.plant.walk.time_s);
        }
    }
    if (twin_runs) {
        struct drive_axis_command command;
        drive_node_command(&twin, 1000000, &command);
    }
    if (defect != NULL && defect->hold != NULL) {
        defect->hold();
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        plant_sea_output(&loop.nodes.plant, (enum side)side, &output);
        largest_load_N =
            output.spring_force_N > largest_load_N ? output.spring_force_N : largest_load_N;
    }
}

static bool wait(void *context, unsigned waits)
{
    (void)context;
    run_tick();
    return waits < WAITS_MAX;
}

static bool pause_for(void *context, unsigned milliseconds)
{
    (void)context;
    for (unsigned i = 0; i < milliseconds; i++) {
        run_tick();
    }
    return !is_to_end;
}

static void instruct(void *context, enum commission_hand hand, enum side leg, const char *words)
{
    (void)context;
    (void)words;
    hands = (struct hands){hand, leg, 0};
}

/* They saw what there was to see: which motor moved. */
static int confirm(void *context, enum side leg, const char *question)
{
    (void)context;
    (void)leg;
    if (strstr(question, "motor") != NULL) {
        return drives_are_crossed ? 0 : 1;
    }
    return 1;
}

/* Who is in the stand; NULL is the paper's walker with the virtual device. */
static const char *person_path, *device_path;
static void (*change_device)(struct device_file *device);

static void mirror(struct device_file *device)
{
    device_file_set(device, SIDE_LEFT, DEVICE_LEG_direction, -1.0);
    device_file_set(device, SIDE_LEFT, DEVICE_LEG_zero_counts, 12345.0);
    device_file_set(device, SIDE_RIGHT, DEVICE_LEG_zero_counts, -777.0);
}

static void put_switches_under_feet(struct device_file *device)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(device, (enum side)leg, DEVICE_LEG_foot_switches,
                        DEVICE_SWITCHES_LEG_SENSOR);
    }
}

static void leave_left_alone(struct device_file *device)
{
    device_file_set(device, SIDE_RIGHT, DEVICE_LEG_protocol, DEVICE_NO_DRIVE_PROTOCOL);
}

static void leave_right_alone(struct device_file *device)
{
    device_file_set(device, SIDE_LEFT, DEVICE_LEG_protocol, DEVICE_NO_DRIVE_PROTOCOL);
}

static void setup(void)
{
    static struct loop_config config;
    static struct subject subject;
    struct control_params params;
    char message[LOOP_MESSAGE_MAX];
    ck_assert_msg(subject_read(&subject, person_path, device_path, message) == 0, "%s", message);
    if (change_device != NULL) {
        change_device(&subject.device);
    }
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    ck_assert_msg(loop_configure(&config, &subject, &params, 0.41, SENSORS_17BIT, 1, message) == 0,
                  "%s", message);
    config.plant.start_hold.release_tick = UINT64_MAX / 2; /* it stays in its stand */
    for (int side = 0; side < SIDE_COUNT; side++) {
        config.plant.foot_switch[side].present =
            subject.device.description.leg[side].foot_switches != DEVICE_SWITCHES_NONE;
    }
    if (defect != NULL && defect->build != NULL) {
        defect->build(&config);
    }
    memset(&commission, 0, sizeof commission);
    hands = (struct hands){COMMISSION_HAND_STAND, SIDE_LEFT, 0};
    twin_runs = is_to_end = drives_are_crossed = false;
    feet_are_crossed = foot_is_dead = foot_is_reversed = false;
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
    loop.rig.task.node.objects.walk_requested = 0;
    const int port = sim_bus_attach(&loop.bus, "tool", NULL, NULL);
    commission_declare(&commission, &subject.device);
    commission.ctl.link = (struct ctl_link){.bus = sim_bus_port(&loop.bus, port),
                                            .wait = wait,
                                            .pause = pause_for,
                                            .node = NODE_CONTROLLER};
    commission.ctl.out = open_memstream(&out_text, &out_size);
    commission.ctl.complaints = stderr;
    commission.person = (struct commission_operator){instruct, confirm, NULL};
    (void)snprintf(commission.now, sizeof commission.now, "2026-11-30 12:00");
    if (defect != NULL && defect->inject != NULL) {
        defect->inject();
    }
    for (int i = 0; i < START_TICKS; i++) {
        run_tick();
    }
    ctl_open(&commission.ctl);
    largest_load_N = 0.0;
}

static void setup_good(void)
{
    defect = NULL;
    person_path = device_path = NULL;
    change_device = NULL;
    setup();
}

static void teardown(void)
{
    fclose(commission.ctl.out);
    free(out_text);
    loop_free(&loop);
}

static double rated_N(void)
{
    return device_file_number(&loop.config.subject.device, SIDE_LEFT, DEVICE_LEG_rated_force_N);
}

/* All steps in their order, until one has failed. Returns it, or -1. */
static int run_all(void)
{
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        if (step == COMMISSION_LINK) { /* which goes to what is prescribed */
            largest_load_before_link_N = largest_load_N;
        }
        const enum commission_verdict verdict =
            commission_run(&commission, (enum commission_step)step);
        if (verdict == COMMISSION_FAILED || verdict == COMMISSION_INTERRUPTED) {
            return step;
        }
    }
    return -1;
}

static const char *all_findings(int step)
{
    static char text[COMMISSION_FINDINGS * COMMISSION_LINE];
    text[0] = '\0';
    for (unsigned i = 0; i < commission.result[step].finding_count; i++) {
        strcat(text, commission.result[step].finding[i]);
        strcat(text, "\n");
    }
    strcat(text, commission.result[step].reason);
    return text;
}

/* ---- a device that is right -------------------------------------------------------------------- */

START_TEST(a_right_device_passes_every_step)
{
    const int failed = run_all();
    ck_assert_msg(failed < 0, "%s: %s",
                  failed < 0 ? "" : commission_step_name((enum commission_step)failed),
                  failed < 0 ? "" : all_findings(failed));
    ck_assert(commission_is_complete(&commission));
    ck_assert_int_eq(commission.result[COMMISSION_SWITCHES].verdict, COMMISSION_NO_PART);
    const char *spring = commission.result[COMMISSION_SPRING].done;
    double stiffness = 0.0;
    const char *at = strstr(spring, "left leg: ");
    ck_assert_ptr_nonnull(at);
    ck_assert_int_eq(sscanf(at, "left leg: %lf N/m", &stiffness), 1);
    const double true_N_m = loop.nodes.plant.sea[SIDE_LEFT].params.spring_N_per_m;
    ck_assert_msg(stiffness > 0.95 * true_N_m && stiffness < 1.05 * true_N_m, "%s", spring);
    ck_assert_int_eq(commission.device.description.leg[SIDE_LEFT].unload, DEVICE_UNLOAD_DRIVE);
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_STANDBY);
}
END_TEST

static const struct {
    const char *person, *device;
    void (*change)(struct device_file *device);
} devices[] = {
    {NULL, NULL, mirror},
    {NULL, NULL, leave_left_alone},
    {NULL, NULL, leave_right_alone},
    {NULL, "sim_host/devices/epos4.ini", NULL},
    {NULL, "sim_host/devices/cia402.ini", NULL},
    {NULL, "sim_host/devices/odrive.ini", NULL},
    {NULL, "sim_host/devices/ak80.ini", NULL},
    {NULL, "sim_host/devices/ak80.ini", leave_left_alone},
    {NULL, "sim_host/devices/odrive.ini", leave_right_alone},
    {"sim_host/persons/adult70.ini", "sim_host/devices/virtual-adult.ini", NULL},
    {"sim_host/persons/adult70.ini", "sim_host/devices/exo50.ini", NULL},
};
enum { DEVICES = sizeof devices / sizeof devices[0] };

START_TEST(other_devices_pass_as_well)
{
    defect = NULL;
    person_path = devices[_i].person;
    device_path = devices[_i].device;
    change_device = devices[_i].change;
    setup();
    const int failed = run_all();
    ck_assert_msg(failed < 0, "%s: %s %s",
                  failed < 0 ? "" : commission_step_name((enum commission_step)failed),
                  failed < 0 ? "" : all_findings(failed),
                  failed < 0 ? "" : commission.result[failed].done);
    ck_assert(largest_load_before_link_N <= LOAD_LIMIT_SHARE * rated_N());
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *found = &commission.device.description.leg[leg];
        const struct device_leg *declared = &loop.config.subject.device.description.leg[leg];
        ck_assert_int_eq(found->unload, declared->unload);
    }
    printf("  %d %s: %s %s\n", _i, device_path != NULL ? device_path : "virtual",
           commission.result[COMMISSION_SPRING].done, commission.result[COMMISSION_BANDWIDTH].done);
    teardown();
}
END_TEST

START_TEST(loads_grow_only_behind_steps_that_passed)
{
    ck_assert_int_eq(commission_run(&commission, COMMISSION_SPRING), COMMISSION_INTERRUPTED);
    ck_assert_ptr_nonnull(strstr(commission.result[COMMISSION_SPRING].reason, "comes first"));
    ck_assert(largest_load_N == 0.0);
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_PASSED);
    ck_assert_int_eq(commission_run(&commission, COMMISSION_REST), COMMISSION_PASSED);
    ck_assert(largest_load_N < 0.001 * rated_N());
    ck_assert_int_eq(commission_run(&commission, COMMISSION_MOVES), COMMISSION_PASSED);
    ck_assert(largest_load_N < 0.05 * rated_N());
    commission_skip(&commission, COMMISSION_LATCH, "there is no foot yet");
    ck_assert_int_eq(commission_run(&commission, COMMISSION_SPRING), COMMISSION_PASSED);
    ck_assert(largest_load_N < LOAD_LIMIT_SHARE * rated_N());
    ck_assert_int_eq(commission_run(&commission, COMMISSION_MOVES), COMMISSION_PASSED); /* again */
}
END_TEST

/* Ctrl-C in the middle of a motion: the tool goes, and the controller unloads. */
START_TEST(an_interrupted_step_does_no_harm)
{
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_PASSED);
    ck_assert_int_eq(commission_run(&commission, COMMISSION_REST), COMMISSION_PASSED);
    is_to_end = true;
    ck_assert_int_eq(commission_run(&commission, COMMISSION_MOVES), COMMISSION_INTERRUPTED);
    for (int i = 0; i < 1500; i++) {
        run_tick();
    }
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_STANDBY);
    is_to_end = false;
    ck_assert_int_eq(commission_run(&commission, COMMISSION_MOVES), COMMISSION_PASSED);
}
END_TEST

/* The same without a word: the tool dies while a spring is loaded. */
START_TEST(a_tool_that_dies_leaves_no_load)
{
    struct controller_objects *objects = &loop.rig.task.node.objects;
    struct sea_output output;
    objects->motion_kind = MOTION_KIND_MOVE;
    objects->motion_share = 0.05f;
    objects->motion_seconds = 0.3f;
    objects->motion_order++;
    for (int i = 0; i < 500; i++) {
        objects->motion_renewal = (uint8_t)(objects->motion_renewal + (i % 100 == 0 ? 1 : 0));
        run_tick();
    }
    objects->motion_seconds = 20.0f;
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_COMMISSIONING);
    ck_assert(largest_load_N > 0.01 * rated_N());
    for (int i = 0; i < 1500; i++) { /* half a second of silence, and the unload */
        run_tick();
    }
    plant_sea_output(&loop.nodes.plant, SIDE_LEFT, &output);
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_STANDBY);
    ck_assert(output.spring_force_N < 0.01 * rated_N());
}
END_TEST

START_TEST(the_emergency_stop_ends_a_motion)
{
    struct controller_objects *objects = &loop.rig.task.node.objects;
    objects->motion_kind = MOTION_KIND_MOVE;
    objects->motion_share = 0.05f;
    objects->motion_seconds = 2.0f;
    objects->motion_order++;
    for (int i = 0; i < 1800; i++) {
        objects->motion_renewal = (uint8_t)(objects->motion_renewal + (i % 100 == 0 ? 1 : 0));
        run_tick();
    }
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_COMMISSIONING);
    hands.hand = COMMISSION_HAND_PRESS;
    for (int i = 0; i < 600; i++) {
        objects->motion_renewal = (uint8_t)(objects->motion_renewal + (i % 100 == 0 ? 1 : 0));
        run_tick();
    }
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(loop.rig.task.output.fault, SUPERVISOR_FAULT_EMERGENCY_STOP);
    ck_assert_int_eq(loop.rig.task.controller.motion.outcome, MOTION_INTERRUPTED);
}
END_TEST

/* ---- twelve of twelve ---------------------------------------------------------------------------- */

START_TEST(a_device_that_is_not_what_its_file_says_is_found)
{
    const bool is_paper = _i < DEFECTS;
    person_path = is_paper ? NULL : "sim_host/persons/adult70.ini";
    device_path = is_paper ? NULL : "sim_host/devices/exo50.ini";
    change_device = NULL;
    defect = &defects[_i % DEFECTS];
    setup();
    const int failed = run_all();
    printf("  %-24s %s, %4.1f %% of the rated force: %s\n", defect->name,
           failed < 0 ? "not found" : commission_step_name((enum commission_step)failed),
           100.0 * largest_load_N / rated_N(),
           failed >= 0 && commission.result[failed].finding_count > 0
               ? commission.result[failed].finding[0]
               : "-");
    ck_assert_int_eq(failed, defect->found_in);
    ck_assert_int_eq(commission.result[failed].verdict, COMMISSION_FAILED);
    ck_assert_msg(strstr(all_findings(failed), defect->says) != NULL, "%s", all_findings(failed));
    ck_assert(largest_load_N <= LOAD_LIMIT_SHARE * rated_N());
    teardown();
}
END_TEST

/* The campaign's fault of a motor's scale, on the devices that a person wears: each push of it has 1.23 times the
 * energy, and nothing tells in a walk. */
START_TEST(a_motor_scale_of_0_9_is_found_before_a_person_wears_it)
{
    static const char *const worn[] = {"sim_host/devices/virtual-adult.ini",
                                       "sim_host/devices/exo50.ini"};
    const enum side side = _i % 2 == 0 ? SIDE_LEFT : SIDE_RIGHT;
    defect = NULL;
    person_path = "sim_host/persons/adult70.ini";
    device_path = worn[_i / 2];
    change_device = NULL;
    setup();
    loop.nodes.assembly.motor_scale[side] = 0.9;
    ck_assert_int_eq(run_all(), COMMISSION_SPRING);
    const char *found = all_findings(COMMISSION_SPRING);
    printf("  %s: %s", device_path, found);
    ck_assert_uint_eq(commission.result[COMMISSION_SPRING].finding_count, 1);
    ck_assert_msg(strncmp(found, side == SIDE_LEFT ? "left leg" : "right leg", 8) == 0, "%s",
                  found);
    ck_assert_msg(strstr(found, "gear (counts_per_m)") != NULL, "%s", found);
    ck_assert(largest_load_N <= LOAD_LIMIT_SHARE * rated_N());
    teardown();
}
END_TEST

static void say_drive_unloads(struct device_file *device)
{
    device_file_set(device, SIDE_RIGHT, DEVICE_LEG_unload, DEVICE_UNLOAD_DRIVE);
}

START_TEST(a_drive_whose_protocol_cannot_unload_is_not_believed)
{
    defect = NULL;
    person_path = NULL;
    device_path = _i == 0 ? "sim_host/devices/odrive.ini" : "sim_host/devices/ak80.ini";
    change_device = say_drive_unloads;
    setup();
    ck_assert_int_eq(run_all(), COMMISSION_LINK);
    ck_assert_msg(strstr(all_findings(COMMISSION_LINK), "right drive: its protocol") != NULL, "%s",
                  all_findings(COMMISSION_LINK));
    ck_assert_uint_eq(commission.result[COMMISSION_LINK].finding_count, 1);
    ck_assert_int_eq(commission.device.description.leg[SIDE_RIGHT].unload, DEVICE_UNLOAD_NONE);
    teardown();
}
END_TEST

START_TEST(a_drive_that_does_not_unload_on_link_loss_is_found)
{
    static const struct defect no_unload = {
        "no unload", NULL, NULL, hold_no_unload, COMMISSION_LINK, "did not unload"};
    setup_good();
    for (int step = 0; step < COMMISSION_LINK; step++) {
        ck_assert_int_ne(commission_run(&commission, (enum commission_step)step),
                         COMMISSION_FAILED);
    }
    defect = &no_unload;
    ck_assert_int_eq(commission_run(&commission, COMMISSION_LINK), COMMISSION_FAILED);
    ck_assert_msg(strstr(all_findings(COMMISSION_LINK), "right drive: at 10 % of") != NULL, "%s",
                  all_findings(COMMISSION_LINK));
    ck_assert_int_eq(commission.device.description.leg[SIDE_RIGHT].unload, DEVICE_UNLOAD_NONE);
    ck_assert_int_eq(commission.device.description.leg[SIDE_LEFT].unload, DEVICE_UNLOAD_DRIVE);
    for (int i = 0; i < 2000; i++) {
        run_tick();
    }
    struct sea_output output;
    plant_sea_output(&loop.nodes.plant, SIDE_RIGHT, &output);
    ck_assert(output.spring_force_N < 0.01 * rated_N());
    defect = NULL;
    teardown();
}
END_TEST

START_TEST(foot_switches_are_read)
{
    static const struct {
        bool *defect;
        enum commission_verdict verdict;
        const char *says;
    } rows[] = {
        {NULL, COMMISSION_PASSED, ""},
        {&feet_are_crossed, COMMISSION_FAILED, "left foot: the other leg's switch followed"},
        {&foot_is_dead, COMMISSION_FAILED, "left foot: its switches were pressed, and nothing"},
        {&foot_is_reversed, COMMISSION_FAILED, "left leg: its foot switch reads pressed with"},
    };
    defect = NULL;
    person_path = device_path = NULL;
    change_device = put_switches_under_feet;
    setup();
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_PASSED);
    if (rows[_i].defect != NULL) {
        *rows[_i].defect = true;
    }
    ck_assert_int_eq(commission_run(&commission, COMMISSION_SWITCHES), rows[_i].verdict);
    ck_assert_msg(strstr(all_findings(COMMISSION_SWITCHES), rows[_i].says) != NULL, "%s",
                  all_findings(COMMISSION_SWITCHES));
    teardown();
}
END_TEST

START_TEST(a_controller_that_runs_with_another_file_is_found)
{
    setup_good();
    device_file_set(&commission.declared, SIDE_RIGHT, DEVICE_LEG_direction, -1.0);
    device_file_set(&commission.declared, SIDE_LEFT, DEVICE_LEG_spring_N_per_m, 101.0);
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_FAILED);
    const char *found = all_findings(COMMISSION_IDENTIFY);
    ck_assert_msg(strstr(found,
                         "right leg, key \"direction\": the file says -1, and the controller "
                         "runs with 1;") != NULL,
                  "%s", found);
    ck_assert_ptr_nonnull(strstr(found, "left leg, key \"spring_N_per_m\": the file says 101"));
    ck_assert_uint_eq(commission.result[COMMISSION_IDENTIFY].finding_count, 2);
    teardown();
}
END_TEST

/* It counts from what was declared, also the second time. */
START_TEST(a_zero_that_is_found_again_is_not_added_up)
{
    setup_good();
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_PASSED);
    for (int n = 0; n < 2; n++) {
        lean_rad = 0.02;
        ck_assert_int_eq(commission_run(&commission, COMMISSION_ZERO), COMMISSION_PASSED);
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            assert_close(
                device_file_number(&commission.device, (enum side)leg, DEVICE_LEG_leg_zero_rad),
                0.02, 1e-3, 0.0);
        }
    }
    lean_rad = 0.0;
    teardown();
}
END_TEST

START_TEST(a_foot_switch_that_is_not_wired_is_found)
{
    setup_good(); /* no switch is there */
    ck_assert_int_eq(commission_run(&commission, COMMISSION_IDENTIFY), COMMISSION_PASSED);
    put_switches_under_feet(&commission.device);
    ck_assert_int_eq(commission_run(&commission, COMMISSION_SWITCHES), COMMISSION_FAILED);
    ck_assert_ptr_nonnull(
        strstr(all_findings(COMMISSION_SWITCHES), "tells nothing of a foot switch"));
    teardown();
}
END_TEST

/* ---- what is written ------------------------------------------------------------------------------ */

START_TEST(a_later_run_goes_on_from_the_record)
{
    static struct commission again;
    char path[] = "/tmp/afo-record-XXXXXX", message[OBJECT_MESSAGE_MAX];
    const int file = mkstemp(path);
    FILE *stream = fdopen(file, "w");
    (void)commission_run(&commission, COMMISSION_IDENTIFY);
    commission_skip(&commission, COMMISSION_ZERO, "later; with a # sign");
    device_file_set(&commission.device, SIDE_LEFT, DEVICE_LEG_leg_zero_rad, 0.125);
    device_file_set(&commission.device, SIDE_RIGHT, DEVICE_LEG_unload, DEVICE_UNLOAD_NONE);
    commission_declare(&again, &commission.declared);
    commission.result[COMMISSION_REST].verdict = COMMISSION_FAILED;
    commission.result[COMMISSION_REST].finding_count = 1;
    strcpy(commission.result[COMMISSION_REST].finding[0], "left motor: <10 mm>");
    commission_record_write(&commission, stream);
    fclose(stream);
    ck_assert_int_eq(commission_record_read(&again, path, message), 0);
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        ck_assert_int_eq(again.result[step].verdict, commission.result[step].verdict);
    }
    ck_assert_str_eq(again.result[COMMISSION_IDENTIFY].done,
                     commission.result[COMMISSION_IDENTIFY].done);
    ck_assert_str_eq(again.result[COMMISSION_ZERO].reason, "later, with a , sign");
    ck_assert_str_eq(again.result[COMMISSION_REST].finding[0], "left motor: <10 mm>");
    ck_assert(device_file_number(&again.device, SIDE_LEFT, DEVICE_LEG_leg_zero_rad) == 0.125);
    ck_assert_int_eq(again.device.description.leg[SIDE_RIGHT].unload, DEVICE_UNLOAD_NONE);
    commission_declare(&again, &again.device); /* with the file that was written: the same device */
    ck_assert_int_eq(commission_record_read(&again, path, message), 0);
    ck_assert_str_eq(message, "");
    ck_assert_int_eq(again.result[COMMISSION_REST].verdict, COMMISSION_FAILED);
    device_file_set(&again.declared, SIDE_LEFT, DEVICE_LEG_direction, -1.0); /* edited since */
    ck_assert_int_eq(commission_record_read(&again, path, message), 0);
    ck_assert_ptr_nonnull(strstr(message, "all steps are open again"));
    ck_assert_int_eq(again.result[COMMISSION_REST].verdict, COMMISSION_NOT_DONE);
    strcpy(again.declared.name, "somebody else's");
    ck_assert_int_eq(commission_record_read(&again, path, message), -1);
    ck_assert_ptr_nonnull(strstr(message, "another device than \"somebody else's\""));
    unlink(path);
    ck_assert_int_eq(commission_record_read(&again, path, message), 0); /* none yet: all open */
    ck_assert_int_eq(again.result[COMMISSION_IDENTIFY].verdict, COMMISSION_NOT_DONE);
}
END_TEST

START_TEST(the_page_holds_what_was_found_and_says_when_it_is_not_complete)
{
    char *page = NULL;
    size_t size = 0;
    commission.result[COMMISSION_REST].verdict = COMMISSION_FAILED;
    commission.result[COMMISSION_REST].finding_count = 1;
    strcpy(commission.result[COMMISSION_REST].finding[0], "left motor: <10 mm>");
    FILE *stream = open_memstream(&page, &size);
    commission_page_write(&commission, stream);
    fclose(stream);
    ck_assert_ptr_nonnull(strstr(page, "left motor: &lt;10 mm&gt;"));
    ck_assert_ptr_nonnull(strstr(page, "NOT COMPLETE"));
    ck_assert_ptr_nonnull(strstr(page, "signature"));
    ck_assert_ptr_nonnull(strstr(page, "counts_per_m = 13107200"));
    ck_assert_ptr_null(strstr(page, "http"));
    free(page);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("commission");
    TCase *good = tcase_create("a right device");
    tcase_set_timeout(good, 120);
    tcase_add_checked_fixture(good, setup_good, teardown);
    tcase_add_test(good, a_right_device_passes_every_step);
    tcase_add_test(good, loads_grow_only_behind_steps_that_passed);
    tcase_add_test(good, an_interrupted_step_does_no_harm);
    tcase_add_test(good, a_tool_that_dies_leaves_no_load);
    tcase_add_test(good, the_emergency_stop_ends_a_motion);
    tcase_add_test(good, a_later_run_goes_on_from_the_record);
    tcase_add_test(good, the_page_holds_what_was_found_and_says_when_it_is_not_complete);
    suite_add_tcase(suite, good);
    TCase *others = tcase_create("other devices");
    tcase_set_timeout(others, 120);
    tcase_add_loop_test(others, other_devices_pass_as_well, 0, DEVICES);
    suite_add_tcase(suite, others);
    TCase *wrong = tcase_create("devices that are not what their file says");
    tcase_set_timeout(wrong, 120);
    tcase_add_loop_test(wrong, a_device_that_is_not_what_its_file_says_is_found, 0, 2 * DEFECTS);
    tcase_add_loop_test(wrong, a_motor_scale_of_0_9_is_found_before_a_person_wears_it, 0, 4);
    tcase_add_loop_test(wrong, foot_switches_are_read, 0, 4);
    tcase_add_test(wrong, a_controller_that_runs_with_another_file_is_found);
    tcase_add_test(wrong, a_zero_that_is_found_again_is_not_added_up);
    tcase_add_test(wrong, a_foot_switch_that_is_not_wired_is_found);
    tcase_add_loop_test(wrong, a_drive_whose_protocol_cannot_unload_is_not_believed, 0, 2);
    tcase_add_test(wrong, a_drive_that_does_not_unload_on_link_loss_is_found);
    suite_add_tcase(suite, wrong);
    return run_suite(suite);
}
