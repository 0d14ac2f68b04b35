#include "sim_host/cli/walking_report.h"

#include <math.h>

enum { DIGITS = 6, LAST_STEPS = 20 };

/* A found event belongs to a recorded one that is no further away, s. */
#define FOUND_WITHIN_S 0.15

static void means(const struct walk_record *record, const struct loop *loop,
                  struct walking *walking)
{
    /* A person keeps their pace, a walker is taken to one. */
    const bool person = loop->nodes.plant.config.kind == PLANT_RECORDED_PERSON;
    walking_of(record, loop, person ? record->count : LAST_STEPS, walking);
}

void walking_report_json(struct json_writer *json, const struct walk_record *record,
                         const struct loop *loop)
{
    struct walking walking;
    means(record, loop, &walking);
    const struct {
        const char *name;
        double value;
    } all[] = {
        {"walking_speed_m_s", walking.speed_m_s},
        {"step_length_m", walking.step_length_m},
        {"step_time_s", walking.step_time_s},
        {"cadence_per_min", walking.cadence_per_min},
        {"stance_percent", 100.0 * walking.stance_share},
        {"double_support_percent", 100.0 * walking.double_support_share},
        {"step_time_symmetry_percent", walking.step_time_symmetry_percent},
        {"push_off_J", walking.push_off_J},
        {"push_off_J_per_kg", walking.push_off_J_per_kg},
        {"cost_of_transport", walking.cost_of_transport},
        {"margin_of_stability_m", walking.margin_of_stability_m},
    };
    json_open_object(json, "walking");
    json_unsigned(json, "strides", walking.strides);
    json_bool(json, "way_by_compass", walking.by_compass);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        json_number(json, all[i].name, all[i].value, DIGITS);
    }
    json_close_object(json);
}

/* How many recorded events were found, and how late on average, s. */
static size_t found(const struct gait_moments *truth, const struct gait_moments *seen,
                    double *late_s)
{
    size_t count = 0, from = 0;
    double sum_s = 0.0;
    for (size_t i = 0; i < truth->count; i++) {
        const double at_s = truth->at[i].event_s;
        while (from < seen->count && seen->at[from].event_s < at_s - FOUND_WITHIN_S) {
            from++;
        }
        if (from < seen->count && seen->at[from].event_s <= at_s + FOUND_WITHIN_S) {
            sum_s += seen->at[from].event_s - at_s;
            count++;
            from++;
        }
    }
    *late_s = count > 0 ? sum_s / (double)count : 0.0;
    return count;
}

static void events_of(FILE *stream, const char *name, const struct gait_moments *truth,
                      const struct gait_moments *seen)
{
    double late_s;
    const size_t count = found(truth, seen, &late_s);
    fprintf(stream, "%zu of %zu %s found", count, truth->count, name);
    if (count > 0) {
        fprintf(stream, ", %.0f ms %s", 1e3 * fabs(late_s), late_s < 0.0 ? "early" : "late");
    }
    if (seen->count > count) {
        fprintf(stream, ", %zu more", seen->count - count);
    }
}

static void person_lines(FILE *stream, const struct walk_record *record)
{
    static const char *const legs[SIDE_COUNT] = {"left", "right"};
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct gait_record *gait = &record->gait;
        if (gait->true_strike[side].count == 0) {
            continue; /* nothing was recorded to judge by */
        }
        fprintf(stream, "  events     %s: ", legs[side]);
        events_of(stream, "heel strikes", &gait->true_strike[side],
                  &gait->seen[side][GAIT_HEEL_STRIKE]);
        fputs("; ", stream);
        events_of(stream, "toe-offs", &gait->true_toe_off[side], &gait->seen[side][GAIT_LIFT_OFF]);
        fputc('\n', stream);
    }
}

void walking_report_text(FILE *stream, const struct walk_record *record, const struct loop *loop)
{
    struct walking walking;
    means(record, loop, &walking);
    if (walking.strides > 0) {
        fprintf(stream,
                "  walking    %.3f m/s%s, steps of %.3f m, %.1f a minute; stance %.1f %%, double "
                "support %.1f %% of the stride; symmetry index %+.1f %% (step time)\n",
                walking.speed_m_s, walking.by_compass ? " for a leg of this length" : "",
                walking.step_length_m, walking.cadence_per_min, 100.0 * walking.stance_share,
                100.0 * walking.double_support_share, walking.step_time_symmetry_percent);
    }
    if (walking.push_off_J == walking.push_off_J) {
        fprintf(stream,
                "  push-off   %.4g J a step (%.4g J/kg), cost of transport %.4g; margin of "
                "stability %+.4f m at heel strike\n",
                walking.push_off_J, walking.push_off_J_per_kg, walking.cost_of_transport,
                walking.margin_of_stability_m);
    }
    if (walking.by_compass) {
        person_lines(stream, record);
    }
}
