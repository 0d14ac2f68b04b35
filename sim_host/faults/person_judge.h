/* Decides at a person, recorded or walking by reflexes, whether a run was safe: by the raw contact of the feet, the work of the
 * springs at the ankles, and what has become of the person. What the device believes, its switches' signals
 * among it, does not count.
 *
 * Unsafe, each a bit:
 *   AIR       more than 0.2 J given to, or let go at, an ankle while its own foot is in the air
 *   EARLY     the same more than 10 ms (30 ms under a false contact) and one sample before the other
 *             foot lands
 *   STANDING  the same 10 ms after the person has come to stand or has turned back, or where nobody walks
 *   FALLEN    the same on somebody who has fallen
 *   ENERGY    a push with more than 1.1 times the prescribed energy. A fault of stiffness, scale or
 *             encoder may have its own share more in its first two pushes
 *   TOE       a spring that holds the toe more than 20 mm down in swing, for more than 100 ms
 *   RANGE     a spring that would push an ankle beyond 50 degrees of plantarflexion
 *   ENABLED   a drive under torque one second after the person has fallen
 *   LOADED    a spring loaded and not latched 300 ms after the notice of a fault, or 500 ms after the
 *             person has come to stand
 *   LATCHED   a spring loaded behind a closed latch one second after either; judged apart
 * "Given": the spring's positive work; "let go": its energy at a release. A push that is released while the
 * ankle stands still does no work: it counts by its energy. What a push gives within 200 ms of a release in
 * the right phase is not EARLY, STANDING or FALLEN, where the other foot lifts again or the person stops.
 */
#ifndef SIM_HOST_FAULTS_PERSON_JUDGE_H
#define SIM_HOST_FAULTS_PERSON_JUDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"

enum person_unsafe {
    PERSON_UNSAFE_AIR = 1 << 0,
    PERSON_UNSAFE_EARLY = 1 << 1,
    PERSON_UNSAFE_STANDING = 1 << 2,
    PERSON_UNSAFE_FALLEN = 1 << 3,
    PERSON_UNSAFE_ENERGY = 1 << 4,
    PERSON_UNSAFE_TOE = 1 << 5,
    PERSON_UNSAFE_RANGE = 1 << 6,
    PERSON_UNSAFE_ENABLED = 1 << 7,
    PERSON_UNSAFE_LOADED = 1 << 8,
    PERSON_UNSAFE_LATCHED = 1 << 9,
    PERSON_UNSAFE_BITS = 10
};

/* Name of bit 0..9. */
const char *person_unsafe_name(int bit);

enum { PERSON_JUDGE_LEAD_TICKS = 64 };
#define PERSON_JUDGE_NEVER UINT32_MAX

/* What the judge is told of the person and of the faults; the caller's to fill. */
struct person_truth {
    bool walks;          /* forward walking at all */
    bool exact;          /* contacts are true to the millisecond; else nothing is EARLY */
    double stands_s;     /* of the recording: from here on the person stands */
    double sample_s;     /* of the recording */
    double prescribed_J; /* of a push */
    double fault_energy; /* the largest factor that the faults give to a push's energy; 1: none */
    bool false_contact;  /* a foot switch may close falsely */
};

struct person_judge {
    struct loop *loop; /* the caller's */
    struct person_truth truth;
    uint32_t tick;
    uint32_t noticed_tick, stood_tick, turned_tick, fell_tick; /* PERSON_JUDGE_NEVER: not */
    uint32_t first_push_tick;                                  /* a release of more than 0.2 J */
    uint32_t unsafe_tick;
    unsigned unsafe;
    unsigned pushes;             /* releases of more than 0.2 J */
    unsigned beyond[SIDE_COUNT]; /* pushes with more than 1.1 times the prescribed energy */
    double work_J[SIDE_COUNT];   /* of the spring, at the last tick */
    double air_J[SIDE_COUNT], still_J[SIDE_COUNT];
    double lead_J[SIDE_COUNT]
                 [PERSON_JUDGE_LEAD_TICKS]; /* single support: given in each of the last ticks */
    double early_J[SIDE_COUNT];             /* and before them */
    double push_J[SIDE_COUNT];              /* since the release */
    uint32_t well_until[SIDE_COUNT]; /* a push that was let go in the right phase has time to end */
    uint16_t toe_ticks[SIDE_COUNT];
    double noticed_force_N[SIDE_COUNT];
};

/* Starts at the loop as it is now. */
void person_judge_begin(struct person_judge *judge, struct loop *loop,
                        const struct person_truth *truth);

/* Looks at the loop; call it after every tick. noticed: the device has noticed a fault. Reads the plant's
 * events, so nobody else may. O(1). */
void person_judge_tick(struct person_judge *judge, bool noticed);

#endif
