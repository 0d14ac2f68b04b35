#include "sim_host/emulator/g474/fdcan_model.h"

#include <stddef.h>
#include <string.h>

#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

/* Offsets, RM0440 section "FDCAN registers". */
enum {
    CCCR = 0x18,
    NBTP = 0x1C,
    TSCC = 0x20,
    TSCV = 0x24,
    ECR = 0x40,
    PSR = 0x44,
    IR = 0x50,
    IE = 0x54,
    ILS = 0x58,
    ILE = 0x5C,
    RXGFC = 0x80,
    RXF0S = 0x90,
    RXF0A = 0x94,
    RXF1S = 0x98,
    RXF1A = 0x9C,
    TXBC = 0xC0,
    TXBRP = 0xC8,
    TXBAR = 0xCC,
    TXBCR = 0xD0,
    TXBTO = 0xD4,
    TXBCF = 0xD8,
    TXBTIE = 0xDC,
    TXBCIE = 0xE0,
    TXEFS = 0xE4,
    TXEFA = 0xE8,
    CKDIV = 0x100
};

enum { INIT = 1, CCE = 2 };

/* Flags of IR by their bit. */
enum {
    RF0N = 0,
    RF0F = 1,
    RF0L = 2,
    TC = 7,
    TCF = 8,
    TFE = 9,
    TEFN = 10,
    TEFF = 11,
    TEFL = 12,
    ELO = 16,
    EP = 17,
    EW = 18,
    BO = 19,
    PEA = 21
};

/* Word addresses in the message RAM, RM0440 figure "Message RAM configuration":
 * 28 standard filters, 8 extended of 2, 3 + 3 receive elements of 18, 3 events of
 * 2, 3 transmit buffers of 18. */
enum {
    WORD_FILTERS = 0,
    WORD_RX = 28 + 16,
    WORD_RX_FIFO = 3 * 18,
    WORD_EVENTS = WORD_RX + 2 * WORD_RX_FIFO,
    WORD_TX = WORD_EVENTS + 3 * 2
};

static void raise_flag(struct fdcan_model *model, int flag)
{
    model->reg[IR / 4] |= 1u << flag;
}

/* ---- Registers --------------------------------------------------------------- */

static bool configurable(const struct fdcan_model *model)
{
    return (model->reg[CCCR / 4] & (INIT | CCE)) == (INIT | CCE);
}

static uint32_t fifo_status(const struct model_fifo *fifo)
{
    return fifo->fill | (fifo->get << 8) | (fifo->put << 16) | ((fifo->fill == 3 ? 1u : 0u) << 24) |
           ((fifo->lost ? 1u : 0u) << 25);
}

static void acknowledge(struct model_fifo *fifo, uint32_t index)
{
    /* The get index moves behind the acknowledged element, freeing all up to it. */
    uint32_t freed = (index + 3 - fifo->get) % 3 + 1;

    if (index >= 3 || freed > fifo->fill) {
        model_misuse("element %u was acknowledged with %u in the FIFO", index, fifo->fill);
        return;
    }
    fifo->get = (index + 1) % 3;
    fifo->fill -= freed;
    fifo->lost = false;
}

static uint32_t error_state_bits(const struct fdcan_model *model)
{
    bool passive = model->tec >= 128 || model->rec >= 128;
    bool warning = model->tec >= 96 || model->rec >= 96;

    return (passive ? 1u << 5 : 0) | (warning ? 1u << 6 : 0) | (model->bus_off ? 1u << 7 : 0);
}

static uint32_t read_init(struct fdcan_model *model)
{
    bool shown = (model->reg[CCCR / 4] & INIT) != 0;

    if (shown != model->init_asked && model->init_delay >= 0) {
        if (model->init_delay == 0) {
            model->reg[CCCR / 4] ^= INIT;
        } else {
            model->init_delay--;
        }
    }
    return model->reg[CCCR / 4];
}

