/* The functions behind the Python package afo: the same object code as build/afo, in one shared library.
 *
 * Python reads this very file for its declarations. So it has plain C types only, and of the preprocessor only
 * numbers. SI units; signs as in model/stride.h: a forward walker's stance rate is negative. An apex is three numbers:
 * stance rate rad/s, swing angle rad, swing rate rad/s.
 *
 * The caller owns all arrays. `text` has room for AFO_TEXT bytes, and receives the reason in words where a function
 * returns an error. All functions may be called from several threads at once, with objects of their own.
 */
#ifndef SIM_HOST_PYTHON_LIBRARY_H
#define SIM_HOST_PYTHON_LIBRARY_H

#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default)

#define AFO_TEXT 1024

/* Version of the program that the library is of, with git's commit. A static string. */
const char *afo_version(void);

/* ---- the return map ------------------------------------------------------------------ */

struct afo_walker {
    double M, m, l, k, g; /* kg, kg, m, N/m, m/s^2 */
};

/* 0, or -1 with the parameter that is wrong and its limits in text. */
int afo_walker_check(const struct afo_walker *walker, char *text);

/* Many walkers, each `strides` strides. Walker i starts from x[3 i]. */
struct afo_strides {
    size_t count;
    int64_t strides;
    const double *x;     /* 3 count */
    const double *r0;    /* count: push-off, m; with kp the one at the aimed speed */
    const double *speed; /* count: aimed apex speed v*, rad/s; NULL without a law */
    double kp;           /* eq. (16): r0[k] = r0 + kp (v[k] - v*), m per rad/s, >= 0; 0: no law */
    double accuracy;     /* largest error of a stride; 0: 1e-9 */
    int threads;         /* 0: one a core */
    double *next;        /* out, 3 count: NaN where there is no next apex */
    int64_t *done;       /* out, count: whole strides; may be NULL */
    int8_t *fault;       /* out, count: 0 or the fault's number; may be NULL */
    double *by_x;  /* out, 9 count: d next[i] / d x[j] of the last stride by row; may be NULL */
    double *by_r0; /* out, 3 count; NULL as by_x is. With a law r0 does not depend on x in either */
};

/* Runs them on the batch engine. 0, or -1 with text; then nothing in the arrays counts. A number that is not
 * finite is that walker's fault. Cost: about a microsecond a stride and core, eight with derivatives. */
int afo_strides_run(const struct afo_walker *walker, const struct afo_strides *job, char *text);

/* "no heel strike" and so on. A static string, also for a number that is no fault. */
const char *afo_fault_name(int fault);

/* ---- steady gaits -------------------------------------------------------------------- */

struct afo_gait {
    double r0_m, kp;
    double x[3];           /* the first apex */
    double eigenvalues[6]; /* real and imaginary parts by turns, largest magnitude first */
    double by_x[9];    /* derivative of the apex `period` strides on, by row; with the law's part */
    double by_r0[3];   /* of the same by r0; with a law the aimed speed follows */
    double residual;   /* of the fixed point; rates in units of sqrt(g/l) */
    double times_s[3]; /* of the first stride: apex to strike, double support, lift-off to apex */
    double step_length_m, inter_leg_rad;            /* of the first stride */
    double distance_m, duration_s, spring_energy_J; /* of the whole period */
    int32_t period, clamped_strides;
};

#define AFO_BRANCH_LONG 0
#define AFO_BRANCH_SHORT 1

/* A gait that repeats after `period` strides, 1..1024. guess: Newton starts from this apex; NULL: the branch is followed
 * from the paper's gait. kp as above. 0, or -1 with text. Cost: about 10 ms; some seconds for a long period. */
int afo_fixed_point(const struct afo_walker *walker, double r0_m, int branch, int period, double kp,
                    const double *guess, struct afo_gait *gait, char *text);

/* The gaits of period 1 at each of r0_m[count] in turn, each followed from the one before. Returns how many were
 * reached; where that is less than count, text says where the branch was lost. About 1 ms a gait. */
size_t afo_branch(const struct afo_walker *walker, int branch, const double *r0_m, size_t count,
                  double kp, struct afo_gait *gaits, char *text);

/* ---- basins -------------------------------------------------------------------------- */

#define AFO_BASIN_FALLS 0
#define AFO_BASIN_CONVERGES 1
#define AFO_BASIN_WALKS_ON 2

/* What becomes of `count` starts x[3 count]: 1 within 1e-4 of the long branch's gait at r0_m, 0 fallen, 2 neither after
 * `strides`. 0, or -1 with text. About a microsecond a stride and core. */
int afo_basin(const struct afo_walker *walker, double r0_m, double kp, size_t count,
              const double *x, int strides, int threads, int8_t *outcome, int32_t *strides_taken,
              char *text);

/* ---- a walk through the whole chain: control task, bus, sensors, drives, walker ------ */

