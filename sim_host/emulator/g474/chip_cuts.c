#include "sim_host/emulator/g474/chip_cuts.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { EXIT_GOOD_CUT = 0, EXIT_BAD_CUT = 1, EXIT_ALIKE = 2 };

/* Waits until at most `left` copies are under way. */
static void wait_for_copies(struct chip_cuts *cuts, unsigned left)
{
    while (cuts->under_way > left) {
        int status = 0;
        const bool ended = wait(&status) > 0 && WIFEXITED(status);
        const bool alike = ended && WEXITSTATUS(status) == EXIT_ALIKE;
        cuts->ran += alike ? 0 : 1;
        cuts->bad += !alike && (!ended || WEXITSTATUS(status) != EXIT_GOOD_CUT);
        cuts->under_way--;
    }
}

/* Power has failed in a copy: is what comes known? */
static void after_cut(void *context)
{
    struct chip_cuts *cuts = context;

    cuts->chip->on_power_loss = NULL;
    if (chip_starts_know(cuts->starts, &cuts->chip->flash_registers)) {
        _exit(EXIT_ALIKE);
    }
    chip_flash_use_begin(&cuts->use, cuts->chip);
}

/* Before each operation; the copy returns from here and meets its end in the operation. */
static void before_operation(void *context)
{
    struct chip_cuts *cuts = context;
    struct flash_model *flash = &cuts->chip->flash_registers;
    const uint32_t operation = flash->operations - cuts->first;

    if (operation % cuts->every != 0) {
        return;
    }
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    wait_for_copies(cuts, processors > 1 ? (unsigned)processors - 1 : 0);
    fflush(NULL);
    const pid_t copy = fork();
    if (copy == 0) {
        cuts->in_copy = true;
        cuts->chip->on_power_loss = cuts->starts != NULL ? after_cut : NULL;
        cuts->chip->power_context = cuts;
        cuts->at = operation;
        flash->power_fails_at = flash->operations;
        flash->on_operation = NULL;
        return;
    }
    cuts->tried++;
    if (copy < 0) {
        cuts->bad++;
    } else {
        cuts->under_way++;
    }
}

const char *chip_cuts_begin(struct chip_cuts *cuts, struct chip *chip)
{
    struct flash_model *flash = &chip->flash_registers;

    cuts->chip = chip;
    cuts->first = flash->operations;
    cuts->resets = chip->resets;
    if (cuts->every == 0) {
        flash->power_fails_at = cuts->first + cuts->at;
    } else {
        flash->on_operation = before_operation;
        flash->operation_context = cuts;
    }
    if (cuts->every != 0 && cuts->alike) {
        void *const shared = mmap(NULL, sizeof *cuts->starts, PROT_READ | PROT_WRITE,
                                  MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (shared == MAP_FAILED) {
            return "out of memory";
        }
        cuts->starts = shared;
    }
    return NULL;
}

void chip_cuts_finish(struct chip_cuts *cuts)
{
    struct flash_model *flash = &cuts->chip->flash_registers;

    if (!cuts->in_copy) {
        wait_for_copies(cuts, 0);
    }
    flash->on_operation = NULL;
    flash->power_fails_at = UINT32_MAX;
    if (cuts->starts != NULL && !cuts->in_copy) {
        (void)munmap(cuts->starts, sizeof *cuts->starts);
        cuts->starts = NULL;
    }
    cuts->operations = flash->operations - cuts->first;
    cuts->hit = cuts->chip->resets != cuts->resets;
    if (!cuts->hit) {
        chip_power_cycle(cuts->chip);
    }
}

void chip_cuts_end(struct chip_cuts *cuts, const char *trouble)
{
    if (!cuts->in_copy) {
        return;
    }
    if (trouble != NULL) {
        fprintf(stderr, "power cut in operation %u: %s\n", cuts->at, trouble);
    } else if (cuts->starts != NULL) {
        chip_starts_keep(cuts->starts, &cuts->use);
    }
    _exit(trouble != NULL ? EXIT_BAD_CUT : EXIT_GOOD_CUT);
}
