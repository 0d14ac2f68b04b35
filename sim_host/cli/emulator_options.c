#include "sim_host/cli/emulator_options.h"

#include "sim_host/cli/option.h"

enum { KEY_IMAGE = 0x800, KEY_STEPS, KEY_CORRUPT };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The image:", 2},
    {"image", KEY_IMAGE, "ELF", 0,
     "what the emulator runs (build/arm/afo-mps2-an386.elf; g474: build/arm/afo-nucleo-g474re.bin)",
     0},
    {"steps", KEY_STEPS, "N", 0,
     "walk this many steps (pil: 200; slcan, where one takes some seconds: 3)", 0},
    {"corrupt", KEY_CORRUPT, "N", 0, "flip a bit of the image's N-th frame: must be noticed", 0},
    {0, 0, 0, 0, "What comes out:", 4},
    {"json", 'j', 0, 0, "one JSON object on standard output", 0},
    {"quiet", 'q', 0, 0, "no report", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct emulator_options *options = (struct emulator_options *)state->input;
    switch (key) {
    case KEY_IMAGE:
        options->image = text;
        return 0;
    case KEY_STEPS:
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, options->steps_max);
        return 0;
    case KEY_CORRUPT:
        options->corrupt_frame = option_whole(state, "--corrupt", text, 1, UINT64_MAX);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case 'q':
        options->quiet = true;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp emulator_options_parser = {option_list, take, 0, 0, 0, 0, 0};

void emulator_options_init(struct emulator_options *options, uint32_t steps, uint32_t steps_max)
{
    *options = (struct emulator_options){
        .image = "build/arm/afo-mps2-an386.elf", .steps = steps, .steps_max = steps_max};
}