static uint32_t model_read(void *context, uint32_t offset)
{
    struct fdcan_model *model = context;
    uint32_t value;

    switch (offset) {
    case CCCR:
        return read_init(model);
    case TSCV:
        return model->time_bits & 0xFFFF;
    case ECR: /* reading resets the error logging counter */
        value = (model->tec > 255 ? 255 : model->tec) | ((model->rec & 0x7F) << 8) |
                ((model->rec >= 128 ? 1u : 0u) << 15) | (model->logged_errors << 16);
        model->logged_errors = 0;
        return value;
    case PSR: /* reading sets the last error code to "no change" */
        value = model->last_error | error_state_bits(model);
        model->last_error = 7;
        return value;
    case RXF0S:
        return fifo_status(&model->rx[0]);
    case RXF1S:
        return fifo_status(&model->rx[1]);
    case TXEFS:
        return fifo_status(&model->events);
    case TXBRP:
        return model->pending;
    case TXBTO:
        return model->occurred;
    case TXBCF:
        return model->cancelled;
    default:
        return model->reg[offset / 4];
    }
}

static void write_cccr(struct fdcan_model *model, uint32_t value)
{
    bool was_init = (model->reg[CCCR / 4] & INIT) != 0;

    MODEL_CHECK((value & 0x300u) == 0, "FD operation asked for");
    model->init_asked = (value & INIT) != 0;
    if (model->init_asked != was_init && model->init_delay == 0) {
        model->reg[CCCR / 4] ^= INIT;
    }
    if (was_init && (value & INIT) != 0 && (value & CCE) != 0) {
        /* Setting CCE resets the state of FIFOs and transmit requests. */
        model->reg[CCCR / 4] |= CCE;
        memset(model->rx, 0, sizeof model->rx);
        memset(&model->events, 0, sizeof model->events);
        model->pending = model->occurred = model->cancelled = 0;
        model->on_wire = -1;
    }
    if ((value & INIT) == 0) {
        model->reg[CCCR / 4] &= ~(uint32_t)CCE;
        model->recessive_sequences = 0;
    }
}

static void cancel(struct fdcan_model *model, uint32_t bits)
{
    for (int buffer = 0; buffer < 3; buffer++) {
        uint32_t bit = 1u << buffer;
        if ((bits & bit) == 0 || (model->pending & bit) == 0) {
            continue;
        }
        if (model->on_wire == buffer) {
            model->cancelled |= bit; /* finished when the transmission ends */
            continue;
        }
        model->pending &= ~bit;
        model->cancelled |= bit;
        if (model->reg[TXBCIE / 4] & bit) {
            raise_flag(model, TCF);
        }
    }
}

static void model_write(void *context, uint32_t offset, uint32_t value)
{
    struct fdcan_model *model = context;

    switch (offset) {
    case CCCR:
        write_cccr(model, value);
        return;
    case NBTP:
    case TSCC:
    case RXGFC:
    case TXBC:
    case CKDIV:
        if (!configurable(model)) {
            model->protected_writes++;
            return;
        }
        break;
    case IR:
        model->reg[IR / 4] &= ~value;
        return;
    case RXF0A:
        acknowledge(&model->rx[0], value);
        return;
    case RXF1A:
        acknowledge(&model->rx[1], value);
        return;
    case TXEFA:
        acknowledge(&model->events, value);
        return;
    case TXBAR:
        MODEL_CHECK((model->pending & value) == 0, "a buffer in use was requested again");
        if ((model->reg[CCCR / 4] & CCE) == 0) {
            model->pending |= value & 7;
            model->occurred &= ~value;
            model->cancelled &= ~value;
        }
        return;
    case TXBCR:
        cancel(model, value);
        return;
    default:
        break;
    }
    model->reg[offset / 4] = value;
}

static uint32_t ram_read(void *context, uint32_t offset)
{
    return ((struct fdcan_model *)context)->ram[offset / 4];
}

static void ram_write(void *context, uint32_t offset, uint32_t value)
{
    struct fdcan_model *model = context;
    uint32_t word = offset / 4;

    if (word >= WORD_TX) {
        uint32_t buffer = (word - WORD_TX) / 18;
        MODEL_CHECK((model->pending & (1u << buffer)) == 0, "buffer %u changed while requested",
                    buffer);
    } else {
        MODEL_CHECK(word < WORD_RX || configurable(model), "the receive side was overwritten");
    }
    model->ram[word] = value;
}

void fdcan_model_reset(struct fdcan_model *model)
{
    memset(model, 0, offsetof(struct fdcan_model, ram));
    memset(&model->rx, 0, sizeof *model - offsetof(struct fdcan_model, rx));
    model->reg[CCCR / 4] = INIT;
    model->reg[NBTP / 4] = 0x06000A03; /* reset value */
    model->init_asked = true;
    model->on_wire = -1;
    model->last_error = 7;
}

