/* TIM2: 32 bits, the compare of its first channel, and the output of its second one. RM0440, "TIM2". */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

enum {
    CR1 = 0x00,
    DIER = 0x0C,
    SR = 0x10,
    EGR = 0x14,
    CCMR1 = 0x18,
    CCER = 0x20,
    CNT = 0x24,
    PSC = 0x28,
    ARR = 0x2C,
    CCR1 = 0x34,
    CCR2 = 0x38
};
enum {
    CR1_CEN = 1,
    FLAG_UPDATE = 1,
    FLAG_COMPARE_1 = 2,
    FLAG_COMPARE_2 = 4,
    CC2E = 1 << 4,
    OC2M = 7
};
enum { LOW_ON_MATCH = 2, FORCED_HIGH = 5, PULSE_PIN = 1 };

/* Nanoseconds of `counts` counts, and counts of a time, exact for whole kHz. */
static uint64_t ns_of_counts(const struct chip *chip, uint64_t counts)
{
    const uint64_t khz = chip->clocks.timer_khz;
    const uint64_t clocks = counts * (chip->timer.psc_active + 1u);
    return (clocks * 1000000u + khz - 1) / khz;
}

static uint64_t counts_since_base(const struct chip *chip)
{
    const uint64_t ns = chip_now_ns(chip) - chip->timer.base_ns;
    return ns * chip->clocks.timer_khz / 1000000u / (chip->timer.psc_active + 1u);
}

static uint32_t timer_count(const struct chip *chip)
{
    const struct chip_timer *timer = &chip->timer;
    return (timer->cr1 & CR1_CEN) != 0 ? timer->count_base + (uint32_t)counts_since_base(chip)
                                       : timer->count_base;
}

static void schedule_timer(struct chip *chip)
{
    struct chip_timer *timer = &chip->timer;

    timer->match_ns = timer->overflow_ns = timer->low_ns = CHIP_NEVER;
    if ((timer->cr1 & CR1_CEN) == 0) {
        return;
    }
    const uint32_t now = timer_count(chip);
    const uint64_t done = counts_since_base(chip);
    const uint64_t to_match = timer->ccr1 != now ? timer->ccr1 - now : UINT64_C(1) << 32;
    const uint64_t to_overflow = (UINT64_C(1) << 32) - now;

    timer->match_ns = timer->base_ns + ns_of_counts(chip, done + to_match);
    timer->overflow_ns = timer->base_ns + ns_of_counts(chip, done + to_overflow);
    if (timer->high && (timer->ccmr1 >> 12 & (uint32_t)OC2M) == (uint32_t)LOW_ON_MATCH) {
        timer->low_ns = timer->base_ns + ns_of_counts(chip, done + (timer->ccr2 - now));
    }
}

/* A part of a count that has passed stays passed. */
void chip_timer_rebase(struct chip *chip)
{
    struct chip_timer *timer = &chip->timer;

    if ((timer->cr1 & CR1_CEN) == 0) {
        timer->base_ns = chip_now_ns(chip);
        return;
    }
    const uint64_t done = counts_since_base(chip);
    timer->count_base += (uint32_t)done;
    timer->base_ns += ns_of_counts(chip, done);
}

static uint32_t timer_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    const struct chip_timer *timer = &chip->timer;

    switch (offset) {
    case CR1:
        return timer->cr1;
    case DIER:
        return timer->dier;
    case SR:
        return timer->sr;
    case CNT:
        return timer_count(chip);
    case PSC:
        return timer->psc;
    case ARR:
        return timer->arr;
    case CCR1:
        return timer->ccr1;
    case CCR2:
        return timer->ccr2;
    case CCMR1:
        return timer->ccmr1;
    case CCER:
        return timer->ccer;
    default:
        model_misuse("TIM2 register %#x read", offset);
        return 0;
    }
}

