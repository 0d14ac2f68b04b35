#include "sim_host/cli/sim_report.h"

#include <math.h>

#include "firmware/version.h"
#include "model/tick.h"
#include "sim_host/cli/drive_report.h"
#include "sim_host/cli/experiment.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/push_report.h"
#include "sim_host/cli/recording_report.h"
#include "sim_host/cli/sim_experiment.h"
#include "sim_host/cli/walking_report.h"
#include "sim_host/devices/setup_text.h"
#include "sim_host/persons/law_name.h"
#include "sim_host/plant/walking_units.h"

static const char *side_name(enum side side)
{
    return side == SIDE_LEFT ? "left" : "right";
}

/* ---- JSON ------------------------------------------------------------------ */

static void walked_json(struct json_writer *json, const struct walk_record *record)
{
    json_open_list(json, "apex_speed_rad_s");
    for (uint32_t i = 0; i < record->count; i++) {
        json_number(json, NULL, record->rows[i].apex_speed_rad_s, 9);
    }
    json_close_list(json);
    json_open_list(json, "r0_m");
    for (uint32_t i = 0; i < record->count; i++) {
        const struct walk_row *row = &record->rows[i];
        json_number(json, NULL, row->measured ? row->r0_m : (double)NAN, 9);
    }
    json_close_list(json);
    json_open_list(json, "used_fallback");
    for (uint32_t i = 0; i < record->count; i++) {
        if (record->rows[i].measured) {
            json_bool(json, NULL, record->rows[i].used_fallback);
        } else {
            json_null(json, NULL);
        }
    }
    json_close_list(json);
}

void sim_report_json(FILE *stream, const struct sim_options *options, const struct loop *loop,
                     const struct walk_record *record, const struct sim_outcome *outcome)
{
    struct json_writer json;
    json_begin(&json, stream);
    json_open_object(&json, NULL);
    json_text(&json, "version", version_text());
    json_text(&json, "subject", loop->config.subject.person.name);
    json_text(&json, "sensors", options->sensing.preset_name);
    json_unsigned(&json, "seed", options->sensing.seed);
    json_text(&json, "law", law_name_of((enum law_mode)loop->config.params.law));
    json_bool(&json, "fell", outcome->fell);
    json_text(&json, "fault", outcome->fault[0] != '\0' ? outcome->fault : NULL);
    json_unsigned(&json, "steps", record->count);
    json_number(&json, "target_speed_rad_s", loop->config.desired_speed_rad_s, 9);
    if (recording_options_person(&options->recording)) {
        json_unsigned(&json, "apexes_left", record->apexes[SIDE_LEFT]);
        json_unsigned(&json, "apexes_right", record->apexes[SIDE_RIGHT]);
        recording_report_json(&json, &record->gait);
    }
    walking_report_json(&json, record, loop);
    push_report_json(&json, &record->push, loop);
    drive_report_json(&json, &loop->rig.task);
    walked_json(&json, record);
    json_number(&json, "bus_load", sim_bus_load(&loop->bus), 9);
    json_number(&json, "simulated_s", (double)loop->tick * (TICK_PERIOD_US / 1e6), 9);
    json_open_object(&json, "experiment");
    experiment_identity(&json, options->argc, options->argv);
    sim_experiment_json(&json, options, &loop->config);
    json_close_object(&json);
    json_close_object(&json);
    json_end(&json);
}

/* ---- CSV ------------------------------------------------------------------- */

/* A value, or nothing where there is none. */
static void cell(FILE *stream, double value, int decimals)
{
    if (value == value) {
        fprintf(stream, ",%.*f", decimals, value);
    } else {
        fputc(',', stream);
    }
}

