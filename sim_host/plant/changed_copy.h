/* Changed copies of a recorded or made walk, each by a formula: the same as scripts/people_copies.py.
 *
 * "Around standing" scales an angle's distance from that of a standing person: leg upright, ankle at 5
 * degrees of dorsiflexion. A copy says from when on the person stands, and whether anything in it is
 * forward walking at all; the judge needs both.
 * Uses the heap (the samples). Not for the control loop.
 */
#ifndef SIM_HOST_PLANT_CHANGED_COPY_H
#define SIM_HOST_PLANT_CHANGED_COPY_H

#include <stdbool.h>
#include <stddef.h>

#include "sim_host/plant/recording.h"

/* X(NAME, name, walks) */
#define COPY_TABLE(X)                                                                              \
    X(PLAIN, "plain", true)          /* as it is */                                                \
    X(SLOW, "slow", true)            /* 0.6 around standing, 1.8 times the period */               \
    X(SHORT, "short", true)          /* 0.5 around standing */                                     \
    X(LIMP, "limp", true)            /* left 0.7 around standing, its stance 0.85 of the time */   \
    X(LIMP_40, "limp-40", true)      /* left 0.6 around standing, its stance 0.8 of the time */    \
    X(TRIP, "trip", true)            /* every 7 s a swing leg is held for 150 ms */                \
    X(GAP, "gap", true)              /* every 5.37 s 100 ms of samples are missing */              \
    X(OFFSET, "offset", true)        /* the left leg reads 5 degrees too much */                   \
    X(NEUTRAL, "neutral", true)      /* both ankles read 5 degrees too much plantarflexion */      \
    X(DRIFT, "drift", true)          /* left 3 sin(t / 3 s), right 2 sin(t / 5 s) degrees */       \
    X(QUICK, "quick", true)          /* after two thirds the pace rises by 30 % */                 \
    X(STOP, "stop", true)            /* at two thirds, and a share of a stride later, it stands */ \
    X(LEG_HELD, "leg-held", true)    /* from two thirds on the left leg is held in the air */      \
    X(BACKWARDS, "backwards", false) /* from its end to its beginning */                           \
    X(HARNESS, "harness", false)     /* no contact, ankles at neutral */                           \
    X(ROCKING, "rocking", false)     /* both legs +-6 degrees at 0.7 Hz, feet down */              \
    X(SCISSORING, "scissoring", false)   /* legs +-12 degrees against each other at 0.9 Hz */      \
    X(ON_THE_SPOT, "on-the-spot", false) /* feet lifted by the knee at 0.9 Hz, put down there */

#define COPY_ENUM(NAME, name, walks) COPY_##NAME,
enum copy_kind { COPY_TABLE(COPY_ENUM) COPY_KINDS };
#undef COPY_ENUM

struct copy_kind_info {
    const char *name;
    bool walks;
};
extern const struct copy_kind_info copy_kinds[COPY_KINDS];

struct copy_truth {
    bool walks;      /* there is forward walking in it */
    double stands_s; /* from here on the person stands, s of the copy; COPY_NEVER: they do not */
};
#define COPY_NEVER 1e9

/* Makes the copy of *source. phase: 0 .. 1, of COPY_STOP: the share of a left stride. RECORDING_OK;
 * RECORDING_TOO_SHORT where the source has no stride to stop in; RECORDING_NO_MEMORY. Unless OK *copy is
 * empty. The caller frees it. Cost O(samples). */
enum recording_error changed_copy_make(struct recording *copy, const struct recording *source,
                                       enum copy_kind kind, double phase,
                                       const struct recording_format *format,
                                       struct copy_truth *truth);

/* The samples of [from_s, from_s + seconds], with times from 0 on. */
enum recording_error changed_copy_window(struct recording *window, const struct recording *source,
                                         double from_s, double seconds);

#endif
