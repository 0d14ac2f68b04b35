/* afo device: what a device file says, whether it fits, and how an old subject file becomes two. */
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/devices/device_frames.h"
#include "sim_host/devices/device_import.h"
#include "sim_host/devices/device_text.h"
#include "sim_host/programs/commands.h"
#include "sim_host/subjects/actuators.h"
#include "sim_host/subjects/old_subject.h"

enum { FILES_MAX = 3 };

struct arguments {
    int files, least, most;
    const char *person; /* --person of check */
    const char *path[FILES_MAX];
};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct arguments *arguments = (struct arguments *)state->input;
    switch (key) {
    case 'p':
        arguments->person = text;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->files == arguments->most) {
            argp_error(state, "one file too many: \"%s\"", text);
        }
        arguments->path[arguments->files++] = text;
        return 0;
    case ARGP_KEY_END:
        if (arguments->files < arguments->least) {
            argp_error(state, "a file is missing");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void read_arguments(struct arguments *arguments, int argc, char **argv, const char *usage,
                           const char *doc)
{
    const struct argp parser = {0, take, usage, doc, 0, 0, 0};
    option_parse(&parser, argc, argv, arguments);
}

static int read_device(const char *path, struct device_file *file)
{
    char message[DEVICE_MESSAGE_MAX] = "";
    if (path == NULL) {
        device_file_default(file);
        return 0;
    }
    return device_file_read(file, path, message) == 0 ? 0 : program_complain("%s", message);
}

/* ---- check ------------------------------------------------------------------- */

/* What a device that fits still cannot do. */
static void print_limits(const struct device_description *device)
{
    struct device_refusal refusal;
    char reason[DEVICE_MESSAGE_MAX];
    if (device_check_person(device, &refusal) != DEVICE_OK) {
        device_refusal_text(&refusal, reason, sizeof reason);
        printf("  %s\n", reason);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        if (!device_leg_is_driven(own)) {
            printf("  %s: no drive, sensors only\n", device_leg_name(leg));
        } else if (own->unload == DEVICE_UNLOAD_NONE) {
            printf("  %s: not safe on link loss: nothing is declared that unloads the spring\n",
                   device_leg_name(leg));
        }
    }
}

/* Its [plant] sections: whoever walks with the device in simulation reads them. */
static int check_plant(const char *path, const struct device_file *file)
{
    char message[ACTUATORS_MESSAGE_MAX] = "";
    struct actuators actuators;
    return actuators_of(file, path, &actuators, message) == 0 ? 0 : program_complain("%s", message);
}

/* With this person in it: their prescription within its limits, and a latch that reports for a body. */
static int check_person(const char *path, const char *device_path)
{
    static struct control_params params;
    static struct subject subject;
    struct walk_options options;
    char message[SUBJECT_MESSAGE_MAX] = "";
    double speed_rad_s;
    walk_options_init(&options);
    options.person_path = path;
    options.device_path = device_path;
    if (walk_options_resolve(&options, &subject, &params, &speed_rad_s, message) != 0) {
        return program_complain("%s", message);
    }
    return 0;
}

static int check(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"person", 'p', "FILE", 0, "with this person in it: does it suit them, may they wear it?",
         0},
        {0}};
    const struct argp parser = {options,
                                take,
                                "DEVICE.ini",
                                "Checks a device file, and says what the device cannot do.\v"
                                "Exit status: 0 it fits, 1 not, 2 wrong usage.",
                                0,
                                0,
                                0};
    struct arguments arguments = {.least = 1, .most = 1};
    struct device_file file;
    option_parse(&parser, argc, argv, &arguments);
    if (read_device(arguments.path[0], &file) != 0 || check_plant(arguments.path[0], &file) != 0) {
        return EXIT_BAD;
    }
    if (arguments.person != NULL && check_person(arguments.person, arguments.path[0]) != 0) {
        return EXIT_BAD;
    }
    printf("%s: fits%s%s\n", file.name, arguments.person != NULL ? ", with " : "",
           arguments.person != NULL ? arguments.person : "");
    print_limits(&file.description);
    return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
}

/* ---- show and keys -------------------------------------------------------------- */

