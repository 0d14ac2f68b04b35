#include "sim_host/plant/sea_config.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586

#define SEA_CONFIG_ROW(field, unit, low, high, fallback, meaning) \
    {#field, unit, meaning, low, high, fallback, offsetof(struct sea_config, field)},
const struct sea_key sea_keys[SEA_KEYS] = {SEA_CONFIG_KEYS(SEA_CONFIG_ROW)};
#undef SEA_CONFIG_ROW

static double *value_of(struct sea_config *config, const struct sea_key *key)
{
    return (double *)(void *)((char *)config + key->offset);
}

static double value_in(const struct sea_config *config, const struct sea_key *key)
{
    return *(const double *)(const void *)((const char *)config + key->offset);
}

static bool is_finite(double x)
{
    return x - x == 0.0;
}

void sea_config_default(struct sea_config *config)
{
    memset(config, 0, sizeof *config);
    for (int i = 0; i < SEA_KEYS; i++) {
        *value_of(config, &sea_keys[i]) = sea_keys[i].fallback;
    }
}

/* ---- reading ---------------------------------------------------------------- */

static int read_number(const char **text, double *number)
{
    char *end = NULL;
    errno = 0;
    *number = strtod(*text, &end);
    if (end == *text || errno == ERANGE || !is_finite(*number)) {
        return -1;
    }
    *text = end;
    return 0;
}

static void skip(const char **text, const char *what)
{
    *text += strspn(*text, what);
}

/* "x y, x y, ..." with rising x. */
static int read_table(const char *text, struct sea_table *table)
{
    struct sea_table read = {.count = 0};
    skip(&text, " \t");
    while (*text != '\0') {
        double x, y;
        if (read.count == SEA_TABLE_POINTS || read_number(&text, &x) != 0 ||
            read_number(&text, &y) != 0 || (read.count > 0 && x <= read.x[read.count - 1])) {
            return -1;
        }
        read.x[read.count] = x;
        read.y[read.count] = y;
        read.count++;
        skip(&text, " \t");
        if (*text != '\0' && *text++ != ',') {
            return -1;
        }
        skip(&text, " \t");
    }
    *table = read;
    return read.count > 0 ? 0 : -1;
}

static enum sea_set_result set_table(struct sea_table *table, const char *key, const char *text,
                                     const char *points, char *message, size_t size)
{
    if (read_table(text, table) == 0) {
        return SEA_SET;
    }
    (void)snprintf(message, size,
                   "key \"%s\": \"%.60s\" is no table; allowed are 1 to %d points \"%s\", with "
                   "commas between them, the first number of each rising",
                   key, text, SEA_TABLE_POINTS, points);
    return SEA_SET_REFUSED;
}

enum sea_set_result sea_config_set(struct sea_config *config, const char *key, const char *text,
                                   char *message, size_t size)
{
    if (strcmp(key, "spring_table") == 0) {
        return set_table(&config->spring_table, key, text, "metres newtons", message, size);
    }
    if (strcmp(key, "lever_table") == 0) {
        return set_table(&config->lever_table, key, text, "radians metres", message, size);
    }
    for (int i = 0; i < SEA_KEYS; i++) {
        const struct sea_key *row = &sea_keys[i];
        const char *rest = text;
        double number;
        if (strcmp(key, row->name) != 0) {
            continue;
        }
        if (read_number(&rest, &number) != 0 || *rest != '\0') {
            (void)snprintf(message, size, "key \"%s\" (%s): \"%.40s\" is not a number", key,
                           row->meaning, text);
            return SEA_SET_REFUSED;
        }
        if (!(number >= row->minimum && number <= row->maximum)) {
            (void)snprintf(message, size,
                           "key \"%s\" (%s): %.40s is out of range, allowed is %g to %g %s", key,
                           row->meaning, text, row->minimum, row->maximum, row->unit);
            return SEA_SET_REFUSED;
        }
        *value_of(config, row) = number;
        return SEA_SET;
    }
    (void)snprintf(message, size, "unknown key \"%.40s\" of an actuator", key);
    return SEA_SET_UNKNOWN;
}

/* ---- checks of the values ----------------------------------------------------- */

static int check_ranges(const struct sea_config *config, char *message, size_t size)
{
    for (int i = 0; i < SEA_KEYS; i++) {
        const struct sea_key *row = &sea_keys[i];
        const double value = value_in(config, row);
        if (value >= row->minimum && value <= row->maximum) {
            continue;
        }
        if (value == value) {
            (void)snprintf(message, size,
                           "key \"%s\" (%s): %g is out of range, allowed is %g to %g %s", row->name,
                           row->meaning, value, row->minimum, row->maximum, row->unit);
        } else {
            (void)snprintf(message, size, "key \"%s\" (%s) is missing, allowed is %g to %g %s",
                           row->name, row->meaning, row->minimum, row->maximum, row->unit);
        }
        return -1;
    }
    return 0;
}

static int check_spring(const struct sea_config *config, char *message, size_t size)
{
    const struct sea_table *table = &config->spring_table;
    const int told =
        (config->spring_N_per_m > 0.0) + (config->spring_Nm_rad > 0.0) + (table->count > 0);
    if (told != 1) {
        (void)snprintf(message, size,
                       "the spring is told %d times: one of \"spring_N_per_m\", \"spring_Nm_rad\" "
                       "and \"spring_table\" has to be there",
                       told);
        return -1;
    }
    if (config->spring_Nm_rad > 0.0 && !(config->spring_arm_m > 0.0)) {
        (void)snprintf(message, size,
                       "key \"spring_arm_m\" is missing: a torsion spring needs its arm, in m");
        return -1;
    }
    for (int i = 0; i < table->count; i++) {
        const double before_m = i > 0 ? table->x[i - 1] : 0.0,
                     before_N = i > 0 ? table->y[i - 1] : 0.0;
        if (!(table->x[i] > before_m && table->y[i] > before_N && table->x[i] <= 1.0 &&
              table->y[i] <= 1e6)) {
            (void)snprintf(message, size,
                           "key \"spring_table\": point %d, %g m %g N, has to lie above %g m %g N "
                           "and within 1 m and 1e6 N",
                           i + 1, table->x[i], table->y[i], before_m, before_N);
            return -1;
        }
    }
    return 0;
}

static int check_lever(const struct sea_config *config, char *message, size_t size)
{
    const struct sea_table *table = &config->lever_table;
    for (int i = 0; i < table->count; i++) {
        if (!(table->x[i] >= -1.6 && table->x[i] <= 1.6 && table->y[i] >= 0.01 &&
              table->y[i] <= 0.5)) {
            (void)snprintf(
                message, size,
                "key \"lever_table\": point %d, %g rad %g m, is out of range, allowed is "
                "-1.6 to 1.6 rad and 0.01 to 0.5 m",
                i + 1, table->x[i], table->y[i]);
            return -1;
        }
    }
    return 0;
}

static int check_drive(const struct sea_config *config, char *message, size_t size)
{
    const double periods = 1e-3 / config->drive_period_s;
    const double off = periods - (double)(int)(periods + 0.5);
    if (off > 1e-6 || off < -1e-6) {
        (void)snprintf(message, size, "key \"drive_period_s\": %g s does not divide 1 ms",
                       config->drive_period_s);
        return -1;
    }
    if (config->substep_s > config->drive_period_s) {
        (void)snprintf(message, size, "key \"substep_s\": %g s is longer than drive_period_s, %g s",
                       config->substep_s, config->drive_period_s);
        return -1;
    }
    if (config->efficiency_backward > config->efficiency_forward) {
        (void)snprintf(message, size,
                       "key \"efficiency_backward\": %g is above efficiency_forward, %g",
                       config->efficiency_backward, config->efficiency_forward);
        return -1;
    }
    if (config->current_peak_A < config->current_continuous_A) {
        (void)snprintf(message, size,
                       "key \"current_peak_A\": %g A is below current_continuous_A, %g A",
                       config->current_peak_A, config->current_continuous_A);
        return -1;
    }
    return 0;
}

/* What is either so or not. */
static int check_choices(const struct sea_config *config, char *message, size_t size)
{
    const struct {
        const char *name;
        double value;
    } choices[] = {{"two_way", config->two_way}, {"supply_shared", config->supply_shared}};
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        if (choices[i].value != 0.0 && choices[i].value != 1.0) {
            (void)snprintf(message, size, "key \"%s\": %g is neither 0 nor 1", choices[i].name,
                           choices[i].value);
            return -1;
        }
    }
    return 0;
}

