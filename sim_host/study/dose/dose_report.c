/* What afo study dose says and writes. */
#include <math.h>
#include <string.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/study/dose/dose_pairs.h"

enum { DIGITS = 9, NAME_MAX_BYTES = 96 };

/* ---- rows ------------------------------------------------------------------------------ */

static void csv_row(FILE *stream, const struct dose_trial *trial, const struct dose_result *result)
{
    fprintf(stream, "%s,%llu,%d,", trial->person_path, (unsigned long long)trial->seed,
            !trial->without_device);
    if (trial->without_device) {
        fputs(",", stream);
    } else {
        fprintf(stream, "%.9g,%.9g", trial->r0_m, trial->late_s);
    }
    fprintf(stream, ",%d,%u", result->fell, result->steps);
#define FIELD(name, unit, what)                \
    fputs(",", stream);                        \
    if (!result->fell) {                       \
        fprintf(stream, "%.9g", result->name); \
    }
    DOSE_MEASURES(FIELD)
#undef FIELD
    fputs("\n", stream);
}

void dose_report_csv(FILE *stream, const struct dose_study *study)
{
    fputs("person,seed,device,r0_m,late_s,fell,steps", stream);
#define NAME(name, unit, what) fputs("," #name, stream);
    DOSE_MEASURES(NAME)
#undef NAME
    fputs("\n", stream);
    for (uint32_t i = 0; i < dose_study_walks(study); i++) {
        struct dose_trial trial;
        dose_study_trial(study, i, &trial);
        csv_row(stream, &trial, &study->result[i]);
    }
}

static void json_row(struct json_writer *json, const struct dose_trial *trial,
                     const struct dose_result *result)
{
    json_open_object(json, NULL);
    json_text(json, "person", trial->person_path);
    json_unsigned(json, "seed", trial->seed);
    json_bool(json, "device", !trial->without_device);
    if (!trial->without_device) {
        json_number(json, "r0_m", trial->r0_m, DIGITS);
        json_number(json, "late_s", trial->late_s, DIGITS);
    }
    json_bool(json, "fell", result->fell);
    json_unsigned(json, "steps", result->steps);
    if (!result->fell) {
#define FIELD(name, unit, what) json_number(json, #name, result->name, DIGITS);
        DOSE_MEASURES(FIELD)
#undef FIELD
    }
    json_close_object(json);
}

void dose_report_json(FILE *stream, const struct dose_study *study)
{
    struct json_writer json;
    json_begin(&json, stream);
    json_open_object(&json, NULL);
    json_text(&json, "of", "this model, and no people");
    json_text(&json, "device", study->device);
    json_number(&json, "push_step_N", study->push_step_N, DIGITS);
    json_open_list(&json, "walks");
    for (uint32_t i = 0; i < dose_study_walks(study); i++) {
        struct dose_trial trial;
        dose_study_trial(study, i, &trial);
        json_row(&json, &trial, &study->result[i]);
    }
    json_close_list(&json);
    json_close_object(&json);
    json_end(&json);
}

/* ---- sentences ------------------------------------------------------------------------- */

static void tell_dose(FILE *stream, const struct dose_study *study, uint32_t person, uint32_t late,
                      uint32_t r0)
{
    struct dose_pairs pairs;
    dose_pair_up(study, person, late, r0, &pairs);
    const struct dose_result *with = &pairs.with, *alone = &pairs.alone;
    fprintf(stream, "  r0 %g m", study->r0_m[r0]);
    if (pairs.fell > 0) {
        fprintf(
            stream,
            ": this model falls in %u of %u walks, after %u steps at the earliest; without the device in %u",
            pairs.fell, study->seeds, pairs.earliest, pairs.fell_alone);
    }
    if (pairs.count > 0) {
        fprintf(
            stream,
            ": the device gives this model %.2f J a metre; its own ankle work a metre changes by %+.1f %% (%+.1f to %+.1f in %u pairs), its hip work by "
            "%+.1f %%, its activation by %+.1f %%; this model walks at %.3f m/s (%.3f without), with %.1f steps a minute (%.1f)",
            with->device_J_m, dose_percent(with->ankle_J_m, alone->ankle_J_m), pairs.least_percent,
            pairs.most_percent, pairs.count, dose_percent(with->hip_J_m, alone->hip_J_m),
            dose_percent(with->activation, alone->activation), with->speed_m_s, alone->speed_m_s,
            with->cadence_per_min, alone->cadence_per_min);
    }
    if (pairs.count > 0 && study->push_step_N > 0.0) {
        fprintf(stream, "; it survives %.0f N forward (%.0f)", with->push_margin_N,
                alone->push_margin_N);
    }
    fputs("\n", stream);
}

static void tell_margin(FILE *stream, const struct dose_study *study, uint32_t person,
                        uint32_t late)
{
    const double holds_m = dose_margin_holds_m(study, person, late);
    fputs("  this model keeps walking and half of its push margin, in every pair, ", stream);
    if (holds_m > 0.0) {
        fprintf(stream, "up to r0 %g m\n", holds_m);
    } else {
        fprintf(stream, "with no r0 from %g m on\n", study->r0_m[0]);
    }
}

static void tell_alone(FILE *stream, const struct dose_study *study, uint32_t person)
{
    uint32_t fell = 0;
    for (uint32_t seed = 0; seed < study->seeds; seed++) {
        fell += dose_study_alone(study, person, seed)->fell ? 1 : 0;
    }
    const struct dose_result *first = dose_study_alone(study, person, 0);
    fprintf(stream, "\n%s, without the device: this model falls in %u of %u walks of %u steps",
            study->person[person], fell, study->seeds, study->steps);
    if (!first->fell) {
        fprintf(stream, "; with seed 1 it does %.1f J of ankle work and %.1f J of hip work a metre",
                first->ankle_J_m, first->hip_J_m);
    }
    fputs("\n", stream);
}

