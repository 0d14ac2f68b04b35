/* Exceptions with floating-point state on the emulated chip, after the Armv7-M Architecture Reference
 * Manual (DDI 0403E): B1.5.6 (entry), B1.5.7 (frames), B1.5.8 (return), B3.2.21 (FPCCR).
 * Without the engine there is nothing to run, and nothing is tested. */
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/emulator/g474/chip.h"
#include "tests/support/assert_close.h"

enum {
    STACK = 0x20001000,
    EXCEPTION = 16 + 30, /* of nobody whose line is followed */
    FPCA = 4,
    LSPACT = 1,
    EXTENDED_BYTES = 26 * 4, /* R0 to R3, R12, LR, PC, xPSR, S0 to S15, FPSCR, and a word unused */
    BASIC_BYTES = 8 * 4
};
#define MAIN 0x08000200u
#define HANDLER 0x08000220u
#define FPCCR_LAZY 0xC0000000u /* ASPEN, LSPEN: as after a reset */
#define FPCCR_EAGER 0x80000000u
#define RUBBISH 0x5A5A5A5Au

static const char engine[] = "build/venv/lib/python3*/site-packages/unicorn/lib/libunicorn.so.2";
static struct chip *chip;
static char path[] = "/tmp/test_chip_exceptions_XXXXXX";

/* An image of two loops: the program, and a handler that begins with `first`. */
static void start(uint32_t first)
{
    static uint32_t image[512];
    const int file = mkstemp(strcpy(path, "/tmp/test_chip_exceptions_XXXXXX"));

    memset(image, 0xFF, sizeof image);
    image[0] = STACK;
    image[1] = MAIN | 1u;
    image[EXCEPTION] = HANDLER | 1u;
    image[(MAIN & 0xFFFFu) / 4] = 0xE7FEE7FEu; /* b . */
    image[(HANDLER & 0xFFFFu) / 4] = first;
    image[(HANDLER & 0xFFFFu) / 4 + 1] = 0xE7FEE7FEu;
    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(write(file, image, sizeof image), sizeof image);
    ck_assert_int_eq(close(file), 0);
    chip = calloc(1, sizeof *chip);
    ck_assert_ptr_nonnull(chip);
    ck_assert_msg(chip_start(chip, NULL, path, NULL, 0) == 0, "%s", chip->message);
    memset(chip->ram, RUBBISH & 0xFF, CHIP_RAM_BYTES);
    chip->scs.enabled[EXCEPTION] = true;
    for (uint32_t i = 0; i < 4; i++) {
        core_set(&chip->core, (enum core_register)(CORE_R0 + (int)i), 0x100u + i);
    }
    core_set(&chip->core, CORE_R12, 0x112);
    core_set(&chip->core, CORE_LR, 0x08000333);
}

static void stop(void)
{
    chip_free(chip);
    free(chip);
    chip = NULL;
    (void)unlink(path);
}

static void use_float(void)
{
    uint32_t s[16];

    for (uint32_t i = 0; i < 16; i++) {
        s[i] = 0xF0u + i;
    }
    core_set_float(&chip->core, s);
    core_set(&chip->core, CORE_FPSCR, 0x03000000);
    core_set(&chip->core, CORE_CONTROL, core_get(&chip->core, CORE_CONTROL) | FPCA);
    ck_assert_uint_eq(core_get(&chip->core, CORE_CONTROL) & FPCA, FPCA);
}

static uint32_t word(uint32_t address)
{
    return chip_ram_word(chip, address);
}

static void expect_float_at(uint32_t frame)
{
    for (uint32_t i = 0; i < 16; i++) {
        ck_assert_uint_eq(word(frame + 32 + 4 * i), 0xF0u + i);
    }
    ck_assert_uint_eq(word(frame + 96), 0x03000000);
}

static void expect_no_float_at(uint32_t frame)
{
    for (uint32_t i = 0; i < 18; i++) {
        ck_assert_uint_eq(word(frame + 32 + 4 * i), RUBBISH);
    }
}

