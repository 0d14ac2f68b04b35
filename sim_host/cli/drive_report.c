#include "sim_host/cli/drive_report.h"

static const char *const legs[SIDE_COUNT] = {"left", "right"};

static bool stays_loaded(const struct control_task *task, int leg)
{
    return (task->node.objects.loaded_without_link >> leg & 1u) != 0;
}

static const char *cause_of(const struct derate *derate, int leg)
{
    return derate_cause_name((enum derate_cause)derate->leg[leg].cause);
}

static void link_line(FILE *stream, const struct control_task *task)
{
    const bool left = stays_loaded(task, SIDE_LEFT), right = stays_loaded(task, SIDE_RIGHT);
    if (left || right) {
        fprintf(stream,
                "  link loss  NOT SAFE: nothing is declared that unloads the %s when the link is "
                "lost\n",
                left && right ? "springs of both legs"
                : left        ? "left leg's spring"
                              : "right leg's spring");
    }
}

void drive_report_text(FILE *stream, const struct control_task *task)
{
    const struct derate *derate = &task->controller.derate;
    if (derate->least_share < 1.0f) {
        fprintf(stream, "  spared     pushes at %.0f %% of what was prescribed, %.0f %% at least\n",
                100.0 * (double)derate->share, 100.0 * (double)derate->least_share);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (derate->leg[leg].cause != (uint8_t)DERATE_NONE) {
            fprintf(stream, "             the %s drive is spared: %s\n", legs[leg],
                    cause_of(derate, leg));
        }
    }
    if (derate->withdrew_cause != (uint8_t)DERATE_NONE) {
        fprintf(stream, "  withdrawn  for the %s drive: %s%s\n", legs[derate->withdrew_leg & 1u],
                derate_cause_name((enum derate_cause)derate->withdrew_cause),
                derate->withdrawn ? ", and it lasts" : ", and it is over: ask anew");
    }
    link_line(stream, task);
}

void drive_report_json(struct json_writer *json, const struct control_task *task)
{
    const struct derate *derate = &task->controller.derate;
    const bool ever = derate->withdrew_cause != (uint8_t)DERATE_NONE;
    json_open_object(json, "drives");
    json_number(json, "push_share", (double)derate->share, 6);
    json_number(json, "least_push_share", (double)derate->least_share, 6);
    json_bool(json, "withdrawn", derate->withdrawn);
    json_text(json, "withdrawn_for",
              ever ? derate_cause_name((enum derate_cause)derate->withdrew_cause) : NULL);
    json_text(json, "withdrawn_leg", ever ? legs[derate->withdrew_leg & 1u] : NULL);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        json_open_object(json, legs[leg]);
        json_text(json, "spared_for",
                  derate->leg[leg].cause != (uint8_t)DERATE_NONE ? cause_of(derate, leg) : NULL);
        json_bool(json, "loaded_without_link", stays_loaded(task, leg));
        json_close_object(json);
    }
    json_close_object(json);
}
