/* afo study validate-person: how a person who walks by reflexes walks, against curves that nobody was tuned with. */
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/loop/loop.h"
#include "sim_host/study/person/commands.h"
#include "sim_host/study/person/normative.h"
#include "sim_host/study/person/objective.h"
#include "sim_host/study/person/person_options.h"
#include "sim_host/study/person/person_walk.h"
#include "sim_host/study/plot.h"

enum { KEY_SEEDS = 0x600, KEY_STEPS, KEY_NOISE, KEY_JSON };
enum { SEEDS_MOST = 100 };

#define COUNTED_FROM_S 5.0
#define STEP_AT_MOST_S 2.0

static const struct argp_option option_list[] = {
    {"seeds", KEY_SEEDS, "N", 0, "walks, each with its own noise (3)", 0},
    {"steps", KEY_STEPS, "N", 0, "of each walk, behind the first 5 s (100)", 0},
    {"noise", KEY_NOISE, "PERCENT", 0, "of the reflexes; 0: none (the person's own)", 0},
    {"json", KEY_JSON, 0, 0, "one JSON object", 0},
    {0}};

struct input {
    struct person_walk walk;
    struct person_options who;
    int seeds;
    double noise_share; /* below 0: the person's own */
    bool json;
};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct input *input = (struct input *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &input->who;
        return 0;
    case KEY_SEEDS:
        input->seeds = (int)option_whole(state, "--seeds", text, 1, SEEDS_MOST);
        return 0;
    case KEY_STEPS:
        input->walk.steps = (uint32_t)option_whole(state, "--steps", text, 4, 100000);
        return 0;
    case KEY_NOISE:
        input->noise_share =
            option_number(state, "--noise", text, 0.0, 100.0 * REFLEX_NOISE_MOST) / 100.0;
        return 0;
    case KEY_JSON:
        input->json = true;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- output --------------------------------------------------------------------------------------------------- */

/* A leg's curve, as far as it has one. */
static bool match_of(const struct gait_summary *summary, enum side side, int curve,
                     struct normative_match *match)
{
    if (summary->has_curve[side]) {
        normative_compare(&normative_curves[curve], summary->curve[side][curve], match);
    }
    return summary->has_curve[side];
}

static void print(const struct input *input, const struct gait_summary *summary)
{
    printf("  %4s %6s %6s %9s %11s %11s\n", "seed", "fell", "steps", "speed m/s", "step time s",
           "peak, weights");
    for (int i = 0; i < input->seeds; i++) {
        const struct gait_summary *s = &summary[i];
        printf("  %4d %6s %6d %9.3f %11.3f %11.3f\n", i + 1, s->fell ? "yes" : "no", s->steps,
               s->speed_m_s, s->step_time_s, s->peak_weights);
    }
    printf("against people who were not tuned with (Schwartz et al. 2008), seed 1:\n"
           "  %-28s %5s %6s %8s %8s %8s\n",
           "curve", "leg", "r", "RMS", "offset", "people's");
    for (int curve = 0; curve < NORMATIVE_CURVES; curve++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            const struct normative_curve *norm = &normative_curves[curve];
            struct normative_match match;
            if (match_of(summary, (enum side)side, curve, &match)) {
                printf("  %-28s %5s %6.3f %8.2f %8.2f %8.2f %s\n", norm->name,
                       side == SIDE_LEFT ? "left" : "right", match.r, match.rms, match.offset,
                       norm->spread, norm->unit);
            }
        }
    }
}

static void json_walks(struct json_writer *json, const struct input *input,
                       const struct gait_summary *summary)
{
    json_open_list(json, "walks");
    for (int i = 0; i < input->seeds; i++) {
        const struct gait_summary *s = &summary[i];
        json_open_object(json, NULL);
        json_integer(json, "seed", i + 1);
        json_bool(json, "fell", s->fell);
        json_integer(json, "steps", s->steps);
        json_number(json, "walked_s", s->walked_s, 6);
        json_number(json, "speed_m_s", s->speed_m_s, 17);
        json_number(json, "step_time_s", s->step_time_s, 6);
        json_number(json, "step_time_sd_s", s->step_time_sd_s, 6);
        json_number(json, "peak_body_weights", s->peak_weights, 6);
        json_close_object(json);
    }
    json_close_list(json);
}

