/* A trace of ticks over the core's trace port (SWO): which tick, what it took, the state.
 *
 * Off unless the image is built with TRACE=swo. Then it costs some 40 instructions a tick, and nothing
 * is sent unless a debugger has switched the ports on; nobody ever waits for it. scripts/tick-trace
 * reads what a debugger has recorded. Registers: Armv7-M Architecture Reference Manual, C1.7 (ITM).
 */
#ifndef HAL_PORT_CORTEX_M_TICK_TRACE_H
#define HAL_PORT_CORTEX_M_TICK_TRACE_H

#include <stdint.h>

#include "hal/port_cortex_m/mmio.h"

#define ITM_STIMULUS 0xE0000000u
#define ITM_TER 0xE0000E00u
#define ITM_TCR 0xE0000E80u
#define ITM_TCR_ENABLED (1u << 0)

/* The stimulus ports; their numbers never change their meaning. */
enum { TICK_TRACE_TICK = 0, TICK_TRACE_CYCLES = 1, TICK_TRACE_STATE = 2 };

/* Sends a word on `port` if somebody listens and there is room. Loop; O(1). */
static inline void tick_trace_put(uint32_t port, uint32_t word)
{
    const uint32_t stimulus = ITM_STIMULUS + 4u * port;

    if ((mmio_read(ITM_TCR) & ITM_TCR_ENABLED) != 0u && (mmio_read(ITM_TER) >> port & 1u) != 0u &&
        (mmio_read(stimulus) & 1u) != 0u) {
        mmio_write(stimulus, word);
    }
}

#ifdef TICK_TRACE
static inline void tick_trace(uint32_t tick, uint32_t cycles, uint32_t state, uint32_t fault)
{
    tick_trace_put(TICK_TRACE_TICK, tick);
    tick_trace_put(TICK_TRACE_CYCLES, cycles);
    tick_trace_put(TICK_TRACE_STATE, state | fault << 8);
}
#else
static inline void tick_trace(uint32_t tick, uint32_t cycles, uint32_t state, uint32_t fault)
{
    (void)tick;
    (void)cycles;
    (void)state;
    (void)fault;
}
#endif

#endif
