#include "hal/port_stm32g474/board_io.h"

#include "hal/bus/frame_table.h"
#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/peripheral_clock.h"
#include "hal/port_stm32g474/system_registers.h"

enum { LSI_HZ = 32000, IWDG_DIVISOR = 4, NS_PER_US = 1000 };
#define RELOAD ((uint32_t)WATCHDOG_TIMEOUT_MS * (LSI_HZ / IWDG_DIVISOR) / 1000U)
/* It counts down; it may be fed from here on. */
#define WINDOW \
    ((uint32_t)(WATCHDOG_TIMEOUT_MS - WATCHDOG_OPENS_MS) * (LSI_HZ / IWDG_DIVISOR) / 1000U)
/* Setting the compare takes far less than a period: the second turn hits. */
enum { MARK_TURNS = 3 };

/* ---- Timer ------------------------------------------------------------------ */

#define COUNT_OF(table) (sizeof(table) / sizeof((table)[0]))

uint32_t tim2_clock_init(struct tim2_clock *clock, uint32_t timer_clock_hz)
{
    clock->high = 0;
    clock->waiting = 0;
    clock->missed = 0;
    peripheral_clock_enable(RCC_APB1ENR1, RCC_APB1_TIM2);
    mmio_write(TIM2_PSC, timer_clock_hz / 1000000U - 1U);
    mmio_write(TIM2_ARR, 0xFFFFFFFFU);
    mmio_write(TIM2_EGR, TIM_EGR_UG); /* loads the prescaler, sets UIF */
    mmio_write(TIM2_CCR1, (uint32_t)TICK_PERIOD_US);
    mmio_write(TIM2_CCMR1, TIM_CCMR1_OC2_LOW_ON_MATCH);
    mmio_write(TIM2_CCER, TIM_CCER_CC2E);
    mmio_write(TIM2_SR, 0);
    mmio_write(TIM2_DIER, TIM_DIER_UIE | TIM_DIER_CC1IE);
    mmio_write(TIM2_CR1, TIM_CR1_CEN);
    const struct mmio_expected expected[] = {
        {TIM2_PSC, UINT32_MAX, timer_clock_hz / 1000000U - 1U},
        {TIM2_ARR, UINT32_MAX, UINT32_MAX},
        {TIM2_CCR1, UINT32_MAX, (uint32_t)TICK_PERIOD_US},
        {TIM2_CCMR1, UINT32_MAX, TIM_CCMR1_OC2_LOW_ON_MATCH},
        {TIM2_CCER, UINT32_MAX, TIM_CCER_CC2E},
        {TIM2_DIER, UINT32_MAX, TIM_DIER_UIE | TIM_DIER_CC1IE},
        {TIM2_CR1, UINT32_MAX, TIM_CR1_CEN},
    };
    return mmio_first_lost(expected, COUNT_OF(expected));
}

static void count_missed(struct tim2_clock *clock, uint32_t periods)
{
    const uint32_t missed = clock->missed;
    clock->missed = periods > UINT32_MAX - missed ? UINT32_MAX : missed + periods;
}

/* How far the counter is beyond `due`; 0 when it is not there yet. */
static uint32_t microseconds_beyond(uint32_t due)
{
    const uint32_t beyond = mmio_read(TIM2_CNT) - due;
    return beyond <= (uint32_t)INT32_MAX ? beyond : 0U;
}

/* Sets the compare to the next end of a period. Behind the counter it would match again
 * only after 71 minutes, so a period that ended while it was being set is counted, too. */
static void mark_next_period(struct tim2_clock *clock)
{
    uint32_t due = mmio_read(TIM2_CCR1);

    for (int turn = 0; turn < MARK_TURNS; turn++) {
        const uint32_t late = microseconds_beyond(due) / (uint32_t)TICK_PERIOD_US;
        due += (late + 1U) * (uint32_t)TICK_PERIOD_US;
        count_missed(clock, late + (turn > 0 ? 1U : 0U));
        mmio_write(TIM2_SR, ~TIM_SR_CC1IF); /* before the new value, whose match must stay */
        mmio_write(TIM2_CCR1, due);
        if ((int32_t)(mmio_read(TIM2_CNT) - due) < 0) {
            return;
        }
    }
}

