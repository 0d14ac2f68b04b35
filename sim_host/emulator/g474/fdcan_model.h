/* A model of the STM32G474's FDCAN1, written from the description in RM0440 and in
 * Bosch's M_CAN user manual, not from the driver: its numbers are its own.
 *
 * Modelled: init mode and its write protection, the message RAM's layout, standard
 * filters, both receive FIFOs in blocking mode, transmit buffers in queue mode with
 * cancellation, the transmit event FIFO, the time stamp counter, error counters,
 * bus-off and its recovery, interrupt flags, enables and line. */
#ifndef SIM_HOST_EMULATOR_G474_FDCAN_MODEL_H
#define SIM_HOST_EMULATOR_G474_FDCAN_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum { MODEL_RAM_WORDS = 212 };

struct model_fifo {
    uint32_t fill, get, put;
    bool lost;
};

struct model_frame {
    uint32_t id;
    uint32_t length;
    uint8_t data[8];
};

struct fdcan_model {
    uint32_t reg[0x104 / 4]; /* plain values of those that hold their value */
    uint32_t ram[MODEL_RAM_WORDS];
    struct model_fifo rx[2];
    struct model_fifo events;
    uint32_t pending, occurred, cancelled; /* TXBRP, TXBTO, TXBCF */
    int on_wire;                           /* buffer being sent, -1 = none */
    uint32_t time_bits;
    uint32_t tec, rec, logged_errors, last_error;
    bool bus_off;
    uint32_t recessive_sequences; /* seen since INIT was cleared in bus-off */
    int init_delay;               /* reads until a change of INIT shows; -1 = never */
    bool init_asked;
    uint32_t protected_writes; /* refused writes to protected registers */
    struct model_frame sent[256];
    uint32_t sent_count;
};

/* State after a reset, message RAM full of rubbish; mapped at its addresses. */
void fdcan_model_init(struct fdcan_model *model);

/* A reset of the peripheral alone: its RAM keeps what it holds. */
void fdcan_model_reset(struct fdcan_model *model);

/* A frame of another node has ended on the bus; `start_bits` is the time of its
 * start. Returns false when it was filtered out or lost. */
bool fdcan_model_receive(struct fdcan_model *model, const struct model_frame *frame, bool extended,
                         bool remote, uint32_t start_bits);

/* The core puts its most urgent request on the wire; false when there is none. */
bool fdcan_model_begin(struct fdcan_model *model);
/* What is on the wire arrives, or is disturbed and stays requested. */
void fdcan_model_end_good(struct fdcan_model *model);
void fdcan_model_end_disturbed(struct fdcan_model *model);

/* A disturbed frame of somebody else. */
void fdcan_model_receive_error(struct fdcan_model *model);

/* 11 recessive bits, once. */
void fdcan_model_recessive(struct fdcan_model *model);

/* True while interrupt line 0 is raised. */
bool fdcan_model_line0(const struct fdcan_model *model);

#endif
