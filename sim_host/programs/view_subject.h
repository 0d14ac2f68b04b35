/* Who walks with what, as JSON for the server of afo view. */
#ifndef SIM_HOST_PROGRAMS_VIEW_SUBJECT_H
#define SIM_HOST_PROGRAMS_VIEW_SUBJECT_H

#include "sim_host/cli/view_options.h"
#include "sim_host/subjects/subject.h"

/* Person, device, parameters, build: what frames alone do not tell. Returns text that the caller frees, or NULL without
 * memory. */
char *view_subject_json(const struct subject *subject, const struct control_params *params,
                        double desired_speed_rad_s, const struct view_options *options);

#endif