static void json_curves(struct json_writer *json, const struct gait_summary *summary)
{
    json_open_list(json, "curves");
    for (int curve = 0; curve < NORMATIVE_CURVES; curve++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            struct normative_match match;
            if (match_of(summary, (enum side)side, curve, &match)) {
                json_open_object(json, NULL);
                json_text(json, "curve", normative_curves[curve].name);
                json_text(json, "unit", normative_curves[curve].unit);
                json_text(json, "leg", side == SIDE_LEFT ? "left" : "right");
                json_number(json, "r", match.r, 6);
                json_number(json, "rms", match.rms, 6);
                json_number(json, "offset", match.offset, 6);
                json_number(json, "spread_of_people", normative_curves[curve].spread, 6);
                json_close_object(json);
            }
        }
    }
    json_close_list(json);
}

/* For the picture. */
static void write_curves(FILE *picture, const struct gait_summary *summary)
{
    fputs("curve,leg,r,rms_over_spread\n", picture);
    for (int curve = 0; curve < NORMATIVE_CURVES; curve++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            struct normative_match match;
            if (match_of(summary, (enum side)side, curve, &match)) {
                fprintf(picture, "%s,%s,%.6g,%.6g\n", normative_curves[curve].name,
                        side == SIDE_LEFT ? "left" : "right", match.r,
                        match.rms / normative_curves[curve].spread);
            }
        }
    }
}

static void print_json(const struct input *input, const struct gait_summary *summary)
{
    struct json_writer json;
    json_begin(&json, stdout);
    json_open_object(&json, NULL);
    json_text(&json, "person", input->walk.subject->person.name);
    json_number(&json, "noise_percent", 100.0 * input->walk.noise_share, 6);
    json_text(&json, "device", input->walk.worn ? input->walk.subject->device.name : NULL);
    json_walks(&json, input, summary);
    json_unsigned(&json, "curves_of_walk", 1);
    json_curves(&json, summary);
    if (!summary->fell && summary->has_curve[SIDE_LEFT] && summary->has_curve[SIDE_RIGHT]) {
        json_open_object(&json, "objective");
        for (int i = 0; i < OBJECTIVE_TERMS; i++) {
            json_number(&json, objective_terms[i].name,
                        objective_share(&objective_terms[i], summary), 6);
        }
        json_close_object(&json);
    }
    json_close_object(&json);
    json_end(&json);
}

/* ---- main ----------------------------------------------------------------------------------------------------- */

static int validate(struct input *input, bool *fell)
{
    static struct gait_summary summary[SEEDS_MOST];
    char message[LOOP_MESSAGE_MAX];
    *fell = false;
    for (int i = 0; i < input->seeds; i++) {
        input->walk.seed = (uint64_t)i + 1;
        if (person_walk_run(&input->walk, &summary[i], message) != 0) {
            return program_complain("%s", message);
        }
        *fell = *fell || summary[i].fell || summary[i].steps < (int)input->walk.steps;
    }
    if (input->json) {
        print_json(input, summary);
    } else {
        print(input, summary);
    }
    FILE *picture = plot_table("validate-person");
    if (picture != NULL) {
        write_curves(picture, summary);
    }
    return program_output_done();
}

int validate_person_main(int argc, char **argv)
{
    static const char doc[] =
        "Walks a person who walks by reflexes, and compares joint angles and moments with those of "
        "people that no person was tuned with.\v"
        "An offset of the hip's angle is the pelvis' lean, which this person's trunk does not have.\n"
        "Exit status: 0 walked all steps with all seeds, 1 fell, 2 wrong usage.";
    static struct subject subject;
    static struct input input = {
        .walk = {.from_s = COUNTED_FROM_S, .steps = 100}, .seeds = 3, .noise_share = -1.0};
    static const struct argp_child children[] = {{&person_options_parser, 0, NULL, 0}, {0}};
    const struct argp parser = {option_list, take, NULL, doc, children, NULL, NULL};
    char message[SUBJECT_MESSAGE_MAX];
    bool fell;
    plot_option_parse(&parser, argc, argv, &input);
    if (subject_read(&subject, input.who.person, input.who.device, message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    input.walk.subject = &subject;
    input.walk.worn = input.who.device != NULL;
    input.walk.r0_m = input.who.r0_m;
    input.walk.step_s = input.who.step_s;
    input.walk.until_s = COUNTED_FROM_S + STEP_AT_MOST_S * (double)input.walk.steps;
    input.walk.noise_share =
        input.noise_share >= 0.0 ? input.noise_share : subject.person.muscles.noise_percent / 100.0;
    if (validate(&input, &fell) != 0) {
        return EXIT_USAGE;
    }
    return fell ? EXIT_BAD : EXIT_GOOD;
}
