/* afo compare: the same walk by several laws; one table and one picture. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/figure.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/cli/sim_session.h"
#include "sim_host/persons/law_name.h"
#include "sim_host/programs/commands.h"

enum {
    KEY_LAWS = 0x900,
    KEY_STEPS,
    KEY_PLOT,
    DEFAULT_STEPS = 200,
    LAST = 20,
    PANELS = 2,
    LAWS_MOST = 8,
    SPARE_STEPS = 2
};

struct options {
    struct sim_options sim;
    enum law_mode law[LAWS_MOST];
    int laws;
    const char *plot_path;
};

/* What one law made of the walk. */
struct result {
    const char *law;
    bool fell;
    char outcome[sizeof((struct sim_outcome *)0)->fault];
    uint32_t steps;
    double *speed_rad_s, *r0_m;                  /* owned; by step */
    struct walk_summary last;                    /* of the apex speed */
    double mean_r0_m, speed_m_s, cost_transport; /* over the same steps; NaN: none */
};

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

static const struct argp_option option_list[] = {
    {"laws", KEY_LAWS, "NAME,...", 0,
     "laws to compare (default: proportional,dlqr,deadbeat,predictive): those of --law, and open-loop, "
     "which holds the push-off of the speed's steady gait",
     1},
    {"steps", KEY_STEPS, "N", 0, "walk this many steps with each (default 200)", 1},
    {"plot", KEY_PLOT, "FILE.svg", 0,
     "apex speed and precompression by step, all laws over each other", 1},
    {"json", 'j', 0, 0, "one JSON object instead of the table", 1},
    {0}};

/* ---- options ------------------------------------------------------------------------- */

