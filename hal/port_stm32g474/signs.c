#include "hal/port_stm32g474/signs.h"

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/peripheral_clock.h"
#include "hal/port_stm32g474/system_registers.h"

enum { PIN_LD2 = 5, PIN_TX = 2, PIN_RX = 3 };

static void pin(uint32_t number, uint32_t mode)
{
    mmio_change(GPIOA_BASE + GPIO_MODER, 3U << (2U * number), mode << (2U * number));
}

static bool has_its_pin(void)
{
    const uint32_t mode = (mmio_read(GPIOA_BASE + GPIO_MODER) >> (2U * (uint32_t)PIN_TX)) & 3U;
    const uint32_t function = (mmio_read(GPIOA_BASE + GPIO_AFRL) >> (4U * (uint32_t)PIN_TX)) & 0xFU;

    return mode == (uint32_t)GPIO_MODE_ALTERNATE && function == (uint32_t)GPIO_AF_LPUART1;
}

void signs_init(uint32_t clock_hz)
{
    peripheral_clock_enable(RCC_AHB2ENR, RCC_AHB2_GPIOA);
    peripheral_clock_enable(RCC_APB1ENR2, RCC_APB1_LPUART1);
    mmio_clear(RCC_CCIPR, RCC_CCIPR_LPUART1SEL_MASK); /* the bus's clock, as fast as the core */
    mmio_change(GPIOA_BASE + GPIO_AFRL, 0xFFU << (4U * (uint32_t)PIN_TX),
                (GPIO_AF_LPUART1 << (4U * (uint32_t)PIN_TX)) |
                    (GPIO_AF_LPUART1 << (4U * (uint32_t)PIN_RX)));
    pin(PIN_LD2, GPIO_MODE_OUTPUT);
    pin(PIN_TX, GPIO_MODE_ALTERNATE);
    pin(PIN_RX, GPIO_MODE_ALTERNATE);
    mmio_write(LPUART1_CR1, 0);
    /* RM0440, "LPUART baud rate generation": 256 times the clock over the rate; in two steps,
     * for 256 * 170 MHz needs more than 32 bits. Below 0.01 % off. */
    mmio_write(LPUART1_BRR, clock_hz / (uint32_t)SIGNS_BAUD * 256U +
                                clock_hz % (uint32_t)SIGNS_BAUD * 256U / (uint32_t)SIGNS_BAUD);
    if (has_its_pin()) {
        mmio_write(LPUART1_CR1, LPUART_CR1_UE | LPUART_CR1_TE);
    }
}

void signs_light(bool lit)
{
    mmio_write(GPIOA_BASE + GPIO_BSRR, lit ? 1U << PIN_LD2 : 1U << (PIN_LD2 + 16));
}

bool signs_try_put(char character)
{
    if ((mmio_read(LPUART1_CR1) & LPUART_CR1_TE) == 0U) {
        return true; /* off: nobody would hear it */
    }
    if ((mmio_read(LPUART1_ISR) & LPUART_ISR_TXE) == 0U) {
        return false;
    }
    mmio_write(LPUART1_TDR, (uint8_t)character);
    return true;
}

void signs_write(const char *text)
{
    for (; *text != '\0'; text++) {
        for (uint32_t poll = 0; poll < (uint32_t)SIGNS_POLLS && !signs_try_put(*text); poll++) {
        }
    }
}

void signs_wait(uint32_t clock_hz, uint32_t time_ms)
{
    const uint32_t polls = clock_tree_wait_polls(clock_hz, time_ms);

    for (volatile uint32_t poll = 0; poll < polls; poll++) {
    }
}

void signs_write_hex(uint32_t number)
{
    static const char digits[] = "0123456789ABCDEF";
    char text[9];

    for (uint32_t i = 0; i < 8U; i++) {
        text[i] = digits[(number >> (28U - 4U * i)) & 0xFU];
    }
    text[8] = '\0';
    signs_write(text);
}

void signs_line_begin(struct signs_line *line, const char *name, uint32_t number)
{
    uint32_t length = 0;

    for (; length < 10U && name[length] != '\0'; length++) {
        line->text[length] = name[length];
    }
    line->text[length++] = ' ';
    for (uint32_t unit = 1000; unit > 0U; unit /= 10U) {
        line->text[length++] = (char)('0' + (char)(number / unit % 10U));
    }
    line->text[length++] = '\r';
    line->text[length++] = '\n';
    line->length = length;
    line->at = 0;
}

void signs_line_go_on(struct signs_line *line)
{
    if (line->at < line->length && signs_try_put(line->text[line->at])) {
        line->at++;
    }
}
