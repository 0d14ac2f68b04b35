/* afo import: a file of a gait laboratory as the recording that afo sim --recording plays; a log of another CAN tool as
 * one that afo replay reads. The files are read in Python (sim_host/formats). */
#include <stdbool.h>
#include <stdio.h>

#include "firmware/version.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/python_tool.h"

enum {
    KEY_FROM = 0xA00,
    KEY_FORCES,
    KEY_COLUMN,
    KEY_MARKER,
    KEY_ANGLES,
    KEY_TIME,
    KEY_RATE,
    KEY_CONTACT_OVER,
    KEY_REVERSE,
    KEY_SWAP,
    KEY_ANKLE_NEUTRAL,
    KEY_LONGEST_GAP,
    KEY_PART,
    KEY_INTERFACE,
    WORDS_MAX = 128
};

struct options {
    const char *file;
    const char *word[WORDS_MAX]; /* for the tool; two are its own, the last is NULL */
    int count;
};

static const char doc[] =
    "Makes the recording that afo sim --recording plays, from a C3D file, OpenSim's markers (.trc) or joint angles (.mot, "
    ".sto), or a table in a text file: any separator, decimal commas, ms, degrees or radians, contact as a number or a force. "
    "Tells what it took for what, fills short gaps, and checks signs, units and sides. Without --out it only tells. "
    "Vector's .asc and PEAK's .trc become logs for afo replay.\v"
    "Roles are time; thigh_l, thigh_r, shank_l and shank_r, the segment's pitch from the vertical with the lower end forward "
    "positive; ankle_l and ankle_r, dorsiflexion positive; contact_l and contact_r. A table may have joint angles instead: "
    "pelvis, hip_l, hip_r, knee_l, knee_r. Markers have the roles hip_l, knee_l, ankle_l, heel_l, toe_l and asi_l, psi_l, "
    "from which a hip is computed, and the same of the right leg.\n\n"
    "  afo import walk.c3d --out walk.csv\n"
    "  afo import ik.mot --forces grf.mot --out walk.csv\n"
    "  afo import imu.txt --column thigh_l=LTHI --reverse shank_l --out walk.csv\n"
    "  afo import bus.asc --interface can1 --out bus.log\n\n"
    "Exit status: 0 written and nothing looks wrong, 1 written but a check found something, 2 wrong usage, or a file that "
    "cannot be read.";

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "What comes out:", 1},
    {"out", 'o', "FILE", 0, "write there; FILE.json beside it says from what", 0},
    {0, 0, 0, 0, "What the file is:", 2},
    {"from", KEY_FROM, "KIND", 0,
     "c3d, trc, mot (also .sto), table or log (default: by the file's name)", 0},
    {"forces", KEY_FORCES, "FILE", 0,
     "OpenSim's ground reaction forces (.mot, .sto) of the same walk: contacts are taken from it",
     0},
    {"column", KEY_COLUMN, "ROLE=NAME", 0, "this column of a table; no name: there is none", 0},
    {"marker", KEY_MARKER, "ROLE=NAME", 0, "this marker of a C3D or .trc file, such as knee_l=LKNE",
     0},
    {"angles", KEY_ANGLES, "UNIT", 0, "of a table: deg or rad (default: by names, units or size)",
     0},
    {"time", KEY_TIME, "UNIT", 0, "of a table: s, ms or us (default: by names, units or size)", 0},
    {"rate", KEY_RATE, "HZ", 0, "samples a second of a table without times", 0},
    {"contact-over", KEY_CONTACT_OVER, "VALUE", 0,
     "a foot is down above this force or number (default: 20 N, 0.03 body weights, or the larger of two numbers)",
     0},
    {"interface", KEY_INTERFACE, "NAME", 0, "of a log with several: can0, can1, ... (default: all)",
     0},
    {0, 0, 0, 0, "What to mend:", 3},
    {"reverse", KEY_REVERSE, "ROLE", 0, "turn the sign of an angle, such as shank_l", 0},
    {"swap", KEY_SWAP, "PART", 0, "left is right: thigh, shank, ankle or contact", 0},
    {"ankle-neutral", KEY_ANKLE_NEUTRAL, "DEG", 0,
     "angle of the file's ankles at which a person stands; it is subtracted", 0},
    {"longest-gap", KEY_LONGEST_GAP, "S", 0,
     "fill gaps up to this length, cut at longer ones (default 0.1)", 0},
    {"part", KEY_PART, "N", 0, "keep this part where gaps cut the walk (default: the longest)", 0},
    {0}};

