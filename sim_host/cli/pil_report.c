#include "sim_host/cli/pil_report.h"

#include <stdio.h>

#include "sim_host/cli/json_writer.h"

static void print_difference(FILE *stream, const struct pil_difference *difference)
{
    const struct can_msg *frames[2] = {&difference->host, &difference->image};

    fprintf(stream, "first difference: tick %u, frame %u%s\n", difference->tick, difference->place,
            difference->missing ? ", missing from the image"
            : difference->extra ? ", only from the image"
                                : "");
    for (int i = 0; i < 2; i++) {
        fprintf(stream, "  %s %03X#", i == 0 ? "host " : "image", (unsigned)frames[i]->id);
        for (int j = 0; j < frames[i]->length; j++) {
            fprintf(stream, "%02X", frames[i]->data[j]);
        }
        fputc('\n', stream);
    }
}

static double mean_instructions(const struct pil_bridge *bridge)
{
    return bridge->answer.sequence > 0
               ? (double)bridge->total_instructions / (double)bridge->answer.sequence
               : 0.0;
}

void pil_report_json(const struct pil_session *session, double wall_s)
{
    const struct pil_bridge *bridge = &session->bridge;
    const struct crash_record *crash = &bridge->hello.crash;
    struct json_writer json;

    json_begin(&json, stdout);
    json_open_object(&json, NULL);
    json_bool(&json, "good", session->reached && bridge->differences == 0);
    json_unsigned(&json, "steps", session->record.count);
    json_bool(&json, "fell", session->fell);
    json_text(&json, "trouble", session->trouble);
    json_unsigned(&json, "ticks", session->loop->tick);
    json_unsigned(&json, "compared_frames", bridge->compared);
    json_unsigned(&json, "differences", bridge->differences);
    json_unsigned(&json, "worst_tick_instructions", bridge->worst_instructions);
    json_unsigned(&json, "worst_tick", bridge->worst_tick);
    json_fixed(&json, "mean_tick_instructions", mean_instructions(bridge), 0);
    json_unsigned(&json, "stack_unused_bytes", bridge->stack_unused);
    json_unsigned(&json, "starts", bridge->starts);
    json_unsigned(&json, "state", bridge->state);
    json_text(&json, "fault", supervisor_fault_name((enum supervisor_fault)bridge->fault));
    json_unsigned(&json, "crash_cause", crash->cause);
    json_unsigned(&json, "crash_pc", crash->pc);
    json_unsigned(&json, "crash_count", crash->count);
    json_unsigned(&json, "black_box_state", bridge->hello.black_box_state);
    json_unsigned(&json, "build_id", bridge->hello.build_id);
    json_unsigned(&json, "black_box_frames", session->black_box_summary.frames);
    json_unsigned(&json, "black_box_fault_bits", session->black_box_summary.reason);
    json_fixed(&json, "wall_s", wall_s, 1);
    json_close_object(&json);
    json_end(&json);
}

void pil_report_text(const struct pil_session *session, double wall_s)
{
    const struct pil_bridge *bridge = &session->bridge;

    printf("%u steps on the emulated Cortex-M4F, %llu ticks in %.1f s\n", session->record.count,
           (unsigned long long)session->loop->tick, wall_s);
    printf("frames compared with the host's build: %llu, different: %llu\n",
           (unsigned long long)bridge->compared, (unsigned long long)bridge->differences);
    printf("instructions of a tick: %u at worst (tick %u), %.0f on average\n",
           bridge->worst_instructions, bridge->worst_tick, mean_instructions(bridge));
    printf("thread stack never used: %u bytes\n", bridge->stack_unused);
    if (session->fault != PIL_FAULT_NONE) {
        printf("after \"%s\": latched \"%s\", crash record %u, springs %s\n",
               pil_faults[session->fault].name,
               supervisor_fault_name((enum supervisor_fault)bridge->fault),
               (unsigned)bridge->hello.crash.cause,
               pil_session_is_unloaded(session) ? "unloaded" : "LOADED");
    }
    if (session->trouble[0] != '\0') {
        printf("trouble: %s\n", session->trouble);
    }
    if (bridge->differences > 0) {
        print_difference(stdout, &bridge->first);
    }
}
