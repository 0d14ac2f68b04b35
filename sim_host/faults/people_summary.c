#include "sim_host/faults/people_summary.h"

#include "sim_host/faults/fault_shot.h"
#include "sim_host/faults/oracle.h"

enum { ROW_PAIRS = FAULT_ALL_KINDS, ROW_ALL, ROWS };

struct row {
    unsigned runs, assisted, pushes, noticed, late, unsafe, latched;
};

static bool is_unsafe(const struct people_result *result)
{
    return (result->unsafe & ~(unsigned)PERSON_UNSAFE_LATCHED) != 0 || result->unsafe_device != 0;
}

static bool belongs(const struct people_result *result, unsigned row)
{
    return row == ROW_ALL     ? true
           : row == ROW_PAIRS ? result->plan.count == 2
                              : result->plan.count == 1 && result->plan.shot[0].kind == row;
}

static void add(struct row *row, const struct people_result *result)
{
    row->runs++;
    row->assisted += result->assisted ? 1 : 0;
    row->pushes += result->pushes;
    row->noticed += result->assisted && result->noticed_tick != PERSON_JUDGE_NEVER ? 1 : 0;
    row->late += result->late ? 1 : 0;
    row->unsafe += is_unsafe(result) ? 1 : 0;
    row->latched += (result->unsafe & PERSON_UNSAFE_LATCHED) != 0 ? 1 : 0;
}

static void print_rows(FILE *stream, const struct people_result *results, uint32_t count,
                       bool markdown)
{
    fputs(markdown ? "| fault | runs | assisted | pushes | noticed | late | unsafe | latched |\n"
                     "|---|--:|--:|--:|--:|--:|--:|--:|\n"
                   : "fault                                  runs assisted  pushes noticed   late "
                     "unsafe latched\n",
          stream);
    for (unsigned index = 0; index < ROWS; index++) {
        struct row row = {0};
        for (uint32_t i = 0; i < count; i++) {
            if (belongs(&results[i], index)) {
                add(&row, &results[i]);
            }
        }
        const char *name = index == ROW_PAIRS ? "pairs of faults"
                           : index == ROW_ALL ? "all runs"
                                              : fault_kinds[index].name;
        if (row.runs > 0) {
            fprintf(stream,
                    markdown ? "| %s | %u | %u | %u | %u | %u | %u | %u |\n"
                             : "%-36s %6u %8u %7u %7u %6u %6u %7u\n",
                    name, row.runs, row.assisted, row.pushes, row.noticed, row.late, row.unsafe,
                    row.latched);
        }
    }
}

static void print_criterion(FILE *stream, const struct people_result *results, uint32_t count,
                            const char *name, unsigned person, unsigned device, bool markdown)
{
    unsigned single = 0, pairs = 0;
    for (uint32_t i = 0; i < count; i++) {
        const bool is =
            (results[i].unsafe & person) != 0 || (results[i].unsafe_device & device) != 0;
        single += is && results[i].plan.count == 1 ? 1 : 0;
        pairs += is && results[i].plan.count == 2 ? 1 : 0;
    }
    fprintf(stream, markdown ? "| %s | %u | %u | %.2f |\n" : "%-36s %6u %6u %6.2f %%\n", name,
            single, pairs, 100.0 * (single + pairs) / (count > 0 ? (double)count : 1.0));
}

static void print_criteria(FILE *stream, const struct people_result *results, uint32_t count,
                           bool markdown)
{
    fputs(markdown ? "\n| unsafe by | single | pairs | % of all runs |\n|---|--:|--:|--:|\n"
                   : "\nunsafe by                            single  pairs  share\n",
          stream);
    for (int bit = 0; bit < PERSON_UNSAFE_BITS; bit++) {
        print_criterion(stream, results, count, person_unsafe_name(bit), 1u << bit, 0, markdown);
    }
    for (int bit = 0; bit < UNSAFE_BITS; bit++) {
        if (((1u << bit) & (UNSAFE_RELEASE | UNSAFE_LOADED | UNSAFE_FALLEN)) == 0) {
            print_criterion(stream, results, count, oracle_unsafe_name(bit), 0, 1u << bit,
                            markdown);
        }
    }
    fputc('\n', stream);
}

