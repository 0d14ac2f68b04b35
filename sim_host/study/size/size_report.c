#include "sim_host/study/size/size_report.h"

#include <math.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/plant/sea_spring.h"

enum { DIGITS = 4, FREQUENCIES = 11 };
static const double frequencies_hz[FREQUENCIES] = {1.0,  2.0,  4.0,  7.0,  10.0, 15.0,
                                                   20.0, 30.0, 40.0, 60.0, 80.0};

/* Of the chirp: a small one, m of spring, and one of nearly the whole push-off's range. */
#define CHIRP_M 0.001
#define LARGE_SHARE 0.45

/* Figures of devices that were published, for a look beside. */
static const char *const published =
    "published, motor and battery off the leg:\n"
    "    ankle exoskeletons  120 N m, 16 Hz at 50 N m and 21 Hz at 20 N m, below 0.88 kg\n"
    "                        (Witte, Zhang, Jackson, Collins, ICRA 2015)\n"
    "    ankle prosthesis    175 N m, 1.0 kW, 17 Hz, 0.96 kg (Caputo, Collins, J Biomech Eng 136, 2014)\n"
    "  and devices that take over a whole ankle give 13 to 26 J a step; an ankle itself 0.3 to 0.45 J/kg\n";

/* The limit that is used most. */
static enum size_limit nearest(const struct size_setup *setup, const struct size_row *row,
                               double *margin)
{
    double share[SIZE_LIMITS];
    int most = 0;
    size_shares(setup, row, share);
    for (int i = 1; i < SIZE_LIMITS; i++) {
        if (share[i] > share[most]) {
            most = i;
        }
    }
    *margin = 1.0 - share[most];
    return (enum size_limit)most;
}

static void head(FILE *stream, const struct size_result *result)
{
    const struct size_setup *setup = result->setup;
    const struct sea_config *config = &setup->config;
    const double r0_m = (double)setup->params.start_r0_m;
    struct sea_spring spring, pushing;
    sea_spring_init(&spring, config);
    sea_spring_init_with_cuff(&pushing, config);
    fprintf(
        stream,
        "\n  device     %s\n  person     %s\n"
        "  push-off   r0* = %.4g m: %.4g N on the latch, %.4g N m at the ankle, %.4g J stored\n"
        "  motor      %.4g N at %.4g A, %.4g N at %.4g A for ever; a rotor worth %.3g kg\n"
        "  mass       %.2f kg a leg (motor %.2f, screw %.2f, spring %.2f, supply %.2f, rest %.2f)\n",
        result->device, result->person, r0_m, sea_spring_force_N(&spring, r0_m),
        sea_spring_force_N(&pushing, r0_m) * sea_config_lever_at_m(config, 0.0),
        sea_spring_energy_J(&spring, r0_m), sea_config_force_N(config, config->current_peak_A),
        config->current_peak_A, sea_config_force_N(config, config->current_continuous_A),
        config->current_continuous_A, sea_config_mass_kg(config), sea_config_total_mass_kg(config),
        config->motor_mass_kg, config->transmission_mass_kg, config->spring_mass_kg,
        config->supply_mass_kg, config->structure_mass_kg);
}

static void motion_table(FILE *stream, const struct size_result *result)
{
    fputs("\n  cadence  pushes  torque   work  power  release   spare   swing   push-off\n"
          "   1/min            (N m)    (J)    (W)      (%)    (ms)   (N m)        (V)\n",
          stream);
    for (int i = 0; i < result->count; i++) {
        const struct size_row *row = &result->rows[i];
        fprintf(stream, "  %7.0f  %3d/%-3d %6.1f %6.2f %6.0f %8.1f %7.0f %7.2f %10.1f\n",
                row->cadence_1_min, row->pushes, SIZE_STRIDES, row->peak_torque_Nm, row->work_J,
                row->peak_power_W, 100.0 * row->release_share, 1000.0 * row->spare_s, row->swing_Nm,
                row->push_V);
    }
}

static void load_table(FILE *stream, const struct size_result *result)
{
    fputs("\n  cadence  RMS A  peak A  bus V  supply A  supply W  after 1 h  what limits\n"
          "   1/min                  least      peak      mean     (degC)  (margin)\n",
          stream);
    for (int i = 0; i < result->count; i++) {
        const struct size_row *row = &result->rows[i];
        double margin;
        const enum size_limit limit = nearest(result->setup, row, &margin);
        fprintf(stream, "  %7.0f %6.2f %7.1f %6.1f %9.1f %9.1f %10.0f  %s (%.0f %%)\n",
                row->cadence_1_min, row->rms_A, row->peak_A, row->lowest_bus_V, row->peak_supply_A,
                row->mean_supply_W, row->hour_degC, size_limit_name(limit), 100.0 * margin);
    }
}