static void pass(struct options *options, struct argp_state *state, const char *name,
                 const char *text)
{
    if (options->count + 8 > WORDS_MAX) {
        argp_error(state, "too many options");
        return;
    }
    options->word[options->count++] = name;
    options->word[options->count++] = text;
}

static const char *const kinds[] = {"c3d", "trc", "mot", "table", "log"};
static const char *const units[] = {"deg", "rad"};
static const char *const clocks[] = {"s", "ms", "us"};
static const char *const parts[] = {"thigh", "shank", "ankle", "contact"};

#define NAMES(list) (list), sizeof(list) / sizeof(list)[0]

/* What is handed on to the importer, and what it has to be: one of the names, a number between low and high, or any
 * text (neither). */
static const struct handed {
    int key;
    const char *name;
    const char *const *names;
    size_t count;
    double low, high;
} handed[] = {
    {'o', "--out", NULL, 0, 0.0, 0.0},
    {KEY_FROM, "--from", NAMES(kinds), 0.0, 0.0},
    {KEY_FORCES, "--forces", NULL, 0, 0.0, 0.0},
    {KEY_COLUMN, "--column", NULL, 0, 0.0, 0.0},
    {KEY_MARKER, "--marker", NULL, 0, 0.0, 0.0},
    {KEY_ANGLES, "--angles", NAMES(units), 0.0, 0.0},
    {KEY_TIME, "--time", NAMES(clocks), 0.0, 0.0},
    {KEY_REVERSE, "--reverse", NULL, 0, 0.0, 0.0},
    {KEY_SWAP, "--swap", NAMES(parts), 0.0, 0.0},
    {KEY_INTERFACE, "--interface", NULL, 0, 0.0, 0.0},
    {KEY_RATE, "--rate", NULL, 0, 1.0, 1e5},
    {KEY_CONTACT_OVER, "--contact-over", NULL, 0, -1e6, 1e6},
    {KEY_ANKLE_NEUTRAL, "--ankle-neutral", NULL, 0, -90.0, 90.0},
    {KEY_LONGEST_GAP, "--longest-gap", NULL, 0, 0.0, 10.0},
};

static bool hand_on(struct options *options, int key, const char *text, struct argp_state *state)
{
    for (size_t i = 0; i < sizeof handed / sizeof handed[0]; i++) {
        const struct handed *one = &handed[i];
        if (one->key == key) {
            if (one->names != NULL) {
                (void)option_choice(state, one->name, text, one->names, one->count,
                                    sizeof one->names[0]);
            } else if (one->low < one->high) {
                (void)option_number(state, one->name, text, one->low, one->high);
            }
            pass(options, state, one->name, text);
            return true;
        }
    }
    return false;
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    if (hand_on(options, key, text, state)) {
        return 0;
    }
    switch (key) {
    case KEY_PART:
        (void)option_whole(state, "--part", text, 1, 1000000);
        pass(options, state, "--part", text);
        return 0;
    case ARGP_KEY_ARG:
        if (options->file != NULL) {
            argp_error(state, "one file, found also \"%s\"; forces of the same walk: --forces FILE",
                       text);
        }
        options->file = text;
        return 0;
    case ARGP_KEY_END:
        if (options->file == NULL) {
            argp_error(state, "which file? afo import FILE --out FILE.csv");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int afo_import(int argc, char **argv)
{
    static const struct argp parser = {option_list, take, "FILE", doc, 0, 0, 0};
    static struct python_tool tool;
    struct options options = {.count = 2};
    option_parse(&parser, argc, argv, &options);
    if (python_tool_find(&tool, "formats", "recording_import.py") == 0) {
        options.word[options.count++] = "--version";
        options.word[options.count++] = version_text();
        options.word[options.count++] = "--";
        options.word[options.count++] = options.file;
        options.word[options.count] = NULL;
        python_tool_become(&tool, options.word);
    }
    return EXIT_USAGE;
}