void dose_report_text(FILE *stream, const struct dose_study *study)
{
    fprintf(stream, "\nAll of it is what this model does; it says nothing about people.\n");
    if (study->push_step_N > 0.0) {
        fprintf(
            stream,
            "A push is a force forward at the hip for 0.2 s, in one phase of one walk; its margin is known to "
            "%g N.\n",
            study->push_step_N);
    }
    for (uint32_t person = 0; person < study->persons; person++) {
        tell_alone(stream, study, person);
        for (uint32_t late = 0; late < study->lates; late++) {
            fprintf(stream, " latches %g ms late\n", 1000.0 * study->late_s[late]);
            for (uint32_t r0 = 0; r0 < study->r0s; r0++) {
                tell_dose(stream, study, person, late, r0);
            }
            if (study->push_step_N > 0.0) {
                tell_margin(stream, study, person, late);
            }
        }
    }
}

/* ---- table ----------------------------------------------------------------------------- */

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static void table_row(FILE *stream, const struct dose_study *study, uint32_t person, uint32_t late,
                      uint32_t r0)
{
    struct dose_pairs pairs;
    dose_pair_up(study, person, late, r0, &pairs);
    const struct dose_result *with = &pairs.with, *alone = &pairs.alone;
    fprintf(stream, "| %s | %g | %g | %u (%u) |", base_name(study->person[person]), study->r0_m[r0],
            1000.0 * study->late_s[late], pairs.fell, pairs.fell_alone);
    if (pairs.count == 0) {
        fputs(" | | | | | | |\n", stream);
        return;
    }
    fprintf(stream, " %.2f | %+.1f (%+.1f to %+.1f) | %+.1f | %+.1f | %.3f (%.3f) | %.1f (%.1f) |",
            with->device_J_m, dose_percent(with->ankle_J_m, alone->ankle_J_m), pairs.least_percent,
            pairs.most_percent, dose_percent(with->hip_J_m, alone->hip_J_m),
            dose_percent(with->activation, alone->activation), with->speed_m_s, alone->speed_m_s,
            with->cadence_per_min, alone->cadence_per_min);
    if (study->push_step_N > 0.0) {
        fprintf(stream, " %.0f (%.0f)", with->push_margin_N, alone->push_margin_N);
    }
    fputs(" |\n", stream);
}

void dose_report_markdown(FILE *stream, const struct dose_study *study)
{
    fprintf(
        stream,
        "What this model does; it says nothing about people. In brackets: without the device.\n\n"
        "| person | r0, m | latch late, ms | falls of %u | device, J/m | own ankle work, %% | "
        "own hip work, %% | activation, %% | speed, m/s | steps a minute | push margin, N |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        study->seeds);
    for (uint32_t person = 0; person < study->persons; person++) {
        for (uint32_t late = 0; late < study->lates; late++) {
            for (uint32_t r0 = 0; r0 < study->r0s; r0++) {
                table_row(stream, study, person, late, r0);
            }
        }
    }
    fputs("\n| person | latch late, ms | keeps walking and half of its push margin up to r0, m |\n"
          "|---|--:|--:|\n",
          stream);
    for (uint32_t i = 0; i < study->persons * study->lates && study->push_step_N > 0.0; i++) {
        const uint32_t person = i / study->lates, late = i % study->lates;
        fprintf(stream, "| %s | %g | %g |\n", base_name(study->person[person]),
                1000.0 * study->late_s[late], dose_margin_holds_m(study, person, late));
    }
}

/* ---- picture --------------------------------------------------------------------------- */

static void plot_row(FILE *stream, const struct dose_study *study, const char *who, double r0_m,
                     const struct dose_result *result)
{
    const bool asks_for_pushes = study->push_step_N > 0.0;
    fprintf(stream, "%s,%.9g", who, r0_m);
#define FIELD(name, unit, what)                                                          \
    if (result->fell || (&result->name == &result->push_margin_N && !asks_for_pushes)) { \
        fputs(",", stream);                                                              \
    } else {                                                                             \
        fprintf(stream, ",%.9g", result->name);                                          \
    }
    DOSE_MEASURES(FIELD)
#undef FIELD
    fputs("\n", stream);
}

void dose_report_plot(FILE *stream, const struct dose_study *study)
{
    fputs("who,r0_m", stream);
#define NAME(name, unit, what) fputs("," #name, stream);
    DOSE_MEASURES(NAME)
#undef NAME
    fputs("\n", stream);
    const uint32_t lines = study->persons * study->seeds * study->lates;
    for (uint32_t i = 0; i < lines; i++) {
        const uint32_t late = i % study->lates, seed = i / study->lates % study->seeds,
                       person = i / study->lates / study->seeds;
        char who[NAME_MAX_BYTES];
        (void)snprintf(who, sizeof who, "%.60s; seed %u; %g ms", base_name(study->person[person]),
                       seed + 1, 1000.0 * study->late_s[late]);
        plot_row(stream, study, who, 0.0, dose_study_alone(study, person, seed));
        for (uint32_t r0 = 0; r0 < study->r0s; r0++) {
            plot_row(stream, study, who, study->r0_m[r0],
                     dose_study_with(study, person, seed, late, r0));
        }
    }
}
