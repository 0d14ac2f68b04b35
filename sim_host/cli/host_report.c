#include "sim_host/cli/host_report.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/drive_report.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/program.h"
#include "sim_host/devices/setup_text.h"

/* Nodes that are there have booted and are set up by then. */
enum { WAITED_TICKS = TICKS_OF_MS(2000) };

const char *host_report_state_name(enum supervisor_state state)
{
    static const char *const names[SUPERVISOR_STATES] = {"waiting for the nodes",
                                                         "self test",
                                                         "standby",
                                                         "engaging",
                                                         "walking",
                                                         "unloading",
                                                         "FAULT",
                                                         "commissioning"};
    return (unsigned)state < SUPERVISOR_STATES ? names[state] : "unknown";
}

bool host_report_is_refused(const struct control_task *task)
{
    const struct controller_objects *objects = &task->node.objects;
    return objects->refused_node != 0 && objects->refused_verdict != -SETUP_SILENT;
}

struct setup_failure host_report_failure(const struct controller_objects *objects)
{
    return (struct setup_failure){.verdict = (enum setup_verdict)(-(int)objects->refused_verdict),
                                  .node = objects->refused_node,
                                  .sub = objects->refused_sub,
                                  .index = objects->refused_index,
                                  .expected = objects->refused_expected,
                                  .found = objects->refused_found};
}

void host_report_refusal(const struct control_task *task, uint32_t *told)
{
    const struct controller_objects *objects = &task->node.objects;
    const uint32_t number = (uint32_t)objects->refused_node << 24 |
                            (uint32_t)objects->refused_index << 8 | objects->refused_sub;
    if (number == *told) {
        return;
    }
    *told = objects->refused_node != 0 ? number : 0;
    if (objects->refused_node != 0) {
        char text[SETUP_TEXT_MAX];
        const struct setup_failure failure = host_report_failure(objects);
        setup_refusal_text(&objects->device, &failure, text, sizeof text);
        program_complain("%s%s", text, host_report_is_refused(task) ? "" : ", asked again");
    }
}

/* Who the nodes are to a person, by their role. */
static const char *const node_names[] = {
    "left drive",       "right drive",       "left leg sensor",   "right leg sensor",
    "left latch board", "right latch board", "left ankle sensor", "right ankle sensor"};
static_assert(sizeof node_names / sizeof node_names[0] == NETWORK_NODES, "a name for each node");

static void say_of_node(const struct network_node *node, char *text, size_t size)
{
    if (node->state == NMT_UNKNOWN) {
        snprintf(text, size, "is silent");
    } else if (node->error_code != 0) {
        snprintf(text, size, "reports emergency 0x%04X", node->error_code);
    } else if (node->state == NMT_STOPPED) {
        snprintf(text, size, "is stopped");
    } else if (node->state != NMT_OPERATIONAL) {
        snprintf(text, size, "is not started yet");
    } else {
        text[0] = '\0';
    }
}

void host_report_nodes(const struct network *network, char *text)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < NETWORK_NODES && used < HOST_REPORT_NODES_MAX; i++) {
        char state[64];
        say_of_node(&network->node[i], state, sizeof state);
        if (network->node[i].id != 0 && state[0] != '\0') {
            used +=
                (size_t)snprintf(text + used, HOST_REPORT_NODES_MAX - used, "%s%s (node %u) %s",
                                 used > 0 ? "; " : "", node_names[i], network->node[i].id, state);
        }
    }
}

void host_report_nodes_on_change(const struct control_task *task, char *told)
{
    char text[HOST_REPORT_NODES_MAX];
    const bool lost = task->output.fault == SUPERVISOR_FAULT_NODE_LOST;
    const bool waited = task->output.state == SUPERVISOR_INIT && task->tick >= WAITED_TICKS;
    if (!lost && !waited) {
        return;
    }
    host_report_nodes(&task->network, text);
    if (text[0] != '\0' && strcmp(text, told) != 0) {
        program_complain("%s", text);
    }
    memcpy(told, text, sizeof text);
}

void host_report_text(const struct control_task *task, const struct host_figures *figures,
                      const struct pacer *pacer)
{
    struct can_bus_status status;
    const struct can_bus bus = task->config.bus;
    can_bus_get_status(&bus, &status);
    printf("\n  steps      %u; last: %.6f rad/s measured, %.6f commanded, r0 %.6f m\n",
           figures->steps, (double)task->controller.last_step.measured_speed_rad_s,
           (double)task->controller.last_step.commanded_speed_rad_s,
           (double)task->controller.last_step.r0_m);
    printf("  ticks      %u; %llu cycles without all answers, %u answers late\n", task->tick,
           (unsigned long long)figures->lost_cycles, task->node.objects.counters.late_answers);
    printf("  bus        %u frames out, %u in, %u refused, %u lost on receive, %u error frames, "
           "bus-off %u times, interface down %u times\n",
           status.tx_frames, status.rx_frames, status.tx_refused, status.rx_overflow,
           status.error_frames, status.bus_off_count, figures->went_down);
    printf("  state      %s, fault: %s\n", host_report_state_name(task->output.state),
           supervisor_fault_name(task->output.fault));
    drive_report_text(stdout, task);
    if (pacer != NULL) {
        pacer_report(pacer, stdout);
    }
}

void host_report_json(const struct control_task *task, const struct host_figures *figures,
                      const struct pacer *pacer)
{
    struct can_bus_status status;
    struct json_writer json;
    const struct can_bus bus = task->config.bus;
    can_bus_get_status(&bus, &status);
    json_begin(&json, stdout);
    json_open_object(&json, NULL);
    json_unsigned(&json, "steps", figures->steps);
    json_unsigned(&json, "ticks", task->tick);
    json_unsigned(&json, "lost_cycles", figures->lost_cycles);
    json_unsigned(&json, "late_answers", task->node.objects.counters.late_answers);
    json_number(&json, "measured_speed_rad_s",
                (double)task->controller.last_step.measured_speed_rad_s, 9);
    json_number(&json, "r0_m", (double)task->controller.last_step.r0_m, 9);
    json_integer(&json, "state", (int)task->output.state);
    json_integer(&json, "fault", (int)task->output.fault);
    json_unsigned(&json, "faults", figures->faults);
    json_unsigned(&json, "tx_frames", status.tx_frames);
    json_unsigned(&json, "rx_frames", status.rx_frames);
    json_unsigned(&json, "tx_refused", status.tx_refused);
    json_unsigned(&json, "rx_overflow", status.rx_overflow);
    json_unsigned(&json, "error_frames", status.error_frames);
    json_unsigned(&json, "went_down", figures->went_down);
    json_unsigned(&json, "missed_deadlines", pacer->missed);
    drive_report_json(&json, task);
    json_fixed(&json, "worst_late_us", 1e-3 * (double)pacer->worst_late_ns, 3);
    json_close_object(&json);
    json_end(&json);
}
