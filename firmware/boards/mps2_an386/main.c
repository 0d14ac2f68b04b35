/* The orthosis on QEMU's mps2-an386: the bus is a pair of pipes to the host when
 * there is one, else an slcan adapter on UART 0. Same objects as the real board. */
#include "firmware/orthosis.h"
#include "firmware/version.h"
#include "hal/port_cortex_m/cortex_m4.h"
#include "hal/port_mps2/mps2_board.h"
#include "hal/port_mps2/mps2_registers.h"
#include "hal/port_mps2/pil_bus.h"
#include "hal/port_mps2/semihosting.h"
#include "hal/port_mps2/uart_slcan_bus.h"

enum {
    EXCEPTION_NMI = 2,
    EXCEPTION_TIMER0 = 16 + MPS2_IRQ_TIMER0,
    RUN_MARK = 0x52554E21,
    SLCAN_CYCLE_MS = 20 /* without all answers the next cycle starts after this */
};

static struct orthosis orthosis;
static struct mps2_clock timer;
static union {
    struct pil_bus pil;
    struct uart_slcan_bus uart;
} link;

__attribute__((section(".blackbox"))) static struct black_box black_box;
__attribute__((section(".crash.record"))) struct crash_record crash_record;
__attribute__((section(".crash.streak"))) struct crash_streak crash_streak;
/* RUN_MARK while running: found at a start without a crash record, the watchdog bit. */
__attribute__((section(".noinit"))) static uint32_t run_mark;

void timer0_handler(void);

void timer0_handler(void)
{
    mps2_clock_interrupt(&timer);
}

__attribute__((section(".vectors"), used)) const union vector vector_table[16 + MPS2_IRQ_COUNT] = {
    {.stack = handler_stack_top},
    {.handler = reset_handler},
    VECTOR_EXCEPTIONS,
    VECTOR_FAULT_8,
    {.handler = timer0_handler}, /* 8 */
    VECTOR_FAULT_16,
    VECTOR_FAULT_4,
    VECTOR_FAULT_2,
    VECTOR_FAULT,
};

bool board_survives(uint32_t exception)
{
    /* The first bark: the reset follows by itself, and nothing may look like a crash
     * of another kind. */
    return exception == EXCEPTION_NMI && mps2_watchdog_barked();
}

void board_last_will(struct crash_record *record)
{
    record->build_id = version_build_id();
    run_mark = 0;
}

uint32_t board_time_ms(void)
{
    return timer.milliseconds;
}

/* Notes a reset by the watchdog. Returns true when the last run did not end well. */
static bool restarted(void)
{
    const bool was_running = run_mark == (uint32_t)RUN_MARK;

    if (was_running) {
        crash_streak_add(&crash_streak);
        crash_record_begin(&crash_record);
        crash_record.cause = CRASH_WATCHDOG;
        crash_record.build_id = version_build_id();
        crash_record_seal(&crash_record);
    }
    return crash_record_is_valid(&crash_record);
}

static bool open_pipes(void)
{
    struct pil_hello hello = {.build_id = version_build_id()};

    if (crash_record_is_valid(&crash_record)) {
        hello.crash = crash_record;
    }
    if (black_box_is_valid(&black_box)) {
        hello.black_box_state = black_box.header.state;
        hello.black_box_reason = black_box.header.reason;
    }
    return pil_bus_open(&link.pil, &hello);
}

/* ---- Faults to provoke, for the tests of what follows ---------------------------- */

static bool supervisor_stalls;

/* The linker puts this in the place of supervisor_update (firmware.mk), in this image only:
 * how the supervisor stops while all else goes on, and whether the gate sees it. */
bool __real_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault);
bool __wrap_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault);

bool __wrap_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault)
{
    return !supervisor_stalls && __real_supervisor_update_f32(supervisor, tick, conditions, fault);
}

static void provoke(uint32_t inputs)
{
    if ((inputs & PIL_DO_HARD_FAULT) != 0u) {
        *(volatile uint32_t *)0xF0000000u = 1; /* nothing is there */
    }
    if ((inputs & PIL_DO_OVERFLOW_STACK) != 0u) {
        __asm volatile("1: push {r0}\n b 1b\n");
    }
    if ((inputs & PIL_DO_ASSERT) != 0u) {
        cortex_m4_crash(CRASH_ASSERTION, 1234);
    }
    while ((inputs & PIL_DO_HANG) != 0u) {
    }
    if ((inputs & PIL_DO_STALL_SUPERVISOR) != 0u) {
        /* Everything else goes on, a millisecond a tick as on the real board. */
        const uint32_t now_ms = timer.milliseconds;
        supervisor_stalls = true;
        while (timer.milliseconds == now_ms) {
        }
    }
}

/* ---- The two loops ----------------------------------------------------------------- */

static _Noreturn void run_over_pipes(void)
{
    for (;;) {
        orthosis_start_cycle(&orthosis);
        (void)orthosis_poll(&orthosis);
        link.pil.ticks = orthosis.task.tick;
        provoke(link.pil.inputs);
    }
}

static _Noreturn void run_over_uart(void)
{
    uint32_t cycle_began_ms = timer.milliseconds;
    bool sync_under_way = true;

    orthosis_start_cycle(&orthosis);
    for (;;) {
        const unsigned progress = orthosis_poll(&orthosis);
        const uint32_t now_ms = timer.milliseconds;
        if ((progress & CONTROL_TASK_TICKED) != 0u) {
            sync_under_way = false;
            cycle_began_ms = now_ms;
        }
        if ((!sync_under_way && control_task_cycle_complete(&orthosis.task)) ||
            now_ms - cycle_began_ms >= SLCAN_CYCLE_MS) {
            sync_under_way = true;
            cycle_began_ms = now_ms;
            orthosis_start_cycle(&orthosis);
        }
    }
}

int main(void)
{
    struct orthosis_config config = {
        .watchdog = &mps2_watchdog,
        .nv = &mps2_nv_store,
        .black_box = &black_box,
        .crash = &crash_record,
        .streak = &crash_streak,
        .restarted = restarted(),
    };
    const bool pipes = open_pipes();

    if (pipes) {
        link.pil.stack_unused = cortex_m4_stack_unused;
        config.bus = pil_bus_interface(&link.pil);
        config.stop = pil_bus_emergency_stop(&link.pil);
    } else {
        uart_slcan_bus_open(&link.uart);
        config.bus = uart_slcan_bus_interface(&link.uart);
        config.stop = mps2_button_stop;
    }
    mps2_clock_init(&timer);
    cortex_m4_enable_interrupt(MPS2_IRQ_TIMER0, 1);
    cortex_m4_interrupts_on();
    orthosis_init(&orthosis, &config);
    run_mark = (uint32_t)RUN_MARK;
    mps2_watchdog_start();
    if (pipes) {
        run_over_pipes();
    }
    run_over_uart();
}