static void take_laws(struct options *options, const char *text, struct argp_state *state)
{
    char name[64], message[256];
    options->laws = 0;
    for (const char *at = text;; at++) {
        const size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        if (options->laws == LAWS_MOST) {
            argp_error(state, "--laws: at most %d laws", LAWS_MOST);
        }
        if (law_from_name(name, &options->law[options->laws]) != 0) {
            law_name_refuse(name, message, sizeof message);
            argp_error(state, "--laws: %s", message);
        }
        if (options->law[options->laws] == LAW_PERSON) {
            argp_error(
                state,
                "--laws: person is the law of a recorded person, and no compass walks by it");
        }
        options->laws++;
        at += length;
        if (*at == '\0') {
            return;
        }
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->sim.walk;
        state->child_inputs[1] = &options->sim.sensor;
        state->child_inputs[2] = &options->sim.ground;
        state->child_inputs[3] = &options->sim.sensing;
        return 0;
    case KEY_LAWS:
        take_laws(options, text, state);
        return 0;
    case KEY_STEPS:
        options->sim.steps = (uint32_t)option_whole(state, "--steps", text, 1, 10000000);
        return 0;
    case KEY_PLOT:
        options->plot_path = text;
        return 0;
    case 'j':
        options->sim.json = true;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    case ARGP_KEY_END:
        if (options->sim.walk.law_given || options->sim.walk.open_loop ||
            options->sim.walk.r0_m > 0.0) {
            argp_error(state, "the laws are named by --laws, not by --law, --open-loop or --r0");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void parse_options(struct options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 2},
                                                 {&sensor_options_parser, 0, "", 4},
                                                 {&ground_options_parser, 0, "", 5},
                                                 {&sensing_options_parser, 0, 0, 3},
                                                 {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Walks the same walk by several laws, on the same sensors, ground and push, and sets them beside each other.\v"
        "Exit status: 0 all walked, 1 one fell or was stopped, 2 wrong usage or input.",
        children,
        0,
        0};
    *options = (struct options){.sim = {.steps = DEFAULT_STEPS,
                                        .fault_step = UINT32_MAX,
                                        .quiet = true,
                                        .argc = argc,
                                        .argv = argv},
                                .law = {LAW_PROPORTIONAL, LAW_DLQR, LAW_DEADBEAT, LAW_PREDICTIVE},
                                .laws = 4};
    walk_options_init(&options->sim.walk);
    sensor_options_init(&options->sim.sensor);
    sensing_options_init(&options->sim.sensing);
    option_parse(&parser, argc, argv, options);
}

/* The law's own options: open-loop has no speed of its own, but that speed's steady push-off. */
static int choose_law(struct sim_options *sim, enum law_mode law)
{
    char message[LOOP_MESSAGE_MAX] = "";
    sim->walk.law_given = law != LAW_OPEN_LOOP;
    sim->walk.law = law;
    if (law != LAW_OPEN_LOOP) {
        if (law_of((real)law)->has_own_gains) {
            sim->walk.kp = -1.0; /* --kp is for the others */
        }
        return 0;
    }
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    if (walk_options_resolve(&sim->walk, &subject, &params, &speed_rad_s, message) != 0) {
        return program_complain("%s", message);
    }
    sim->walk.open_loop = true;
    sim->walk.speed = (struct speed_option){0.0, 0.0};
    sim->walk.kp = -1.0;
    sim->walk.r0_m = (double)speed_table_inverse(&params.table, (real)speed_rad_s);
    return 0;
}

/* ---- walking ------------------------------------------------------------------------- */

static void summarise(const struct sim_session *session, struct result *result)
{
    const struct walk_record *record = &session->record;
    const struct person *person = &session->config.subject.person;
    const double weight_N =
        (person->torso_mass_kg + 2.0 * person->leg_mass_kg) * person->gravity_m_s2;
    const double spring_N_m = subject_spring_N_per_m(&session->config.subject);
    double r0 = 0.0, squares = 0.0, way_m = 0.0, time_s = 0.0;
    uint32_t count = 0;
    for (uint32_t i = record->count > LAST ? record->count - LAST : 0; i + 1 < record->count; i++) {
        const struct walk_row *row = &record->rows[i];
        if (row->measured && row->step_length_m > 0.0) {
            r0 += row->r0_m;
            squares += row->r0_m * row->r0_m;
            way_m += row->step_length_m;
            time_s += record->rows[i + 1].time_s - row->time_s;
            count++;
        }
    }
    result->last = walk_record_summary(record, LAST);
    result->mean_r0_m = count > 0 ? r0 / count : (double)NAN;
    result->speed_m_s = count > 0 ? way_m / time_s : (double)NAN;
    result->cost_transport =
        count > 0 ? 0.5 * spring_N_m * squares / (weight_N * way_m) : (double)NAN;
}

static void keep(const struct sim_session *session, struct result *result)
{
    const struct walk_record *record = &session->record;
    result->steps = record->count;
    result->fell = session->outcome.fell;
    snprintf(result->outcome, sizeof result->outcome, "%s", session->outcome.fault);
    for (uint32_t i = 0; i < record->count; i++) {
        result->speed_rad_s[i] = record->rows[i].apex_speed_rad_s;
        result->r0_m[i] = record->rows[i].measured ? record->rows[i].r0_m : (double)NAN;
    }
    summarise(session, result);
}

static int walk_by(const struct options *options, enum law_mode law, struct result *result)
{
    static struct sim_session session;
    session = (struct sim_session){.options = options->sim};
    result->law = law_name_of(law);
    int status = choose_law(&session.options, law);
    if (status == 0 && sim_session_configure(&session) == 0 && sim_session_open(&session) == 0) {
        sim_session_walk(&session, &interrupted);
        keep(&session, result);
    } else {
        status = -1;
    }
    sim_session_free(&session);
    return status;
}

/* ---- telling ------------------------------------------------------------------------- */

static void print_table(const struct result *results, int count)
{
    printf("\n  %-13s %6s %12s %12s %9s %10s %8s  outcome\n", "law", "steps", "apex speed",
           "spread", "r0", "speed", "cost of");
    printf("  %-13s %6s %12s %12s %9s %10s %8s\n", "", "", "(rad/s)", "(%)", "(m)", "(m/s)",
           "transport");
    for (int i = 0; i < count; i++) {
        const struct result *r = &results[i];
        const double spread =
            100.0 * (r->last.greatest_rad_s - r->last.least_rad_s) / r->last.mean_rad_s;
        printf("  %-13s %6u %12.6f %12.3f %9.5f %10.4f %9.5f  %s%s\n", r->law, r->steps,
               r->last.mean_rad_s, spread, r->mean_r0_m, r->speed_m_s, r->cost_transport,
               r->outcome[0] == '\0' ? "walked"
               : r->fell             ? "FELL: "
                                     : "STOPPED: ",
               r->outcome);
    }
    printf(
        "\n  All figures but the number of steps are of the last %d steps, or of all where there are fewer.\n",
        LAST);
}

static void print_json(const struct result *results, int count)
{
    struct json_writer json;
    json_begin(&json, stdout);
    json_open_list(&json, NULL);
    for (int i = 0; i < count; i++) {
        const struct result *r = &results[i];
        json_open_object(&json, NULL);
        json_text(&json, "law", r->law);
        json_unsigned(&json, "steps", r->steps);
        json_bool(&json, "fell", r->fell);
        json_text(&json, "fault", r->outcome[0] != '\0' ? r->outcome : NULL);
        json_number(&json, "mean_rad_s", r->last.mean_rad_s, 9);
        json_number(&json, "least_rad_s", r->last.least_rad_s, 9);
        json_number(&json, "greatest_rad_s", r->last.greatest_rad_s, 9);
        json_number(&json, "r0_m", r->mean_r0_m, 9);
        json_number(&json, "speed_m_s", r->speed_m_s, 9);
        json_number(&json, "cost_of_transport", r->cost_transport, 9);
        json_close_object(&json);
    }
    json_close_list(&json);
    json_end(&json);
}

/* number: 1, 2, 3 for the steps. */
static int draw(struct output_file *file, const struct result *results, int count,
                const double *number)
{
    struct figure_panel panels[PANELS] = {
        {.title = "Apex speed (rad/s)", .x_title = "step"},
        {.title = "Precompression asked for (m)", .x_title = "step"}};
    if (file->stream == NULL) {
        return 0;
    }
    for (int i = 0; i < count; i++) {
        panels[0].series[i] = (struct figure_series){results[i].law, number, results[i].speed_rad_s,
                                                     NULL, results[i].steps};
        panels[1].series[i] =
            (struct figure_series){results[i].law, number, results[i].r0_m, NULL, results[i].steps};
    }
    panels[0].series_count = panels[1].series_count = (size_t)count;
    figure_write(file->stream, "The same walk by several laws", panels, PANELS);
    return program_commit_output(file);
}

/* Every law in turn; *done receives how many walked. */
static int walk_all(const struct options *options, struct result *results, int *done)
{
    int status = EXIT_GOOD;
    for (*done = 0; *done < options->laws && !interrupted; (*done)++) {
        if (walk_by(options, options->law[*done], &results[*done]) != 0) {
            return EXIT_USAGE;
        }
        status = results[*done].outcome[0] != '\0' ? EXIT_BAD : status;
    }
    return status;
}

/* The rows of all laws lie in `values`, two of so many numbers a law, and one of the steps' numbers behind them. */
static int compare(const struct options *options, double *values, size_t row)
{
    struct result results[LAWS_MOST] = {{0}};
    struct output_file plot = {0};
    double *number = &values[2 * (size_t)options->laws * row];
    int done = 0, status = EXIT_USAGE;
    for (size_t i = 0; i < row; i++) {
        number[i] = (double)i + 1.0;
    }
    for (size_t i = 0; i < (size_t)options->laws; i++) {
        results[i].speed_rad_s = &values[2 * i * row];
        results[i].r0_m = &values[(2 * i + 1) * row];
    }
    if (program_open_output(&plot, options->plot_path) == 0) {
        status = walk_all(options, results, &done);
    }
    if (status != EXIT_USAGE) {
        (options->sim.json ? print_json : print_table)(results, done);
        if (draw(&plot, results, done, number) != 0 || program_output_done() != 0) {
            status = EXIT_USAGE;
        }
    }
    output_file_discard(&plot);
    return status;
}

int afo_compare(int argc, char **argv)
{
    static struct options options;
    signal(SIGINT, on_interrupt);
    signal(SIGTERM, on_interrupt);
    parse_options(&options, argc, argv);
    const size_t row = (size_t)options.sim.steps + SPARE_STEPS;
    double *values = calloc((2 * (size_t)options.laws + 1) * row, sizeof *values);
    if (values == NULL) {
        program_complain("out of memory: ask for fewer --steps");
        return EXIT_USAGE;
    }
    const int status = compare(&options, values, row);
    free(values);
    return status;
}
