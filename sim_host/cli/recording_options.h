/* A recording in the walker's place, from the command line. */
#ifndef SIM_HOST_CLI_RECORDING_OPTIONS_H
#define SIM_HOST_CLI_RECORDING_OPTIONS_H

#include <stdbool.h>

#include "sim_host/loop/loop.h"
#include "sim_host/plant/recorded_person.h"

/* Takes "ROLE=NAME", e.g. "thigh_l=LT Thigh Pitch"; roles: time, and thigh, shank,
 * ankle, contact with _l or _r. An empty name: the recording has no such column.
 * Returns false when the role is unknown or the name too long. */
bool recording_options_column(struct recording_format *format, const char *text);

/* The recording's person instead of the walker, and the controller's rules, law and timing
 * for them; open_loop keeps the law. Returns 0, or -1 with the reason in message
 * (LOOP_MESSAGE_MAX bytes). The file itself is read by loop_init(). */
int recording_options_apply(const char *path, const struct recording_format *format, bool open_loop,
                            struct loop_config *config, char *message);

/* The roles, for messages. */
extern const char recording_options_roles[];

#endif
