/* Frame lengths against a second computation, bit by bit on a string, and against
 * the bounds of the architecture (55, 75, 95, 115, 135 bits with intermission). */
#include <check.h>
#include <string.h>

#include "sim_host/bus/frame_bits.h"
#include "tests/support/assert_close.h"

static struct frame_bits tables;

static size_t append(char *bits, size_t at, unsigned long value, unsigned count)
{
    for (unsigned i = count; i-- > 0;) {
        bits[at++] = (value >> i & 1U) != 0 ? '1' : '0';
    }
    return at;
}

/* The CRC as the Bosch specification words it: a shift register per bit. */
static unsigned crc_by_bits(const char *bits, size_t count)
{
    unsigned reg = 0;
    for (size_t i = 0; i < count; i++) {
        const unsigned next = (unsigned)(bits[i] - '0') ^ (reg >> 14 & 1U);
        reg = reg << 1 & 0x7FFFU;
        if (next != 0) {
            reg ^= 0x4599U;
        }
    }
    return reg;
}

static unsigned length_by_bits(const struct can_msg *message, unsigned *crc)
{
    char bits[160];
    size_t n = append(bits, 0, 0, 1);
    const unsigned remote = (message->flags & CAN_FRAME_REMOTE) != 0;
    if ((message->flags & CAN_FRAME_EXTENDED) != 0) {
        n = append(bits, n, message->id >> 18, 11);
        n = append(bits, n, 3, 2);
        n = append(bits, n, message->id & 0x3FFFF, 18);
        n = append(bits, n, remote, 1);
        n = append(bits, n, 0, 2);
    } else {
        n = append(bits, n, message->id, 11);
        n = append(bits, n, remote, 1);
        n = append(bits, n, 0, 2);
    }
    n = append(bits, n, message->length, 4);
    for (unsigned i = 0; !remote && i < message->length; i++) {
        n = append(bits, n, message->data[i], 8);
    }
    *crc = crc_by_bits(bits, n);
    n = append(bits, n, *crc, 15);

    unsigned sent = 0;
    unsigned run = 0;
    char last = '?';
    for (size_t i = 0; i < n; i++) {
        run = bits[i] == last ? run + 1 : 1;
        last = bits[i];
        sent++;
        if (run == 5) {
            sent++;
            last = last == '0' ? '1' : '0';
            run = 1;
        }
    }
    return sent;
}

static unsigned next_random(unsigned *state)
{
    *state = *state * 1664525U + 1013904223U;
    return *state >> 8;
}

START_TEST(lengths_and_crc_agree_with_a_bitwise_computation)
{
    unsigned seed = 12345;
    for (int i = 0; i < 20000; i++) {
        struct can_msg message = {.length = (uint8_t)(next_random(&seed) % 9)};
        if (i % 4 == 1) {
            message.flags |= CAN_FRAME_EXTENDED;
        }
        if (i % 7 == 3) {
            message.flags |= CAN_FRAME_REMOTE;
        }
        message.id = next_random(&seed) * 37U &
                     ((message.flags & CAN_FRAME_EXTENDED) != 0 ? 0x1FFFFFFFU : 0x7FFU);
        for (unsigned b = 0; b < message.length; b++) {
            /* Many long runs, so that stuff bits are many. */
            const unsigned r = next_random(&seed);
            message.data[b] = (uint8_t)(i % 3 == 0 ? 0x00U : i % 3 == 1 ? 0xFFU << (r % 9U) : r);
        }
        unsigned crc;
        const unsigned want = length_by_bits(&message, &crc);
        ck_assert_uint_eq(frame_bits_crc15(&tables, &message), crc);
        ck_assert_uint_eq(frame_bits_stuffed(&tables, &message), want);
    }
}
END_TEST

START_TEST(no_frame_is_longer_than_the_bound_and_patterns_come_near_it)
{
    static const unsigned bound[9] = {55, 65, 75, 85, 95, 105, 115, 125, 135};
    unsigned seed = 1;
    unsigned longest[9] = {0};
    for (int i = 0; i < 200000; i++) {
        struct can_msg message = {.id = next_random(&seed) & 0x7FFU, .length = (uint8_t)(i % 9)};
        const unsigned r = next_random(&seed);
        for (unsigned b = 0; b < message.length; b++) {
            /* 0x78 and 0x87 turn on every fourth bit: a stuff bit each. */
            message.data[b] = (r & 1U) != 0 ? 0x78 : (r & 2U) != 0 ? 0x87 : 0x0F;
        }
        const unsigned bits =
            frame_bits_stuffed(&tables, &message) + FRAME_BITS_TAIL + FRAME_BITS_INTERMISSION;
        ck_assert_uint_le(bits, bound[message.length]);
        longest[message.length] = bits > longest[message.length] ? bits : longest[message.length];
    }
    for (unsigned s = 0; s < 9; s++) {
        ck_assert_uint_ge(longest[s] * 10, bound[s] * 8);
    }
}
END_TEST

int main(void)
{
    frame_bits_init(&tables);
    Suite *suite = suite_create("frame_bits");
    TCase *tcase = tcase_create("all");
    tcase_add_test(tcase, lengths_and_crc_agree_with_a_bitwise_computation);
    tcase_add_test(tcase, no_frame_is_longer_than_the_bound_and_patterns_come_near_it);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
