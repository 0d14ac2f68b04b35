/* afo study tune-person: gains for a person who walks by reflexes, by CMA-ES. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/loop/loop.h"
#include "sim_host/study/person/commands.h"
#include "sim_host/study/person/objective.h"
#include "sim_host/study/person/person_options.h"
#include "sim_host/study/person/tuning.h"
#include "sim_host/study/plot.h"

enum {
    KEY_OUT = 0x600,
    KEY_STATE,
    KEY_NAME,
    KEY_GENERATIONS,
    KEY_SEED,
    KEY_WALKS,
    KEY_SECONDS,
    KEY_NOISE,
    KEY_PUSH,
    KEY_SIGMA,
    KEY_JOBS,
    KEY_KEYS,
    KEY_OBJECTIVE
};

enum { JUDGED_WALKS = TUNING_WALKS_MOST };

static const struct argp_option option_list[] = {
    {"out", KEY_OUT, "FILE", 0, "the person file to write", 0},
    {"name", KEY_NAME, "TEXT", 0, "of the person there", 0},
    {"state", KEY_STATE, "FILE", 0,
     "kept behind every generation; where there is one, the tuning goes on from it", 0},
    {"generations", KEY_GENERATIONS, "N", 0, "in all (100)", 0},
    {"seed", KEY_SEED, "N", 0, "of search and noise (1)", 0},
    {"walks", KEY_WALKS, "N", 0, "for each person tried, 1 to 8 (2)", 0},
    {"seconds", KEY_SECONDS, "S", 0, "of each walk (15)", 0},
    {"noise", KEY_NOISE, "PERCENT", 0, "of the reflexes meanwhile; 0: none (4)", 0},
    {"push", KEY_PUSH, "M_S", 0, "pushes at the hip, impulse by the body's mass (0.05)", 0},
    {"sigma", KEY_SIGMA, "SHARE", 0, "first size of the search's steps (0.06)", 0},
    {"jobs", KEY_JOBS, "N", 0, "threads; no result depends on them (1)", 0},
    {"keys", KEY_KEYS, 0, 0, "print the keys of a person file's [muscles], and do nothing", 1},
    {"objective", KEY_OBJECTIVE, 0, 0, "print what is asked for, and do nothing", 1},
    {0}};

struct input {
    struct tuning_plan plan;
    struct person_options who;
    const char *out, *name;
};

static void print_objective(void)
{
    printf(
        "A walk with a fall costs 100, and up to 100 more the earlier it is. Any other one costs\n"
        "s / (1 + s / 100), where s is the sum of  weight (d / unit)^2  for the distance d of each measure from its band:\n"
        "  %-30s %6s %6s  %5s %6s\n",
        "measure", "from", "to", "unit", "weight");
    for (int i = 0; i < OBJECTIVE_TERMS; i++) {
        const struct objective_term *term = &objective_terms[i];
        printf("  %-30s %6g %6g  %5g %6g  %s\n", term->name, term->low, term->high, term->unit,
               term->weight, term->unit_text);
    }
}

static error_t take_number(struct tuning_plan *plan, int key, const char *text,
                           struct argp_state *state)
{
    switch (key) {
    case KEY_GENERATIONS:
        plan->generations = (int)option_whole(state, "--generations", text, 0, 1000000);
        return 0;
    case KEY_SEED:
        plan->seed = option_whole(state, "--seed", text, 0, 1000000000);
        return 0;
    case KEY_WALKS:
        plan->walks = (int)option_whole(state, "--walks", text, 1, TUNING_WALKS_MOST);
        return 0;
    case KEY_SECONDS:
        plan->walk_s = option_number(state, "--seconds", text, 5.0, 600.0);
        return 0;
    case KEY_NOISE:
        plan->noise_share =
            option_number(state, "--noise", text, 0.0, 100.0 * REFLEX_NOISE_MOST) / 100.0;
        return 0;
    case KEY_PUSH:
        plan->push_m_s = option_number(state, "--push", text, 0.0, 1.0);
        return 0;
    case KEY_SIGMA:
        plan->sigma = option_number(state, "--sigma", text, 1e-4, 1.0);
        return 0;
    case KEY_JOBS:
        plan->jobs = (int)option_whole(state, "--jobs", text, 1, 256);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct input *input = (struct input *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &input->who;
        return 0;
    case KEY_OUT:
        input->out = text;
        return 0;
    case KEY_NAME:
        input->name = text;
        return 0;
    case KEY_STATE:
        input->plan.state_path = text;
        return 0;
    case KEY_KEYS:
        person_muscles_print_keys(stdout);
        exit(program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE);
    case KEY_OBJECTIVE:
        print_objective();
        exit(program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE);
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    case ARGP_KEY_END:
        if (input->out == NULL) {
            argp_error(state, "give --out FILE for the result");
        }
        return 0;
    default:
        return take_number(&input->plan, key, text, state);
    }
}

static int write_person(const struct input *input, const struct tuning *tuning, double value,
                        struct output_file *file)
{
    static struct person person;
    struct person_muscles *muscles = &person.muscles;
    tuning_person(tuning, &person);
    if (input->name != NULL) {
        snprintf(person.name, sizeof person.name, "%.*s", PERSON_NAME_MAX - 1, input->name);
    }
    muscles->tuned_seed = (double)tuning->plan.seed;
    muscles->tuned_walks = (double)tuning->search.generations * tuning->search.lambda;
    muscles->tuned_value = value;
    snprintf(muscles->tuned_with, sizeof muscles->tuned_with, "no device");
    if (tuning->plan.worn) {
        snprintf(muscles->tuned_with, sizeof muscles->tuned_with, "%.40s, r0 %g m",
                 tuning->plan.subject.device.name, tuning->plan.r0_m);
    }
    muscles->given[0][PERSON_MUSCLES_NOISE] = true;
    person_write(file->stream, &person);
    return program_commit_output(file);
}

static int tune(const struct input *input, struct output_file *file)
{
    static struct tuning tuning;
    char message[LOOP_MESSAGE_MAX] = "";
    double mean = 0.0, best = 0.0, value = 0.0;
    if (tuning_begin(&tuning, &input->plan, message) != 0) {
        return program_complain("%s", message);
    }
    FILE *picture = plot_table("tune-person");
    if (picture != NULL) {
        fputs("generation,mean,best\n", picture);
    }
    while (tuning.search.generations < input->plan.generations) {
        if (tuning_generation(&tuning, &mean, &best, message) != 0) {
            return program_complain("%s", message);
        }
        printf("generation %4d: %8.3f in the mean, %8.3f the best; steps of %.4f\n",
               tuning.search.generations, mean, best, tuning.search.sigma);
        fflush(stdout);
        if (picture != NULL) {
            fprintf(picture, "%d,%.9g,%.9g\n", tuning.search.generations, mean, best);
        }
    }
    if (tuning_value(&tuning, JUDGED_WALKS, &value, message) != 0) {
        return program_complain("%s", message);
    }
    if (write_person(input, &tuning, value, file) != 0) {
        return -1;
    }
    printf("the mean's objective over %d walks with fresh seeds: %.4f\n", JUDGED_WALKS, value);
    return 0;
}

int tune_person_main(int argc, char **argv)
{
    static const char doc[] =
        "Tunes the reflexes of a person who walks by them (afo sim --plant reflex), by CMA-ES.\v"
        "What is asked for is printed by --objective; what a person file may say of muscles, by "
        "--keys. The result is a person file that says how it was made.\n"
        "Exit status: 0 written, 1 not, 2 wrong usage.";
    static struct input input = {.plan = {.seed = 1,
                                          .generations = 100,
                                          .walks = 2,
                                          .walk_s = 15.0,
                                          .noise_share = 0.04,
                                          .push_m_s = 0.05,
                                          .sigma = 0.06,
                                          .jobs = 1}};
    static const struct argp_child children[] = {{&person_options_parser, 0, NULL, 0}, {0}};
    const struct argp parser = {option_list, take, NULL, doc, children, NULL, NULL};
    char message[SUBJECT_MESSAGE_MAX];
    plot_option_parse(&parser, argc, argv, &input);
    input.plan.worn = input.who.device != NULL;
    input.plan.r0_m = input.who.r0_m;
    input.plan.step_s = input.who.step_s;
    if (subject_read(&input.plan.subject, input.who.person, input.who.device, message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    static struct output_file file;
    if (program_open_output(&file, input.out) != 0) { /* said before hours are spent */
        return EXIT_USAGE;
    }
    const int status = tune(&input, &file) == 0 ? EXIT_GOOD : EXIT_BAD;
    output_file_discard(&file);
    return status;
}
