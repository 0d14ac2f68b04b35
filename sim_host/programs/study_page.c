/* afo study page: the paper's page for any walker. It is written in Python (sim_host/study/page). */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/python_tool.h"
#include "sim_host/subjects/subject.h"

enum { KEY_PERSON = 0x100, KEY_DEVICE, KEY_OUT, KEY_QUICK, NUMBERS = 5, NUMBER_TEXT = 32 };

struct options {
    struct subject subject;
    double number[NUMBERS]; /* M, m, l, k, g; 0: the subject's */
    const char *out;
    bool quick;
};

static const struct argp_option option_list[] = {
    {"person", KEY_PERSON, "FILE", 0, "person file (INI; default: the paper's walker)", 1},
    {"device", KEY_DEVICE, "FILE", 0,
     "device file, for the spring (INI; default: the virtual device)", 1},
    {"M", 'M', "KG", 0, "hip mass, in the place of the person's", 2},
    {"m", 'm', "KG", 0, "mass of one leg", 2},
    {"l", 'l', "M", 0, "leg length", 2},
    {"k", 'k', "N/M", 0, "ankle stiffness, in the place of the device's", 2},
    {"g", 'g', "M/S2", 0, "gravity", 2},
    {"out", KEY_OUT, "FOLDER", 0, "for the page, its figures and numbers (default: page)", 3},
    {"quick", KEY_QUICK, 0, 0, "coarse, in some seconds", 3},
    {0}};
static const char number_keys[NUMBERS] = {'M', 'm', 'l', 'k', 'g'};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    char message[SUBJECT_MESSAGE_MAX], name[] = "--?";
    switch (key) {
    case KEY_PERSON:
        if (person_read(&options->subject.person, text, message) != 0) {
            argp_failure(state, EXIT_USAGE, 0, "%s", message);
        }
        return 0;
    case KEY_DEVICE:
        if (device_file_read(&options->subject.device, text, message) != 0) {
            argp_failure(state, EXIT_USAGE, 0, "%s", message);
        }
        return 0;
    case KEY_OUT:
        options->out = text;
        return 0;
    case KEY_QUICK:
        options->quick = true;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    default:
        for (int i = 0; i < NUMBERS; i++) {
            if (key == number_keys[i]) {
                name[2] = number_keys[i];
                options->number[i] = option_number(state, name, text, 1e-6, 1e9);
                return 0;
            }
        }
        return ARGP_ERR_UNKNOWN;
    }
}

/* Makes the folder and asks whether it can be written. 0, or -1 behind a complaint. */
static int make_folder(const char *path)
{
    if ((mkdir(path, 0777) != 0 && errno != EEXIST) || access(path, W_OK | X_OK) != 0) {
        return program_complain("--out %s: %s", path, strerror(errno));
    }
    return 0;
}

static void choose_numbers(struct options *options)
{
    const struct person *person = &options->subject.person;
    const double own[NUMBERS] = {person->torso_mass_kg, person->leg_mass_kg, person->leg_length_m,
                                 subject_spring_N_per_m(&options->subject), person->gravity_m_s2};
    for (int i = 0; i < NUMBERS; i++) {
        options->number[i] = options->number[i] > 0.0 ? options->number[i] : own[i];
    }
}

int afo_study_page(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Makes the paper's tables and figures for any walker: its gait, period doublings, eigenvalues, basins, long runs "
        "and the step law, in FOLDER/index.html.\v"
        "  afo study page --person adult70.ini --device virtual-adult.ini --out adult\n"
        "  afo study page --k 80 --out softer\n\n"
        "All ranges are the paper's in this walker's units of length and time.\n"
        "Exit status: 0 made, 1 the walker has no steady gait to begin with, 2 wrong usage, or what cannot be written.",
        0,
        0,
        0};
    static struct python_tool tool;
    static char number[NUMBERS][NUMBER_TEXT], command[4096];
    static struct options options;
    options = (struct options){.out = "page"};
    subject_default(&options.subject);
    option_parse(&parser, argc, argv, &options);
    choose_numbers(&options);
    for (int i = 0; i < NUMBERS; i++) {
        (void)snprintf(number[i], NUMBER_TEXT, "%.17g", options.number[i]);
    }
    program_command_text(argc, argv, command, sizeof command);
    if (make_folder(options.out) == 0 &&
        python_tool_find(&tool, "study/page", "study_page.py") == 0) {
        const char *words[] = {
            NULL,        NULL,        "--afo",   tool.program,
            "--out",     options.out, "--who",   options.subject.person.name,
            "--command", command,     number[0], number[1],
            number[2],   number[3],   number[4], options.quick ? "--quick" : NULL,
            NULL};
        python_tool_become(&tool, words);
    }
    return EXIT_USAGE;
}