/* What a law of the caller's is told at an apex. */
struct afo_law_input {
    uint32_t step;      /* 1 is the first */
    double speed_rad_s; /* forward apex speed measured, > 0 */
    double swing_angle_rad, swing_rate_rad_s;
    double desired_rad_s; /* speed asked for */
    double command_rad_s; /* v*: the same behind the ramp per step */
    double steady_r0_m;   /* finv(v*): the steady gait's push-off */
    double r0_m;          /* the last answer */
    double r0_min_m, r0_max_m,
        r0_change_max_m; /* limits behind the law: value, and change per step */
};

/* Gives the push-off wanted, m. Not finite: the last answer stays, and the walk ends. Called once per step in
 * the thread that advances the walk. */
typedef double afo_law_fn(void *context, const struct afo_law_input *input);

struct afo_walk_settings {
    const char *person, *device; /* files; NULL: the paper's walker, the virtual device */
    const char *law;             /* name; NULL: the person's, or eq. (16) */
    const char *sensors;         /* "ideal", "17bit", "14bit", "12bit"; NULL: 17bit */
    double speed_rad_s;          /* at the apex; 0: the prescribed one */
    double walking_m_s;          /* in the place of speed_rad_s; 0: not given */
    double r0_m;                 /* of the law open-loop; else 0 */
    double start_r0_m;           /* 0: the walker's own */
    double kp;                   /* below 0: the walker's own */
    uint64_t seed;
    uint32_t steps;
    double slope_deg, terrain_mm, push_Ns, push_s; /* as `afo sim` takes them */
    const char *recording;                         /* a file; NULL: none */
    const char *switches;                          /* of a person's feet; NULL: seeded */
    int32_t by_reflexes;                           /* 1: a person who walks by reflexes */
    afo_law_fn *own_law;                           /* NULL, or in the place of `law` */
    void *context;
};

struct afo_step {
    uint32_t step; /* 1 is the first apex */
    int32_t side;  /* stance leg: 0 left, 1 right */
    double time_s, apex_speed_rad_s, measured_speed_rad_s, target_speed_rad_s, r0_m, step_time_s,
        step_length_m, heel_strike_s, toe_off_s, walking_speed_m_s, push_off_J,
        margin_of_stability_m; /* NaN where there is none */
    int32_t used_fallback;     /* -1: not known */
};

struct afo_tick {
    uint64_t tick;
    double time_s;
    double theta_left_rad, theta_right_rad, rate_left_rad_s, rate_right_rad_s;
    double ankle_left_m, ankle_right_m, motor_left_m, motor_right_m;
    double hip_x_m, hip_y_m, toe_left_x_m, toe_left_y_m, toe_right_x_m, toe_right_y_m;
    double ground_left_x_N, ground_left_y_N, ground_right_x_N,
        ground_right_y_N;      /* all of the world; NaN of a recorded person */
    int32_t stance;            /* 0 left, 1 right, -1 no foot of a person is on the ground */
    int32_t phase;             /* 0 held, 1 single, 2 double, 3 down, -1 as above */
    int32_t event, supervisor; /* afo_event_name(), afo_supervisor_name() */
};

struct afo_walk;

/* A walk, ready to begin; free it with afo_walk_close(). NULL with text when the settings do not fit. */
struct afo_walk *afo_walk_open(const struct afo_walk_settings *settings, char *text);
void afo_walk_close(struct afo_walk *walk);

#define AFO_WALK_GOES_ON 0
#define AFO_WALK_DONE 1
#define AFO_WALK_ENDED 2 /* a fall, a stop, a law without an answer; text says which */

/* Walks at most `ticks` ticks of a millisecond on. rows: room for so many, or NULL; *taken receives how many were
 * walked. Call it no more once it returned another value than AFO_WALK_GOES_ON. About 10 us a tick. */
int afo_walk_advance(struct afo_walk *walk, uint32_t ticks, struct afo_tick *rows, uint32_t *taken,
                     char *text);

/* Whether the walker fell. */
int afo_walk_fell(const struct afo_walk *walk);

/* The walk's desired speed, rad/s. */
double afo_walk_speed(const struct afo_walk *walk);

/* The steps so far: fills up to `room` rows, and returns how many steps there are. */
uint32_t afo_walk_steps(const struct afo_walk *walk, struct afo_step *rows, uint32_t room);

struct afo_event {
    int32_t side; /* 0 left, 1 right */
    int32_t kind; /* afo_event_name(): 1 heel_strike, 7 toe_off */
    double time_s;
};

/* The true heel strikes and toe-offs so far, of one side behind the other: fills up to `room` rows, and returns how many
 * there are. Their time is the recording's where one is played. */
uint32_t afo_walk_events(const struct afo_walk *walk, struct afo_event *rows, uint32_t room);

/* Those that the controller reported, the same way: the moment as it estimated it. */
uint32_t afo_walk_found(const struct afo_walk *walk, struct afo_event *rows, uint32_t room);

/* Static strings; "" for an event below 0. */
const char *afo_event_name(int event);
const char *afo_supervisor_name(int state);

#pragma GCC visibility pop

#endif
