#include "sim_host/programs/view_subject.h"

#include <stdio.h>
#include <stdlib.h>

#include "controller/supervisor/supervisor.h"
#include "firmware/params_guard.h"
#include "firmware/version.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/json_writer.h"

enum { DIGITS = 9 };

static void put_leg(struct json_writer *json, const struct subject *subject, int side)
{
    static const char *const names[SIDE_COUNT] = {"left", "right"};
    const struct device_leg *leg = &subject->device.description.leg[side];
    const double *number = subject->device.number[side];
    json_open_object(json, names[side]);
    json_bool(json, "driven", device_leg_is_driven(leg));
    json_number(json, "counts_per_m", number[DEVICE_LEG_counts_per_m], DIGITS);
    json_integer(json, "zero_counts", leg->zero_counts);
    json_integer(json, "direction", leg->direction);
    json_number(json, "spring_N_per_m", number[DEVICE_LEG_spring_N_per_m], DIGITS);
    json_number(json, "rated_force_N", number[DEVICE_LEG_rated_force_N], DIGITS);
    json_integer(json, "latch_bit", leg->latch_bit);
    json_integer(json, "leg_direction", leg->leg_direction);
    json_number(json, "leg_zero_rad", number[DEVICE_LEG_leg_zero_rad], DIGITS);
    json_bool(json, "lever_ankle", leg->ankle == DEVICE_ANKLE_LEVER);
    json_number(json, "ankle_lever_m", number[DEVICE_LEG_ankle_lever_m], DIGITS);
    json_number(json, "ankle_neutral_rad", number[DEVICE_LEG_ankle_neutral_rad], DIGITS);
    json_close_object(json);
}

static void put_names(struct json_writer *json)
{
    json_open_list(json, "states");
    for (int i = 0; i < SUPERVISOR_STATES; i++) {
        json_text(json, NULL, host_report_state_name((enum supervisor_state)i));
    }
    json_close_list(json);
    json_open_list(json, "faults");
    for (int i = 0; i < SUPERVISOR_FAULTS; i++) {
        json_text(json, NULL, supervisor_fault_name((enum supervisor_fault)i));
    }
    json_close_list(json);
}

static void put_parameters(struct json_writer *json, const struct control_params *params)
{
    json_open_object(json, "parameters");
    for (size_t i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *one = &control_param_descriptors[i];
        const real *value = (const real *)(const void *)((const char *)params + one->offset);
        json_number(json, one->name, (double)*value, DIGITS);
    }
    json_close_object(json);
}

static void put_all(struct json_writer *json, const struct subject *subject,
                    const struct control_params *params, double desired_speed_rad_s,
                    const struct view_options *options)
{
    real low_rad_s = REAL(0.0), high_rad_s = REAL(0.0);
    control_params_speeds(params, &low_rad_s, &high_rad_s);
    json_text(json, "person", subject->person.name);
    json_text(json, "person_file", options->sim.walk.person_path);
    json_text(json, "device", subject->device.name);
    json_text(json, "device_file", options->sim.walk.device_path);
    json_text(json, "recording", options->sim.recording.path);
    json_bool(json, "is_person", params->body != REAL(0.0));
    json_number(json, "desired_speed_rad_s", desired_speed_rad_s, DIGITS);
    json_number(json, "lowest_speed_rad_s", (double)low_rad_s, DIGITS);
    json_number(json, "highest_speed_rad_s", (double)high_rad_s, DIGITS);
    json_number(json, "tick_s", 1e-6 * TICK_PERIOD_US, DIGITS);
    json_unsigned(json, "bitrate", BUS_BITRATE);
    json_text(json, "version", version_text());
    json_unsigned(json, "build_id", version_build_id());
    put_leg(json, subject, SIDE_LEFT);
    put_leg(json, subject, SIDE_RIGHT);
    put_parameters(json, params);
    put_names(json);
}

char *view_subject_json(const struct subject *subject, const struct control_params *params,
                        double desired_speed_rad_s, const struct view_options *options)
{
    struct json_writer json;
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL) {
        return NULL;
    }
    json_begin(&json, stream);
    json_open_object(&json, NULL);
    put_all(&json, subject, params, desired_speed_rad_s, options);
    json_close_object(&json);
    json_end(&json);
    if (fclose(stream) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
