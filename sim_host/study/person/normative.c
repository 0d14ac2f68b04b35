#include "sim_host/study/person/normative.h"

#include <math.h>

const struct normative_curve normative_curves[NORMATIVE_CURVES] = {
    [CURVE_ANGLE +
     JOINT_HIP] = {"hip flexion", "deg", 6.1, {35.8, 35.5, 34.2, 31.1, 26.9, 22.5, 18.1, 13.6, 9.3,
                                               5.3,  1.6,  -1.7, -4.4, -5.8, -4.9, -0.9, 6.1,  14.1,
                                               21.4, 27.4, 32.0, 35.1, 36.6, 36.5, 35.8, 35.5}},
    [CURVE_ANGLE +
        JOINT_KNEE] = {"knee flexion", "deg", 6.3, {5.6,  10.9, 16.9, 19.3, 18.6, 16.5, 13.9,
                                                    11.3, 9.0,  7.2,  6.2,  6.8,  9.5,  14.5,
                                                    22.6, 33.9, 46.3, 55.7, 59.1, 56.9, 49.8,
                                                    38.8, 25.5, 12.5, 4.6,  5.4}},
    [CURVE_ANGLE + JOINT_ANKLE] = {"ankle dorsiflexion",
                                   "deg",
                                   5.3,
                                   {-2.1, -5.6, -4.1, -0.2, 2.9, 5.2,  6.8,   8.0,   9.1,
                                    10.2, 11.1, 11.8, 11.5, 8.4, -0.2, -13.8, -19.8, -14.7,
                                    -7.9, -2.4, 1.1,  2.5,  1.8, 0.1,  -1.1,  -2.3}},
    [CURVE_MOMENT + JOINT_HIP] = {"hip extension moment",
                                  "N m/kg",
                                  0.15,
                                  {0.12,  0.54,  0.50,  0.44,  0.32,  0.17,  0.09,  0.03,  -0.03,
                                   -0.12, -0.25, -0.42, -0.58, -0.62, -0.43, -0.32, -0.21, -0.14,
                                   -0.08, -0.03, -0.02, 0.00,  0.11,  0.28,  0.34,  0.12}},
    [CURVE_MOMENT + JOINT_KNEE] = {"knee extension moment",
                                   "N m/kg",
                                   0.11,
                                   {-0.13, -0.07, 0.23,  0.37,  0.30,  0.17,  0.03,  -0.06, -0.14,
                                    -0.20, -0.24, -0.22, -0.10, 0.06,  0.14,  0.10,  0.08,  0.08,
                                    0.05,  0.02,  0.00,  -0.03, -0.10, -0.20, -0.26, -0.13}},
    [CURVE_MOMENT + JOINT_ANKLE] = {"ankle plantarflexion moment",
                                    "N m/kg",
                                    0.12,
                                    {0.00,  -0.13, -0.06, 0.06,  0.18,  0.31,  0.44, 0.56,  0.69,
                                     0.84,  1.00,  1.16,  1.23,  1.07,  0.56,  0.05, -0.03, -0.02,
                                     -0.01, -0.01, -0.01, -0.01, -0.02, -0.01, 0.00, 0.00}},
};

void normative_compare(const struct normative_curve *norm, const double curve[GAIT_POINTS],
                       struct normative_match *match)
{
    const int every = (GAIT_POINTS - 1) / (NORMATIVE_POINTS - 1);
    double sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0, squares = 0.0;
    for (int i = 0; i < NORMATIVE_POINTS; i++) {
        sum_a += curve[every * i] / NORMATIVE_POINTS;
        sum_b += norm->mean[i] / NORMATIVE_POINTS;
    }
    for (int i = 0; i < NORMATIVE_POINTS; i++) {
        const double a = curve[every * i] - sum_a, b = norm->mean[i] - sum_b;
        const double off = curve[every * i] - norm->mean[i];
        aa += a * a;
        bb += b * b;
        ab += a * b;
        squares += off * off;
    }
    match->r = ab / sqrt(aa * bb);
    match->rms = sqrt(squares / NORMATIVE_POINTS);
    match->offset = sum_a - sum_b;
}