/* The level that the second channel's pin takes. */
static void set_output(struct chip *chip, bool high)
{
    struct chip_timer *timer = &chip->timer;
    const struct chip_port *a = &chip->port[0];
    const bool leads_out = (timer->ccer & CC2E) != 0 && (a->reg[0] >> (2 * PULSE_PIN) & 3) == 2 &&
                           (a->reg[0x20 / 4] >> (4 * PULSE_PIN) & 0xF) == 1;

    if (high && !timer->high && leads_out) {
        timer->pulses++;
        timer->rose_ns = chip_now_ns(chip);
    } else if (!high && timer->high && leads_out) {
        timer->fell_ns = chip_now_ns(chip);
    }
    timer->high = high;
}

/* RM0440, "TIMx_CCMR1", OC2M; of its modes those in use. */
static void write_output_mode(struct chip *chip, uint32_t value)
{
    const uint32_t mode = value >> 12 & (uint32_t)OC2M;

    MODEL_CHECK((value & ~(7u << 12)) == 0 && (mode == LOW_ON_MATCH || mode == FORCED_HIGH),
                "TIM2_CCMR1 %#x is not modelled", value);
    chip->timer.ccmr1 = value;
    if (mode == FORCED_HIGH) {
        set_output(chip, true);
    }
}

static void timer_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    struct chip_timer *timer = &chip->timer;

    chip_timer_rebase(chip);
    switch (offset) {
    case CR1:
        timer->cr1 = value;
        break;
    case DIER:
        timer->dier = value;
        break;
    case SR: /* writing 0 clears */
        timer->sr &= value;
        break;
    case EGR:
        if ((value & 1) != 0) {
            timer->psc_active = timer->psc;
            timer->count_base = 0;
            timer->base_ns = chip_now_ns(chip);
            timer->sr |= FLAG_UPDATE;
        }
        break;
    case CNT:
        timer->count_base = value;
        timer->base_ns = chip_now_ns(chip);
        break;
    case PSC:
        timer->psc = value & 0xFFFF;
        break;
    case ARR:
        MODEL_CHECK(value == UINT32_MAX, "TIM2 counts to %#x: only 32 bits are modelled", value);
        timer->arr = value;
        break;
    case CCR1:
        timer->ccr1 = value;
        break;
    case CCR2:
        timer->ccr2 = value;
        break;
    case CCMR1:
        write_output_mode(chip, value);
        break;
    case CCER:
        timer->ccer = value;
        break;
    default:
        model_misuse("TIM2 register %#x written", offset);
        break;
    }
    schedule_timer(chip);
}

void chip_timer_fire(struct chip *chip)
{
    struct chip_timer *timer = &chip->timer;
    const uint64_t now_ns = chip_now_ns(chip);

    if (now_ns >= timer->low_ns) {
        timer->sr |= FLAG_COMPARE_2;
        set_output(chip, false);
        schedule_timer(chip);
    }
    if (now_ns < timer->match_ns && now_ns < timer->overflow_ns) {
        return;
    }
    timer->sr |= now_ns >= timer->match_ns ? FLAG_COMPARE_1 : 0;
    if (now_ns >= timer->overflow_ns) {
        timer->sr |= FLAG_UPDATE;
        timer->psc_active = timer->psc;
    }
    schedule_timer(chip);
}

uint64_t chip_timer_due(const struct chip *chip)
{
    const struct chip_timer *timer = &chip->timer;
    const uint64_t due =
        timer->match_ns < timer->overflow_ns ? timer->match_ns : timer->overflow_ns;
    return timer->low_ns < due ? timer->low_ns : due;
}

void chip_timer_reset(struct chip *chip)
{
    struct chip_timer *timer = &chip->timer;
    const uint64_t pulses = timer->pulses, rose_ns = timer->rose_ns, fell_ns = timer->fell_ns;

    set_output(chip, false);
    memset(timer, 0, sizeof *timer);
    timer->arr = UINT32_MAX;
    timer->match_ns = timer->overflow_ns = timer->low_ns = CHIP_NEVER;
    timer->pulses = pulses;
    timer->rose_ns = rose_ns;
    timer->fell_ns = fell_ns;
}

void chip_timer_map(struct chip *chip)
{
    mmio_model_map(0x40000000u, 0x400, timer_read, timer_write, chip);
}
