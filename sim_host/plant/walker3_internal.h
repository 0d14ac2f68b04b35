/* Kinematics, masses and multipliers that motion and impacts of walker3 share;
 * nobody else includes this. Pure functions, constant cost. */
#ifndef SIM_HOST_PLANT_WALKER3_INTERNAL_H
#define SIM_HOST_PLANT_WALKER3_INTERNAL_H

#include "sim_host/plant/walker3.h"

/* Everything that depends on the configuration only. Below, e points up a leg and t
 * is the direction in which its upper end moves when the angle grows. */
struct walker3_at {
    double sin_s, cos_s, sin_n, cos_n;
    double sin_d, cos_d; /* of theta_s - theta_n */
    double hip_m;        /* L = l + r */
    double centre_m;     /* s = r + l/2 */
    double half_m;       /* l/2 */
};

/* Mass matrix from the kinetic energy of the three points; symmetric, [0][2] is 0. */
struct walker3_mass_matrix {
    double m00, m01, m11, m12, m22;
};

struct walker3_at walker3_geometry(const struct walker3_params *params,
                                   const struct walker3_state *state);

struct walker3_mass_matrix walker3_mass(const struct walker3_params *params,
                                        const struct walker3_at *at);

void walker3_mass_times(const struct walker3_mass_matrix *mass, const double x[3], double out[3]);

/* Rows of the swing toe's Jacobian, x and y. */
void walker3_toe_rows(const struct walker3_params *params, const struct walker3_at *at,
                      double swing_extension_m, double row_x[3], double row_y[3]);

double walker3_dot(const double a[3], const double b[3]);

/* The one direction in which both toes stay where they are. */
void walker3_free_direction(const double row_x[3], const double row_y[3], double n[3]);

/* Multipliers of the toe rows from J^T lambda = rest, rest in the rows' span. */
void walker3_toe_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                             double lambda[2]);

/* The same when the ankle is locked too: J^T lambda + (0, 0, lock) = rest. */
void walker3_locked_multipliers(const double row_x[3], const double row_y[3], const double rest[3],
                                double lambda[2], double *lock);

/* Sum of mass times velocity, or of mass times the part of the acceleration that
 * is linear in ddq: both are the same map of their three-vector. */
void walker3_momentum(const struct walker3_params *params, const struct walker3_at *at,
                      const double x[3], double out[2]);

/* Single support: ankle locked or free. Returns the locking force. */
double walker3_single_support(const struct walker3_mass_matrix *mass, const double f[3],
                              bool locked, double ddq[3]);

#endif