void sim_report_csv(FILE *stream, const struct walk_record *record, double target_rad_s)
{
    const double none = (double)NAN, origin_s = record->gait.origin_s;
    fputs("step,time_s,side,apex_speed_rad_s,measured_speed_rad_s,target_speed_rad_s,r0_m,"
          "step_time_s,step_length_m,used_fallback,heel_strike_s,toe_off_s,walking_speed_m_s,"
          "push_off_J,margin_of_stability_m\n",
          stream);
    for (uint32_t i = 0; i < record->count; i++) {
        const struct walk_row *row = &record->rows[i];
        const double length_m = row->step_length_m > 0.0 ? row->step_length_m : none;
        const double from_strike_s = walking_step_time_s(record, i);
        fprintf(stream, "%u,%.6f,%s", row->number, row->time_s - origin_s, side_name(row->side));
        cell(stream, row->apex_speed_rad_s, 9);
        cell(stream, row->measured ? row->measured_speed_rad_s : none, 9);
        cell(stream, row->measured ? row->command_rad_s : target_rad_s, 9);
        cell(stream, row->measured ? row->r0_m : none, 9);
        cell(stream, i > 0 ? row->time_s - record->rows[i - 1].time_s : none, 6);
        cell(stream, length_m, 6);
        fprintf(stream, ",%s", !row->measured ? "" : row->used_fallback ? "1" : "0");
        cell(stream, row->heel_strike_s - origin_s, 6);
        cell(stream, row->toe_off_s - origin_s, 6);
        cell(stream, walking_speed_m_s(length_m, from_strike_s), 6);
        cell(stream, row->push_off_J, 6);
        cell(stream, row->margin_m, 6);
        fputc('\n', stream);
    }
}

/* A reflex person's segments, each against the vertical or the ground: positive leaning forward, swung forward, toes up.
 * And the centre of pressure below each foot, world, where the ground carries it. */
static bool has_segments(const struct loop *loop)
{
    return loop->config.plant.kind == PLANT_REFLEX_PERSON;
}

void sim_tick_header(FILE *stream, const struct loop *loop)
{
    fputs("tick,time_s,stance,phase,theta_left_rad,theta_right_rad,rate_left_rad_s,"
          "rate_right_rad_s,ankle_left_m,ankle_right_m,motor_left_m,motor_right_m,hip_x_m,hip_y_m,"
          "event,supervisor,toe_left_x_m,toe_left_y_m,toe_right_x_m,toe_right_y_m,"
          "ground_left_x_N,ground_left_y_N,ground_right_x_N,ground_right_y_N",
          stream);
    if (has_segments(loop)) {
        fputs(
            ",trunk_lean_rad,thigh_left_rad,shank_left_rad,foot_left_rad,thigh_right_rad,"
            "shank_right_rad,foot_right_rad,pressure_left_x_m,pressure_left_y_m,pressure_right_x_m,"
            "pressure_right_y_m",
            stream);
    }
    fputc('\n', stream);
}

static const char *event_name(int event)
{
    switch (event) {
    case WALK_EVENT_APEX:
        return "apex";
    case WALK_EVENT_HEEL_STRIKE:
        return "heel_strike";
    case WALK_EVENT_RELEASE:
        return "release";
    case WALK_EVENT_LIFT_OFF:
        return "lift_off";
    case WALK_EVENT_FAULT:
        return "fault";
    case WALK_EVENT_LET_GO:
        return "let_go";
    case WALK_EVENT_TAKE_HOLD:
        return "take_hold";
    case WALK_EVENT_TOE_OFF:
        return "toe_off";
    case WALK_EVENT_RECLOSED:
        return "reclosed";
    default:
        return "";
    }
}

/* As a table holds it: one word. */
static const char *supervisor_word(enum supervisor_state state)
{
    static const char *const words[SUPERVISOR_STATES] = {"init",     "self_test",    "standby",
                                                         "engaging", "walking",      "unloading",
                                                         "fault",    "commissioning"};
    return (unsigned)state < SUPERVISOR_STATES ? words[state] : "unknown";
}

/* As fields behind others; empty ones where they are not known. */
static void write_numbers(FILE *stream, const double *number, int count, bool are_known)
{
    for (int i = 0; i < count; i++) {
        if (are_known) {
            fprintf(stream, ",%.9f", number[i]);
        } else {
            fputc(',', stream);
        }
    }
}

static void segments(FILE *stream, const struct plant *plant)
{
    const double *angle = plant->reflex.body.q;
    fprintf(stream, ",%.6f", -angle[MULTIBODY_TRUNK]);
    for (int i = MULTIBODY_TRUNK + 1; i < MULTIBODY_DOF; i++) {
        fprintf(stream, ",%.6f", angle[i]);
    }
    for (int k = 0; k < SIDE_COUNT; k++) {
        const struct vector2 at = plant->reflex.pressure_m[k];
        const double place_m[2] = {-at.x, at.y};
        write_numbers(stream, place_m, 2, plant->reflex.ground_N[k].y > 0.0);
    }
}

