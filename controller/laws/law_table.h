/* The once-per-step laws, one row each.
 *
 * A law is one file with its row (proportional.c, dlqr.c ...) and one line of LAW_TABLE, which
 * gives it its number, its row and its name. The number is the value of the parameter `law`: it
 * appears on the bus and in files, so it never changes. Names are for people: command lines,
 * person files and messages at the host get them from here; the device is built without them.
 * The laws themselves are described in step_law.h.
 */
#ifndef CONTROLLER_LAWS_LAW_TABLE_H
#define CONTROLLER_LAWS_LAW_TABLE_H

#include <stdbool.h>

#include "model/real.h"

#define law_of REAL_SYMBOL(law_of)

/*  X(enum value, number, row of this file, name)
 *   0  paper eq. (16)
 *   1  constant r0, approached by a ramp from the start gait
 *   2  whole apex state, least quadratic cost of the linearised map
 *   3  whole apex state, the linearised map's eigenvalues all zero
 *   4  search with the return map on board: predictive_search.h
 *   8  for a person: prescribed r0, v* = their own running mean */
#define LAW_TABLE(X)                                     \
    X(LAW_PROPORTIONAL, 0, proportional, "proportional") \
    X(LAW_OPEN_LOOP, 1, open_loop, "open-loop")          \
    X(LAW_DLQR, 2, dlqr, "dlqr")                         \
    X(LAW_DEADBEAT, 3, deadbeat, "deadbeat")             \
    X(LAW_PREDICTIVE, 4, predictive, "predictive")       \
    X(LAW_PERSON, 8, person, "person")
/* The largest number of the table, as a literal: the parameter's range. */
#define LAW_LARGEST 8.0

#define LAW_ENUM(value, number, id, name) value = number,
enum law_mode { LAW_TABLE(LAW_ENUM) };
#undef LAW_ENUM

struct apex;
struct control_params;
struct step_law;

struct law {
    /* A walk begins, after step_law_init has set what all laws have. NULL: nothing more. */
    void (*init)(struct step_law *law, const struct control_params *params);
    /* One apex: the precompression wanted, m; writes law->command_rad_s. Clears law->is_final if
     * work() goes on. */
    real (*step)(struct step_law *law, const struct control_params *params, const struct apex *apex,
                 real desired_rad_s);
    /* Once a tick while the answer is not final; true when it has changed. NULL: final at once. */
    bool (*work)(struct step_law *law, const struct control_params *params);
    /* The push-off cannot wait: makes the answer final. NULL where `work` is. */
    void (*finish)(struct step_law *law);
    bool needs_branch;       /* params->branch, and the swing leg's part of the apex state */
    bool has_own_gains;      /* those of the branch: kp_m_s_rad does nothing */
    bool keeps_within_reach; /* of the motor: r0_change_max_m may be as large as r0_max_m */
};

/* The row of a parameter's value; NULL for a number that is no law's. Pure, constant
 * cost. */
const struct law *law_of(real number);

/* The row of a law: each law's file defines its own, `const struct law LAW_ROW(dlqr)`. */
#define LAW_ROW(id) REAL_SYMBOL(law_##id)
#define LAW_EXTERN(value, number, id, name) extern const struct law LAW_ROW(id);
LAW_TABLE(LAW_EXTERN)
#undef LAW_EXTERN

#endif
