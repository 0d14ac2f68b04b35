#include "sim_host/faults/summary.h"

#include <stdlib.h>

#include "model/tick.h"
#include "sim_host/faults/fault_shot.h"

enum { ROW_PAIRS = FAULT_KINDS, ROW_ALL = FAULT_KINDS + 1, ROWS = FAULT_KINDS + 2 };

struct row {
    unsigned injected, effective, noticed, fell, late, unsafe;
    uint32_t *notice_ms, *unload_ms; /* of the noticed ones */
    unsigned notices, unloads;
};

static uint32_t ms_of(uint32_t ticks)
{
    return (uint32_t)((uint64_t)ticks * TICK_PERIOD_US / 1000u);
}

static int by_size(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static bool belongs(const struct campaign_result *result, unsigned row)
{
    if (row == ROW_ALL) {
        return true;
    }
    return row == ROW_PAIRS ? result->plan.count == 2
                            : result->plan.count == 1 && (unsigned)result->plan.shot[0].kind == row;
}

static void add_result(struct row *row, const struct campaign_result *result)
{
    row->injected++;
    row->effective += result->effective ? 1 : 0;
    row->fell += result->walk_fault != WALK_FAULT_NONE ? 1 : 0;
    row->late += result->late ? 1 : 0;
    row->unsafe += result->unsafe != 0 ? 1 : 0;
    if (result->noticed_tick == ORACLE_NEVER) {
        return;
    }
    row->noticed++;
    row->notice_ms[row->notices++] = ms_of(result->noticed_tick - result->effect_tick);
    if (result->unloaded_tick != ORACLE_NEVER) {
        row->unload_ms[row->unloads++] = ms_of(result->unloaded_tick - result->noticed_tick);
    }
}

static void print_times(FILE *stream, uint32_t *ms, unsigned count, bool markdown)
{
    if (count == 0) {
        fprintf(stream, markdown ? " - | - |" : "      -      -");
        return;
    }
    qsort(ms, count, sizeof *ms, by_size);
    fprintf(stream, markdown ? " %u | %u |" : " %6u %6u", ms[count / 2], ms[count - 1]);
}

static void print_row(FILE *stream, unsigned index, struct row *row, bool markdown)
{
    const char *name = index == ROW_PAIRS ? "pairs of faults"
                       : index == ROW_ALL ? "all runs"
                                          : fault_kinds[index].name;
    if (row->injected == 0) {
        return;
    }
    fprintf(stream, markdown ? "| %s | %u | %u | %u |" : "%-34s %6u %6u %6u", name, row->injected,
            row->effective, row->noticed);
    print_times(stream, row->notice_ms, row->notices, markdown);
    print_times(stream, row->unload_ms, row->unloads, markdown);
    fprintf(stream, markdown ? " %u | %u | %u |\n" : " %6u %6u %6u\n", row->fell, row->late,
            row->unsafe);
}

static void print_head(FILE *stream, bool markdown)
{
    fputs(
        markdown
            ? "| fault | injected | effective | noticed | to notice, ms: median | worst | to unload, ms: "
              "median | worst | fell | late | unsafe |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
            : "                                               effec-  notic-  to notice ms  to "
              "unload ms\n"
              "fault                            injected   tive     ed  median  worst median  worst   "
              "fell   late unsafe\n",
        stream);
}

unsigned summary_table(FILE *stream, const struct campaign_result *results, uint32_t count,
                       bool markdown)
{
    uint32_t *times = (uint32_t *)malloc(2 * (size_t)count * sizeof *times);
    unsigned bad = 0;
    if (times == NULL) {
        fputs("afo faults: out of memory\n", stderr);
        return 1;
    }
    print_head(stream, markdown);
    for (unsigned index = 0; index < ROWS; index++) {
        struct row row = {.notice_ms = times, .unload_ms = times + count};
        for (uint32_t i = 0; i < count; i++) {
            if (belongs(&results[i], index)) {
                add_result(&row, &results[i]);
            }
        }
        print_row(stream, index, &row, markdown);
    }
    free(times);
    for (uint32_t i = 0; i < count; i++) {
        if (results[i].unsafe != 0 || results[i].late) {
            bad++;
            summary_tell(stream, &results[i]);
        }
    }
    return bad;
}

void summary_tell(FILE *stream, const struct campaign_result *result)
{
    const struct campaign_plan *plan = &result->plan;
    fprintf(stream, "run %u (%s):", plan->index, campaign_scene_name(plan->scene));
    for (unsigned i = 0; i < plan->count; i++) {
        fault_shot_tell(stream, &plan->shot[i], i > 0);
    }
    fprintf(stream, " %s", result->effective ? "effective" : "without effect");
    fault_tick_tell(stream, "felt", result->effect_tick);
    fault_tick_tell(stream, "noticed", result->noticed_tick);
    fault_tick_tell(stream, "unloaded", result->unloaded_tick);
    fprintf(stream, ", controller: %s, walker: %s%s", supervisor_fault_name(result->fault),
            walk_fault_name(result->walk_fault), result->late ? ", LATE" : "");
    for (int bit = 0; bit < UNSAFE_BITS; bit++) {
        if ((result->unsafe & (1u << bit)) != 0) {
            fprintf(stream, ", UNSAFE: %s", oracle_unsafe_name(bit));
        }
    }
    fault_tick_tell(stream, "unsafe", result->unsafe_tick);
    fputc('\n', stream);
}
