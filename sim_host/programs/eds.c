/* afo eds: writes the data sheets (EDS) of all nodes and the DBC of the bus from the
 * tables the code itself uses. */
#include <stdio.h>
#include <string.h>

#include "firmware/controller_node.h"
#include "hal/bus/frame_table.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/nodes/dbc_writer.h"
#include "sim_host/nodes/drive_node.h"
#include "sim_host/nodes/eds_writer.h"
#include "sim_host/nodes/leg_sensor_node.h"
#include "sim_host/programs/commands.h"
#include "sim_host/subjects/subject.h"

enum { OTHER_NUMBERS = 40 };

/* A bus on which nobody listens: the devices are only built, not run. */
static enum can_result send_nowhere(void *context, const struct can_msg *message)
{
    (void)context;
    (void)message;
    return CAN_OK;
}

static const struct can_bus_ops nowhere_ops = {.send = send_nowhere};

struct devices {
    struct drive_node drive[SIDE_COUNT];
    struct leg_sensor_node sensor[SIDE_COUNT];
    struct control_params params;
    struct controller_node controller;
};

static int build_nodes(struct devices *devices, const struct drive_node_config *drives,
                       bool ankle_is_lever, int number_offset)
{
    const struct can_bus bus = {.ops = &nowhere_ops};
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct drive_node_config drive = *drives;
        drive.side = (enum side)side;
        drive.node_id = (uint8_t)(NODE_DRIVE_LEFT + side + number_offset);
        const struct leg_sensor_node_config sensor = {
            .side = (enum side)side,
            .node_id = (uint8_t)(NODE_SENSOR_LEFT + side + number_offset),
            .ankle_is_lever = ankle_is_lever};
        if (drive_node_init(&devices->drive[side], &drive, bus, 0) != 0 ||
            leg_sensor_node_init(&devices->sensor[side], &sensor, bus, 0) != 0) {
            return -1;
        }
    }
    return 0;
}

/* The paper's walker: 0.35 m of stroke, a 16-bit encoder on a 5 mm screw; a controller that keeps
 * nothing. */
static int build(struct devices *devices)
{
    const struct drive_node_config drive = {.counts_per_m = 13107200,
                                            .stroke_m = 0.35,
                                            .rated_force_N = 1.0,
                                            .following_error_m = 0.1,
                                            .unload_rate_m_per_s = 0.5};
    const struct can_bus bus = {.ops = &nowhere_ops};
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    if (build_nodes(devices, &drive, false, 0) != 0 ||
        subject_control_params(&subject, &devices->params, message) != 0) {
        return -1;
    }
    return controller_node_init(&devices->controller, &devices->params, 0.0F, false, bus);
}

/* The same types with all settings different, other node numbers, of another build; a controller that
 * walks, keeps settings and a black box, and has crashed. */
static int build_others(struct devices *devices)
{
    static const struct controller_settings_store_ops store;
    static struct black_box box;
    static struct crash_record crash;
    const struct drive_node_config drive = {.counts_per_m = 50000,
                                            .zero_counts = 1000,
                                            .inverted = true,
                                            .stroke_m = 0.1,
                                            .max_speed_m_per_s = 0.25,
                                            .rated_force_N = 900.0,
                                            .following_error_m = 0.02,
                                            .unload_rate_m_per_s = 0.2};
    const struct can_bus bus = {.ops = &nowhere_ops};
    struct controller_node *controller = &devices->controller;
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    if (build_nodes(devices, &drive, true, OTHER_NUMBERS) != 0 ||
        subject_control_params(&subject, &devices->params, message) != 0) {
        return -1;
    }
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) { /* nobody walks with them */
        *(float *)((char *)&devices->params + control_param_descriptors[i].offset) += 1.0f;
    }
    if (controller_node_init(controller, &devices->params, 0.5F, true, bus) != 0) {
        return -1;
    }
    crash.cause = CRASH_HARD_FAULT;
    crash_record_seal(&crash);
    black_box_start(&box, 0, 0);
    controller_node_attach(controller, &store, NULL, &box, &crash, NULL);
    controller->objects.build_id++;
    controller->objects.version[0]++;
    controller->device.comm.software_version[0]++;
    return 0;
}

static int write_one(const char *directory, const char *name, struct co_device *device,
                     struct co_device *other, const char *description)
{
    char path[OUTPUT_PATH_MAX];
    char message[OUTPUT_PATH_MAX + 256];
    struct output_file file;
    memset(&file, 0, sizeof file);
    if (snprintf(path, sizeof path, "%s/%s", directory, name) >= (int)sizeof path) {
        return program_complain("the path of the directory is too long");
    }
    if (output_file_open(&file, path, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    const struct eds_text text = {name, description};
    const struct eds_subject subject = {device, other};
    const bool written =
        device == NULL ? dbc_write(file.stream) : eds_write(file.stream, &subject, &text);
    if (!written && ferror(file.stream) == 0) {
        output_file_discard(&file);
        return program_complain("%s: a name in the dictionary has one of = ; or a line end", name);
    }
    if (output_file_commit(&file, message, sizeof message) != 0 || !written) {
        return program_complain("%s", message);
    }
    return 0;
}

static error_t take_option(int key, char *text, struct argp_state *state)
{
    const char **directory = state->input;
    if (key == ARGP_KEY_ARG && *directory == NULL) {
        *directory = text;
        return 0;
    }
    if (key == ARGP_KEY_ARG) {
        option_refuse_argument(state, text);
    }
    if (key == ARGP_KEY_END && *directory == NULL) {
        argp_error(state, "a directory must be given");
    }
    return key == ARGP_KEY_ARG || key == ARGP_KEY_END ? 0 : ARGP_ERR_UNKNOWN;
}

int afo_eds(int argc, char **argv)
{
    static const struct argp parser = {
        0,
        take_option,
        "DIRECTORY",
        "Writes drive-left.eds, drive-right.eds, sensor-left.eds, sensor-right.eds, "
        "controller.eds and afo.dbc into DIRECTORY, from the object dictionaries and the frame "
        "table.\v"
        "Exit status: 0 written, 2 wrong usage or not written.",
        0,
        0,
        0};
    static struct devices devices, others;
    const char *directory = NULL;
    option_parse(&parser, argc, argv, &directory);
    if (build(&devices) != 0 || build_others(&others) != 0) {
        program_complain("the devices cannot be built");
        return EXIT_USAGE;
    }
    const struct {
        const char *name;
        struct co_device *device, *other;
        const char *description;
    } files[] = {
        {"drive-left.eds", &devices.drive[0].device, &others.drive[0].device, "SEA drive, left"},
        {"drive-right.eds", &devices.drive[1].device, &others.drive[1].device, "SEA drive, right"},
        {"sensor-left.eds", &devices.sensor[0].device, &others.sensor[0].device,
         "Leg sensor, left"},
        {"sensor-right.eds", &devices.sensor[1].device, &others.sensor[1].device,
         "Leg sensor, right"},
        {"controller.eds", &devices.controller.device, &others.controller.device, "AFO controller"},
        {"afo.dbc", NULL, NULL, ""},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (write_one(directory, files[i].name, files[i].device, files[i].other,
                      files[i].description) != 0) {
            return EXIT_USAGE;
        }
    }
    return EXIT_GOOD;
}