void tim2_clock_interrupt(struct tim2_clock *clock)
{
    /* FDCAN's interrupt reads the time: not between the flag and the count. */
    const uint32_t state = mmio_lock();
    const uint32_t flags = mmio_read(TIM2_SR);

    if ((flags & TIM_SR_UIF) != 0U) {
        mmio_write(TIM2_SR, ~TIM_SR_UIF); /* writing 0 clears, 1 leaves */
        clock->high = clock->high + 1U;
    }
    mmio_unlock(state);
    if ((flags & TIM_SR_CC1IF) != 0U) {
        count_missed(clock, clock->waiting > 0U ? 1U : 0U);
        clock->waiting = clock->waiting + 1U;
        mark_next_period(clock);
    }
}

static uint64_t now_us(const struct tim2_clock *clock)
{
    uint32_t state = mmio_lock();
    uint32_t low = mmio_read(TIM2_CNT);
    uint32_t high = clock->high;

    if ((mmio_read(TIM2_SR) & TIM_SR_UIF) != 0U) { /* an overflow nobody counted yet */
        low = mmio_read(TIM2_CNT);
        high++;
    }
    mmio_unlock(state);
    return ((uint64_t)high << 32) | low;
}

uint64_t tim2_clock_now_ns(void *clock)
{
    return now_us(clock) * NS_PER_US;
}

uint32_t tim2_clock_now_us(const struct tim2_clock *clock)
{
    (void)clock;
    return mmio_read(TIM2_CNT);
}

uint32_t tim2_clock_now_ms(const struct tim2_clock *clock)
{
    /* 2^32 us are 4,294,967 ms and 296 us: no 64-bit division, which the image does without. */
    const uint64_t time_us = now_us(clock);
    const uint32_t low = (uint32_t)time_us, high = (uint32_t)(time_us >> 32);
    return high * 4294967U + low / 1000U + (high * 296U + low % 1000U) / 1000U;
}

static bool take_tick(void *context)
{
    struct tim2_clock *clock = context;
    uint32_t state = mmio_lock();
    bool ended = clock->waiting > 0U;

    if (ended) {
        clock->waiting = clock->waiting - 1U;
    }
    mmio_unlock(state);
    return ended;
}

static uint32_t missed_ticks(void *context)
{
    const struct tim2_clock *clock = context;
    return clock->missed;
}

static const struct clock_ops tim2_ops = {tim2_clock_now_ns, take_tick, missed_ticks};

struct clock tim2_clock_interface(struct tim2_clock *clock)
{
    struct clock interface = {&tim2_ops, clock};
    return interface;
}

/* RM0440, "TIMx_CCMR1", OC2M: the output goes high at once, and low when the counter gets to CCR2. */
static void give_pulse(void *context)
{
    (void)context;
    mmio_write(TIM2_CCR2, mmio_read(TIM2_CNT) + (uint32_t)SYNC_PULSE_US);
    mmio_write(TIM2_CCMR1, TIM_CCMR1_OC2_HIGH);
    mmio_write(TIM2_CCMR1, TIM_CCMR1_OC2_LOW_ON_MATCH);
}

static const struct sync_pulse_ops pa1_ops = {give_pulse};
const struct sync_pulse pa1_sync_pulse = {&pa1_ops, 0};

/* ---- Watchdog --------------------------------------------------------------- */

static void wait_for_watchdog(void)
{
    for (uint32_t poll = 0; poll < WATCHDOG_POLLS; poll++) {
        if ((mmio_read(IWDG_SR) & IWDG_SR_BUSY) == 0U) {
            break; /* if it never ends, the reset values still stand there */
        }
    }
}

