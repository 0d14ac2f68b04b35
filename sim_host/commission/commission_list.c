/* The steps with their results, for programs. */
#include "sim_host/cli/json_writer.h"
#include "sim_host/commission/commission.h"

static void put_step(struct json_writer *json, const struct commission *commission,
                     enum commission_step step)
{
    const struct commission_result *result = &commission->result[step];
    const int missing = commission_missing(commission, step);
    json_open_object(json, NULL);
    json_text(json, "name", commission_step_name(step));
    json_text(json, "shows", commission_step_shows(step));
    json_text(json, "verdict", commission_verdict_name(result->verdict));
    json_text(json, "comes_first",
              missing >= 0 ? commission_step_name((enum commission_step)missing) : NULL);
    json_text(json, "when", result->when);
    json_text(json, "done", result->done);
    json_text(json, "reason", result->reason);
    json_open_list(json, "found");
    for (unsigned i = 0; i < result->finding_count; i++) {
        json_text(json, NULL, result->finding[i]);
    }
    json_close_list(json);
    json_close_object(json);
}

void commission_list_write(const struct commission *commission, FILE *stream)
{
    struct json_writer json;
    json_begin(&json, stream);
    json_open_object(&json, NULL);
    json_text(&json, "device", commission->declared.name);
    json_bool(&json, "complete", commission_is_complete(commission));
    json_open_list(&json, "steps");
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        put_step(&json, commission, (enum commission_step)step);
    }
    json_close_list(&json);
    json_close_object(&json);
    json_end(&json);
}
