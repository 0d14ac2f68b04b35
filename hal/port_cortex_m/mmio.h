/* Access to registers and memory of the STM32G474 by address.
 *
 * On the target these are the plain volatile accesses. On the host the tests
 * define them, on a model of the peripheral: the drivers are the same source.
 */
#ifndef HAL_PORT_CORTEX_M_MMIO_H
#define HAL_PORT_CORTEX_M_MMIO_H

#include <stdint.h>

#if defined(__arm__)

static inline uint32_t mmio_read(uint32_t address)
{
    return *(volatile const uint32_t *)address;
}

static inline void mmio_write(uint32_t address, uint32_t value)
{
    *(volatile uint32_t *)address = value;
}

/* Keeps interrupts out until mmio_unlock with its result. Below 10 instructions. */
static inline uint32_t mmio_lock(void)
{
    uint32_t primask;
    __asm volatile("mrs %0, primask\n cpsid i" : "=r"(primask)::"memory");
    return primask;
}

static inline void mmio_unlock(uint32_t primask)
{
    __asm volatile("msr primask, %0" ::"r"(primask) : "memory");
}

/* Sleeps until an interrupt is pending, also under mmio_lock. The barrier behind it: scripts/errata.txt,
 * system 2.2.8. */
static inline void mmio_sleep(void)
{
    __asm volatile("dsb\n wfi\n isb" ::: "memory");
}

/* Everything written before is done before anything after begins. */
static inline void mmio_barrier(void)
{
    __asm volatile("dsb\n isb" ::: "memory");
}

#else

uint32_t mmio_read(uint32_t address);
void mmio_write(uint32_t address, uint32_t value);
uint32_t mmio_lock(void);
void mmio_unlock(uint32_t state);
void mmio_sleep(void);
void mmio_barrier(void);

#endif

/* A register and what it must hold under `mask` once it is set up. */
struct mmio_expected {
    uint32_t address, mask, value;
};

/* Reads `count` registers back. Returns the address of the first that does not hold what was
 * written, 0 when all do. One read a register. */
static inline uint32_t mmio_first_lost(const struct mmio_expected *expected, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if ((mmio_read(expected[i].address) & expected[i].mask) != expected[i].value) {
            return expected[i].address;
        }
    }
    return 0;
}

static inline void mmio_set(uint32_t address, uint32_t bits)
{
    mmio_write(address, mmio_read(address) | bits);
}

static inline void mmio_clear(uint32_t address, uint32_t bits)
{
    mmio_write(address, mmio_read(address) & ~bits);
}

/* Replaces the bits under `mask`. */
static inline void mmio_change(uint32_t address, uint32_t mask, uint32_t bits)
{
    mmio_write(address, (mmio_read(address) & ~mask) | bits);
}

#endif
