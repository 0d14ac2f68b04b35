/* FDCAN1: configuration and start, and leaving the bus for good. */
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/port_cortex_m/mmio.h"
#include "hal/port_fdcan/fdcan.h"
#include "hal/port_fdcan/fdcan_registers.h"

/* 24 quanta a bit: sync 1, before the sample point 20, after it 3. The sample
 * point is at 21/24 = 87.5 %, CiA 301's recommendation (table of bit timings). */
#define QUANTA 24u
#define SEGMENT_1 20u
#define SEGMENT_2 3u
#define JUMP_WIDTH 3u

#define ALL_TX_BUFFERS ((1U << FDCAN_TX_BUFFERS) - 1U)

static void put(uint32_t offset, uint32_t value)
{
    mmio_write(FDCAN1_BASE + offset, value);
}

/* Waits until INIT reads as wanted: it crosses into the core's own clock. */
static bool wait_for_init(bool wanted)
{
    for (uint32_t poll = 0; poll < FDCAN_INIT_POLLS; poll++) {
        if (((mmio_read(FDCAN1_BASE + FDCAN_CCCR) & FDCAN_CCCR_INIT) != 0U) == wanted) {
            return true;
        }
    }
    return false;
}

static uint32_t filter_element(const struct fdcan_filter *filter)
{
    const uint32_t target = filter->fifo == 0U ? FDCAN_FILTER_TO_FIFO0 : FDCAN_FILTER_TO_FIFO1;

    return (FDCAN_FILTER_RANGE << FDCAN_FILTER_TYPE_POS) | (target << FDCAN_FILTER_TARGET_POS) |
           ((uint32_t)filter->first << FDCAN_FILTER_ID1_POS) | filter->last;
}

static uint32_t filter_address(uint32_t index)
{
    return FDCAN1_RAM_BASE + FDCAN_RAM_FILTERS + 4U * index;
}

/* What no filter accepts, extended and remote frames are nobody's. */
static uint32_t filter_rules(const struct fdcan_config *config)
{
    return FDCAN_RXGFC_RRFE | FDCAN_RXGFC_RRFS | FDCAN_RXGFC_ANFE_REJECT | FDCAN_RXGFC_ANFS_REJECT |
           (config->filter_count << FDCAN_RXGFC_LSS_POS);
}

static void write_filters(const struct fdcan_config *config)
{
    for (uint32_t offset = 0; offset < FDCAN_RAM_BYTES; offset += 4U) {
        mmio_write(FDCAN1_RAM_BASE + offset, 0); /* after power-up it holds anything */
    }
    for (uint32_t i = 0; i < config->filter_count; i++) {
        mmio_write(filter_address(i), filter_element(&config->filters[i]));
    }
    put(FDCAN_RXGFC, filter_rules(config));
}

static uint32_t bit_timing(uint32_t prescaler)
{
    return ((JUMP_WIDTH - 1U) << FDCAN_NBTP_NSJW_POS) | ((prescaler - 1U) << FDCAN_NBTP_NBRP_POS) |
           ((SEGMENT_1 - 1U) << FDCAN_NBTP_NTSEG1_POS) |
           ((SEGMENT_2 - 1U) << FDCAN_NBTP_NTSEG2_POS);
}

static void write_timing(uint32_t prescaler)
{
    put(FDCAN_CKDIV, 0);
    put(FDCAN_NBTP, bit_timing(prescaler));
    put(FDCAN_TSCC, FDCAN_TSCC_TSS_INTERNAL); /* one count a bit */
}

static void enable_interrupts(void)
{
    put(FDCAN_TXBTIE, ALL_TX_BUFFERS);
    put(FDCAN_TXBCIE, ALL_TX_BUFFERS);
    put(FDCAN_IR, FDCAN_IR_ALL);
    put(FDCAN_IE, FDCAN_INTERRUPTS);
    put(FDCAN_ILS, 0); /* all on line 0 */
    put(FDCAN_ILE, FDCAN_ILE_EINT0);
}

/* Reads back what was written while the registers were open. */
static uint32_t first_lost(const struct fdcan_config *config, uint32_t prescaler)
{
    const struct mmio_expected expected[] = {
        {FDCAN1_BASE + FDCAN_CKDIV, 0xFU, 0},
        {FDCAN1_BASE + FDCAN_NBTP, UINT32_MAX, bit_timing(prescaler)},
        {FDCAN1_BASE + FDCAN_TSCC, 3U, FDCAN_TSCC_TSS_INTERNAL},
        {FDCAN1_BASE + FDCAN_RXGFC, UINT32_MAX, filter_rules(config)},
        {FDCAN1_BASE + FDCAN_TXBC, FDCAN_TXBC_TFQM, FDCAN_TXBC_TFQM},
        {FDCAN1_BASE + FDCAN_TXBTIE, ALL_TX_BUFFERS, ALL_TX_BUFFERS},
        {FDCAN1_BASE + FDCAN_TXBCIE, ALL_TX_BUFFERS, ALL_TX_BUFFERS},
        {FDCAN1_BASE + FDCAN_IE, FDCAN_INTERRUPTS, FDCAN_INTERRUPTS},
        {FDCAN1_BASE + FDCAN_ILE, FDCAN_ILE_EINT0, FDCAN_ILE_EINT0},
    };
    uint32_t lost = mmio_first_lost(expected, sizeof expected / sizeof expected[0]);

    for (uint32_t i = 0; i < config->filter_count && lost == 0U; i++) {
        const struct mmio_expected filter = {filter_address(i), UINT32_MAX,
                                             filter_element(&config->filters[i])};
        lost = mmio_first_lost(&filter, 1);
    }
    return lost;
}

enum fdcan_result fdcan_init(struct fdcan *can, const struct fdcan_config *config)
{
    const uint32_t bit_clock_hz = (uint32_t)QUANTA * (uint32_t)BUS_BITRATE;
    uint32_t prescaler = config->kernel_clock_hz / bit_clock_hz;

    memset(can, 0, sizeof *can);
    can->config = *config;
    if (prescaler == 0U || prescaler > FDCAN_NBTP_NBRP_MAX ||
        prescaler * bit_clock_hz != config->kernel_clock_hz ||
        config->filter_count > FDCAN_FILTER_MAX) {
        return FDCAN_BAD_CONFIG;
    }
    put(FDCAN_CCCR, FDCAN_CCCR_INIT);
    if (!wait_for_init(true)) {
        return FDCAN_TIMEOUT;
    }
    put(FDCAN_CCCR, FDCAN_CCCR_INIT | FDCAN_CCCR_CCE); /* classic CAN: FDOE and BRSE stay 0 */
    write_timing(prescaler);
    write_filters(config);
    put(FDCAN_TXBC, FDCAN_TXBC_TFQM);
    enable_interrupts();
    can->lost_register = first_lost(config, prescaler);
    if (can->lost_register != 0U) {
        return FDCAN_LOST_WRITE;
    }
    put(FDCAN_CCCR, 0);
    if (!wait_for_init(false)) {
        return FDCAN_TIMEOUT;
    }
    can->started = true;
    return FDCAN_OK;
}

void fdcan_silence(void)
{
    mmio_write(FDCAN1_BASE + FDCAN_CCCR, FDCAN_CCCR_INIT);
}
