#include "sim_host/study/map/laws_timed.h"

#include <string.h>

#include "model/timed_stride.h"
#include "sim_host/gait/linear.h"
#include "sim_host/random/rng.h"
#include "sim_host/study/study_walker.h"

#define DIFFERENCE 1e-6
#define NEWTON_MAX 20
#define NEWTON_DONE 1e-10
#define R0_LOW 0.005
#define R0_HIGH 0.3
#define RICCATI_STEPS 3000
#define WEIGHT_R0 0.1
#define WEIGHT_RELEASE 10.0 /* a millisecond costs as much as a centimetre of spring */

static const double weight[3] = {1.0, 0.1, 0.01};

struct timed_map {
    struct walker walker;
    struct stride_settings settings;
    struct stride_result result;
};

static int step(struct timed_map *map, const double x[3], double r0_m, double release_s,
                double next[3])
{
    const struct apex from = {x[0], x[1], x[2]};
    if (timed_stride(&map->walker, &map->settings, &from, r0_m, release_s, &map->result) !=
        STRIDE_OK) {
        return 0;
    }
    next[0] = map->result.next.stance_rate_rad_s;
    next[1] = map->result.next.swing_angle_rad;
    next[2] = map->result.next.swing_rate_rad_s;
    return 1;
}

/* Central differences by the three states, r0 and the release. One-sided where the sides of the strike
 * differ: the release stays on its side. */
static int differentiate(struct timed_map *map, struct laws_timed_gait *gait)
{
    for (int j = 0; j < 5; j++) {
        double side[2][3];
        for (int s = 0; s < 2; s++) {
            const double shift = s == 0 ? -DIFFERENCE : DIFFERENCE;
            double x[3] = {gait->apex[0], gait->apex[1], gait->apex[2]};
            if (j < 3) {
                x[j] += shift;
            }
            if (!step(map, x, gait->r0_m + (j == 3 ? shift : 0.0),
                      gait->release_s + (j == 4 ? shift : 0.0), side[s])) {
                return 0;
            }
        }
        for (int i = 0; i < 3; i++) {
            const double slope = (side[1][i] - side[0][i]) / (2.0 * DIFFERENCE);
            *(j < 3 ? &gait->map[i][j] : &gait->input[i][j - 3]) = slope;
        }
    }
    return 1;
}

static int find_gait(struct timed_map *map, struct laws_timed_gait *gait)
{
    for (int n = 0; n < NEWTON_MAX; n++) {
        double next[3], residual[3], correction[3], largest = 0.0;
        double system[LINEAR_MAX][LINEAR_MAX] = {{0.0}};
        gait->apex[0] = -gait->speed_rad_s;
        if (!differentiate(map, gait) ||
            !step(map, gait->apex, gait->r0_m, gait->release_s, next)) {
            return 0;
        }
        for (int i = 0; i < 3; i++) {
            residual[i] = gait->apex[i] - next[i];
            largest = real_abs(residual[i]) > largest ? real_abs(residual[i]) : largest;
            system[i][0] = gait->map[i][1] - (i == 1 ? 1.0 : 0.0);
            system[i][1] = gait->map[i][2] - (i == 2 ? 1.0 : 0.0);
            system[i][2] = gait->input[i][0];
        }
        if (largest < NEWTON_DONE) {
            return 1;
        }
        if (!linear_solve(3, (const double(*)[LINEAR_MAX])system, residual, correction)) {
            return 0;
        }
        gait->apex[1] += correction[0];
        gait->apex[2] += correction[1];
        gait->r0_m += correction[2];
        if (!(gait->r0_m > 0.001 && gait->r0_m < 0.4)) {
            return 0;
        }
    }
    return 0;
}

