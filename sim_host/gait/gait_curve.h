/* The curve of period-1 gaits on the long-period branch: push-off r0 -> apex speed and gait.
 *
 * The controller's table of finv and the start states of simulations come from here. Computed in
 * double whatever the caller is compiled for; plain doubles in and out. The same bits from every
 * compiler and machine (only + - * / sqrt and model/trig.h).
 */
#ifndef SIM_HOST_GAIT_GAIT_CURVE_H
#define SIM_HOST_GAIT_GAIT_CURVE_H

struct gait_walker {
    double hip_mass_kg, leg_mass_kg, leg_length_m, ankle_stiffness_N_m, gravity_m_s2;
};

/* Angles from the vertical, walking towards -x: stance rates are negative (model/walker.h). */
struct gait_point {
    double r0_m;
    double speed_rad_s; /* forward apex speed v = -stance rate */
    double apex[3];     /* stance rate rad/s, swing angle rad, swing rate rad/s; stance angle 0 */
    double
        strike[4]; /* just before heel strike: stance angle, swing angle rad; their rates rad/s */
    double lift_off[4]; /* just after lift-off, legs renamed: a walk may be started here */
    double apex_to_strike_s, double_support_s, lift_off_to_apex_s;
    double step_length_m; /* toe to toe */
    double inter_leg_rad; /* at heel strike */
    int clamped;          /* the ankle started from rest: see collision_clamp_m_s */
};

enum gait_curve_error {
    GAIT_CURVE_OK = 0,
    GAIT_CURVE_BAD_WALKER = -1, /* a parameter out of range */
    GAIT_CURVE_BAD_GRID =
        -2, /* r0 outside GAIT_CURVE_FLOOR..GAIT_CURVE_CEILING leg lengths, or fewer than one point */
    GAIT_CURVE_LOST = -3 /* the branch could not be followed to this walker or this far */
};

/* Slowest push-off served, in leg lengths: below it the speed goes to zero with the square root of r0. */
#define GAIT_CURVE_FLOOR 0.002
/* Longest push-off served, in leg lengths: beyond every gait of the paper. */
#define GAIT_CURVE_CEILING 0.4

/* The walker of the paper. */
struct gait_walker gait_walker_of_paper(void);

/* Fills points[0..count-1] with the gaits at r0_min_m + i * r0_step_m (r0_step_m > 0 when count > 1).
 * The caller owns the array. Each gait's residual is below 1e-12 in units of l and sqrt(g/l).
 * On GAIT_CURVE_LOST the points before *reached (may be NULL) are good.
 * Not for interrupts or the control loop: about 1 ms a point. No heap, no I/O. */
enum gait_curve_error gait_curve(const struct gait_walker *walker, double r0_min_m,
                                 double r0_step_m, int count, struct gait_point *points,
                                 int *reached);

/* The error in words; a static string, never NULL. */
const char *gait_curve_error_name(enum gait_curve_error error);

#endif