void fdcan_model_init(struct fdcan_model *model)
{
    memset(model->ram, 0xA7, sizeof model->ram);
    fdcan_model_reset(model);
    mmio_model_map(0x40006400, 0x104, model_read, model_write, model);
    mmio_model_map(0x4000A400, 4 * MODEL_RAM_WORDS, ram_read, ram_write, model);
}

/* ---- The bus ------------------------------------------------------------------ */

/* FIFO for a standard identifier: 0, 1, or -1 = rejected. */
static int filter(const struct fdcan_model *model, uint32_t id)
{
    uint32_t gfc = model->reg[RXGFC / 4];
    uint32_t filters = (gfc >> 16) & 0x1F;

    for (uint32_t i = 0; i < filters; i++) {
        uint32_t element = model->ram[WORD_FILTERS + i];
        uint32_t first = (element >> 16) & 0x7FF, second = element & 0x7FF;
        bool match = false;
        switch (element >> 30) {
        case 0: /* range */
            match = id >= first && id <= second;
            break;
        case 1: /* two identifiers */
            match = id == first || id == second;
            break;
        case 2: /* identifier and mask */
            match = (id & second) == (first & second);
            break;
        default:
            break;
        }
        if (match) {
            uint32_t target = (element >> 27) & 7;
            return target == 1 ? 0 : target == 2 ? 1 : -1;
        }
    }
    return ((gfc >> 4) & 3) < 2 ? (int)((gfc >> 4) & 3) : -1;
}

bool fdcan_model_receive(struct fdcan_model *model, const struct model_frame *frame, bool extended,
                         bool remote, uint32_t start_bits)
{
    uint32_t gfc = model->reg[RXGFC / 4];
    int target;
    uint32_t *element;
    struct model_fifo *fifo;

    if ((model->reg[CCCR / 4] & INIT) != 0 || model->bus_off) {
        return false;
    }
    if (remote && (gfc & (extended ? 1u : 2u)) != 0) {
        return false;
    }
    target =
        extended ? (((gfc >> 2) & 3) < 2 ? (int)((gfc >> 2) & 3) : -1) : filter(model, frame->id);
    if (target < 0) {
        return false;
    }
    fifo = &model->rx[target];
    if (fifo->fill == 3) {
        fifo->lost = true;
        raise_flag(model, RF0L + 3 * target);
        return false;
    }
    element = &model->ram[WORD_RX + target * WORD_RX_FIFO + (int)fifo->put * 18];
    element[0] = (extended ? frame->id | (1u << 30) : frame->id << 18) | (remote ? 1u << 29 : 0);
    element[1] = (frame->length << 16) | (start_bits & 0xFFFF);
    element[2] = element[3] = 0;
    for (uint32_t i = 0; i < 8; i++) {
        element[2 + i / 4] |= (uint32_t)frame->data[i] << (8 * (i % 4));
    }
    fifo->put = (fifo->put + 1) % 3;
    fifo->fill++;
    raise_flag(model, RF0N + 3 * target);
    if (fifo->fill == 3) {
        raise_flag(model, RF0F + 3 * target);
    }
    if (model->rec > 0) {
        model->rec = model->rec > 127 ? 119 : model->rec - 1;
    }
    return true;
}

bool fdcan_model_begin(struct fdcan_model *model)
{
    uint32_t best_id = UINT32_MAX;

    if ((model->reg[CCCR / 4] & INIT) != 0 || model->bus_off) {
        return false;
    }
    MODEL_CHECK((model->reg[TXBC / 4] & (1u << 24)) != 0, "the buffers are no queue");
    for (int buffer = 0; model->on_wire < 0 && buffer < 3; buffer++) {
        uint32_t id = (model->ram[WORD_TX + buffer * 18] >> 18) & 0x7FF;
        if ((model->pending & (1u << buffer)) != 0 && id < best_id) {
            best_id = id;
        }
    }
    for (int buffer = 2; model->on_wire < 0 && buffer >= 0; buffer--) {
        uint32_t id = (model->ram[WORD_TX + buffer * 18] >> 18) & 0x7FF;
        if ((model->pending & (1u << buffer)) != 0 && id == best_id) {
            best_id = id;
            model->on_wire = buffer; /* among equals the lowest number: the last one found */
            for (int lower = buffer - 1; lower >= 0; lower--) {
                if ((model->pending & (1u << lower)) != 0 &&
                    ((model->ram[WORD_TX + lower * 18] >> 18) & 0x7FF) == best_id) {
                    model->on_wire = lower;
                }
            }
        }
    }
    return model->on_wire >= 0;
}

