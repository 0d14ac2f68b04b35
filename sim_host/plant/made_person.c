#include "sim_host/plant/made_person.h"

#include <stdbool.h>
#include <stdlib.h>

#include "sim_host/plant/range.h"
#include "sim_host/random/rng.h"

static const double DEG = 0.017453292519943295;
static const double USUAL_TOE_OFF = 0.62;
static const double RATE_HZ = 200.0;
/* A standing person, degrees: knee a little bent, shank back, ankle in dorsiflexion. */
static const double UPRIGHT_DEG[] = {8.0, -8.0, 5.0};

struct landmark {
    double share, deg;
};

/* The ends of the phases, and what lies between them where a phase has a peak of its own: the knee
 * straightens before the heel lands, and the thigh comes back by then. */
static const struct landmark thigh[] = {{0.00, 22}, {0.12, 18}, {0.31, 2},  {0.50, -18},
                                        {0.62, -9}, {0.75, 15}, {0.87, 27}, {0.96, 25}};
static const struct landmark knee[] = {{0.00, 3},  {0.06, 12}, {0.12, 16}, {0.31, 7},  {0.43, 7},
                                       {0.50, 12}, {0.62, 40}, {0.73, 60}, {0.87, 25}, {0.96, 1}};
static const struct landmark ankle[] = {{0.00, 0}, {0.06, -5}, {0.12, -3},  {0.31, 6},  {0.44, 10},
                                        {0.50, 7}, {0.56, -5}, {0.63, -17}, {0.75, -5}, {0.87, 1}};
#define COUNT_OF(table) (int)(sizeof(table) / sizeof((table)[0]))

static double slope(const struct landmark *table, int count, int i)
{
    const struct landmark *before = &table[i == 0 ? count - 1 : i - 1];
    const struct landmark *after = &table[i == count - 1 ? 0 : i + 1];
    const double from = before->share - (i == 0 ? 1.0 : 0.0);
    const double to = after->share + (i == count - 1 ? 1.0 : 0.0);
    return (after->deg - before->deg) / (to - from);
}

/* Catmull-Rom through the landmarks; the curve is periodic. */
static double through(const struct landmark *table, int count, double share)
{
    int i = 0;
    while (i + 1 < count && table[i + 1].share <= share) {
        i++;
    }
    const int j = i + 1 < count ? i + 1 : 0;
    const double h = table[j].share + (j == 0 ? 1.0 : 0.0) - table[i].share;
    const double u = (share - table[i].share) / h;
    const double a = table[i].deg, b = table[j].deg;
    const double ra = h * slope(table, count, i), rb = h * slope(table, count, j);
    const double c2 = 3.0 * (b - a) - 2.0 * ra - rb, c3 = 2.0 * (a - b) + ra + rb;
    return a + u * (ra + u * (c2 + u * c3));
}

void made_person_usual(struct made_person_params *params)
{
    *params = (struct made_person_params){.seconds = 20.0,
                                          .stride_s = 1.12,
                                          .size = 1.0,
                                          .toe_off = USUAL_TOE_OFF,
                                          .stride_scatter = 0.01,
                                          .seed = 1};
}

const char *made_person_check(const struct made_person_params *params)
{
    const struct range ranges[] = {
        {"seconds", params->seconds, 1.0, 1000.0},
        {"stride_s", params->stride_s, 0.6, 3.0},
        {"size", params->size, 0.2, 1.5},
        {"asymmetry", params->asymmetry, 0.0, 0.4},
        {"toe_off", params->toe_off, 0.52, 0.75},
        {"stride_scatter", params->stride_scatter, 0.0, 0.1},
    };
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

/* A stride with another share on the ground: stance and swing are stretched, each by itself. */
static double stretched(double share, double toe_off)
{
    return share < toe_off ? share * USUAL_TOE_OFF / toe_off
                           : 1.0 - (1.0 - share) * (1.0 - USUAL_TOE_OFF) / (1.0 - toe_off);
}

void made_person_angles(double share, double toe_off, double *thigh_deg, double *shank_deg,
                        double *ankle_deg)
{
    const double at = stretched(share, toe_off);
    *thigh_deg = through(thigh, COUNT_OF(thigh), at);
    *shank_deg = *thigh_deg - through(knee, COUNT_OF(knee), at);
    *ankle_deg = through(ankle, COUNT_OF(ankle), at);
}

double made_person_speed_m_s(const struct made_person_params *params, double leg_m)
{
    const double strike_deg = thigh[0].deg - 0.5 * knee[0].deg;
    return 4.0 * leg_m * DEG * strike_deg * params->size * (1.0 - 0.5 * params->asymmetry) /
           params->stride_s;
}

static double around(double upright_deg, double deg, double size)
{
    return upright_deg + size * (deg - upright_deg);
}

static void fill_leg(struct recording_sample *sample, enum side side,
                     const struct made_person_params *params, double share,
                     const struct recording_format *format)
{
    double deg[3];
    const double size = params->size * (side == SIDE_LEFT ? 1.0 - params->asymmetry : 1.0);
    made_person_angles(share, params->toe_off, &deg[0], &deg[1], &deg[2]);
    const double leg_deg =
        0.5 * (around(UPRIGHT_DEG[0], deg[0], size) + around(UPRIGHT_DEG[1], deg[1], size));
    sample->leg_angle_rad[side] = DEG * leg_deg;
    sample->plantarflexion_rad[side] = -DEG * around(UPRIGHT_DEG[2], deg[2], size);
    sample->ankle_m[side] =
        recording_ankle_m(&format->ankle[side], sample->plantarflexion_rad[side]);
    sample->contact[side] = share < params->toe_off;
}

static double fraction(double x)
{
    return x - (double)(long long)x;
}

enum recording_error made_person_record(struct recording *recording,
                                        const struct made_person_params *params,
                                        const struct recording_format *format)
{
    struct rng rng;
    const size_t count = (size_t)(params->seconds * RATE_HZ);
    double start_s = 0.0, stride_s = params->stride_s;
    *recording = (struct recording){.count = count, .has_contact = true};
    recording->samples = (struct recording_sample *)calloc(count, sizeof *recording->samples);
    if (recording->samples == NULL) {
        *recording = (struct recording){0};
        return RECORDING_NO_MEMORY;
    }
    rng_init(&rng, params->seed, 0x3AD);
    for (size_t i = 0; i < count; i++) {
        struct recording_sample *sample = &recording->samples[i];
        sample->time_s = (double)i / RATE_HZ;
        while (sample->time_s >= start_s + stride_s) {
            start_s += stride_s;
            stride_s = params->stride_s * (1.0 + params->stride_scatter * rng_normal(&rng));
        }
        const double phase = (sample->time_s - start_s) / stride_s;
        fill_leg(sample, SIDE_LEFT, params, phase, format);
        fill_leg(sample, SIDE_RIGHT, params, fraction(phase + 0.5 + 0.25 * params->asymmetry),
                 format);
    }
    return RECORDING_OK;
}