static void use_table(FILE *stream, const struct size_result *result)
{
    fputs("\n  cadence  used of the limits, in %:\n          ", stream);
    for (int k = 0; k < SIZE_LIMITS; k++) {
        fprintf(stream, " %19s", size_limit_name((enum size_limit)k));
    }
    fputc('\n', stream);
    for (int i = 0; i < result->count; i++) {
        double share[SIZE_LIMITS];
        size_shares(result->setup, &result->rows[i], share);
        fprintf(stream, "  %7.0f ", result->rows[i].cadence_1_min);
        for (int k = 0; k < SIZE_LIMITS; k++) {
            fprintf(stream, " %19.0f", 100.0 * share[k]);
        }
        fputc('\n', stream);
    }
}

/* -3 dB between two frequencies of the list; NaN if it lies beyond. */
static double bandwidth_hz(const double gain[FREQUENCIES])
{
    for (int i = 1; i < FREQUENCIES; i++) {
        if (gain[i] < sqrt(0.5)) {
            const double part = (gain[i - 1] - sqrt(0.5)) / (gain[i - 1] - gain[i]);
            return frequencies_hz[i - 1] + part * (frequencies_hz[i] - frequencies_hz[i - 1]);
        }
    }
    return (double)NAN;
}

/* What a drive answers to sines: small, and as large as a push-off; and what the ankle feels. */
struct answers {
    double gain[FREQUENCIES], lag_rad[FREQUENCIES], large[FREQUENCIES], impedance[FREQUENCIES];
};

static void answer(const struct size_setup *setup, struct answers *answers)
{
    const double large_m = LARGE_SHARE * (double)setup->params.start_r0_m;
    for (int i = 0; i < FREQUENCIES; i++) {
        double unused;
        size_answer(setup, frequencies_hz[i], CHIRP_M, &answers->gain[i], &answers->lag_rad[i]);
        size_answer(setup, frequencies_hz[i], large_m, &answers->large[i], &unused);
        answers->impedance[i] = size_impedance_Nm_rad(setup, frequencies_hz[i]);
    }
}

static void bandwidth_line(FILE *stream, const char *name, const double gain[FREQUENCIES])
{
    const double at_hz = bandwidth_hz(gain);
    if (at_hz == at_hz) {
        fprintf(stream, "  %s %.1f Hz (-3 dB)\n", name, at_hz);
    } else {
        fprintf(stream, "  %s above %g Hz (-3 dB)\n", name, frequencies_hz[FREQUENCIES - 1]);
    }
}

static void chirp_table(FILE *stream, const struct size_result *result)
{
    const struct size_setup *setup = result->setup;
    const double large_m = LARGE_SHARE * (double)setup->params.start_r0_m;
    struct answers answers;
    answer(setup, &answers);
    fprintf(
        stream,
        "\n  the spring's force on a held load, per force asked for; torque at the ankle, per angle, "
        "behind an open latch\n"
        "       Hz  +-%-4.1f mm: gain   lag (deg)  +-%-4.1f mm: gain   impedance (N m/rad)\n",
        1e3 * CHIRP_M, 1e3 * large_m);
    for (int i = 0; i < FREQUENCIES; i++) {
        fprintf(stream, "  %7.0f  %14.3f  %10.0f  %14.3f  %20.1f\n", frequencies_hz[i],
                answers.gain[i], answers.lag_rad[i] * 57.29577951308232, answers.large[i],
                answers.impedance[i]);
    }
    bandwidth_line(stream, "bandwidth, small force", answers.gain);
    bandwidth_line(stream, "bandwidth, large force", answers.large);
}

static void beyond_lines(FILE *stream, const struct size_result *result)
{
    for (int i = 0; i < result->count; i++) {
        const struct size_row *row = &result->rows[i];
        double share[SIZE_LIMITS];
        size_shares(result->setup, row, share);
        for (int k = 0; k < SIZE_LIMITS; k++) {
            if (share[k] > 1.0) {
                fprintf(stream, "  beyond the limit at %.0f steps/min: %s, %.0f %% of it%s\n",
                        row->cadence_1_min, size_limit_name((enum size_limit)k), 100.0 * share[k],
                        k == SIZE_WINDING && row->hour_degC > SIZE_HOTTEST_DEGC ? " and more" : "");
            }
        }
        if (row->pushes < SIZE_STRIDES) {
            fprintf(stream, "  not given at %.0f steps/min: %d of %d pushes\n", row->cadence_1_min,
                    SIZE_STRIDES - row->pushes, SIZE_STRIDES);
        }
    }
}