static int show(int argc, char **argv)
{
    struct arguments arguments = {.most = 1};
    struct device_file file;
    read_arguments(&arguments, argc, argv, "[DEVICE.ini]",
                   "Prints a device file with all of its keys and what they mean; without a file "
                   "the virtual device.\v"
                   "Exit status: 0 printed, 1 the file is refused, 2 wrong usage.");
    if (read_device(arguments.path[0], &file) != 0) {
        return EXIT_BAD;
    }
    device_file_write(stdout, &file);
    return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
}

static void print_key(unsigned index, unsigned key, const struct device_key *row)
{
    char fallback[DEVICE_VALUE_TEXT_MAX] = "has to be said";
    if (row->fallback != DEVICE_ASKED) {
        device_value_text(row, (double)row->fallback, fallback, sizeof fallback);
    }
    printf("%-22s 0x%04X:%02X  ", row->name, index, key + 1);
    if (row->type == DEVICE_FLOAT || row->type == DEVICE_INT) {
        printf("%g to %g%s%s", (double)row->minimum, (double)row->maximum,
               row->unit[0] != '\0' ? " " : "", row->unit);
    } else {
        printf("%s", row->type == DEVICE_OBJECT ? "an object, as 0x2101:00" : row->unit);
    }
    printf("; %s\n    %s\n", fallback, row->meaning);
}

static void print_plant_key(const struct sea_key *row)
{
    char fallback[32] = "has to be said";
    if (row->fallback == row->fallback) {
        snprintf(fallback, sizeof fallback, "%g", row->fallback);
    }
    printf("%-27s [plant]  %g to %g%s%s; %s\n    %s\n", row->name, row->minimum, row->maximum,
           row->unit[0] != '\0' ? " " : "", row->unit, fallback, row->meaning);
}

static int keys(int argc, char **argv)
{
    struct arguments arguments = {0};
    read_arguments(&arguments, argc, argv, "",
                   "Lists the keys of device files: name, object of the controller's node (left "
                   "leg; the right one's is 0x2052), range, and what holds without it.");
    for (unsigned key = 0; key < DEVICE_COMMON_COUNT; key++) {
        print_key(DEVICE_INDEX_COMMON, key, &device_common_keys[key]);
    }
    for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
        print_key(DEVICE_INDEX_LEFT, key, &device_leg_keys[key]);
    }
    for (int key = 0; key < SEA_KEYS; key++) {
        print_plant_key(&sea_keys[key]);
    }
    printf("spring_table, lever_table   [plant]  up to %d points, as 0.01 80, 0.02 200\n",
           SEA_TABLE_POINTS);
    return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
}

/* ---- frames ------------------------------------------------------------------------ */

static void print_frame(const struct device_frame *frame)
{
    char period[32], deadline[32];
    snprintf(period, sizeof period, frame->in_ticks ? "FRAME_TICKS(%u)" : "%u", frame->period);
    snprintf(deadline, sizeof deadline, frame->in_ticks ? "FRAME_TICKS(%u)" : "%u",
             frame->deadline);
    printf("X(%s, 0x%03X, %u, %s, %s, %u, %c)\n", frame->name, frame->id, frame->bytes, period,
           deadline, frame->node, frame->kind);
}

static int frames(int argc, char **argv)
{
    struct arguments arguments = {.most = 1};
    struct device_file file;
    struct device_frame table[DEVICE_FRAMES_MAX];
    read_arguments(&arguments, argc, argv, "[DEVICE.ini]",
                   "Prints every frame on the bus of a device, a row each as in "
                   "hal/bus/frame_table.h: afo device frames FILE | scripts/bus-budget --frames "
                   "- --bitrate 1000000 --emergencies 1\v"
                   "Exit status: 0 printed, 1 the file is refused, 2 wrong usage.");
    if (read_device(arguments.path[0], &file) != 0) {
        return EXIT_BAD;
    }
    const unsigned count = device_frames(&file.description, table);
    for (unsigned i = 0; i < count; i++) {
        print_frame(&table[i]);
    }
    return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
}

/* ---- import ------------------------------------------------------------------------- */

static void print_lacks(uint32_t lacks)
{
    for (unsigned lack = 0; lack < DEVICE_LACKS_COUNT; lack++) {
        if ((lacks >> lack & 1u) != 0) {
            printf("; without %s: %s\n", device_lack_objects((enum device_lack)lack),
                   device_lack_cost((enum device_lack)lack));
        }
    }
}