void sim_tick_line(FILE *stream, const struct loop *loop, int event, double origin_s)
{
    static const char *const phases[] = {"held", "single", "double", "down"};
    struct plant_truth truth;
    struct sea_output motor[SIDE_COUNT];
    plant_truth(&loop->nodes.plant, &truth);
    plant_sea_output(&loop->nodes.plant, SIDE_LEFT, &motor[SIDE_LEFT]);
    plant_sea_output(&loop->nodes.plant, SIDE_RIGHT, &motor[SIDE_RIGHT]);
    const bool stands = !truth.is_person || truth.phase != WALK_HELD;
    fprintf(stream, "%llu,%.3f,%s,%s", (unsigned long long)truth.tick, truth.time_s - origin_s,
            stands ? side_name(truth.stance) : "", stands ? phases[truth.phase] : "");
    write_numbers(stream, truth.leg_angle_rad, SIDE_COUNT, true);
    write_numbers(stream, truth.leg_rate_rad_s, SIDE_COUNT, true);
    write_numbers(stream, truth.ankle_m, SIDE_COUNT, true);
    fprintf(stream, ",%.9f,%.9f", motor[SIDE_LEFT].position_m, motor[SIDE_RIGHT].position_m);
    write_numbers(stream, truth.hip_m, 2, truth.has_place);
    fprintf(stream, ",%s,%s", event_name(event), supervisor_word(loop->rig.task.output.state));
    write_numbers(stream, truth.toe_m[0], 2, truth.has_place);
    write_numbers(stream, truth.toe_m[1], 2, truth.has_place);
    write_numbers(stream, truth.ground_force_N[0], 2, truth.has_place);
    write_numbers(stream, truth.ground_force_N[1], 2, truth.has_place);
    if (has_segments(loop)) {
        segments(stream, &loop->nodes.plant);
    }
    fputc('\n', stream);
}

/* ---- for people ------------------------------------------------------------ */

static void step_lines(FILE *stream, const struct walk_record *record)
{
    /* The first, some between, the last five: enough to see the walk settle. */
    const uint32_t stride = record->count > 16 ? (record->count - 6) / 10 : 1;
    fputs("\n    step  stance   apex speed    measured     command          r0   step length\n"
          "                     (rad/s)     (rad/s)     (rad/s)         (m)           (m)\n",
          stream);
    for (uint32_t i = 0; i < record->count; i++) {
        const struct walk_row *row = &record->rows[i];
        if (i % stride != 0 && i + 5 < record->count) {
            continue;
        }
        fprintf(stream, "   %5u  %-6s   %10.6f  ", row->number, side_name(row->side),
                row->apex_speed_rad_s);
        if (row->measured) {
            fprintf(stream, "%10.6f  %10.6f  %10.6f  ", row->measured_speed_rad_s,
                    row->command_rad_s, row->r0_m);
        } else {
            fprintf(stream, "%10s  %10s  %10s  ", "-", "-", "-");
        }
        if (row->step_length_m > 0.0) {
            fprintf(stream, "%12.6f\n", row->step_length_m);
        } else {
            fprintf(stream, "%12s\n", "-"); /* the walk ended before the foot landed */
        }
    }
}

static void fallback_line(FILE *stream, const struct walk_record *record)
{
    uint32_t count = 0, last = 0;
    for (uint32_t i = 0; i < record->count; i++) {
        if (record->rows[i].used_fallback) {
            count++;
            last = record->rows[i].number;
        }
    }
    if (count > 0) {
        fprintf(
            stream,
            "  fell back  eq. (16) answered for the predictive law in %u of %u steps, last in %u\n",
            count, record->count, last);
    }
}

