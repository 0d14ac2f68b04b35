/* The orthosis on a NUCLEO-G474RE: FDCAN1 on PA11 and PA12, emergency stop on PC0. */
#include "firmware/boards/nucleo_g474re/can_filters.h"
#include "firmware/orthosis.h"
#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "hal/port_cortex_m/cortex_m4.h"
#include "hal/port_cortex_m/cycle_counter.h"
#include "hal/port_cortex_m/self_tests.h"
#include "hal/port_cortex_m/tick_trace.h"
#include "hal/port_fdcan/fdcan.h"
#include "hal/port_stm32g474/board_io.h"
#include "hal/port_stm32g474/clock_tree.h"
#include "hal/port_stm32g474/flash_store.h"
#include "hal/port_stm32g474/idle.h"
#include "hal/port_stm32g474/lsi_meter.h"
#include "hal/port_stm32g474/option_bytes.h"
#include "hal/port_stm32g474/signs.h"
#include "hal/port_stm32g474/supply.h"
#include "hal/port_stm32g474/system_registers.h"

enum { EXCEPTION_NMI = 2, RETRY_MS = 1000, BOARD_PERIOD = 255, OSCILLATOR_PERIOD = 64 };
#define PROGRAM_RAM_BYTES 0x8000u /* link.ld; with parity */

static struct orthosis orthosis;
static struct fdcan can;
static struct tim2_clock timer;
static struct flash_store flash;
static struct iwdg iwdg;
static struct supply supply;
static struct self_tests tests;
static struct lsi_meter lsi;
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
void pvd_handler(void);
void tim2_handler(void);

/* Each ends with a barrier: scripts/errata.txt, core 2.1.3. */
void fdcan1_handler(void)
{
    fdcan_interrupt(&can);
    cortex_m4_barrier();
}

void tim2_handler(void)
{
    tim2_clock_interrupt(&timer);
    cortex_m4_barrier();
}

void pvd_handler(void)
{
    supply_interrupt(&supply);
    cortex_m4_barrier();
}

__attribute__((section(".vectors"), used)) const union vector vector_table[16 + IRQ_COUNT] = {
    {.stack = handler_stack_top},
    {.handler = reset_handler},
    VECTOR_EXCEPTIONS,
    VECTOR_FAULT,
    {.handler = pvd_handler}, /* 1 */
    VECTOR_FAULT_16,
    VECTOR_FAULT_2,
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
    if (record->cause != (uint32_t)CRASH_NMI) {
        return;
    }
    if (clock_tree_crystal_failed()) {
        record->cause = CRASH_CLOCK_FAILED;
    } else if (supply_ram_parity_failed()) {
        record->cause = CRASH_RAM_PARITY;
        black_box.header.magic = 0; /* the word may be in there, and the next start reads it */
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
        if (time_ms % (uint32_t)WATCHDOG_FEED_MS == (uint32_t)WATCHDOG_FEED_MS - 1u) {
            iwdg_feed();
        }
        for (volatile uint32_t poll = 0; poll < polls; poll++) {
        }
    }
    signs_write("afo: no start, cause ");
    signs_write_hex((uint32_t)cause);
    signs_write(" detail ");
    signs_write_hex(detail);
    signs_write("\r\n");
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
                                        sizeof can_filters / sizeof can_filters[0], .now_ns = NULL};
    enum fdcan_result result;

    must_hold(board_io_init());
    must_hold(tim2_clock_init(&timer, CORE_HZ));
    ports_run = true;
    must_hold(supply_init(&supply));
    must_hold(lsi_meter_init(&lsi));
    self_tests_init(&tests, ram_memory, PROGRAM_RAM_BYTES / sizeof(uint32_t));
    result = fdcan_init(&can, &config);
    must_hold(can.lost_register);
    if (result != FDCAN_OK) {
        give_up(CRASH_ASSERTION, (uint32_t) - (int32_t)result);
    }
    cortex_m4_enable_interrupt(IRQ_FDCAN1_IT0, 0);
    cortex_m4_enable_interrupt(IRQ_TIM2, 1);
    cortex_m4_enable_interrupt(IRQ_PVD, 2);
    cortex_m4_interrupts_on();
}

/* One line on the virtual COM port: who starts, on what, and why. */
static void say_start(uint32_t reset_flags)
{
    signs_init(clock_tree_hz());
    signs_write("afo ");
    signs_write(version_text());
    signs_write(" clock ");
    signs_write(clock_tree_hz() == (uint32_t)CORE_HZ ? "170" : "16");
    signs_write(" MHz, option bytes ");
    signs_write_hex(flash_store_option_bytes());
    signs_write(", reset cause ");
    signs_write_hex(reset_flags);
    signs_write(", crash ");
    signs_write_hex(crash_record_is_valid(&crash_record) ? crash_record.cause : 0u);
    signs_write("\r\n");
}

/* LD2 tells the supervisor's state, its number and one; the port each fault that is latched. */
static void show_state(struct signs_line *line, uint8_t *told)
{
    const uint8_t fault = (uint8_t)orthosis.task.output.fault;

    /* Now and then is enough; an odd tick, for telegrams come at even ones. */
    if (orthosis.task.tick % 16u == 1u) {
        signs_light(signs_flash(board_time_ms(), (uint32_t)orthosis.task.output.state + 1u));
    }
    if (fault != *told) {
        *told = fault;
        signs_line_begin(line, "afo fault", fault);
    }
    signs_line_go_on(line);
}

