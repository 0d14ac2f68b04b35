/* The independent watchdog, the pins and DBGMCU. RM0440, sections of these names. */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

#define GPIOA_MODER 0x48000000u
enum { NS_PER_S = 1000000000, LSI_SYNC_NS = 160000 };

/* ---- Watchdog --------------------------------------------------------------------------------- */

enum { IWDG_KR = 0x00, IWDG_PR = 0x04, IWDG_RLR = 0x08, IWDG_SR = 0x0C, IWDG_WINR = 0x10 };

static uint64_t watchdog_count_ns(const struct chip *chip, uint64_t counts)
{
    const uint64_t divider = UINT64_C(4) << (chip->watchdog.pr < 6 ? chip->watchdog.pr : 6);
    return counts * divider * (uint64_t)NS_PER_S / chip->supply.lsi_hz;
}

static void reload_watchdog(struct chip *chip)
{
    struct chip_watchdog *dog = &chip->watchdog;

    if (dog->running) {
        dog->due_ns = chip_now_ns(chip) + watchdog_count_ns(chip, dog->rlr + 1u);
    }
}

/* RM0440, "Window option": above the window's value the counter must not be fed. */
static void feed_watchdog(struct chip *chip)
{
    struct chip_watchdog *dog = &chip->watchdog;

    if (dog->due_ns <= chip_now_ns(chip)) {
        return; /* too late, or too early once */
    }
    if (dog->running && chip_now_ns(chip) + watchdog_count_ns(chip, dog->winr) < dog->due_ns &&
        dog->winr < 0xFFF) {
        dog->due_ns = chip_now_ns(chip); /* it bites */
        return;
    }
    reload_watchdog(chip);
}

static uint32_t watchdog_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;

    switch (offset) {
    case IWDG_PR:
        return chip->watchdog.pr;
    case IWDG_RLR:
        return chip->watchdog.rlr;
    case IWDG_SR:
        return chip_now_ns(chip) < chip->watchdog.busy_until_ns ? 7 : 0;
    default:
        return offset == IWDG_WINR ? chip->watchdog.winr : 0;
    }
}

static void watchdog_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    struct chip_watchdog *dog = &chip->watchdog;

    if (offset == IWDG_KR) {
        dog->unlocked = value == 0x5555;
        if (value == 0xCCCC && !dog->running) {
            dog->running = true;
            chip->clocks.rcc[0x94 / 4] |= 3; /* RM0440: starts the LSI oscillator, too */
            reload_watchdog(chip);
        } else if (value == 0xAAAA) {
            feed_watchdog(chip);
        }
        return;
    }
    MODEL_CHECK(dog->unlocked, "a watchdog register was written while locked");
    if (dog->unlocked && offset == IWDG_PR) {
        dog->pr = value & 7;
    } else if (dog->unlocked && offset == IWDG_RLR) {
        dog->rlr = value & 0xFFF;
    } else if (dog->unlocked && offset == IWDG_WINR) {
        dog->winr = value & 0xFFF;
        reload_watchdog(chip);
    }
    dog->busy_until_ns = chip_now_ns(chip) + LSI_SYNC_NS;
}

static void fire_watchdog(struct chip *chip)
{
    if (chip_now_ns(chip) >= chip->watchdog.due_ns) {
        chip->watchdog.due_ns = CHIP_NEVER;
        chip->uart_reg[0] = chip->uart_reg[1] = 0;
        chip->reset_asked = true;
        chip->reset_cause = (uint32_t)CHIP_RESET_WATCHDOG | (uint32_t)CHIP_RESET_PIN;
    }
}

/* ---- Pins ----------------------------------------------------------------------------------------- */

enum { MODER = 0x00, PUPDR = 0x0C, IDR = 0x10, ODR = 0x14, BSRR = 0x18, BRR = 0x28 };
enum { PORT_C = 2, PERMIT_PIN = 1, LED_PIN = 5 };

static uint32_t pin_field(const struct chip_port *port, uint32_t offset, unsigned pin)
{
    return port->reg[offset / 4] >> (2 * pin) & 3;
}

