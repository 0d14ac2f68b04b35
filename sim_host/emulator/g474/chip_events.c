/* What happens by itself: when the next thing is due, what is due by now, and which interrupts wait. */
#include "sim_host/emulator/g474/chip.h"

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

uint64_t chip_next_due_cycle(const struct chip *chip)
{
    uint64_t due_ns = earlier(chip_clocks_due(chip), chip_io_due(chip));

    due_ns = earlier(due_ns, earlier(chip->flash_done_ns, chip->outside_due_ns));
    return earlier(chip_cycle_of(chip, due_ns), chip_systick_due(chip));
}

/* Interrupt lines are levels: pending while up, unless the handler runs. */
static void follow_line(struct chip *chip, unsigned interrupt, bool up)
{
    if (!chip->scs.active[16 + interrupt]) {
        chip->scs.pending[16 + interrupt] = up;
    }
}

void chip_refresh(struct chip *chip)
{
    follow_line(chip, CHIP_IRQ_FDCAN1, fdcan_model_line0(&chip->can));
    follow_line(chip, CHIP_IRQ_PVD, (chip->supply.exti[5] & chip->supply.exti[0]) != 0);
    follow_line(chip, CHIP_IRQ_TIM2, (chip->timer.sr & chip->timer.dier) != 0);
    chip->attention = chip_wants_exception(chip);
    chip->due = chip->attention || chip->stop_asked || chip->reset_asked || chip->dead
                    ? 0
                    : chip_next_due_cycle(chip);
}

void chip_fire(struct chip *chip)
{
    const uint64_t now_ns = chip_now_ns(chip);

    chip_clocks_fire(chip);
    chip_io_fire(chip);
    chip_systick_fire(chip);
    if (now_ns >= chip->flash_done_ns) {
        chip->flash_done_ns = CHIP_NEVER;
        chip->flash_registers.busy = 0;
    }
    if (now_ns >= chip->outside_due_ns) {
        chip->stop_asked = true;
    }
    chip_refresh(chip);
}