/* A tick has ended: what it took of the processor. */
static void note_cycles(uint32_t *slept)
{
    static uint32_t began;
    const uint32_t now = cycle_counter(), cycles = now - began - *slept;

    if (orthosis.task.now_ns != 0u) { /* the start is no tick */
        control_task_show_cycles(&orthosis.task, cycles);
    }
    tick_trace(orthosis.task.tick, cycles, (uint32_t)orthosis.task.output.state,
               (uint32_t)orthosis.task.output.fault);
    began = now;
    *slept = 0;
}

/* The emergency stop's contact is open, or the chip's power is going: in both cases the springs must
 * be unloaded now. */
static bool must_stop(void *context)
{
    (void)context;
    return supply_is_low(&supply) || board_io_stop_is_pressed();
}

static const struct emergency_stop_ops stop_ops = {must_stop};
static const struct emergency_stop stop_input = {&stop_ops, 0};

/* What 0x2033 tells of this board; now and then is enough. */
static void show_board(struct controller_board *board)
{
    static bool permit_was_high;
    static uint32_t looked_at_tick;
    const uint32_t tick = orthosis.task.tick;
    const bool permit_is_high = board_io_permit_is_high();
    uint32_t bits = (clock_tree_is_boosted() ? (uint32_t)BOARD_BOOST : 0u) |
                    (supply.low ? (uint32_t)BOARD_SUPPLY_LOW : 0u) |
                    (board_io_stop_is_pressed() ? 0u : (uint32_t)BOARD_STOP_CLOSED) |
                    (board_io_cut_is_high() ? (uint32_t)BOARD_POWER_CUT : 0u);

    /* It toggles in each tick: after an odd number of them it is the other way round. */
    if ((tick - looked_at_tick) % 2u == 1u) {
        bits |= permit_is_high != permit_was_high ? (uint32_t)BOARD_PERMIT_MOVES : 0u;
    } else {
        bits |= board->bits & (uint32_t)BOARD_PERMIT_MOVES;
    }
    permit_was_high = permit_is_high;
    looked_at_tick = tick;
    board->bits = (uint8_t)bits;
    board->watchdog_clock_Hz = lsi.hz;
    board->supply_dips = supply.dips;
    board->ram_rounds = tests.ram_rounds;
    board->program_rounds = orthosis.program_rounds;
}

static void begin_board(struct controller_board *board, uint32_t reset_flags)
{
    board->clock_Hz = clock_tree_hz();
    board->option_bytes = flash_store_option_bytes();
    board->wanted_option_bytes = option_bytes_wanted(board->option_bytes);
    board->reset_flags = reset_flags;
}

/* In a tick with little else to do. */
static void test_board(void)
{
    struct controller_objects *objects = &orthosis.task.node.objects;
    static uint32_t turns;
    uint32_t detail = 0;
    const enum crash_cause failed = self_tests_go_on(&tests, &detail);

    if (failed != CRASH_NONE) {
        cortex_m4_crash(failed, detail);
    }
    if (turns % (uint32_t)OSCILLATOR_PERIOD == 0u &&
        lsi_meter_update(&lsi, tim2_clock_now_us(&timer)) && !lsi_meter_is_good(&lsi)) {
        cortex_m4_crash(CRASH_OSCILLATOR, lsi.hz);
    }
    if (flash_store_take_corrected() && objects->counters.flash_corrected < UINT32_MAX) {
        objects->counters.flash_corrected++;
    }
    if (turns++ % (uint32_t)BOARD_PERIOD == 0u) {
        show_board(&objects->board);
    }
}

int main(void)
{
    const uint32_t reset_flags = clock_tree_take_reset_flags();
    const enum clock_tree_result clocks = clock_tree_init();
    const struct nv_store nv = flash_store_interface(&flash);
    const struct program_slots program = flash_store_programs(&flash);
    const struct clock clock = tim2_clock_interface(&timer);
    const struct watchdog watchdog = iwdg_interface(&iwdg);
    struct orthosis_config config = {
        .clock = &clock,
        .stop = stop_input,
        .watchdog = &watchdog,
        .drive_power = &pc1_pc5_drive_power_enable,
        .wearer = &pc2_pc3_wearer_panel,
        .sync_pulse = &pa1_sync_pulse,
        .nv = &nv,
        .program = &program,
        .in_quiet_ticks = test_board,
        .black_box = &black_box,
        .crash = &crash_record,
        .streak = &crash_streak,
        .restarted = restarted(reset_flags),
    };

    say_start(reset_flags);
    if (clocks != CLOCK_TREE_OK) {
        give_up(CRASH_CLOCK_FAILED, (uint32_t) - (int32_t)clocks);
    }
    flash_store_init(&flash);
    must_hold(iwdg_start()); /* before anything reaches the bus */
    start_ports();
    config.bus = fdcan_bus(&can);
    orthosis_init(&orthosis, &config);
    begin_board(&orthosis.task.node.objects.board, reset_flags);
    struct signs_line line = {.length = 0};
    uint8_t told_fault = 0;
    uint32_t slept = 0;
    cycle_counter_start();
    while (clock_take_tick(&clock)) {
        /* Periods that passed in the start are not made up for, all in one. */
    }
    for (;;) {
        const bool ticked = clock_take_tick(&clock);
        if (ticked) {
            note_cycles(&slept);
            control_task_show_missed(&orthosis.task, clock_missed_ticks(&clock));
            orthosis_start_cycle(&orthosis);
            show_state(&line, &told_fault);
            if (orthosis_program_is_damaged(&orthosis)) {
                cortex_m4_crash(CRASH_PROGRAM, 0);
            }
            if (orthosis_wants_restart(&orthosis)) {
                fdcan_silence();
                cortex_m4_reset();
            }
        }
        if (ticked || fdcan_is_due(&can)) {
            (void)orthosis_poll(&orthosis);
        }
        slept += idle_until_interrupt(&can, &timer);
    }
}
