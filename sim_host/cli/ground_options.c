#include "sim_host/cli/ground_options.h"

#include <math.h>
#include <stdlib.h>

#include "sim_host/cli/option.h"

enum { KEY_SLOPE = 0x600, KEY_TERRAIN, KEY_PUSH };

#define PUSH_MAX_NS 1e4
#define PUSH_MAX_S 1e6
#define PUSH_FOR_MAX_S 10.0
#define RAD_PER_DEG 0.017453292519943295

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Ground and pushes:", 1},
    {"slope-deg", KEY_SLOPE, "DEG", 0,
     "slope of the ground, uphill positive, reached by 0.05 a step", 0},
    {"terrain-mm", KEY_TERRAIN, "MM", 0,
     "standard deviation of the footholds' heights in mm, 0 to 100", 0},
    {"push", KEY_PUSH, "NS@S[/FOR]", 0,
     "impulse on the torso (of --plant reflex: at the hip) in N s, forward positive, after S seconds of the walk; "
     "at once, or spread over FOR seconds: 20@5/0.2 is 100 N for 0.2 s",
     0},
    {0}};

static void take_push(struct ground_options *options, const char *text, struct argp_state *state)
{
    char *at, *end;
    options->push_Ns = strtod(text, &at);
    options->push_s = strtod(*at == '@' ? at + 1 : at, &end);
    const bool timed = at != text && *at == '@' && end != at + 1;
    char *last = end;
    options->push_for_s = timed && *end == '/' ? strtod(end + 1, &last) : 0.0;
    if (!timed || *last != '\0' || last == end + 1) {
        argp_error(
            state,
            "--push: \"%s\" is not NEWTONSECONDS@SECONDS or NEWTONSECONDS@SECONDS/DURATION, as in "
            "0.05@12.5 or 20@5/0.2",
            text);
    }
    if (!(fabs(options->push_Ns) <= PUSH_MAX_NS) || options->push_Ns == 0.0) {
        argp_error(state, "--push: %s: the impulse is out of range, allowed is -%g to %g N s but 0",
                   text, PUSH_MAX_NS, PUSH_MAX_NS);
    }
    if (!(options->push_s >= 0.0 && options->push_s <= PUSH_MAX_S)) {
        argp_error(state, "--push: %s: the time is out of range, allowed is 0 to %g s", text,
                   PUSH_MAX_S);
    }
    if (!(options->push_for_s >= 0.0 && options->push_for_s <= PUSH_FOR_MAX_S)) {
        argp_error(state, "--push: %s: the duration is out of range, allowed is 0 to %g s", text,
                   PUSH_FOR_MAX_S);
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct ground_options *options = (struct ground_options *)state->input;
    switch (key) {
    case KEY_SLOPE:
        options->slope_deg = option_number(state, "--slope-deg", text, -20.0, 20.0);
        return 0;
    case KEY_TERRAIN:
        options->terrain_mm = option_number(state, "--terrain-mm", text, 0.0, 100.0);
        return 0;
    case KEY_PUSH:
        take_push(options, text, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp ground_options_parser = {option_list, take, 0, 0, 0, 0, 0};

bool ground_options_given(const struct ground_options *options)
{
    return options->slope_deg != 0.0 || options->terrain_mm != 0.0 || options->push_Ns != 0.0;
}

void ground_options_apply(const struct ground_options *options, struct loop_config *config)
{
    config->plant.roughness_m = 0.001 * options->terrain_mm;
}

/* Whether the plant may be pushed yet. */
static bool is_held(const struct plant *plant)
{
    return plant->config.kind == PLANT_WALKER ? plant->walk.phase == WALK_HELD
                                              : plant_walked_s(plant) < 0.0;
}

static void push(const struct ground_options *options, struct plant *plant, uint32_t *push_ticks)
{
    const uint32_t lasting = (uint32_t)(options->push_for_s / plant->config.tick_s + 0.5);
    const uint32_t ticks = lasting > 1 ? lasting : 1;
    if (*push_ticks >= ticks || is_held(plant) || plant_walked_s(plant) < options->push_s) {
        return;
    }
    plant_push(plant, -options->push_Ns / (double)ticks, 0.0); /* forward is -x */
    (*push_ticks)++;
}

void ground_options_tick(const struct ground_options *options, struct loop *loop,
                         uint32_t *push_ticks)
{
    struct plant *plant = &loop->nodes.plant;
    if (options->slope_deg != 0.0) {
        const double most = GROUND_SLOPE_PER_STEP_DEG * (double)plant_steps(plant);
        const double size = fabs(options->slope_deg) < most ? fabs(options->slope_deg) : most;
        plant->walk.params.slope_rad = copysign(size, options->slope_deg) * RAD_PER_DEG;
    }
    if (options->push_Ns != 0.0) {
        push(options, plant, push_ticks);
    }
}