static void what_was_asked(FILE *stream, const struct sim_options *options, const struct loop *loop)
{
    const struct control_params *params = &loop->config.params;
    if (options->recording.path != NULL) {
        fprintf(stream, "  recording  %s\n", options->recording.path);
    }
    if (options->recording.by_reflexes) {
        char noise[32] = "none";
        const double share = loop->config.plant.reflex.noise_share;
        if (share > REFLEX_NOISE_NONE) {
            snprintf(noise, sizeof noise, "%g %%", 100.0 * share);
        }
        fprintf(stream, "  wearer     a person who walks by reflexes, noise of these: %s%s\n",
                noise,
                options->recording.without_device ? "; and feels nothing of the device" : "");
    }
    fprintf(stream, "  who        %s (M %g kg, m %g kg, l %g m, k %g N/m)\n",
            loop->config.subject.person.name, (double)params->torso_mass_kg,
            (double)params->leg_mass_kg, (double)params->leg_length_m,
            (double)params->spring_stiffness_n_m);
    if (params->law == (real)LAW_PERSON) {
        fprintf(stream, "  law        person: r0* = %g m, v* = their own mean\n",
                (double)params->start_r0_m);
    } else if (params->law == (real)LAW_OPEN_LOOP) {
        fprintf(stream, "  law        off: constant precompression r0 = %g m\n",
                (double)params->open_loop_r0_m);
    } else if (params->law == (real)LAW_PROPORTIONAL) {
        fprintf(stream, "  law        eq. (16) with kp = %.4g m per rad/s, to %g rad/s\n",
                (double)params->kp_m_s_rad, loop->config.desired_speed_rad_s);
    } else {
        fprintf(stream, "  law        %s, to %g rad/s\n", law_name_of((enum law_mode)params->law),
                loop->config.desired_speed_rad_s);
    }
    fprintf(stream, "  sensors    %s, seed %llu\n", options->sensing.preset_name,
            (unsigned long long)options->sensing.seed);
    if (ground_options_given(&options->ground)) {
        fprintf(stream, "  ground     slope %g deg, terrain %g mm, push %g N s at %g s for %g s\n",
                options->ground.slope_deg, options->ground.terrain_mm, options->ground.push_Ns,
                options->ground.push_s, options->ground.push_for_s);
    }
    if (options->release_late_s > 0.0) {
        fprintf(stream, "  latches    open %g ms late\n", 1000.0 * options->release_late_s);
    }
    if (loop->config.fault != LOOP_FAULT_NONE) {
        fprintf(stream, "  fault      %s after step %u", loop_fault_name(loop->config.fault),
                loop->config.fault_step);
        if (options->fault_delay_ms > 0) {
            fprintf(stream, " and %u ms", options->fault_delay_ms);
        }
        fputs(loop->fault_active ? "\n" : ": not reached\n", stream);
    }
}

/* Why a walk did not begin: the node that was refused, by what and by how much. */
static void refused_node(FILE *stream, const struct controller_objects *objects)
{
    char text[SETUP_TEXT_MAX];
    const struct setup_failure failure = host_report_failure(objects);
    if (objects->refused_node != 0 && failure.verdict != SETUP_DONE) {
        setup_refusal_text(&objects->device, &failure, text, sizeof text);
        fprintf(stream, "  set-up     %s\n", text);
    }
}

static const char *plural(uint32_t count)
{
    return count == 1 ? "" : "s";
}

void sim_report_text(FILE *stream, const struct sim_options *options, const struct loop *loop,
                     const struct walk_record *record, const struct sim_outcome *outcome)
{
    const double simulated_s = (double)loop->tick * (TICK_PERIOD_US / 1e6);
    const struct walk_summary last = walk_record_summary(record, 20);
    fprintf(stream, "\n  program    afo %s (build %08x)\n", version_text(),
            (unsigned)version_build_id());
    what_was_asked(stream, options, loop);
    if (outcome->fault[0] != '\0') {
        fprintf(stream, "  outcome    %s after %u step%s: %s\n", outcome->fell ? "FELL" : "STOPPED",
                record->count, plural(record->count), outcome->fault);
        refused_node(stream, &loop->rig.task.node.objects);
    } else {
        fprintf(stream, "  outcome    walked %u step%s\n", record->count, plural(record->count));
    }
    if (record->count > 0) {
        step_lines(stream, record);
        fprintf(stream, "\n  last %2u    mean %.6f rad/s, from %.6f to %.6f (spread %.3f %%)\n",
                last.over, last.mean_rad_s, last.least_rad_s, last.greatest_rad_s,
                100.0 * (last.greatest_rad_s - last.least_rad_s) / last.mean_rad_s);
    }
    walking_report_text(stream, record, loop);
    fallback_line(stream, record);
    push_report_text(stream, &record->push, loop);
    drive_report_text(stream, &loop->rig.task);
    fprintf(stream, "  bus        %.1f %% load at %g kbit/s, %llu frames, %llu error frames\n",
            100.0 * sim_bus_load(&loop->bus), BUS_BITRATE / 1e3,
            (unsigned long long)loop->bus.stats.frames,
            (unsigned long long)loop->bus.stats.error_frames);
    fprintf(stream, "  time       %.1f s of walking in %.2f s, %.0f times real time\n", simulated_s,
            outcome->wall_s, outcome->wall_s > 0.0 ? simulated_s / outcome->wall_s : 0.0);
}