uint32_t iwdg_start(void)
{
    static const struct mmio_expected expected[] = {
        {IWDG_PR, 7U, IWDG_PR_DIV4}, {IWDG_RLR, 0xFFFU, RELOAD}, {IWDG_WINR, 0xFFFU, WINDOW}};
    const uint32_t before_window = COUNT_OF(expected) - 1U;

    mmio_write(IWDG_KR, IWDG_KEY_START);
    mmio_write(IWDG_KR, IWDG_KEY_UNLOCK);
    mmio_write(IWDG_PR, IWDG_PR_DIV4);
    mmio_write(IWDG_RLR, RELOAD);
    wait_for_watchdog();
    const uint32_t lost = mmio_first_lost(expected, before_window);
    if (lost != 0U) {
        return lost; /* with another time-out the window would be another one, too */
    }
    mmio_write(IWDG_WINR, WINDOW); /* RM0440: feeds, too, once the others are in force */
    wait_for_watchdog();
    return mmio_first_lost(expected + before_window, 1);
}

void iwdg_feed(void)
{
    mmio_write(IWDG_KR, IWDG_KEY_FEED);
}

static void feed(void *context)
{
    struct iwdg *iwdg = context;
    const uint32_t count_us = mmio_read(TIM2_CNT);

    if (count_us - iwdg->fed_us >= (uint32_t)WATCHDOG_FEED_MS * 1000U) {
        iwdg->fed_us = count_us;
        iwdg_feed();
    }
}

static const struct watchdog_ops iwdg_ops = {feed};

struct watchdog iwdg_interface(struct iwdg *iwdg)
{
    struct watchdog interface = {&iwdg_ops, iwdg};
    return interface;
}

/* ---- Pins ------------------------------------------------------------------- */

static void pin_mode(uint32_t port, uint32_t pin, uint32_t mode)
{
    mmio_change(port + GPIO_MODER, 3U << (2U * pin), mode << (2U * pin));
}

static void pin_alternate(uint32_t port, uint32_t pin, uint32_t function)
{
    uint32_t shift = 4U * (pin & 7U);

    mmio_change(port + (pin < 8U ? GPIO_AFRL : GPIO_AFRH), 0xFU << shift, function << shift);
    mmio_change(port + GPIO_OSPEEDR, 3U << (2U * pin), GPIO_SPEED_HIGH << (2U * pin));
    pin_mode(port, pin, GPIO_MODE_ALTERNATE);
}

/* Two bits a pin, four for its alternate function. */
#define FIELD_2(pin, value) ((uint32_t)(value) << (2U * (pin)))
#define FIELD_4(pin, value) ((uint32_t)(value) << (4U * ((pin)&7U)))

static const struct mmio_expected pins_expected[] = {
    {RCC_APB1RSTR1, RCC_APB1_FDCAN, 0},
    {GPIOA_BASE + GPIO_PUPDR, FIELD_2(11U, 3U), FIELD_2(11U, GPIO_PULL_UP)},
    {GPIOA_BASE + GPIO_AFRL, FIELD_4(1U, 0xFU), FIELD_4(1U, GPIO_AF_TIM2)},
    {GPIOA_BASE + GPIO_AFRH, FIELD_4(11U, 0xFU) | FIELD_4(12U, 0xFU),
     FIELD_4(11U, GPIO_AF_FDCAN1) | FIELD_4(12U, GPIO_AF_FDCAN1)},
    {GPIOA_BASE + GPIO_MODER, FIELD_2(1U, 3U) | FIELD_2(11U, 3U) | FIELD_2(12U, 3U),
     FIELD_2(1U, GPIO_MODE_ALTERNATE) | FIELD_2(11U, GPIO_MODE_ALTERNATE) |
         FIELD_2(12U, GPIO_MODE_ALTERNATE)},
    {GPIOC_BASE + GPIO_PUPDR, FIELD_2(0U, 3U) | FIELD_2(2U, 3U),
     FIELD_2(0U, GPIO_PULL_DOWN) | FIELD_2(2U, GPIO_PULL_UP)},
    {GPIOC_BASE + GPIO_MODER,
     FIELD_2(0U, 3U) | FIELD_2(1U, 3U) | FIELD_2(2U, 3U) | FIELD_2(3U, 3U) | FIELD_2(5U, 3U),
     FIELD_2(0U, GPIO_MODE_INPUT) | FIELD_2(1U, GPIO_MODE_OUTPUT) | FIELD_2(2U, GPIO_MODE_INPUT) |
         FIELD_2(3U, GPIO_MODE_OUTPUT) | FIELD_2(5U, GPIO_MODE_OUTPUT)},
};