/* Riccati iteration with one or two inputs; gain[i] belongs to input i. */
static void riccati(const struct laws_timed_gait *gait, int inputs, double gain[2][3])
{
    double p[3][3] = {{weight[0], 0, 0}, {0, weight[1], 0}, {0, 0, weight[2]}};
    for (int n = 0; n < RICCATI_STEPS; n++) {
        double pa[3][3], pb[3][2], s[2][2] = {{WEIGHT_R0, 0}, {0, WEIGHT_RELEASE}}, bpa[2][3],
                                   next[3][3];
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                pa[i][j] = p[i][0] * gait->map[0][j] + p[i][1] * gait->map[1][j] +
                           p[i][2] * gait->map[2][j];
            }
            for (int u = 0; u < inputs; u++) {
                pb[i][u] = p[i][0] * gait->input[0][u] + p[i][1] * gait->input[1][u] +
                           p[i][2] * gait->input[2][u];
            }
        }
        for (int u = 0; u < inputs; u++) {
            for (int v = 0; v < inputs; v++) {
                s[u][v] += gait->input[0][u] * pb[0][v] + gait->input[1][u] * pb[1][v] +
                           gait->input[2][u] * pb[2][v];
            }
            for (int j = 0; j < 3; j++) {
                bpa[u][j] = pb[0][u] * gait->map[0][j] + pb[1][u] * gait->map[1][j] +
                            pb[2][u] * gait->map[2][j];
            }
        }
        const double determinant = inputs == 2 ? s[0][0] * s[1][1] - s[0][1] * s[1][0] : s[0][0];
        for (int j = 0; j < 3; j++) {
            gain[0][j] = inputs == 2 ? (s[1][1] * bpa[0][j] - s[0][1] * bpa[1][j]) / determinant
                                     : bpa[0][j] / determinant;
            gain[1][j] =
                inputs == 2 ? (s[0][0] * bpa[1][j] - s[1][0] * bpa[0][j]) / determinant : 0.0;
        }
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                next[i][j] = (i == j ? weight[i] : 0.0) + gait->map[0][i] * pa[0][j] +
                             gait->map[1][i] * pa[1][j] + gait->map[2][i] * pa[2][j];
                for (int u = 0; u < inputs; u++) {
                    next[i][j] -= bpa[u][i] * gain[u][j];
                }
            }
        }
        memcpy(p, next, sizeof next);
    }
}

int laws_timed_gait(const struct gait_walker *walker, double speed_rad_s, double release_s,
                    struct laws_timed_gait *gait)
{
    struct timed_map map;
    struct eigenvalue values[3];
    double next[3], alone[2][3];
    gait->speed_rad_s = speed_rad_s;
    gait->release_s = release_s;
    if (study_walker(walker, 0.01, &map.walker, &map.settings) != 0 || !find_gait(&map, gait) ||
        !step(&map, gait->apex, gait->r0_m, release_s, next)) {
        return -1;
    }
    linear_eigenvalues3((const double(*)[3])gait->map, values);
    for (int i = 0; i < 3; i++) {
        gait->eigenvalue[i] = linear_magnitude(values[i]);
    }
    gait->step_length_m = map.result.step_length_m;
    gait->step_time_s =
        map.result.apex_to_strike_s + map.result.double_support_s + map.result.lift_off_to_apex_s;
    gait->energy_J_per_m =
        0.5 * walker->ankle_stiffness_N_m * gait->r0_m * gait->r0_m / gait->step_length_m;
    riccati(gait, 2, gait->gain);
    riccati(gait, 1, alone);
    memcpy(gait->gain_r0, alone[0], sizeof gait->gain_r0);
    return 0;
}

static int returns(struct timed_map *map, const struct laws_timed_gait *gait,
                   enum laws_timed_law law, double kp, double limit_s, const double start[3])
{
    double x[3] = {start[0], start[1], start[2]}, e[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 60; k++) {
        double r0_m = gait->r0_m, release_s = gait->release_s;
        for (int i = 0; i < 3; i++) {
            e[i] = x[i] - gait->apex[i];
            r0_m -= law == TIMED_LQR_R0 ? gait->gain_r0[i] * e[i]
                                        : (law == TIMED_LQR_BOTH ? gait->gain[0][i] * e[i] : 0.0);
            release_s -= law == TIMED_LQR_BOTH ? gait->gain[1][i] * e[i] : 0.0;
        }
        r0_m -= law == TIMED_PROPORTIONAL ? kp * e[0] : 0.0; /* e[0] = v* - v */
        release_s = real_clamp(release_s, gait->release_s - limit_s, gait->release_s + limit_s);
        if (k > 3 && real_abs(e[0]) < 0.002 && real_abs(e[1]) < 0.002 && real_abs(e[2]) < 0.02) {
            return 1;
        }
        if (!step(map, x, real_clamp(r0_m, R0_LOW, R0_HIGH), release_s, x)) {
            return 0;
        }
    }
    return real_abs(e[0]) < 0.01 * gait->speed_rad_s;
}

double laws_timed_basin(const struct gait_walker *walker, const struct laws_timed_gait *gait,
                        enum laws_timed_law law, double kp, double limit_s, const double low[3],
                        const double high[3], int samples, uint64_t seed)
{
    struct timed_map map;
    struct rng rng;
    int back = 0;
    if (study_walker(walker, 0.06, &map.walker, &map.settings) != 0) {
        return 0.0;
    }
    rng_init(&rng, seed, 73);
    for (int i = 0; i < samples; i++) {
        double x[3];
        for (int k = 0; k < 3; k++) {
            x[k] = low[k] + (high[k] - low[k]) * rng_uniform(&rng);
        }
        back += returns(&map, gait, law, kp, limit_s, x);
    }
    return (double)back / samples;
}
