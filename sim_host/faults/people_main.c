#include "sim_host/faults/people_main.h"

#include <stdlib.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/faults/fault_shot.h"
#include "sim_host/faults/people_campaign.h"
#include "sim_host/faults/people_summary.h"
#include "sim_host/faults/work.h"

/* Of one processor, about. */
#define RUN_S 0.08
#define REFLEX_RUN_S 0.8

struct many {
    const struct fault_options *options;
    struct people_campaign *campaign;
    unsigned recordings;
    struct people_result *results;
};

static bool wants(void *context, uint32_t index)
{
    const struct many *many = (const struct many *)context;
    const uint32_t kind = index % FAULT_ALL_KINDS;
    return fault_options_want(many->options, kind) &&
           people_plan_can(many->recordings, (enum fault_kind)kind);
}

static bool begin(void *context)
{
    (void)context;
    return true;
}

static void make(void *context, uint32_t index, FILE *file)
{
    struct many *many = (struct many *)context;
    struct people_plan plan;
    struct people_result result;
    people_plan(many->options->seed, index, many->recordings, &plan);
    (void)people_campaign_run(many->campaign, &plan, NULL, NULL, &result);
    people_result_write(file, &result);
}

static bool take(void *context, const char *line, uint32_t *index)
{
    struct many *many = (struct many *)context;
    struct people_result result;
    if (!people_result_read(line, many->options->seed, many->recordings, &result) ||
        result.plan.index >= many->options->runs) {
        return false;
    }
    *index = result.plan.index;
    many->results[*index] = result;
    return true;
}

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

/* With other recordings other people walk. */
static void name_files(struct work *work, const struct many *many)
{
    const unsigned long long seed = (unsigned long long)many->options->seed;
    if (many->options->by_reflexes) {
        snprintf(work->prefix, sizeof work->prefix, "reflex-seed%llu", seed);
    } else {
        snprintf(work->prefix, sizeof work->prefix, "people%u-seed%llu", many->recordings, seed);
    }
}

static int run_many(const struct fault_options *options, struct people_campaign *campaign)
{
    struct many many = {.options = options,
                        .campaign = campaign,
                        .recordings = people_campaign_recordings(campaign)};
    struct work work = {.runs = options->runs,
                        .jobs = options->jobs,
                        .chunk = PEOPLE_BLOCK,
                        .out = options->out,
                        .run_s = options->by_reflexes ? REFLEX_RUN_S : RUN_S,
                        .context = &many,
                        .wants = wants,
                        .begin = begin,
                        .make = make,
                        .take = take};
    name_files(&work, &many);
    many.results = (struct people_result *)calloc(options->runs, sizeof *many.results);
    if (many.results == NULL) {
        program_complain("out of memory");
        return EXIT_USAGE;
    }
    int status = work_do(&work);
    if (status == EXIT_GOOD) {
        const uint32_t count = keep_wanted(&many);
        const unsigned bad =
            people_summary(stdout, campaign, many.results, count, options->markdown);
        status = bad == 0 ? EXIT_GOOD : EXIT_BAD;
    }
    free(many.results);
    return status;
}

enum { NAME_BYTES = 160 };

/* What the table of --csv is a table of. */
struct alone {
    const struct fault_options *options;
    const struct people_campaign *campaign;
    const struct people_plan *plan;
};

static void tell_alone(struct json_writer *json, const void *context)
{
    const struct alone *alone = (const struct alone *)context;
    const struct people_scene_plan *scene = &alone->plan->scene;
    char name[NAME_BYTES];
    people_campaign_name(alone->campaign, scene, name, sizeof name);
    json_text(json, "who", name);
    json_text(json, "device", alone->options->device[scene->device]);
    json_text(json, "switches", foot_switch_preset_names[scene->switches]);
    if (!alone->options->by_reflexes) {
        json_unsigned(json, "recordings", people_campaign_recordings(alone->campaign));
    }
    json_unsigned(json, "seed", alone->options->seed);
    json_unsigned(json, "run", alone->plan->index);
    json_bool(json, "from_power_on", alone->plan->from_power_on);
    fault_shots_describe(json, alone->plan->shot, alone->plan->count);
}

static int run_alone(const struct fault_options *options, struct people_campaign *campaign)
{
    struct people_plan plan;
    struct people_result result;
    struct output_file log, ticks;
    people_plan(options->seed, options->run, people_campaign_recordings(campaign), &plan);
    if (!people_plan_can(people_campaign_recordings(campaign), plan.shot[0].kind)) {
        program_complain("run %u is \"%s\": who walks by reflexes cannot be told to do that",
                         options->run, fault_kinds[plan.shot[0].kind].name);
        return EXIT_USAGE;
    }
    if (program_open_output(&log, options->log) != 0) {
        return EXIT_USAGE;
    }
    if (program_open_output(&ticks, options->ticks) != 0) {
        output_file_discard(&log);
        return EXIT_USAGE;
    }
    (void)people_campaign_run(campaign, &plan, log.stream, ticks.stream, &result);
    const bool log_kept = program_commit_output(&log) == 0;
    const struct alone alone = {options, campaign, &plan};
    const bool ticks_kept =
        program_commit_table(&ticks, options->argc, options->argv, tell_alone, &alone) == 0;
    people_summary_tell(stdout, campaign, &result);
    return !log_kept || !ticks_kept                          ? EXIT_USAGE
           : result.unsafe == 0 && result.unsafe_device == 0 ? EXIT_GOOD
                                                             : EXIT_BAD;
}

int people_main(const struct fault_options *options)
{
    struct people_campaign *campaign =
        options->by_reflexes
            ? people_campaign_create_reflex(options->person, options->device)
            : people_campaign_create(options->person, options->device, options->data);
    if (campaign == NULL) {
        return EXIT_USAGE;
    }
    const int status = options->single ? run_alone(options, campaign) : run_many(options, campaign);
    people_campaign_destroy(campaign);
    return status;
}
