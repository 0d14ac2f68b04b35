/* The march test on a memory with faults: stuck cells, cells that do not rise or fall, cells that
 * change with another, addresses that reach two words or none. */
#include "hal/ram_march.h"

#include <string.h>

#include "tests/support/assert_close.h"

enum { WORDS = 64, BEGIN = 0x20000000 };

enum fault {
    GOOD,
    STUCK_LOW,
    STUCK_HIGH,
    DOES_NOT_RISE,
    DOES_NOT_FALL,
    FOLLOWS_LOWER,  /* inverted when a lower word rises */
    FOLLOWS_HIGHER, /* and when a higher one does */
    SAME_WORD,      /* two addresses, one word */
    NO_WORD         /* an address that reaches nothing */
};

static uint32_t memory[WORDS];
static enum fault fault;
static uint32_t place, bit;

static uint32_t index_of(uint32_t address)
{
    const uint32_t index = (address - BEGIN) / 4;
    ck_assert_uint_lt(index, WORDS);
    ck_assert_uint_eq(address % 4, 0);
    return fault == SAME_WORD && index == place ? (place + 7) % WORDS : index;
}

static uint32_t read_word(uint32_t address)
{
    const uint32_t index = index_of(address), value = memory[index];

    if (index != place) {
        return value;
    }
    return fault == NO_WORD      ? UINT32_MAX
           : fault == STUCK_LOW  ? value & ~bit
           : fault == STUCK_HIGH ? value | bit
                                 : value;
}

static void write_word(uint32_t address, uint32_t value)
{
    const uint32_t index = index_of(address), before = memory[index];
    const uint32_t aggressor =
        fault == FOLLOWS_LOWER ? (place + WORDS - 3) % WORDS : (place + 3) % WORDS;

    if ((fault == FOLLOWS_LOWER || fault == FOLLOWS_HIGHER) && index == aggressor &&
        (~before & value & bit) != 0) {
        memory[place] ^= bit;
    }
    if (index == place && fault == DOES_NOT_RISE) {
        value &= before | ~bit;
    }
    if (index == place && fault == DOES_NOT_FALL) {
        value |= before & bit;
    }
    memory[index] = value;
}

static const struct ram_march_access access = {read_word, write_word};

START_TEST(good_memory_passes_and_is_left_clear)
{
    fault = GOOD;
    memset(memory, 0xA7, sizeof memory);
    ck_assert_uint_eq(ram_march(&access, BEGIN, WORDS), 0);
    for (int i = 0; i < WORDS; i++) {
        ck_assert_uint_eq(memory[i], 0);
    }
}
END_TEST

START_TEST(every_kind_of_fault_is_found_at_every_place)
{
    fault = (enum fault)_i;
    for (place = 0; place < WORDS; place++) {
        for (unsigned b = 0; b < 32; b += 5) {
            bit = 1u << b;
            memset(memory, (int)(place * 37 + b), sizeof memory);
            const uint32_t failed = ram_march(&access, BEGIN, WORDS);
            ck_assert_msg(failed != 0, "fault %d at word %u bit %u", _i, place, b);
            if (fault != SAME_WORD) {
                ck_assert_uint_eq(failed, BEGIN + 4 * place);
            }
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ram_march");
    TCase *tcase = tcase_create("ram_march");

    tcase_add_test(tcase, good_memory_passes_and_is_left_clear);
    tcase_add_loop_test(tcase, every_kind_of_fault_is_found_at_every_place, STUCK_LOW, NO_WORD + 1);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
