#include "sim_host/cli/push_report.h"

#include <math.h>

enum { DIGITS = 6, FIGURES = 27 };

/* One figure of a leg. */
struct figure {
    const char *name;
    double value;
};

static const char *const legs[SIDE_COUNT] = {"left", "right"};

static double body_kg(const struct loop *loop)
{
    const struct walker3_params *body = &loop->nodes.plant.config.walk.body;
    return body->hip_mass_kg + 2.0 * body->leg_mass_kg;
}

static double percent(double share)
{
    return 100.0 * share;
}

/* Everything that is told of a leg; names end in their unit. */
static void figures_of(const struct push_record *record, const struct loop *loop, int side,
                       struct figure figure[FIGURES])
{
    const struct push_leg_record *leg = &record->leg[side];
    const struct push_leg *seen = &loop->rig.task.controller.springs.watch.leg[side];
    const bool built = loop->nodes.plant.sea[side].params.as_built;
    const bool none = !(leg->ankle_most_m >= leg->ankle_least_m);
    const double ticks = leg->ticks > 0 ? (double)leg->ticks : (double)NAN;
    const struct figure all[FIGURES] = {
        {"stances", leg->stances},
        {"pushes", leg->pushes},
        {"prescribed_given", seen->count[PUSH_GIVEN]},
        {"missed_latch_open", seen->count[PUSH_LATCH_OPEN]},
        {"missed_not_loaded", seen->count[PUSH_NOT_LOADED]},
        {"missed_not_released", seen->count[PUSH_NOT_RELEASED]},
        {"dragged_in_swing", seen->count[PUSH_DRAGS]},
        {"peak_torque_Nm", push_mean_of(&leg->torque_Nm)},
        {"most_torque_Nm", leg->most_torque_Nm},
        {"work_J", push_mean_of(&leg->work_J)},
        {"work_J_per_kg", push_mean_of(&leg->work_J) / body_kg(loop)},
        {"peak_power_W", push_mean_of(&leg->power_W)},
        {"loaded_percent", percent(push_mean_of(&leg->load_share))},
        {"release_percent", percent(push_mean_of(&leg->release_share))},
        {"end_percent", percent(push_mean_of(&leg->end_share))},
        {"swing_torque_Nm", leg->swing_Nm},
        {"stance_torque_Nm", leg->stance_Nm},
        {"ankle_least_m", none ? (double)NAN : leg->ankle_least_m},
        {"ankle_most_m", none ? (double)NAN : leg->ankle_most_m},
        {"torque_error_rms_Nm", push_record_track_Nm(leg)},
        {"limited_percent", percent((double)leg->limited_ticks / ticks)},
        {"behind_ticks", seen->behind_ticks},
        {"current_rms_A", built ? push_record_rms_A(leg) : (double)NAN},
        {"current_peak_A", built ? leg->peak_A : (double)NAN},
        {"winding_degC", built && leg->ticks > 0 ? leg->hottest_degC : (double)NAN},
        {"supply_least_V", leg->ticks > 0 ? leg->lowest_V : (double)NAN},
        {"lever_m", record->has_lever
                        ? plant_ankle_lever_m(&loop->nodes.plant, (enum side)side, 0.0)
                        : (double)NAN},
    };
    for (int i = 0; i < FIGURES; i++) {
        figure[i] = all[i];
    }
}

void push_report_json(struct json_writer *json, const struct push_record *record,
                      const struct loop *loop)
{
    struct figure figure[FIGURES];
    json_open_object(json, "push");
    for (int side = 0; side < SIDE_COUNT; side++) {
        figures_of(record, loop, side, figure);
        json_open_object(json, legs[side]);
        for (int i = 0; i < FIGURES; i++) {
            json_number(json, figure[i].name, figure[i].value, DIGITS);
        }
        json_close_object(json);
    }
    json_number(json, "work_symmetry", push_record_symmetry(record), DIGITS);
    json_close_object(json);
}

