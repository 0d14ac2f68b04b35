/* The bodies whose gait the observer can look at, one row each.
 *
 * A body is one file with its row (compass_body.c, person_body.c) and one line of BODY_TABLE. Its
 * number is the value of the parameter `body`: it appears on the bus and in files, so it never
 * changes. The names go into the parameter's description, which only the host has.
 */
#ifndef CONTROLLER_ESTIMATOR_BODY_TABLE_H
#define CONTROLLER_ESTIMATOR_BODY_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "model/real.h"
#include "model/side.h"

#define body_of REAL_SYMBOL(body_of)

/*  X(enum value, number, row of this file, name) */
#define BODY_TABLE(X)                             \
    X(BODY_COMPASS, 0, compass, "compass walker") \
    X(BODY_PERSON, 1, person, "person")
/* The largest number of the table, as a literal: the parameter's range. */
#define BODY_LARGEST 1.0

#define BODY_ENUM(value, number, id, name) value = number,
enum body_kind { BODY_TABLE(BODY_ENUM) };
#undef BODY_ENUM

struct body_state;
struct body_tick;
struct control_params;
struct gait_state;

struct body {
    /* Once a tick: finds heel strikes and lift-offs and writes them into the gait's state. */
    void (*update)(struct body_state *state, const struct body_tick *now);
    /* The leg of `stance` has fallen through the vertical. NULL: nothing to do. */
    void (*pass_apex)(struct body_state *state, struct gait_state *gait, enum side stance,
                      uint32_t tick);
    /* That fall was a step's, not a sway's. NULL: it always is. */
    bool (*is_step)(const struct body_state *state, enum side stance);
    /* The other foot may land at any moment, or has landed. */
    bool (*strike_near)(const struct body_state *state, const struct control_params *params,
                        const struct gait_state *gait, uint32_t tick);
    real ahead_least_rad; /* a leg must have been so far ahead for its fall to be an apex */
    bool legs_take_turns; /* the same leg twice in a row is a fault, not an irregular step */
    bool ankle_is_held;   /* by the latch: the ankle extends only while that is open */
};

/* The row of a parameter's value; of no row's value: the compass walker's. Never NULL. Pure. */
const struct body *body_of(real number);

/* The row of a body: each body's file defines its own, `const struct body BODY_ROW(person)`. */
#define BODY_ROW(id) REAL_SYMBOL(body_##id)
#define BODY_EXTERN(value, number, id, name) extern const struct body BODY_ROW(id);
BODY_TABLE(BODY_EXTERN)
#undef BODY_EXTERN

#endif