uint32_t board_io_init(void)
{
    peripheral_clock_enable(RCC_AHB2ENR, RCC_AHB2_GPIOA | RCC_AHB2_GPIOC);
    peripheral_clock_enable(RCC_APB1ENR1, RCC_APB1_FDCAN);
    mmio_set(RCC_APB1RSTR1, RCC_APB1_FDCAN); /* whatever a crash left behind */
    mmio_clear(RCC_APB1RSTR1, RCC_APB1_FDCAN);
    mmio_change(GPIOA_BASE + GPIO_PUPDR, 3U << 22U, GPIO_PULL_UP << 22U); /* PA11 idles recessive */
    pin_alternate(GPIOA_BASE, 1U, GPIO_AF_TIM2);
    pin_alternate(GPIOA_BASE, 11U, GPIO_AF_FDCAN1);
    pin_alternate(GPIOA_BASE, 12U, GPIO_AF_FDCAN1);
    mmio_change(GPIOC_BASE + GPIO_PUPDR, FIELD_2(0U, 3U) | FIELD_2(2U, 3U),
                FIELD_2(0U, GPIO_PULL_DOWN) | FIELD_2(2U, GPIO_PULL_UP));
    pin_mode(GPIOC_BASE, 0U, GPIO_MODE_INPUT);
    pin_mode(GPIOC_BASE, 1U, GPIO_MODE_OUTPUT);
    pin_mode(GPIOC_BASE, 2U, GPIO_MODE_INPUT);
    pin_mode(GPIOC_BASE, 3U, GPIO_MODE_OUTPUT);
    pin_mode(GPIOC_BASE, 5U, GPIO_MODE_OUTPUT); /* low: the data register's reset value */
    return mmio_first_lost(pins_expected, COUNT_OF(pins_expected));
}

static void toggle(void *context)
{
    (void)context;
    mmio_write(GPIOC_BASE + GPIO_ODR, mmio_read(GPIOC_BASE + GPIO_ODR) ^ 2U);
}

bool board_io_permit_is_high(void)
{
    return (mmio_read(GPIOC_BASE + GPIO_IDR) & 2U) != 0U;
}

static void cut(void *context, bool cut)
{
    (void)context;
    mmio_change(GPIOC_BASE + GPIO_ODR, 1U << 5U, cut ? 1U << 5U : 0U);
}

bool board_io_cut_is_high(void)
{
    return (mmio_read(GPIOC_BASE + GPIO_IDR) & 1U << 5U) != 0U;
}

static const struct drive_power_enable_ops pc1_pc5_ops = {toggle, cut};
const struct drive_power_enable pc1_pc5_drive_power_enable = {&pc1_pc5_ops, 0};

bool board_io_stop_is_pressed(void)
{
    return (mmio_read(GPIOC_BASE + GPIO_IDR) & 1U) == 0U;
}

static bool is_pressed(void *context)
{
    (void)context;
    return board_io_stop_is_pressed();
}

static const struct emergency_stop_ops pc0_ops = {is_pressed};
const struct emergency_stop pc0_emergency_stop = {&pc0_ops, 0};

static bool is_wearer_pressing(void *context)
{
    (void)context;
    return (mmio_read(GPIOC_BASE + GPIO_IDR) & 4U) == 0U;
}

static void set_cue(void *context, bool on)
{
    (void)context;
    mmio_change(GPIOC_BASE + GPIO_ODR, 8U, on ? 8U : 0U);
}

static const struct wearer_panel_ops pc2_pc3_ops = {is_wearer_pressing, set_cue};
const struct wearer_panel pc2_pc3_wearer_panel = {&pc2_pc3_ops, 0};
