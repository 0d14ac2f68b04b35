/* What afo host says of its walk: states and refused nodes as they come, figures at the end. */
#ifndef SIM_HOST_CLI_HOST_REPORT_H
#define SIM_HOST_CLI_HOST_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/control_task.h"
#include "sim_host/loop/pacer.h"

struct host_figures {
    uint64_t lost_cycles; /* cycles that went on without an answer */
    uint32_t steps;
    uint32_t faults;    /* times that a fault was latched */
    uint32_t went_down; /* times that the interface did */
};

const char *host_report_state_name(enum supervisor_state state);

/* A node that is not as it must be stays out until it is switched off and on; one that did not
 * answer is asked again. True for the former. */
bool host_report_is_refused(const struct control_task *task);

/* What 0x2031 tells, as the set-up had it. */
struct setup_failure host_report_failure(const struct controller_objects *objects);

/* Says on standard error which node is refused or silent, once; *told remembers it (0 first). */
void host_report_refusal(const struct control_task *task, uint32_t *told);

/* Which nodes are not in operation, and why: "left drive (node 1) is silent; left leg sensor (node 3) reports
 * emergency 0x5000". text: HOST_REPORT_NODES_MAX bytes; empty when all is well. */
enum { HOST_REPORT_NODES_MAX = 320 };
void host_report_nodes(const struct network *network, char *text);

/* Says that on standard error when a fault of the nodes is latched, and once they have been waited for in vain:
 * whenever it has become something else. told: HOST_REPORT_NODES_MAX bytes, "" first. */
void host_report_nodes_on_change(const struct control_task *task, char *told);

/* On standard output, at the end. pacer: NULL where no clock paced the walk (text only). */
void host_report_text(const struct control_task *task, const struct host_figures *figures,
                      const struct pacer *pacer);
void host_report_json(const struct control_task *task, const struct host_figures *figures,
                      const struct pacer *pacer);

#endif