/* Of a reflex scene's runs: whose the falls were, and how many runs of each were with a push, a slip, a trip or the like. */
static void print_falls(FILE *stream, const struct people_result *results, uint32_t count,
                        bool markdown)
{
    fputs(
        markdown
            ? "| whose fall | runs | pushed, slipped, tripped or knocked |\n|---|--:|--:|\n"
            : "whose fall                             runs  pushed, slipped, tripped or knocked\n",
        stream);
    for (int fall = 0; fall < PEOPLE_FALLS; fall++) {
        unsigned runs = 0, befallen = 0;
        for (uint32_t i = 0; i < count; i++) {
            const struct people_plan *plan = &results[i].plan;
            const bool is = results[i].fall == (enum people_fall)fall;
            const bool befell = people_plan_befalls(plan->shot[0].kind) ||
                                (plan->count == 2 && people_plan_befalls(plan->shot[1].kind));
            runs += is ? 1 : 0;
            befallen += is && befell ? 1 : 0;
        }
        fprintf(stream, markdown ? "| %s | %u | %u |\n" : "%-36s %6u %6u\n",
                people_fall_name((enum people_fall)fall), runs, befallen);
    }
    fputc('\n', stream);
}

unsigned people_summary(FILE *stream, const struct people_campaign *campaign,
                        const struct people_result *results, uint32_t count, bool markdown)
{
    unsigned bad = 0;
    print_rows(stream, results, count, markdown);
    print_criteria(stream, results, count, markdown);
    if (people_campaign_recordings(campaign) == PEOPLE_REFLEX_SCENES) {
        print_falls(stream, results, count, markdown);
    }
    for (uint32_t i = 0; i < count; i++) {
        const bool is_bad = is_unsafe(&results[i]) || results[i].late;
        bad += is_bad ? 1 : 0;
        if (is_bad || results[i].unsafe != 0 || results[i].fall >= PEOPLE_FELL_WEARING) {
            people_summary_tell(stream, campaign, &results[i]);
        }
    }
    return bad;
}

void people_summary_tell(FILE *stream, const struct people_campaign *campaign,
                         const struct people_result *result)
{
    char name[160];
    const struct people_plan *plan = &result->plan;
    people_campaign_name(campaign, &plan->scene, name, sizeof name);
    fprintf(stream, "run %u (%s; device %u, switches %s)%s:", plan->index, name, plan->scene.device,
            foot_switch_preset_names[plan->scene.switches],
            plan->from_power_on ? " from power-on" : "");
    for (unsigned i = 0; i < plan->count; i++) {
        fault_shot_tell(stream, &plan->shot[i], i > 0);
    }
    fprintf(stream, " %s, %u pushes", result->assisted ? "assisted" : "not assisted",
            result->pushes);
    fault_tick_tell(stream, "first push", result->first_push_tick);
    fault_tick_tell(stream, "noticed", result->noticed_tick);
    fprintf(stream, ", controller: %s%s", supervisor_fault_name(result->fault),
            result->late ? ", LATE" : "");
    for (int bit = 0; bit < PERSON_UNSAFE_BITS; bit++) {
        if ((result->unsafe & (1u << bit)) != 0) {
            fprintf(stream, ", UNSAFE: %s", person_unsafe_name(bit));
        }
    }
    for (int bit = 0; bit < UNSAFE_BITS; bit++) {
        if ((result->unsafe_device & (1u << bit)) != 0) {
            fprintf(stream, ", UNSAFE: %s", oracle_unsafe_name(bit));
        }
    }
    fault_tick_tell(stream, "unsafe", result->unsafe_tick);
    if (result->fall != PEOPLE_STOOD) {
        fprintf(stream, ", fell: %s", people_fall_name(result->fall));
    }
    fputc('\n', stream);
}
