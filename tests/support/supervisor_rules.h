/* The supervisor's rules, written from its prose (controller/supervisor/supervisor.h) and not from its
 * table, and the safety properties that any table must have. */
#ifndef TESTS_SUPPORT_SUPERVISOR_RULES_H
#define TESTS_SUPPORT_SUPERVISOR_RULES_H

#include "controller/supervisor/supervisor.h"

enum { SUPERVISOR_INPUTS = 1 << SUPERVISOR_CONDITION_BITS };

/* Where the prose goes from `state`. */
enum supervisor_state supervisor_rule(enum supervisor_state state, unsigned conditions);

/* NULL when the table does what the prose says in every state under every input, and has
 * every safety property; else what is wrong, in words. */
const char *supervisor_examine(const struct supervisor_row *rows, int count);

/* States reachable from INIT, as bits, and the number of (state, input) pairs looked at. */
unsigned supervisor_reachable(const struct supervisor_row *rows, int count, unsigned *pairs);

#endif
