#include "sim_host/plant/sea_spring.h"

#include <string.h>

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static void curve_of(const struct sea_config *config, struct sea_table *curve)
{
    memset(curve, 0, sizeof *curve);
    if (config->spring_table.count > 0) {
        *curve = config->spring_table;
        return;
    }
    const double stiffness =
        config->spring_N_per_m > 0.0
            ? config->spring_N_per_m
            : config->spring_Nm_rad / (config->spring_arm_m * config->spring_arm_m);
    curve->count = 1;
    curve->x[0] = config->spring_limit_m;
    curve->y[0] = stiffness * config->spring_limit_m;
}

void sea_spring_init(struct sea_spring *spring, const struct sea_config *config)
{
    memset(spring, 0, sizeof *spring);
    curve_of(config, &spring->curve);
    spring->hysteresis = config->spring_hysteresis;
    spring->limit_m = config->spring_limit_m;
    spring->two_way = config->two_way >= 0.5;
}

void sea_spring_init_with_cuff(struct sea_spring *spring, const struct sea_config *config)
{
    sea_spring_init(spring, config);
    if (config->cuff_N_per_m > 0.0) {
        for (int i = 0; i < spring->curve.count; i++) {
            spring->curve.x[i] += spring->curve.y[i] / config->cuff_N_per_m;
        }
        spring->limit_m += spring->curve.y[spring->curve.count - 1] / config->cuff_N_per_m;
    }
}

/* The straight piece that |compression| lies on: its start and its slope; the last goes on. */
static double piece(const struct sea_table *curve, double compression_m, double *from_m,
                    double *from_N)
{
    int i = 0;
    while (i + 1 < curve->count && curve->x[i] < compression_m) {
        i++;
    }
    *from_m = i > 0 ? curve->x[i - 1] : 0.0;
    *from_N = i > 0 ? curve->y[i - 1] : 0.0;
    return (curve->y[i] - *from_N) / (curve->x[i] - *from_m);
}

/* Going in and coming out enclose the hysteresis' share of twice the stored energy / 2. */
static double share(const struct sea_spring *spring, double compression_m)
{
    const double wave = compression_m < 0.0 ? -spring->wave : spring->wave;
    return 1.0 + 0.5 * spring->hysteresis * wave;
}

void sea_spring_move(struct sea_spring *spring, double compression_m)
{
    const double turn_m = SEA_SPRING_TURN * spring->limit_m;
    const double wave = spring->wave + (compression_m - spring->at_m) / (0.5 * turn_m);
    spring->wave = wave > 1.0 ? 1.0 : (wave < -1.0 ? -1.0 : wave);
    spring->at_m = compression_m;
}

double sea_spring_force_N(const struct sea_spring *spring, double compression_m)
{
    double from_m, from_N;
    if (compression_m <= 0.0 && !spring->two_way) {
        return 0.0;
    }
    const double along_m = magnitude(compression_m);
    const double stiffness = piece(&spring->curve, along_m, &from_m, &from_N);
    const double force_N = (from_N + stiffness * (along_m - from_m)) * share(spring, compression_m);
    return compression_m < 0.0 ? -force_N : force_N;
}

double sea_spring_energy_J(const struct sea_spring *spring, double compression_m)
{
    const struct sea_table *curve = &spring->curve;
    double left_m = magnitude(compression_m), energy_J = 0.0, from_m = 0.0, from_N = 0.0;
    if (compression_m <= 0.0 && !spring->two_way) {
        return 0.0;
    }
    for (int i = 0; i < curve->count && left_m > from_m; i++) {
        const double slope = (curve->y[i] - from_N) / (curve->x[i] - from_m);
        const bool last = i + 1 == curve->count || left_m <= curve->x[i];
        const double way_m = (last ? left_m : curve->x[i]) - from_m;
        energy_J += way_m * (from_N + 0.5 * slope * way_m);
        if (last) {
            break;
        }
        from_m = curve->x[i];
        from_N = curve->y[i];
    }
    return energy_J;
}

void sea_spring_line(const struct sea_spring *spring, double compression_m,
                     double *stiffness_N_per_m, double *zero_m)
{
    double from_m, from_N;
    const double along_m = magnitude(compression_m);
    const double slope = piece(&spring->curve, along_m, &from_m, &from_N);
    const double zero = from_m - from_N / slope;
    *stiffness_N_per_m = slope * share(spring, compression_m);
    *zero_m = compression_m < 0.0 ? -zero : zero;
}