static uint32_t input_of(const struct chip_port *port)
{
    uint32_t input = 0;

    for (unsigned pin = 0; pin < 16; pin++) {
        const uint32_t mode = pin_field(port, MODER, pin);
        const bool out = mode == 1 && (port->reg[ODR / 4] >> pin & 1) != 0;
        const bool held = (port->driven >> pin & 1) != 0;
        const bool in = held ? (port->level >> pin & 1) != 0 : pin_field(port, PUPDR, pin) == 1;
        input |= mode == 3 ? 0 : (mode == 1 ? out : in) ? 1u << pin : 0;
    }
    return input;
}

static uint32_t pins_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    const struct chip_port *port = &chip->port[offset / 0x400];

    offset %= 0x400;
    if (offset >= sizeof port->reg) {
        return 0;
    }
    return offset == IDR ? input_of(port) : port->reg[offset / 4];
}

static void watch_led(struct chip *chip, bool before)
{
    const struct chip_port *a = &chip->port[0];

    if (!before && (a->reg[ODR / 4] >> LED_PIN & 1) != 0 && pin_field(a, MODER, LED_PIN) == 1) {
        chip->led_edges++;
    }
}

static void watch_permit(struct chip *chip, bool before)
{
    const struct chip_port *c = &chip->port[PORT_C];
    const bool after = (c->reg[ODR / 4] >> PERMIT_PIN & 1) != 0;

    if (before != after && pin_field(c, MODER, PERMIT_PIN) == 1) {
        chip->permit_edge_ns = chip_now_ns(chip);
        chip->permit_edges++;
    }
}

static void pins_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    struct chip_port *port = &chip->port[offset / 0x400];
    const bool permit = (chip->port[PORT_C].reg[ODR / 4] >> PERMIT_PIN & 1) != 0;
    const bool led = (chip->port[0].reg[ODR / 4] >> LED_PIN & 1) != 0;
    uint32_t *odr = &port->reg[ODR / 4];

    offset %= 0x400;
    switch (offset) {
    case IDR:
        break;
    case BSRR:
        *odr = ((*odr & ~(value >> 16)) | (value & 0xFFFF)) & 0xFFFF;
        break;
    case BRR:
        *odr &= ~(value & 0xFFFF);
        break;
    default:
        if (offset < sizeof port->reg) {
            port->reg[offset / 4] = value;
        }
        break;
    }
    watch_permit(chip, permit);
    watch_led(chip, led);
}

bool chip_gives(const struct chip *chip, unsigned port, unsigned pin)
{
    const struct chip_port *p = &chip->port[port];
    return pin_field(p, MODER, pin) == 1 && (p->reg[ODR / 4] >> pin & 1) != 0;
}

void chip_drive_pin(struct chip *chip, unsigned port, unsigned pin, bool high)
{
    chip->port[port].driven |= 1u << pin;
    chip->port[port].level = (chip->port[port].level & ~(1u << pin)) | (high ? 1u << pin : 0);
}

/* ---- LPUART1 ---------------------------------------------------------------------------------------- */

enum { UART_CR1 = 0x00, UART_BRR = 0x0C, UART_ISR = 0x1C, UART_TDR = 0x28 };
enum { UART_BITS = 10, UART_TXE = 1 << 7, UART_ENABLED = 1 | 1 << 3 };

static uint32_t uart_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;

    switch (offset) {
    case UART_CR1:
        return chip->uart_reg[0];
    case UART_BRR:
        return chip->uart_reg[1];
    case UART_ISR:
        return chip_now_ns(chip) >= chip->uart_ready_ns ? UART_TXE : 0;
    default:
        return 0;
    }
}

