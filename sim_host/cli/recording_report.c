#include "sim_host/cli/recording_report.h"

enum { DECIMALS = 6 };

static void list(struct json_writer *json, const char *name, const struct gait_moments *moments,
                 bool known)
{
    json_open_list(json, name);
    for (size_t i = 0; i < moments->count; i++) {
        json_fixed(json, NULL, known ? moments->at[i].known_s : moments->at[i].event_s, DECIMALS);
    }
    json_close_list(json);
}

static void loads(struct json_writer *json, const char *name, const struct gait_moments *moments)
{
    json_open_list(json, name);
    for (size_t i = 0; i < moments->count; i++) {
        json_fixed(json, NULL, moments->at[i].value, DECIMALS);
    }
    json_close_list(json);
}

static void leg(struct json_writer *json, const char *name, const struct gait_record *record,
                enum side side)
{
    const struct gait_moments *seen = record->seen[side];
    json_open_object(json, name);
    list(json, "apex_s", &seen[GAIT_APEX], false);
    list(json, "apex_known_s", &seen[GAIT_APEX], true);
    list(json, "heel_strike_s", &seen[GAIT_HEEL_STRIKE], false);
    list(json, "heel_strike_known_s", &seen[GAIT_HEEL_STRIKE], true);
    list(json, "toe_off_s", &seen[GAIT_LIFT_OFF], false);
    list(json, "toe_off_known_s", &seen[GAIT_LIFT_OFF], true);
    list(json, "release_s", &record->release[side], false);
    loads(json, "release_m", &record->release[side]);
    list(json, "recorded_heel_strike_s", &record->true_strike[side], false);
    list(json, "recorded_toe_off_s", &record->true_toe_off[side], false);
    json_fixed(json, "gait_phase_error_rms", gait_record_phase_error(record, side), DECIMALS);
    json_close_object(json);
}

void recording_report_json(struct json_writer *json, const struct gait_record *record)
{
    leg(json, "left", record, SIDE_LEFT);
    leg(json, "right", record, SIDE_RIGHT);
}
