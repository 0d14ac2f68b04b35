/* Walks under a law, on the return map or through the whole chain: the same question to both. */
#ifndef SIM_HOST_STUDY_LAWS_SESSION_H
#define SIM_HOST_STUDY_LAWS_SESSION_H

#include "sim_host/study/laws/laws.h"

enum { SESSION_STEPS_MAX = 4000 };

struct session_config {
    enum law_case law_case;
    const struct subject *truth; /* the body that walks; NULL: the one the law believes */
    double from_rad_s;           /* start: the steady gait of this speed */
    double to_rad_s;             /* wanted from the first step on */
    int steps;                   /* 1..SESSION_STEPS_MAX */
    double slope_rad;            /* reached by slope_ramp_rad a step; > 0 uphill */
    double slope_ramp_rad;
    double
        rise_most; /* each foothold against the one before: uniform within +- this, leg lengths */
    bool heights;  /* rises are heights of the footholds; else the incline straight up to them */
    double noise_rms;  /* map only: of the apex state seen, relative */
    double push_Ns;    /* chain only: on the torso, > 0 forward; 0 = none */
    double push_phase; /* 0..1 from an apex to the next */
    int push_step;     /* apexes before it */
    uint64_t seed;
};

/* One step of a walk. */
struct session_step {
    double speed_rad_s; /* at the apex it ends with */
    double r0_m, step_length_m;
};

struct session_result {
    bool failed; /* could not even be set up, after a message */
    bool fell;
    int steps;                 /* apexes reached after the first */
    int fallbacks;             /* steps at which the predictive law answered by eq. (16) */
    const char *reason;        /* of the fall */
    struct session_step *step; /* [config's steps], by session_records(), or NULL: not wanted */
};

/* Room for what every step of these walks is like, for results[count]. Release with session_records_free(). Returns 0,
 * or -1 after a message. */
int session_records(const struct session_config *configs, int count,
                    struct session_result *results);
void session_records_free(struct session_result *results);

/* Runs `count` >= 1 walks on options->threads threads. Walks on the map run side by side (walks.h), those through
 * the chain one after the other on each thread. results[i].step is the caller's, all else is written. Each
 * result depends on its own config alone. Returns 0, or -1 when one could not be set up, after a message. */
int session_run(const struct laws_options *options, const struct session_config *configs, int count,
                struct session_result *results);

/* Steps until the speed stays within `share` of target to the end; result->steps + 1 if it never does. */
int session_settled(const struct session_result *result, double target_rad_s, double share);

/* Mean of the last `over` speeds (fewer when there are fewer). */
double session_mean_speed(const struct session_result *result, int over);

#endif
