#include "sim_host/cli/recording_report.h"

#include <math.h>

static void list(FILE *stream, const char *name, const struct gait_moments *moments, bool known)
{
    fprintf(stream, "\"%s\": [", name);
    for (size_t i = 0; i < moments->count; i++) {
        fprintf(stream, "%s%.6f", i > 0 ? ", " : "",
                known ? moments->at[i].known_s : moments->at[i].event_s);
    }
    fputs("], ", stream);
}

static void leg(FILE *stream, const struct gait_record *record, enum side side)
{
    const struct gait_moments *seen = record->seen[side];
    list(stream, "apex_s", &seen[GAIT_APEX], false);
    list(stream, "apex_known_s", &seen[GAIT_APEX], true);
    list(stream, "heel_strike_s", &seen[GAIT_HEEL_STRIKE], false);
    list(stream, "heel_strike_known_s", &seen[GAIT_HEEL_STRIKE], true);
    list(stream, "toe_off_s", &seen[GAIT_LIFT_OFF], false);
    list(stream, "toe_off_known_s", &seen[GAIT_LIFT_OFF], true);
    list(stream, "release_s", &record->release[side], false);
    list(stream, "recorded_heel_strike_s", &record->true_strike[side], false);
    list(stream, "recorded_toe_off_s", &record->true_toe_off[side], false);
    const double error = gait_record_phase_error(record, side);
    fputs("\"gait_phase_error_rms\": ", stream);
    if (isfinite(error)) {
        fprintf(stream, "%.6f", error);
    } else {
        fputs("null", stream);
    }
}

void recording_report_json(FILE *stream, const struct gait_record *record)
{
    fputs(", \"left\": {", stream);
    leg(stream, record, SIDE_LEFT);
    fputs("}, \"right\": {", stream);
    leg(stream, record, SIDE_RIGHT);
    fputs("}", stream);
}
