/* afo faults: injects faults into steady walks and judges what the plant did. */
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/faults/campaign.h"
#include "sim_host/faults/fault_options.h"
#include "sim_host/faults/fault_shot.h"
#include "sim_host/faults/people_main.h"
#include "sim_host/faults/summary.h"
#include "sim_host/faults/work.h"
#include "sim_host/programs/commands.h"

/* Of one processor, about. */
#define RUN_S 0.022

/* ---- one run alone ------------------------------------------------------------------- */

/* What the table of --csv is a table of. */
struct alone {
    const struct fault_options *options;
    const struct campaign_plan *plan;
};

static void tell_alone(struct json_writer *json, const void *context)
{
    const struct alone *alone = (const struct alone *)context;
    const char *person = alone->options->walker.person_path;
    json_text(json, "who", person != NULL ? person : "the paper's walker");
    json_unsigned(json, "seed", alone->options->seed);
    json_unsigned(json, "run", alone->plan->index);
    json_text(json, "scene", campaign_scene_name(alone->plan->scene));
    fault_shots_describe(json, alone->plan->shot, alone->plan->count);
}

static int run_alone(const struct fault_options *options)
{
    struct campaign_plan plan;
    struct campaign_result result;
    struct output_file log, ticks;
    campaign_plan(options->seed, options->run, &plan);
    if (program_open_output(&log, options->log) != 0) {
        return EXIT_USAGE;
    }
    struct campaign *campaign =
        program_open_output(&ticks, options->ticks) == 0 ? campaign_create(&options->walker) : NULL;
    if (campaign == NULL) {
        output_file_discard(&log);
        output_file_discard(&ticks);
        return EXIT_USAGE;
    }
    campaign_run(campaign, &plan, log.stream, ticks.stream, &result);
    campaign_destroy(campaign);
    const bool log_kept = program_commit_output(&log) == 0;
    const struct alone alone = {options, &plan};
    const bool ticks_kept =
        program_commit_table(&ticks, options->argc, options->argv, tell_alone, &alone) == 0;
    summary_tell(stdout, &result);
    return !log_kept || !ticks_kept ? EXIT_USAGE : result.unsafe == 0 ? EXIT_GOOD : EXIT_BAD;
}

/* ---- many ------------------------------------------------------------------------------ */

struct many {
    const struct fault_options *options;
    struct campaign *campaign;
    struct campaign_result *results;
};

static bool wants(void *context, uint32_t index)
{
    const struct many *many = (const struct many *)context;
    return fault_options_want(many->options, index % FAULT_KINDS);
}

static bool begin(void *context)
{
    struct many *many = (struct many *)context;
    many->campaign = campaign_create(&many->options->walker);
    return many->campaign != NULL;
}

static void make(void *context, uint32_t index, FILE *file)
{
    struct many *many = (struct many *)context;
    struct campaign_plan plan;
    struct campaign_result result;
    campaign_plan(many->options->seed, index, &plan);
    campaign_run(many->campaign, &plan, NULL, NULL, &result);
    campaign_write(file, &result);
}

static bool take(void *context, const char *line, uint32_t *index)
{
    struct many *many = (struct many *)context;
    struct campaign_result result;
    if (!campaign_read(line, many->options->seed, &result) ||
        result.plan.index >= many->options->runs) {
        return false;
    }
    *index = result.plan.index;
    many->results[*index] = result;
    return true;
}

/* Moves the results of the runs asked for to the front; how many they are. */
static uint32_t keep_wanted(struct many *many)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < many->options->runs; i++) {
        if (wants(many, i)) {
            many->results[count++] = many->results[i];
        }
    }
    return count;
}

static int run_campaign(const struct fault_options *options)
{
    struct many many = {.options = options};
    struct work work = {.runs = options->runs,
                        .jobs = options->jobs,
                        .chunk = 1,
                        .out = options->out,
                        .run_s = RUN_S,
                        .context = &many,
                        .wants = wants,
                        .begin = begin,
                        .make = make,
                        .take = take};
    snprintf(work.prefix, sizeof work.prefix, "seed%llu", (unsigned long long)options->seed);
    many.results = (struct campaign_result *)calloc(options->runs, sizeof *many.results);
    if (many.results == NULL) {
        program_complain("out of memory");
        return EXIT_USAGE;
    }
    int status = work_do(&work);
    if (status == EXIT_GOOD) {
        const uint32_t count = keep_wanted(&many);
        const unsigned bad = summary_table(stdout, many.results, count, options->markdown);
        status = bad == 0 ? EXIT_GOOD : EXIT_BAD;
    }
    campaign_destroy(many.campaign);
    free(many.results);
    return status;
}

int afo_faults(int argc, char **argv)
{
    struct fault_options options;
    fault_options_parse(&options, argc, argv);
    const int status = options.people   ? people_main(&options)
                       : options.single ? run_alone(&options)
                                        : run_campaign(&options);
    return program_output_done() == 0 ? status : EXIT_USAGE;
}