static void store_event(struct fdcan_model *model, const uint32_t *element)
{
    struct model_fifo *fifo = &model->events;
    uint32_t *event = &model->ram[WORD_EVENTS + (int)fifo->put * 2];

    if (fifo->fill == 3) {
        fifo->lost = true;
        raise_flag(model, TEFL);
        return;
    }
    event[0] = element[0];
    event[1] = (element[1] & 0xFF0F0000u) | (1u << 22) | (model->time_bits & 0xFFFF);
    fifo->put = (fifo->put + 1) % 3;
    fifo->fill++;
    raise_flag(model, TEFN);
    if (fifo->fill == 3) {
        raise_flag(model, TEFF);
    }
}

void fdcan_model_end_good(struct fdcan_model *model)
{
    int buffer = model->on_wire;
    uint32_t bit = 1u << buffer;
    const uint32_t *element = &model->ram[WORD_TX + buffer * 18];
    struct model_frame *frame = &model->sent[model->sent_count++ % 256];

    MODEL_CHECK(buffer >= 0, "nothing is on the wire");
    model->on_wire = -1;
    model->pending &= ~bit;
    model->occurred |= bit;
    if (model->reg[TXBTIE / 4] & bit) {
        raise_flag(model, TC);
    }
    if ((model->cancelled & bit) != 0 && (model->reg[TXBCIE / 4] & bit)) {
        raise_flag(model, TCF);
    }
    if (model->pending == 0) {
        raise_flag(model, TFE);
    }
    MODEL_CHECK((element[0] >> 29) == 0, "not a standard data frame");
    frame->id = (element[0] >> 18) & 0x7FF;
    frame->length = (element[1] >> 16) & 0xF;
    for (int i = 0; i < 8; i++) {
        frame->data[i] = (uint8_t)(element[2 + i / 4] >> (8 * (i % 4)));
    }
    if (element[1] & (1u << 23)) {
        store_event(model, element);
    }
    if (model->tec > 0) {
        model->tec--;
    }
}

/* An error counter rose: flags for what changed. */
static void after_error(struct fdcan_model *model, uint32_t before, uint32_t code)
{
    uint32_t after;

    model->last_error = code;
    if (model->logged_errors < 255) {
        model->logged_errors++;
    } else {
        raise_flag(model, ELO);
    }
    raise_flag(model, PEA);
    if (model->tec >= 256) {
        model->bus_off = true;
        model->reg[CCCR / 4] |= INIT;
        model->init_asked = true;
        model->on_wire = -1;
    }
    after = error_state_bits(model);
    if ((before ^ after) & (1u << 5)) {
        raise_flag(model, EP);
    }
    if ((before ^ after) & (1u << 6)) {
        raise_flag(model, EW);
    }
    if ((before ^ after) & (1u << 7)) {
        raise_flag(model, BO);
    }
}

void fdcan_model_end_disturbed(struct fdcan_model *model)
{
    uint32_t before = error_state_bits(model);
    int buffer = model->on_wire;

    MODEL_CHECK(buffer >= 0, "nothing is on the wire");
    model->on_wire = -1;
    if (model->cancelled & (1u << buffer)) { /* no second attempt */
        model->pending &= ~(1u << buffer);
        if (model->reg[TXBCIE / 4] & (1u << buffer)) {
            raise_flag(model, TCF);
        }
    }
    model->tec += 8;
    after_error(model, before, 5); /* dominant bit not seen */
}

void fdcan_model_receive_error(struct fdcan_model *model)
{
    uint32_t before = error_state_bits(model);

    if (model->rec < 128) {
        model->rec += 1;
    }
    after_error(model, before, 1); /* stuff error */
}

void fdcan_model_recessive(struct fdcan_model *model)
{
    if (!model->bus_off || (model->reg[CCCR / 4] & INIT) != 0) {
        return;
    }
    model->recessive_sequences++;
    if (model->recessive_sequences >= 129) {
        model->bus_off = false;
        model->tec = model->rec = 0;
        raise_flag(model, BO);
        raise_flag(model, EP);
        raise_flag(model, EW);
    }
}

bool fdcan_model_line0(const struct fdcan_model *model)
{
    return (model->reg[IR / 4] & model->reg[IE / 4]) != 0 && (model->reg[ILE / 4] & 1) != 0 &&
           model->reg[ILS / 4] == 0;
}
