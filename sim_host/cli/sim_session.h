/* One walk of `afo sim`: from a configured loop to its end, with what is written on the way. */
#ifndef SIM_HOST_CLI_SIM_SESSION_H
#define SIM_HOST_CLI_SIM_SESSION_H

#include <signal.h>
#include <stdbool.h>

#include "sim_host/cli/output_file.h"
#include "sim_host/cli/sim_options.h"
#include "sim_host/cli/sim_report.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/pacer.h"
#include "sim_host/loop/walk_record.h"

struct sim_session {
    struct sim_options options;
    struct loop_config config;
    struct loop *loop; /* owned */
    struct walk_record record;
    struct output_file csv, ticks, log, pushes;
    struct sim_outcome outcome;
    struct pacer pacer;
    uint32_t push_ticks; /* pushed in so far */
};

/* Options to configuration. Returns 0, or -1 behind a complaint. */
int sim_session_configure(struct sim_session *session);

/* Opens --csv, --ticks, --log and --pushes, then the loop with its record. Returns 0, or -1 behind a complaint. */
int sim_session_open(struct sim_session *session);

/* Walks until the walk is over, *interrupted is set or an output fails; says how in session->outcome. */
void sim_session_walk(struct sim_session *session, const volatile sig_atomic_t *interrupted);

/* Whether the table or the log could not be written so far. */
bool sim_session_output_failed(const struct sim_session *session);

/* Everything that is still open or owned. */
void sim_session_free(struct sim_session *session);

#endif
