#include "controller/supervisor/wearer.h"

static uint16_t count_while(uint16_t ticks, bool lasts)
{
    return (uint16_t)(!lasts ? 0 : ticks < UINT16_MAX ? ticks + 1 : ticks);
}

static void pause(struct wearer *wearer)
{
    wearer->paused = true;
    wearer->fade_steps = 0;
}

static void press(struct wearer *wearer, bool fades)
{
    if (wearer->paused) {
        wearer->paused = false;
    } else if (fades && wearer->fade_steps == 0) {
        wearer->fade_steps = WEARER_FADE_STEPS;
        wearer->fade_ticks = 0;
    } else {
        pause(wearer);
    }
}

static void wait_for_steps(struct wearer *wearer, enum supervisor_state state)
{
    if (supervisor_may_assist(state) || wearer->paused) {
        wearer->wait_ticks = 0;
    } else {
        wearer->wait_ticks = count_while(wearer->wait_ticks, state == SUPERVISOR_STANDBY);
    }
    wearer->stopped = wearer->stopped || wearer->wait_ticks >= WEARER_WAIT_TICKS;
}

void wearer_update(struct wearer *wearer, bool pressed, bool requested, enum supervisor_state state,
                   bool fades)
{
    wearer->pressed_ticks = count_while(wearer->pressed_ticks, pressed);
    if (!requested) {
        *wearer = (struct wearer){.pressed_ticks = wearer->pressed_ticks};
        return;
    }
    if (wearer->pressed_ticks == WEARER_PRESS_TICKS) {
        press(wearer, fades);
    }
    if (wearer->pressed_ticks >= WEARER_HOLD_TICKS) {
        wearer->stopped = true;
    }
    wearer->fade_ticks = count_while(wearer->fade_ticks, wearer->fade_steps > 0);
    if (wearer->fade_ticks >= WEARER_FADE_TICKS) {
        pause(wearer);
    }
    wait_for_steps(wearer, state);
}

real wearer_end_step(struct wearer *wearer)
{
    if (wearer->fade_steps == 0) {
        return REAL(1.0);
    }
    const real before = (real)wearer->fade_steps;
    wearer->fade_steps--;
    if (wearer->fade_steps == 0) {
        pause(wearer);
    }
    return (real)wearer->fade_steps / before;
}

bool wearer_allows(const struct wearer *wearer)
{
    return !wearer->paused && !wearer->stopped;
}
