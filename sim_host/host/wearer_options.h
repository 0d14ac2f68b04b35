/* How a recording's columns are named, from the command line. */
#ifndef SIM_HOST_HOST_WEARER_OPTIONS_H
#define SIM_HOST_HOST_WEARER_OPTIONS_H

#include <stdbool.h>

#include "sim_host/plant/wearer.h"

/* Takes "ROLE=NAME", e.g. "thigh_l=LT Thigh Pitch"; roles: time, and thigh, shank,
 * ankle, contact with _l or _r. An empty name: the recording has no such column.
 * Returns false when the role is unknown or the name too long. */
bool wearer_options_column(struct wearer_format *format, const char *text);

/* The roles, for messages. */
extern const char wearer_options_roles[];

#endif
