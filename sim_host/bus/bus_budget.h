/* Whether the bus carries what the frame table says, computed before anything is sent.
 *
 * Worst-case response times by Davis, Burns, Bril, Lukkien, "Controller Area Network (CAN)
 * schedulability analysis: refuted, revisited and revised", Real-Time Systems 35 (2007),
 * section 3.2, with one bus error in 10 ms.
 * Network management and emergencies are not counted.
 * scripts/bus-budget computes the same, prints every frame and can vary more.
 */
#ifndef SIM_HOST_BUS_BUS_BUDGET_H
#define SIM_HOST_BUS_BUS_BUDGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BUS_BUDGET_MESSAGE_MAX = 160, BUS_BUDGET_SLOWEST_TICK_US = 100000 };

/* Longest time from the SYNC, or from queueing, to the end of the frame with this identifier,
 * in bit times; UINT32_MAX when it is unbounded, or the table has no such frame. bitrate
 * 10000..1000000 bit/s, tick_us 100..BUS_BUDGET_SLOWEST_TICK_US. */
uint32_t bus_budget_response_bits(uint32_t bitrate, uint32_t tick_us, uint32_t frame_id);

/* Whether every deadline of the table holds. Same ranges. Below 1 ms. */
bool bus_budget_holds(uint32_t bitrate, uint32_t tick_us);

/* The shortest SYNC period, in steps of 50 us, at which every deadline holds; 0 = none. */
uint32_t bus_budget_fastest_tick_us(uint32_t bitrate);

/* Checks a bit rate and a tick. Returns 0, or -1 with the reason, and what does fit, in message
 * (`size` bytes, at least BUS_BUDGET_MESSAGE_MAX). */
int bus_budget_check(uint32_t bitrate, uint32_t tick_us, char *message, size_t size);

/* The same for those of this build: to be asked at the start of whatever uses the bus. */
int bus_budget_check_build(char *message, size_t size);

#endif
