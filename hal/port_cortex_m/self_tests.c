#include "hal/port_cortex_m/self_tests.h"

#include <stdbool.h>
#include <stddef.h>

#include "hal/port_cortex_m/core_test.h"
#include "hal/port_cortex_m/cortex_m4.h"
#include "hal/port_cortex_m/mmio.h"

/* Slices overlap by a word, so that each word is marched with both neighbours. */
enum { SLICE_STEP = CORE_TEST_RAM_WORDS - 1, GUARD_WORDS = 8, ROUND = 64, REGISTER_PARTS = 3 };

/* A stack's guard is closed to everybody, and holds nothing. */
static bool touches_guard(const uint32_t *at, const uint32_t *bottom)
{
    return at + CORE_TEST_RAM_WORDS > bottom && at < bottom + GUARD_WORDS;
}

static enum crash_cause test_ram(struct self_tests *tests, uint32_t *detail)
{
    uint32_t *const at = tests->ram + tests->ram_word;
    const uint32_t last = tests->ram_words - (uint32_t)CORE_TEST_RAM_WORDS;
    uint32_t failed = 0;

    if (!touches_guard(at, thread_stack_bottom) && !touches_guard(at, handler_stack_bottom)) {
        const uint32_t state = mmio_lock();
        failed = core_test_ram(at);
        mmio_unlock(state);
    }
    if (tests->ram_word == last) {
        tests->ram_word = 0;
        tests->ram_rounds += tests->ram_rounds < UINT32_MAX ? 1u : 0u;
    } else {
        const uint32_t next = tests->ram_word + (uint32_t)SLICE_STEP;
        tests->ram_word = next < last ? next : last;
    }
    *detail = (uint32_t)(uintptr_t)at;
    return failed != 0u ? CRASH_RAM : CRASH_NONE;
}

static uint32_t test_part(uint32_t part)
{
    switch (part) {
    case 0:
        return core_test_registers();
    case 1:
        return core_test_low_floats();
    default:
        return core_test_high_floats();
    }
}

static enum crash_cause test_registers(uint32_t part, uint32_t *detail)
{
    const uint32_t state = mmio_lock();
    const uint32_t failed = test_part(part);

    mmio_unlock(state);
    *detail = part;
    return failed != 0u ? CRASH_REGISTER : CRASH_NONE;
}

static enum crash_cause test_stacks(uint32_t *detail)
{
    const uint32_t *const bottom = cortex_m4_stack_too_deep();

    *detail = (uint32_t)(uintptr_t)bottom;
    return bottom != NULL ? CRASH_STACK : CRASH_NONE;
}

void self_tests_init(struct self_tests *tests, uint32_t *ram, uint32_t words)
{
    *tests = (struct self_tests){.ram = ram, .ram_words = words};
}

enum crash_cause self_tests_go_on(struct self_tests *tests, uint32_t *detail)
{
    const uint32_t turn = tests->turn;

    tests->turn = (turn + 1u) % (uint32_t)ROUND;
    if (turn < (uint32_t)REGISTER_PARTS) {
        return test_registers(turn, detail);
    }
    return turn == (uint32_t)REGISTER_PARTS ? test_stacks(detail) : test_ram(tests, detail);
}