static void print_import(const struct eds_file *eds, const struct device_import *import)
{
    char lacks[DEVICE_VALUE_TEXT_MAX];
    device_value_text(&device_leg_keys[DEVICE_LEG_lacks], (double)import->lacks, lacks,
                      sizeof lacks);
    printf("; %s, %s\n", eds->vendor, eds->product);
    print_lacks(import->lacks);
    printf(
        "; what it does when the link is lost is not in its data sheet: show it, and say in unload what makes "
        "the spring safe\n[both]\nprotocol = cia402\nmode = %s\nlacks = %s\nunload = none\n",
        import->mode == DEVICE_MODE_CSP ? "csp" : "interpolated", lacks);
    printf(
        "; to be said by you (afo device keys): drive_node, direction, zero_counts, counts_per_m, "
        "rated_force_N, spring_N_per_m, stroke_max_m, speed_max_m_s, force_max_N, latch, "
        "leg_sensor_node\n");
}

static int import(int argc, char **argv)
{
    struct arguments arguments = {.least = 1, .most = 1};
    struct eds_file eds;
    struct device_import import;
    char message[EDS_MESSAGE_MAX] = "";
    read_arguments(
        &arguments, argc, argv, "FILE.eds",
        "Reads a drive's data sheet, and prints what a device file says of such a drive: "
        "what fits, what is missing, and what that costs.\v"
        "Exit status: 0 printed, 1 such a drive cannot be used, 2 wrong usage or file.");
    if (eds_file_read(&eds, arguments.path[0], message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    device_import_judge(&eds, &import);
    if (import.fits) {
        print_import(&eds, &import);
    } else {
        program_complain("%s: %s, %s, cannot be used: %s", arguments.path[0], eds.vendor,
                         eds.product, import.reason);
    }
    eds_file_free(&eds);
    if (program_output_done() != 0) {
        return EXIT_USAGE;
    }
    return import.fits ? EXIT_GOOD : EXIT_BAD;
}

/* ---- convert ---------------------------------------------------------------------- */

static int write_both(const char *const *path, const struct person *person,
                      const struct device_file *device)
{
    static struct output_file out[2];
    char message[OUTPUT_PATH_MAX + DEVICE_MESSAGE_MAX] = "";
    int result = output_file_open(&out[0], path[0], message, sizeof message);
    result = result == 0 ? output_file_open(&out[1], path[1], message, sizeof message) : result;
    if (result == 0) {
        person_write(out[0].stream, person);
        device_file_write(out[1].stream, device);
        result = output_file_commit(&out[0], message, sizeof message);
    }
    result = result == 0 ? output_file_commit(&out[1], message, sizeof message) : result;
    output_file_discard(&out[0]);
    output_file_discard(&out[1]);
    return result == 0 ? EXIT_GOOD : (program_complain("%s", message), EXIT_BAD);
}

static int convert(int argc, char **argv)
{
    struct arguments arguments = {.least = 3, .most = 3};
    struct old_subject subject;
    struct person person;
    struct device_file device;
    struct device_refusal refusal;
    char message[OLD_SUBJECT_MESSAGE_MAX] = "";
    read_arguments(&arguments, argc, argv, "OLD.ini PERSON.ini DEVICE.ini",
                   "Parts a subject file, as there was one for person and device together, into a "
                   "person file and a device file.\v"
                   "Exit status: 0 written, 1 not, 2 wrong usage.");
    if (old_subject_read(&subject, arguments.path[0], message) != 0) {
        program_complain("%s", message);
        return EXIT_BAD;
    }
    old_subject_part(&subject, &person, &device);
    if (device_check(&device.description, &refusal) != DEVICE_OK) {
        device_refusal_text(&refusal, message, sizeof message);
        program_complain("%s: %s", arguments.path[0], message);
        return EXIT_BAD;
    }
    return write_both(arguments.path + 1, &person, &device);
}

int afo_device(int argc, char **argv)
{
    static const struct program_command table[] = {
        {"check", check, "whether a device file fits, and what the device cannot do"},
        {"show", show, "a device file with all of its keys"},
        {"keys", keys, "the keys of device files, with ranges"},
        {"frames", frames, "every frame on the bus of a device, for scripts/bus-budget"},
        {"import", import, "what a device file says of a drive, by its data sheet (EDS)"},
        {"convert", convert, "an old subject file into a person file and a device file"},
    };
    static const struct program_commands commands = {
        "device command", "Device files: what hangs on the bus, leg by leg.", table,
        sizeof table / sizeof table[0]};
    return program_dispatch(&commands, argc, argv);
}
