#include "sim_host/bus/frame_bits.h"

#include <assert.h>

enum {
    CRC15_POLYNOMIAL = 0x4599,
    HEADER_STANDARD_BITS = 19, /* SOF, 11 id, RTR, IDE, r0, 4 DLC */
    HEADER_EXTENDED_BITS = 39, /* SOF, 11 id, SRR, IDE, 18 id, RTR, r1, r0, 4 DLC */
    CRC_BITS = 15
};

/* Run states: (last bit) * 5 + (run length - 1). A stuff bit is put in when the
 * run reaches five, and starts a run of its own. */
static unsigned run_step(unsigned state, unsigned bit, unsigned *stuffed)
{
    unsigned last = state / 5;
    unsigned run = state % 5 + 1;
    if (run == 5) {
        *stuffed += 1;
        last ^= 1U;
        run = 1;
    }
    if (bit == last) {
        return last * 5 + run; /* run + 1, stored minus one */
    }
    return bit * 5;
}

void frame_bits_init(struct frame_bits *tables)
{
    for (unsigned byte = 0; byte < 256; byte++) {
        unsigned crc = byte << 7;
        for (unsigned i = 0; i < 8; i++) {
            crc <<= 1;
            if ((crc & 0x8000U) != 0) {
                crc ^= (unsigned)CRC15_POLYNOMIAL;
            }
        }
        tables->crc[byte] = (uint16_t)(crc & 0x7FFFU);
        for (unsigned start = 0; start < FRAME_BITS_RUN_STATES; start++) {
            unsigned state = start;
            unsigned stuffed = 0;
            for (unsigned i = 0; i < 8; i++) {
                state = run_step(state, (byte >> (7 - i)) & 1U, &stuffed);
            }
            tables->next_state[start][byte] = (uint8_t)state;
            tables->stuffed[start][byte] = (uint8_t)stuffed;
        }
    }
}

/* The unstuffed header, right-aligned, SOF first. */
static uint64_t header_of(const struct can_msg *message, unsigned *bits)
{
    const uint64_t remote = (message->flags & CAN_FRAME_REMOTE) != 0 ? 1 : 0;
    if ((message->flags & CAN_FRAME_EXTENDED) != 0) {
        const uint64_t base = (message->id >> 18) & 0x7FFU;
        const uint64_t rest = message->id & 0x3FFFFU;
        *bits = HEADER_EXTENDED_BITS;
        return base << 27 | UINT64_C(3) << 25 | rest << 7 | remote << 6 | message->length;
    }
    *bits = HEADER_STANDARD_BITS;
    return (uint64_t)(message->id & 0x7FFU) << 7 | remote << 6 | message->length;
}

static unsigned payload_of(const struct can_msg *message)
{
    assert(message->length <= CAN_FRAME_DATA_MAX);
    return (message->flags & CAN_FRAME_REMOTE) != 0 ? 0 : message->length;
}

static unsigned crc_of(const struct frame_bits *tables, uint64_t header, unsigned header_bytes,
                       const uint8_t *data, unsigned length)
{
    /* The register starts at 0, so leading zero bits do not change it. */
    unsigned crc = 0;
    for (unsigned i = header_bytes; i-- > 0;) {
        const unsigned byte = (unsigned)(header >> (8 * i)) & 0xFFU;
        crc = ((crc << 8) & 0x7FFFU) ^ tables->crc[((crc >> 7) ^ byte) & 0xFFU];
    }
    for (unsigned i = 0; i < length; i++) {
        crc = ((crc << 8) & 0x7FFFU) ^ tables->crc[((crc >> 7) ^ data[i]) & 0xFFU];
    }
    return crc;
}

uint16_t frame_bits_crc15(const struct frame_bits *tables, const struct can_msg *message)
{
    unsigned header_bits;
    const uint64_t header = header_of(message, &header_bits);
    return (uint16_t)crc_of(tables, header, (header_bits + 7) / 8, message->data,
                            payload_of(message));
}

unsigned frame_bits_stuffed(const struct frame_bits *tables, const struct can_msg *message)
{
    unsigned header_bits;
    const uint64_t header = header_of(message, &header_bits);
    const unsigned length = payload_of(message);
    const unsigned crc = crc_of(tables, header, (header_bits + 7) / 8, message->data, length);

    /* The first odd bits singly, then bytes: 34 + 8 n bits in all (54 + 8 n). */
    const unsigned total = header_bits + 8 * length + CRC_BITS;
    const unsigned odd = total % 8;
    unsigned stuffed = 0;
    unsigned state = 0; /* SOF is a 0: run of one */
    for (unsigned i = 1; i < odd; i++) {
        state = run_step(state, (unsigned)(header >> (header_bits - 1 - i)) & 1U, &stuffed);
    }

    /* What is left of the header is not a whole number of bytes: carry the bits
     * that overlap, header bits, data, CRC, most significant first. */
    uint64_t window = header & ((UINT64_C(1) << (header_bits - odd)) - 1);
    unsigned have = header_bits - odd;
    unsigned next = 0;
    for (unsigned left = total - odd; left >= 8; left -= 8) {
        if (have < 8) {
            if (next < length) {
                window = window << 8 | message->data[next++];
                have += 8;
            } else {
                window = window << CRC_BITS | crc;
                have += CRC_BITS;
            }
        }
        const unsigned byte = (unsigned)(window >> (have - 8)) & 0xFFU;
        have -= 8;
        stuffed += tables->stuffed[state][byte];
        state = tables->next_state[state][byte];
    }
    /* Five equal bits at the very end of the CRC are followed by a stuff bit too. */
    if (state % 5 == 4) {
        stuffed += 1;
    }
    return total + stuffed;
}
