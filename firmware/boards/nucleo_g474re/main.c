/* The orthosis on a NUCLEO-G474RE: FDCAN1 on PA11 and PA12, emergency stop on PC0. */
#include "firmware/boards/nucleo_g474re/can_filters.h"
#include "firmware/orthosis.h"
#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "hal/port_cortex_m/cortex_m4.h"
#include "hal/port_fdcan/fdcan.h"
#include "hal/port_stm32g474/board_io.h"
#include "hal/port_stm32g474/clock_tree.h"
#include "hal/port_stm32g474/flash_store.h"
#include "hal/port_stm32g474/idle.h"
#include "hal/port_stm32g474/system_registers.h"

enum { EXCEPTION_NMI = 2, RETRY_MS = 1000 };

static struct orthosis orthosis;
static struct fdcan can;
static struct tim2_clock timer;
static struct flash_store flash;
/* Before, timer and FDCAN1 have no clock: nobody may ask them anything. */
static bool ports_run;

#define FILTER(first, last, fifo) {first, last, fifo},
static const struct fdcan_filter can_filters[] = {CAN_FILTERS(FILTER)};

__attribute__((section(".blackbox"))) static struct black_box black_box;
__attribute__((section(".crash.record"))) struct crash_record crash_record;
__attribute__((section(".crash.streak"))) struct crash_streak crash_streak;

__attribute__((section(".program_header"),
               used)) static const struct program_header program_header = {
    .magic = PROGRAM_MAGIC,
    .hardware = PROGRAM_HARDWARE_NUCLEO_G474RE}; /* scripts/seal-image: the rest */

void fdcan1_handler(void);
void tim2_handler(void);

void fdcan1_handler(void)
{
    fdcan_interrupt(&can);
}

void tim2_handler(void)
{
    tim2_clock_interrupt(&timer);
}

__attribute__((section(".vectors"), used)) const union vector vector_table[16 + IRQ_COUNT] = {
    {.stack = handler_stack_top},
    {.handler = reset_handler},
    VECTOR_EXCEPTIONS,
    VECTOR_FAULT_16,
    VECTOR_FAULT_4,
    VECTOR_FAULT,
    {.handler = fdcan1_handler}, /* 21 */
    VECTOR_FAULT_4,
    VECTOR_FAULT_2,
    {.handler = tim2_handler}, /* 28 */
    VECTOR_FAULT_64,
    VECTOR_FAULT_8,
    VECTOR_FAULT,
};

bool board_survives(uint32_t exception)
{
    return exception == EXCEPTION_NMI && flash_store_survives_nmi(&flash);
}

void board_last_will(struct crash_record *record)
{
    if (ports_run) {
        fdcan_silence();
    }
    record->build_id = version_build_id();
    if (record->cause == (uint32_t)CRASH_NMI && clock_tree_crystal_failed()) {
        record->cause = CRASH_CLOCK_FAILED;
    }
}

uint32_t board_time_ms(void)
{
    return ports_run ? tim2_clock_now_ms(&timer) : 0u;
}

/* Notes a reset by the watchdog or by a dip of the supply, which leave no record themselves; a
 * record that nobody has seen yet is kept. Returns true when the last run did not end well. */
static bool restarted(uint32_t reset_flags)
{
    const enum crash_cause cause = crash_cause_of_reset((reset_flags & RCC_CSR_IWDGRSTF) != 0u,
                                                        (reset_flags & RCC_CSR_BORRSTF) != 0u,
                                                        crash_streak_is_kept(&crash_streak));

    if (cause == CRASH_WATCHDOG) {
        crash_streak_add(&crash_streak);
    }
    if (cause != CRASH_NONE && !crash_record_is_valid(&crash_record)) {
        crash_record_begin(&crash_record);
        crash_record.cause = cause;
        crash_record.build_id = version_build_id();
        crash_record.detail = reset_flags;
        crash_record_seal(&crash_record);
    }
    return crash_record_is_valid(&crash_record);
}

/* Without the crystal there is no 1 Mbit/s and so no bus: the drives, which hear
 * nothing, stay or go unloaded by themselves. Another try a second later. The watchdog, where it
 * runs already, must not leave a record of its own: the wait is bounded and ends in a reset. */
static _Noreturn void give_up(enum crash_cause cause, uint32_t detail)
{
    const uint32_t polls = clock_tree_wait_polls(clock_tree_hz(), 1);

    for (uint32_t time_ms = 0; time_ms < (uint32_t)RETRY_MS; time_ms++) {
        iwdg_watchdog.ops->feed(iwdg_watchdog.context);
        for (volatile uint32_t poll = 0; poll < polls; poll++) {
        }
    }
    cortex_m4_crash(cause, detail);
}

static void must_hold(uint32_t lost_register)
{
    if (lost_register != 0u) {
        give_up(CRASH_LOST_WRITE, lost_register);
    }
}

static void start_ports(void)
{
    const struct fdcan_config config = {CRYSTAL_HZ, can_filters,
                                        sizeof can_filters / sizeof can_filters[0],
                                        tim2_clock_now_ns, &timer};
    enum fdcan_result result;

    must_hold(board_io_init());
    must_hold(tim2_clock_init(&timer, CORE_HZ));
    ports_run = true;
    result = fdcan_init(&can, &config);
    must_hold(can.lost_register);
    if (result != FDCAN_OK) {
        give_up(CRASH_ASSERTION, (uint32_t) - (int32_t)result);
    }
    cortex_m4_enable_interrupt(IRQ_FDCAN1_IT0, 0);
    cortex_m4_enable_interrupt(IRQ_TIM2, 1);
    cortex_m4_interrupts_on();
}

int main(void)
{
    const uint32_t reset_flags = clock_tree_take_reset_flags();
    const enum clock_tree_result clocks = clock_tree_init();
    const struct nv_store nv = flash_store_interface(&flash);
    const struct program_slots program = flash_store_programs(&flash);
    const struct clock clock = tim2_clock_interface(&timer);
    struct orthosis_config config = {
        .clock = &clock,
        .stop = pc0_emergency_stop,
        .watchdog = &iwdg_watchdog,
        .drive_power = &pc1_drive_power_enable,
        .nv = &nv,
        .program = &program,
        .black_box = &black_box,
        .crash = &crash_record,
        .streak = &crash_streak,
        .restarted = restarted(reset_flags),
    };

    if (clocks != CLOCK_TREE_OK) {
        give_up(CRASH_CLOCK_FAILED, (uint32_t) - (int32_t)clocks);
    }
    flash_store_init(&flash);
    must_hold(iwdg_start()); /* before anything reaches the bus */
    start_ports();
    config.bus = fdcan_bus(&can);
    orthosis_init(&orthosis, &config);
    for (;;) {
        if (clock_take_tick(&clock)) {
            control_task_show_missed(&orthosis.task, clock_missed_ticks(&clock));
            orthosis_start_cycle(&orthosis);
            if (orthosis_program_is_damaged(&orthosis)) {
                cortex_m4_crash(CRASH_PROGRAM, 0);
            }
            if (orthosis_wants_restart(&orthosis)) {
                fdcan_silence();
                cortex_m4_reset();
            }
        }
        (void)orthosis_poll(&orthosis);
        idle_until_interrupt(&can, &timer);
    }
}