static void expect_basic_at(uint32_t frame, uint32_t padded)
{
    static const uint32_t saved[] = {0x100, 0x101, 0x102, 0x103, 0x112, 0x08000333, MAIN};

    for (uint32_t i = 0; i < 7; i++) {
        ck_assert_uint_eq(word(frame + 4 * i), saved[i]);
    }
    ck_assert_uint_eq(word(frame + 28), 0x01000000u | padded << 9);
}

/* Where the stack ends (8 bytes aligned or not), and what is on it then. */
static const struct {
    uint32_t stack, frame, padded;
} alignments[] = {{STACK, STACK - EXTENDED_BYTES, 0}, {STACK - 4, STACK - 8 - EXTENDED_BYTES, 1}};

START_TEST(a_frame_with_float_has_26_words_and_is_aligned)
{
    start(0xE7FEE7FEu);
    chip->scs.ccr = 0; /* such a frame is aligned whatever CCR.STKALIGN says */
    chip->scs.fpccr = FPCCR_EAGER;
    core_set(&chip->core, CORE_MSP, alignments[_i].stack);
    use_float();
    ck_assert_uint_eq(chip_enter(chip, EXCEPTION, MAIN), HANDLER);
    ck_assert_uint_eq(core_get(&chip->core, CORE_MSP), alignments[_i].frame);
    expect_basic_at(alignments[_i].frame, alignments[_i].padded);
    expect_float_at(alignments[_i].frame);
    ck_assert_uint_eq(core_get(&chip->core, CORE_LR), 0xFFFFFFE9u); /* to the thread, main stack */
    ck_assert_uint_eq(core_get(&chip->core, CORE_CONTROL) & FPCA, 0);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, 0);

    const uint32_t others[16] = {0};
    core_set_float(&chip->core, others);
    ck_assert_uint_eq(chip_leave(chip, 0xFFFFFFE9u), MAIN);
    ck_assert_uint_eq(core_get(&chip->core, CORE_MSP), alignments[_i].stack);
    ck_assert_uint_eq(core_get(&chip->core, CORE_CONTROL) & FPCA, FPCA);
    uint32_t s[16];
    core_get_float(&chip->core, s);
    for (uint32_t i = 0; i < 16; i++) {
        ck_assert_uint_eq(s[i], 0xF0u + i);
    }
    stop();
}
END_TEST

START_TEST(without_float_there_are_8_words)
{
    start(0xE7FEE7FEu);
    (void)chip_enter(chip, EXCEPTION, MAIN);
    ck_assert_uint_eq(core_get(&chip->core, CORE_MSP), STACK - BASIC_BYTES);
    expect_basic_at(STACK - BASIC_BYTES, 0);
    ck_assert_uint_eq(core_get(&chip->core, CORE_LR), 0xFFFFFFF9u);
    ck_assert_uint_eq(chip->scs.fpccr, FPCCR_LAZY);
    stop();
}
END_TEST

START_TEST(the_process_stack_and_a_handler_have_their_own_returns)
{
    start(0xE7FEE7FEu);
    core_set(&chip->core, CORE_PSP, 0x20002000);
    core_set(&chip->core, CORE_CONTROL, 2);
    use_float();
    (void)chip_enter(chip, EXCEPTION, MAIN);
    ck_assert_uint_eq(core_get(&chip->core, CORE_LR), 0xFFFFFFEDu);
    ck_assert_uint_eq(core_get(&chip->core, CORE_PSP), 0x20002000 - EXTENDED_BYTES);
    ck_assert_uint_eq(chip->scs.fpcar, 0x20002000 - EXTENDED_BYTES + 32);
    ck_assert_uint_eq(chip->scs.fpccr & 8, 8); /* THREAD */
    use_float();                               /* the handler does, too */
    chip_store_float(chip);
    (void)chip_enter(chip, EXCEPTION, HANDLER);
    ck_assert_uint_eq(core_get(&chip->core, CORE_LR), 0xFFFFFFE1u);
    ck_assert_uint_eq(core_get(&chip->core, CORE_MSP), STACK - EXTENDED_BYTES);
    ck_assert_uint_eq(chip->scs.fpccr & 8, 0);
    stop();
}
END_TEST