/* The speed loop sees its encoder some three periods late (sea_loop.c: filter and difference), and three
 * tenths of a radian there leave it damped; the position loop around it is slower by two. */
#define LOOP_RAD_PER_PERIOD 0.1
#define POSITION_SHARE 0.5

static int check_loops(const struct sea_config *config, char *message, size_t size)
{
    const double most_rad_s = LOOP_RAD_PER_PERIOD / config->drive_period_s;
    const double least_rad_s =
        config->current_bandwidth_rad_s < most_rad_s ? config->current_bandwidth_rad_s : most_rad_s;
    if (config->speed_bandwidth_rad_s > least_rad_s) {
        (void)snprintf(
            message, size,
            "key \"speed_bandwidth_rad_s\": the loop would oscillate at %g rad/s; with this "
            "drive_period_s and current_bandwidth_rad_s %g rad/s are allowed",
            config->speed_bandwidth_rad_s, least_rad_s);
        return -1;
    }
    if (config->position_gain_1_s > POSITION_SHARE * config->speed_bandwidth_rad_s) {
        (void)snprintf(message, size,
                       "key \"position_gain_1_s\": the loop would oscillate at %g 1/s; half of "
                       "speed_bandwidth_rad_s, %g 1/s, is allowed",
                       config->position_gain_1_s, POSITION_SHARE * config->speed_bandwidth_rad_s);
        return -1;
    }
    return 0;
}

