/* The return map in quadruple precision, by another road than the code under test takes.
 *
 * Written from the definition of the walker, not from the reduced equations: positions of the three masses and
 * the toes as functions of (ts, tn, r), derivatives by jets, Lagrange's equations and the plastic impact solved
 * as they stand. Double support is followed in time on the closed chain. Gragg-Bulirsch-Stoer
 * extrapolation to about 1e-24 a step; sine and cosine by their series.
 */
#ifndef TESTS_SUPPORT_QUAD_STRIDE_H
#define TESTS_SUPPORT_QUAD_STRIDE_H

struct quad_walker {
    double hip_mass_kg, leg_mass_kg, leg_length_m, ankle_stiffness_N_m, gravity_m_s2;
};

struct quad_stride {
    int whole;      /* 1: the next apex was reached; else nothing below is meant */
    double next[3]; /* stance rate, swing angle, swing rate at the next apex, rounded to double */
    double times_s[3]; /* apex to strike, double support, lift-off to apex */
    double change; /* largest difference from the same stride with half the step: its own error */
};

/* One stride from an apex (stance rate, swing angle, swing rate) with push-off push_m. About 0.1 s. */
struct quad_stride quad_stride(const struct quad_walker *walker, const double apex[3],
                               double push_m);

#endif
