#include "sim_host/cli/g474_report.h"

#include <stdio.h>

/* Four wait states at every fetch and access, no cache: what an instruction costs on average at most. */
enum { WORST_CYCLES_PER_INSTRUCTION = 4 };

/* What the virtual COM port said, its lines parted by a bar. */
static void copy_serial(const struct chip *chip, char *text)
{
    uint32_t length = 0;

    for (uint32_t i = 0; i < chip->uart_count; i++) {
        const char c = chip->uart[i];
        text[length] = c == '\n' ? '|' : c;
        length += c == '\r' || c == '"' || c == '\\' ? 0 : 1;
    }
    text[length] = '\0';
}

void g474_report_json(const struct chip_session *session, double wall_s)
{
    const struct chip_bridge *bridge = &session->bridge;
    const struct chip *chip = &session->chip;
    char serial[CHIP_UART_MAX];

    copy_serial(chip, serial);
    printf(
        "{\"good\": %s, \"steps\": %u, \"fell\": %s, \"trouble\": \"%s\", \"ticks\": %u, "
        "\"compared_frames\": %llu, \"differences\": %llu, \"first_difference\": \"%s\", "
        "\"findings\": %llu, \"first_finding\": \"%s\", \"worst_tick_instructions\": %u, "
        "\"told_cycles\": %u, \"worst_tick\": %u, \"sync_late_ns\": %llu, \"sync_late_tick\": %u, \"instructions\": %llu, "
        "\"simulated_s\": %.6f, \"exceptions\": %llu, \"tail_chained\": %llu, \"starts\": %u, "
        "\"state\": %u, \"fault\": \"%s\", \"crash_cause\": %u, \"crash_count\": %u, "
        "\"flash_operations\": %u, \"cut_hit\": %s, \"cuts\": %u, \"cuts_run\": %u, \"bad_cuts\": %u, \"permit_edges\": %llu, "
        "\"led_edges\": %u, \"noticed_ms\": %.3f, \"corrected\": %u, \"marks\": %u, "
        "\"mark_delay_us\": [%u, %u], \"pulse_us\": [%u, %u], \"serial\": \"%s\", "
        "\"wall_s\": %.2f}\n",
        chip_session_is_good(session) ? "true" : "false", session->record.count,
        session->fell ? "true" : "false", session->trouble, bridge->ticks,
        (unsigned long long)bridge->compared, (unsigned long long)bridge->differences,
        bridge->first_difference, (unsigned long long)chip->finding_count, chip->findings[0],
        bridge->worst_instructions, session->told_cycles, bridge->worst_tick,
        (unsigned long long)bridge->sync_late_ns, bridge->sync_late_tick,
        (unsigned long long)chip->instructions, (double)chip_now_ns(chip) / 1e9,
        (unsigned long long)chip->scs.entries, (unsigned long long)chip->scs.tail_chained,
        chip->resets, bridge->state, supervisor_fault_name((enum supervisor_fault)bridge->fault),
        (unsigned)session->crash.cause, (unsigned)session->crash.count,
        chip->flash_registers.operations, session->cuts.hit ? "true" : "false", session->cuts.tried,
        session->cuts.ran, session->cuts.bad, (unsigned long long)chip->permit_edges,
        chip->led_edges,
        session->noticed_ns > session->brought_ns
            ? 1e-6 * (double)(session->noticed_ns - session->brought_ns)
            : 0.0,
        session->told_corrected, session->marks.count, session->marks.delay_us[0],
        session->marks.delay_us[1], session->marks.pulse_us[0], session->marks.pulse_us[1], serial,
        wall_s);
}

void g474_report_text(const struct chip_session *session, double wall_s)
{
    const struct chip_bridge *bridge = &session->bridge;
    const struct chip *chip = &session->chip;
    const double simulated_s = (double)chip_now_ns(chip) / 1e9;
    const uint32_t cycles = bridge->worst_instructions * WORST_CYCLES_PER_INSTRUCTION;

    printf("%u steps in the emulated STM32G474, %.1f s in %.1f s (%.1f times real time, %.1f "
           "million instructions a second)\n",
           session->record.count, simulated_s, wall_s, simulated_s / wall_s,
           (double)chip->instructions / wall_s / 1e6);
    printf("frames compared with the host's build: %llu, different: %llu\n",
           (unsigned long long)bridge->compared, (unsigned long long)bridge->differences);
    printf("instructions of a tick, interrupts included: %u at worst (tick %u); at %d cycles each "
           "%u of 170000\n",
           bridge->worst_instructions, bridge->worst_tick, WORST_CYCLES_PER_INSTRUCTION, cycles);
    printf("exceptions %llu, tail-chained %llu, starts %u\n", (unsigned long long)chip->scs.entries,
           (unsigned long long)chip->scs.tail_chained, chip->resets);
    if (session->fault != CHIP_FAULT_NONE) {
        printf("after \"%s\": latched \"%s\", crash record %u, springs %s\n",
               chip_faults[session->fault].name,
               supervisor_fault_name((enum supervisor_fault)bridge->fault),
               (unsigned)session->crash.cause,
               chip_session_is_safe(session) ? "unloaded" : "LOADED");
    }
    if (session->cuts.tried > 0) {
        printf("power cut in %u of %u flash operations, %u run to their end: %u ended badly\n",
               session->cuts.tried, session->cuts.operations, session->cuts.ran, session->cuts.bad);
    }
    if (session->marks.count > 0) {
        printf("%u marks: PA1 rises %u to %u us behind the mark's frame, for %u to %u us\n",
               session->marks.count, session->marks.delay_us[0], session->marks.delay_us[1],
               session->marks.pulse_us[0], session->marks.pulse_us[1]);
    }
    if (session->trouble[0] != '\0') {
        printf("trouble: %s\n", session->trouble);
    }
    if (bridge->differences > 0) {
        printf("first difference: %s\n", bridge->first_difference);
    }
    for (unsigned i = 0; i < CHIP_FINDINGS_MAX && chip->findings[i][0] != '\0'; i++) {
        printf("finding: %s\n", chip->findings[i]);
    }
}
