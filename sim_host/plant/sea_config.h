/* A series-elastic actuator as it is built: every value of motor, transmission, spring, lever,
 * supply, drive and latch, with the checks that tell whether it can be built.
 *
 *     struct sea_config config;
 *     sea_config_default(&config);
 *     ... sea_config_set(&config, key, value, message, size) for each line of the file ...
 *     if (sea_config_check(&config, message, size) != 0) { ... }
 *
 * Two curves are tables of points: the spring's force over its compression, and the lever over the
 * ankle's angle. In a file: spring_table = 0.01 80, 0.02 200, 0.03 400.
 *
 * No heap, no globals, no I/O. Callable from anywhere that may use double. Cost: O(number of keys).
 */
#ifndef SIM_HOST_PLANT_SEA_CONFIG_H
#define SIM_HOST_PLANT_SEA_CONFIG_H

#include <stdbool.h>
#include <stddef.h>

#include "sim_host/plant/sea_keys.h"

enum { SEA_TABLE_POINTS = 12 };

/* Points with rising x; between them a straight line. count 0: no table. */
struct sea_table {
    int count;
    double x[SEA_TABLE_POINTS], y[SEA_TABLE_POINTS];
};

#define SEA_CONFIG_FIELD(field, unit, low, high, fallback, meaning) double field;
struct sea_config {
    SEA_CONFIG_KEYS(SEA_CONFIG_FIELD)
    struct sea_table spring_table; /* x: compression, m; y: force, N; (0, 0) is implied */
    struct sea_table lever_table;  /* x: plantarflexion from neutral, rad; y: lever, m */
};
#undef SEA_CONFIG_FIELD

struct sea_key {
    const char *name, *unit, *meaning;
    double minimum, maximum;
    double fallback; /* NaN: has to be said */
    size_t offset;   /* of the double in struct sea_config, bytes */
};

#define SEA_CONFIG_COUNT(field, unit, low, high, fallback, meaning) +1
enum { SEA_KEYS = 0 SEA_CONFIG_KEYS(SEA_CONFIG_COUNT) };
#undef SEA_CONFIG_COUNT

/* In the order of SEA_CONFIG_KEYS. */
extern const struct sea_key sea_keys[SEA_KEYS];

/* Every key at its fallback; those without one are NaN; no tables. */
void sea_config_default(struct sea_config *config);

enum sea_set_result {
    SEA_SET = 0,
    SEA_SET_UNKNOWN = -1, /* no such key */
    SEA_SET_REFUSED = -2  /* not a number, not a table, or out of range */
};

/* Sets one key from its text in a file. Unless SEA_SET, message (size bytes) says why, with unit and
 * range, and *config is as before. */
enum sea_set_result sea_config_set(struct sea_config *config, const char *key, const char *text,
                                   char *message, size_t size);

/* Every key within its range, the springs and tables told once and rising. 0, or -1 with the key, what
 * was found and what is allowed in message. */
int sea_config_check(const struct sea_config *config, char *message, size_t size);

/* What the actuator is to do: the strongest push-off that may be prescribed. */
struct sea_duty {
    double precompression_m; /* r0: compression at the release */
    double load_s;           /* time there is to load it, and to go back in swing */
};

/* Whether it can be built for this duty: force of the motor against the spring's, at the peak
 * current and the supply's sag; stroke against spring, lever and limit; speed of the motor at the
 * supply's voltage; latch against the spring; energy a push against the supply. 0, or -1 with the
 * first reason in message, in units. The config has passed sea_config_check(). */
int sea_config_can_be_built(const struct sea_config *config, const struct sea_duty *duty,
                            char *message, size_t size);

/* ---- what follows from the values ------------------------------------------- */

/* Motor angle per metre of spring, rad/m. */
double sea_config_rad_per_m(const struct sea_config *config);

/* Rotor, gear and screw as a mass at the spring, kg. */
double sea_config_mass_kg(const struct sea_config *config);

/* Secant of the spring alone over the stroke, N/m: its one number for those who know linear springs. */
double sea_config_stiffness_N_per_m(const struct sea_config *config);

/* Force at the spring at a motor current of current_A, moving against the load, N. */
double sea_config_force_N(const struct sea_config *config, double current_A);

/* Current that holds force_N while the motor moves against it, A. */
double sea_config_current_A(const struct sea_config *config, double force_N);

/* Acceleration at the peak current while the motor moves against load_N, m/s^2 of spring; 0 if it
 * cannot. */
double sea_config_acceleration_m_s2(const struct sea_config *config, double load_N);

/* Speed without load at voltage_V, by the torque-speed curve, m/s of spring; the motor's permitted
 * speed and the drive's limit are not in it. */
double sea_config_no_load_m_s(const struct sea_config *config, double voltage_V);

/* Fastest speed at which the motor can give force_N at the spring from the sagging supply, m/s; 0 if
 * it cannot at all. */
double sea_config_speed_at_m_s(const struct sea_config *config, double force_N);

/* Mass of all that one leg carries, kg. */
double sea_config_total_mass_kg(const struct sea_config *config);

/* Lever at a plantarflexion from neutral, m (outside a table: its ends); and the way of the spring's
 * end from the neutral angle to there, m of spring: the integral of the lever over the angle, and
 * lever_m sin(angle) without a table. */
double sea_config_lever_at_m(const struct sea_config *config, double angle_rad);
double sea_config_way_at_m(const struct sea_config *config, double angle_rad);

/* The same of a lever by itself, which has a table or, with count 0, is constant; and the lever at a way
 * of the spring's end (60 halvings). */
double sea_lever_at_m(const struct sea_table *table, double lever_m, double angle_rad);
double sea_lever_way_m(const struct sea_table *table, double lever_m, double angle_rad);
double sea_lever_at_way_m(const struct sea_table *table, double lever_m, double way_m);
/* The plantarflexion from neutral at that way, -1.5 to 1.5 rad. */
double sea_lever_angle_rad(const struct sea_table *table, double lever_m, double way_m);

#endif