int sea_config_check(const struct sea_config *config, char *message, size_t size)
{
    return check_ranges(config, message, size) == 0 && check_spring(config, message, size) == 0 &&
                   check_lever(config, message, size) == 0 &&
                   check_drive(config, message, size) == 0 &&
                   check_choices(config, message, size) == 0 &&
                   check_loops(config, message, size) == 0
               ? 0
               : -1;
}

/* ---- what follows -------------------------------------------------------------- */

double sea_config_rad_per_m(const struct sea_config *config)
{
    return TWO_PI * config->gear_ratio / config->travel_per_turn_m;
}

double sea_config_mass_kg(const struct sea_config *config)
{
    const double rad_per_m = sea_config_rad_per_m(config);
    return (config->motor_inertia_kg_m2 + config->transmission_inertia_kg_m2) * rad_per_m *
           rad_per_m;
}

double sea_config_force_N(const struct sea_config *config, double current_A)
{
    const double rad_per_m = sea_config_rad_per_m(config);
    const double motor_N =
        (config->torque_constant_Nm_A * current_A - config->motor_coulomb_Nm) * rad_per_m;
    const double force_N = config->efficiency_forward * (motor_N - config->transmission_coulomb_N);
    return force_N > 0.0 ? force_N : 0.0;
}

double sea_config_current_A(const struct sea_config *config, double force_N)
{
    const double rad_per_m = sea_config_rad_per_m(config);
    const double motor_N = force_N / config->efficiency_forward + config->transmission_coulomb_N;
    return (motor_N / rad_per_m + config->motor_coulomb_Nm) / config->torque_constant_Nm_A;
}

double sea_config_acceleration_m_s2(const struct sea_config *config, double load_N)
{
    const double rad_per_m = sea_config_rad_per_m(config);
    const double motor_N =
        (config->torque_constant_Nm_A * config->current_peak_A - config->motor_coulomb_Nm) *
        rad_per_m;
    const double free_N =
        motor_N - load_N / config->efficiency_forward - config->transmission_coulomb_N;
    return free_N > 0.0 ? free_N / sea_config_mass_kg(config) : 0.0;
}

double sea_config_no_load_m_s(const struct sea_config *config, double voltage_V)
{
    return voltage_V / config->torque_constant_Nm_A / sea_config_rad_per_m(config);
}

double sea_config_speed_at_m_s(const struct sea_config *config, double force_N)
{
    const double current_A = sea_config_current_A(config, force_N);
    /* At full voltage the motor's current is the supply's. */
    const double voltage_V =
        config->supply_V - (config->supply_ohm + config->resistance_ohm) * current_A;
    return voltage_V > 0.0 ? sea_config_no_load_m_s(config, voltage_V) : 0.0;
}

double sea_config_total_mass_kg(const struct sea_config *config)
{
    return config->motor_mass_kg + config->transmission_mass_kg + config->spring_mass_kg +
           config->structure_mass_kg + config->supply_mass_kg;
}