void size_report_text(FILE *stream, const struct size_result *result)
{
    const struct sea_config *config = &result->setup->config;
    head(stream, result);
    motion_table(stream, result);
    load_table(stream, result);
    use_table(stream, result);
    beyond_lines(stream, result);
    if (config->supply_energy_Wh > 0.0) {
        const double mean_W = result->rows[result->count / 2].mean_supply_W;
        fprintf(stream, "\n  battery    %.3g W h a leg: %.1f h at %.0f steps/min\n",
                config->supply_energy_Wh, config->supply_energy_Wh / mean_W,
                result->rows[result->count / 2].cadence_1_min);
    }
    if (result->chirp) {
        chirp_table(stream, result);
    }
    fprintf(stream, "\n  %s", published);
}

void size_report_json(FILE *stream, const struct size_result *result)
{
    struct json_writer json;
    json_begin(&json, stream);
    json_open_object(&json, NULL);
    json_text(&json, "device", result->device);
    json_text(&json, "person", result->person);
    json_number(&json, "r0_m", (double)result->setup->params.start_r0_m, DIGITS);
    json_number(&json, "mass_kg", sea_config_total_mass_kg(&result->setup->config), DIGITS);
    json_open_list(&json, "cadence");
    for (int i = 0; i < result->count; i++) {
        const struct size_row *row = &result->rows[i];
        double share[SIZE_LIMITS], margin;
        json_open_object(&json, NULL);
        json_number(&json, "steps_per_min", row->cadence_1_min, DIGITS);
        json_integer(&json, "pushes", row->pushes);
        json_integer(&json, "strides", SIZE_STRIDES);
        json_number(&json, "peak_torque_Nm", row->peak_torque_Nm, DIGITS);
        json_number(&json, "work_J", row->work_J, DIGITS);
        json_number(&json, "peak_power_W", row->peak_power_W, DIGITS);
        json_number(&json, "release_share", row->release_share, DIGITS);
        json_number(&json, "spare_s", row->spare_s, DIGITS);
        json_number(&json, "swing_torque_Nm", row->swing_Nm, DIGITS);
        json_number(&json, "push_off_V", row->push_V, DIGITS);
        json_number(&json, "rms_A", row->rms_A, DIGITS);
        json_number(&json, "peak_A", row->peak_A, DIGITS);
        json_number(&json, "winding_after_hour_degC", row->hour_degC, DIGITS);
        json_number(&json, "lowest_bus_V", row->lowest_bus_V, DIGITS);
        json_number(&json, "peak_supply_A", row->peak_supply_A, DIGITS);
        json_number(&json, "mean_supply_W", row->mean_supply_W, DIGITS);
        json_text(&json, "limited_by", size_limit_name(nearest(result->setup, row, &margin)));
        json_number(&json, "margin", margin, DIGITS);
        size_shares(result->setup, row, share);
        json_open_object(&json, "used");
        for (int k = 0; k < SIZE_LIMITS; k++) {
            json_number(&json, size_limit_name((enum size_limit)k), share[k], DIGITS);
        }
        json_close_object(&json);
        json_close_object(&json);
    }
    json_close_list(&json);
    if (result->chirp) {
        struct answers answers;
        answer(result->setup, &answers);
        json_open_list(&json, "chirp");
        for (int i = 0; i < FREQUENCIES; i++) {
            json_open_object(&json, NULL);
            json_number(&json, "frequency_hz", frequencies_hz[i], DIGITS);
            json_number(&json, "gain", answers.gain[i], DIGITS);
            json_number(&json, "lag_rad", answers.lag_rad[i], DIGITS);
            json_number(&json, "large_gain", answers.large[i], DIGITS);
            json_number(&json, "impedance_Nm_rad", answers.impedance[i], DIGITS);
            json_close_object(&json);
        }
        json_close_list(&json);
        json_number(&json, "bandwidth_hz", bandwidth_hz(answers.gain), DIGITS);
        json_number(&json, "large_force_bandwidth_hz", bandwidth_hz(answers.large), DIGITS);
    }
    json_close_object(&json);
    json_end(&json);
}