START_TEST(lazily_nothing_is_stored_for_a_handler_without_float)
{
    start(0xE7FEE7FEu); /* it loops */
    use_float();
    chip_pend(chip, EXCEPTION);
    chip_run(chip, chip_now_ns(chip) + 20000);
    const uint32_t frame = STACK - EXTENDED_BYTES;
    ck_assert_uint_eq(core_get(&chip->core, CORE_MSP), frame); /* the place is reserved */
    expect_basic_at(frame, 0);
    expect_no_float_at(frame);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, LSPACT);
    ck_assert_uint_eq(chip->scs.fpcar, frame + 32);
    ck_assert_uint_eq(chip_leave(chip, 0xFFFFFFE9u), MAIN);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, 0);
    uint32_t s[16];
    core_get_float(&chip->core, s); /* as they were; nothing was fetched from the stack */
    ck_assert_uint_eq(s[15], 0xFF);
    ck_assert_uint_eq(core_get(&chip->core, CORE_CONTROL) & FPCA, FPCA);
    stop();
}
END_TEST

START_TEST(lazily_the_first_float_instruction_stores)
{
    start(0x0A10EE00u); /* vmov s0, r0 */
    use_float();
    chip_pend(chip, EXCEPTION);
    chip_run(chip, chip_now_ns(chip) + 20000);
    const uint32_t frame = STACK - EXTENDED_BYTES;
    expect_float_at(frame);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, 0);
    uint32_t s[16];
    core_get_float(&chip->core, s);
    ck_assert_uint_eq(s[0], 0x100); /* the handler's own */
    ck_assert_uint_eq(core_get(&chip->core, CORE_CONTROL) & FPCA, FPCA);
    (void)chip_leave(chip, 0xFFFFFFE9u);
    core_get_float(&chip->core, s);
    ck_assert_uint_eq(s[0], 0xF0);
    stop();
}
END_TEST

START_TEST(what_is_owed_outlasts_a_nested_handler_without_float)
{
    start(0xE7FEE7FEu);
    use_float();
    (void)chip_enter(chip, EXCEPTION, MAIN);
    (void)chip_enter(chip, EXCEPTION, HANDLER);
    ck_assert_uint_eq(core_get(&chip->core, CORE_LR), 0xFFFFFFF1u); /* basic: FPCA was clear */
    (void)chip_leave(chip, 0xFFFFFFF1u);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, LSPACT);
    (void)chip_leave(chip, 0xFFFFFFE9u);
    ck_assert_uint_eq(chip->scs.fpccr & LSPACT, 0);
    stop();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("chip_exceptions");
    TCase *cases = tcase_create("core");
    glob_t found;
    const bool is_there = glob(engine, 0, NULL, &found) == 0;

    globfree(&found);
    if (getenv("AFO_UNICORN") == NULL && !is_there) {
        printf("the Unicorn engine is not in build/venv (scripts/setup test): not tested\n");
        return 0;
    }
    tcase_add_loop_test(cases, a_frame_with_float_has_26_words_and_is_aligned, 0, 2);
    tcase_add_test(cases, without_float_there_are_8_words);
    tcase_add_test(cases, the_process_stack_and_a_handler_have_their_own_returns);
    tcase_add_test(cases, lazily_nothing_is_stored_for_a_handler_without_float);
    tcase_add_test(cases, lazily_the_first_float_instruction_stores);
    tcase_add_test(cases, what_is_owed_outlasts_a_nested_handler_without_float);
    suite_add_tcase(suite, cases);
    return run_suite(suite);
}
