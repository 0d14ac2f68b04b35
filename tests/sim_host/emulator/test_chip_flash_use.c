/* Which starts of the emulated chip are alike: those from flash that agrees in all that was read. */
#include <stdlib.h>
#include <string.h>

#include "sim_host/emulator/g474/chip_flash_use.h"
#include "tests/support/assert_close.h"

#define PAGE_BYTES 2048u
#define SLOT 0x2000u
#define STAGE 0x40000u

static struct chip *chip;
static struct chip_flash_use *use;
static struct chip_starts *starts;

static struct flash_model *flash(void)
{
    return &chip->flash_registers;
}

static void set_up(void)
{
    chip = calloc(1, sizeof *chip);
    use = calloc(1, sizeof *use);
    starts = calloc(1, sizeof *starts);
    ck_assert(chip != NULL && use != NULL && starts != NULL);
    memset(flash()->word, 0xFF, sizeof flash()->word);
    chip->flash_use = use; /* as chip_flash_use_begin, without a core */
    memcpy(use->word, flash()->word, sizeof use->word);
    memcpy(use->state, flash()->state, sizeof use->state);
}

static void tear_down(void)
{
    free(chip);
    free(use);
    free(starts);
}

static void put(uint32_t offset, uint64_t word, uint8_t state)
{
    flash()->word[offset / PAGE_BYTES][offset % PAGE_BYTES / 8] = word;
    flash()->state[offset / PAGE_BYTES][offset % PAGE_BYTES / 8] = state;
}

START_TEST(nothing_is_known_at_first)
{
    ck_assert(!chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(a_word_that_was_read_decides)
{
    chip_flash_use_note(chip, STAGE + 12, 4);
    chip_starts_keep(starts, use);
    ck_assert(chip_starts_know(starts, flash()));
    put(STAGE + 16, 1, WORD_WRITTEN); /* not read */
    ck_assert(chip_starts_know(starts, flash()));
    put(STAGE + 8, UINT64_MAX, WORD_TORN); /* the same bits, and they cannot be trusted */
    ck_assert(!chip_starts_know(starts, flash()));
    put(STAGE + 8, UINT64_MAX - 1, WORD_ERASED);
    ck_assert(!chip_starts_know(starts, flash()));
    put(STAGE + 8, UINT64_MAX, WORD_ERASED);
    ck_assert(chip_starts_know(starts, flash()));
    flash()->optr_stored = 1;
    ck_assert(!chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(an_access_over_two_words_reads_both)
{
    chip_flash_use_note(chip, STAGE + 6, 4);
    chip_starts_keep(starts, use);
    put(STAGE + 8, 0, WORD_WRITTEN);
    ck_assert(!chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(what_is_erased_first_does_not_count)
{
    chip_flash_use_change(chip, SLOT, PAGE_BYTES);
    chip_flash_use_change(chip, SLOT + 8, 8);
    chip_flash_use_note(chip, SLOT, 16);
    chip_starts_keep(starts, use);
    put(SLOT + 8, 5, WORD_TORN);
    ck_assert(chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(what_is_read_before_it_is_erased_counts)
{
    chip_flash_use_note(chip, SLOT, 4);
    chip_flash_use_change(chip, SLOT, PAGE_BYTES);
    chip_starts_keep(starts, use);
    put(SLOT, 5, WORD_TORN);
    ck_assert(!chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(a_word_programmed_without_an_erase_counts)
{
    chip_flash_use_change(chip, STAGE, 8);
    chip_starts_keep(starts, use);
    put(STAGE, 0, WORD_WRITTEN);
    ck_assert(!chip_starts_know(starts, flash()));
}
END_TEST

START_TEST(each_kept_start_is_asked)
{
    chip_flash_use_note(chip, STAGE, 4);
    chip_starts_keep(starts, use);
    put(STAGE, 7, WORD_WRITTEN);
    ck_assert(!chip_starts_know(starts, flash()));
    use->word[STAGE / PAGE_BYTES][0] = 7;
    use->state[STAGE / PAGE_BYTES][0] = WORD_WRITTEN;
    chip_starts_keep(starts, use);
    ck_assert(chip_starts_know(starts, flash()));
    put(STAGE, UINT64_MAX, WORD_ERASED);
    ck_assert(chip_starts_know(starts, flash()));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("chip_flash_use");
    TCase *cases = tcase_create("core");

    tcase_add_checked_fixture(cases, set_up, tear_down);
    tcase_add_test(cases, nothing_is_known_at_first);
    tcase_add_test(cases, a_word_that_was_read_decides);
    tcase_add_test(cases, an_access_over_two_words_reads_both);
    tcase_add_test(cases, what_is_erased_first_does_not_count);
    tcase_add_test(cases, what_is_read_before_it_is_erased_counts);
    tcase_add_test(cases, a_word_programmed_without_an_erase_counts);
    tcase_add_test(cases, each_kept_start_is_asked);
    suite_add_tcase(suite, cases);
    return run_suite(suite);
}