void push_report_csv(FILE *stream, const struct push_record *record, const struct loop *loop)
{
    struct figure figure[FIGURES];
    figures_of(record, loop, SIDE_LEFT, figure);
    fputs("leg", stream);
    for (int i = 0; i < FIGURES; i++) {
        fprintf(stream, ",%s", figure[i].name);
    }
    fputc('\n', stream);
    for (int side = 0; side < SIDE_COUNT; side++) {
        figures_of(record, loop, side, figure);
        fputs(legs[side], stream);
        for (int i = 0; i < FIGURES; i++) {
            if (figure[i].value == figure[i].value) {
                fprintf(stream, ",%.*g", DIGITS, figure[i].value);
            } else {
                fputc(',', stream);
            }
        }
        fputc('\n', stream);
    }
}

static void leg_lines(FILE *stream, const struct push_record *record, const struct loop *loop,
                      int side)
{
    const struct push_leg_record *leg = &record->leg[side];
    const struct push_leg *seen = &loop->rig.task.controller.springs.watch.leg[side];
    const uint32_t missed = seen->count[PUSH_LATCH_OPEN] + seen->count[PUSH_NOT_LOADED] +
                            seen->count[PUSH_NOT_RELEASED];
    fprintf(
        stream,
        "  %-5s leg  %u pushes in %u stances: %.1f N m, %.2f J (%.3f J/kg), %.0f W at peak; loaded %.0f %%, "
        "released %.1f %%, over %.1f %% of the gait cycle\n",
        legs[side], leg->pushes, leg->stances, push_mean_of(&leg->torque_Nm),
        push_mean_of(&leg->work_J), push_mean_of(&leg->work_J) / body_kg(loop),
        push_mean_of(&leg->power_W), percent(push_mean_of(&leg->load_share)),
        percent(push_mean_of(&leg->release_share)), percent(push_mean_of(&leg->end_share)));
    fprintf(
        stream,
        "             besides %.2f N m in swing, %.2f N m in stance; torque error %.2f N m RMS; ankle "
        "%.0f to %.0f mm\n",
        leg->swing_Nm, leg->stance_Nm, push_record_track_Nm(leg), 1e3 * leg->ankle_least_m,
        1e3 * leg->ankle_most_m);
    if (loop->nodes.plant.sea[side].params.as_built && leg->ticks > 0) {
        fprintf(
            stream,
            "             motor %.1f A RMS, %.1f A at peak, %.0f degC, supply down to %.1f V, at a "
            "limit in %.1f %% of the ticks\n",
            push_record_rms_A(leg), leg->peak_A, leg->hottest_degC, leg->lowest_V,
            percent((double)leg->limited_ticks / (double)leg->ticks));
    }
    if (seen->count[PUSH_DRAGS] > 0) {
        fprintf(
            stream,
            "             %u pushes dragged at the foot in swing: the motor was not back in time\n",
            (unsigned)seen->count[PUSH_DRAGS]);
    }
    fprintf(stream, "             %u prescribed pushes given, %u missed",
            (unsigned)seen->count[PUSH_GIVEN], (unsigned)missed);
    if (missed > 0) {
        fprintf(stream, ": %u latch open, %u not loaded in time, %u not released",
                (unsigned)seen->count[PUSH_LATCH_OPEN], (unsigned)seen->count[PUSH_NOT_LOADED],
                (unsigned)seen->count[PUSH_NOT_RELEASED]);
    }
    fputc('\n', stream);
}

void push_report_text(FILE *stream, const struct push_record *record, const struct loop *loop)
{
    if (!record->has_lever) {
        return; /* a compass pushes along its leg, and its report tells of its speed */
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        leg_lines(stream, record, loop, side);
    }
    const double symmetry = push_record_symmetry(record);
    if (symmetry == symmetry) {
        fprintf(stream, "  symmetry   %.0f %% (work of the weaker leg)\n", percent(symmetry));
    }
    /* A fault or a drive's need ends the assistance, too, and is told elsewhere. */
    if (loop->rig.task.controller.request_spent &&
        loop->rig.task.controller.derate.withdrew_cause == (uint8_t)DERATE_NONE &&
        loop->rig.task.controller.supervisor.latched == SUPERVISOR_FAULT_NONE) {
        fputs(
            "  withdrawn  three pushes in a row were not given, or dragged at the foot in swing\n",
            stream);
    }
}