/* RM0440, "LPUART baud rate generation". The line is read at 115200 baud: 3 % off is too much. */
static void uart_send(struct chip *chip, uint32_t value)
{
    const uint32_t divisor = chip->uart_reg[1];
    const double baud = divisor != 0 ? 256e3 * chip->clocks.core_khz / divisor : 0;
    const struct chip_port *a = &chip->port[0];

    if ((chip->uart_reg[0] & UART_ENABLED) != UART_ENABLED || pin_field(a, MODER, 2) != 2 ||
        (a->reg[0x20 / 4] >> 8 & 0xF) != 12 || baud < 112000 || baud > 118700) {
        if (!mmio_model_loses(GPIOA_MODER)) { /* else the program is not to blame */
            chip_find(chip, "LPUART1 sends with %.0f baud, and PA2 is %s", baud,
                      pin_field(a, MODER, 2) == 2 ? "its pin" : "no pin of it");
        }
        return;
    }
    MODEL_CHECK(chip_now_ns(chip) >= chip->uart_ready_ns,
                "LPUART1 was given a character too early");
    chip->uart_ready_ns = chip_now_ns(chip) + (uint64_t)(UART_BITS * 1e9 / baud);
    if (chip->uart_count == CHIP_UART_MAX - 1) {
        memmove(chip->uart, chip->uart + CHIP_UART_MAX / 2, CHIP_UART_MAX / 2);
        chip->uart_count -= CHIP_UART_MAX / 2;
    }
    chip->uart[chip->uart_count++] = (char)value;
    chip->uart[chip->uart_count] = '\0';
}

static void uart_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;

    if (offset == UART_CR1) {
        chip->uart_reg[0] = value;
    } else if (offset == UART_BRR) {
        chip->uart_reg[1] = value;
    } else if (offset == UART_TDR) {
        uart_send(chip, value);
    }
}

/* ---- All of them ------------------------------------------------------------------------------------ */

static uint32_t debug_read(void *context, uint32_t offset)
{
    (void)context;
    return offset == 0 ? 0x20016469u : 0; /* DBGMCU_IDCODE of category 3 devices */
}

static void debug_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    (void)offset;
    (void)value;
}

uint64_t chip_io_due(const struct chip *chip)
{
    const uint64_t due = chip_timer_due(chip);
    return chip->watchdog.due_ns < due ? chip->watchdog.due_ns : due;
}

void chip_io_fire(struct chip *chip)
{
    chip_timer_fire(chip);
    fire_watchdog(chip);
}

void chip_io_reset(struct chip *chip)
{
    chip_timer_reset(chip);
    memset(&chip->watchdog, 0, sizeof chip->watchdog);
    chip->watchdog.rlr = chip->watchdog.winr = 0xFFF;
    chip->watchdog.due_ns = CHIP_NEVER;
    for (unsigned i = 0; i < CHIP_PORTS; i++) {
        memset(chip->port[i].reg, 0, sizeof chip->port[i].reg);
        chip->port[i].reg[0] = i == 0 ? 0xABFFFFFFu : i == 1 ? 0xFFFFFEBFu : 0xFFFFFFFFu;
    }
    chip->port[0].reg[PUPDR / 4] = 0x64000000u;
    chip->port[1].reg[PUPDR / 4] = 0x00000100u;
}

void chip_set_lsi(struct chip *chip, uint32_t hz)
{
    struct chip_watchdog *dog = &chip->watchdog;
    const uint64_t now_ns = chip_now_ns(chip);

    if (dog->due_ns != CHIP_NEVER && dog->due_ns > now_ns) { /* so many counts are left */
        dog->due_ns = now_ns + (dog->due_ns - now_ns) * chip->supply.lsi_hz / hz;
    }
    chip->supply.lsi_hz = hz;
    chip_update(chip);
}

void chip_feed_watchdog(struct chip *chip)
{
    feed_watchdog(chip);
    chip_update(chip);
}

void chip_io_map(struct chip *chip)
{
    chip_timer_map(chip);
    mmio_model_map(0x40003000u, 0x400, watchdog_read, watchdog_write, chip);
    mmio_model_map(0x40008000u, 0x400, uart_read, uart_write, chip);
    mmio_model_map(0x48000000u, 0x400 * CHIP_PORTS, pins_read, pins_write, chip);
    mmio_model_map(0xE0042000u, 0x400, debug_read, debug_write, chip);
}
