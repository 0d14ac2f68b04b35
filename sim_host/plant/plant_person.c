/* Switches, latches and the lever at the feet of a person, recorded or walking by reflexes. */
#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/walk_internal.h"

/* The switches read the true contact, with errors of their own, and are wired to the latches. */
void plant_run_switches(struct plant *plant, bool has_contact)
{
    const double now_s = plant_now_s(plant);
    for (int k = 0; k < SIDE_COUNT; k++) {
        plant->foot[k] = foot_switch_update(&plant->foot_switch[k], plant->person.contact[k],
                                            has_contact, now_s);
        contact_wire_update(&plant->other_foot[side_other((enum side)k)], plant->foot[k], now_s);
    }
}

static enum plant_latch_fault latch_fault(const struct plant *plant, enum side side, double now_s)
{
    if (plant->latch_broken[side] != PLANT_LATCH_WELL) {
        return plant->latch_broken[side];
    }
    return now_s >= plant->config.latch_fault_s ? plant->config.latch_fault : PLANT_LATCH_WELL;
}

/* A latch that opens by itself does so under load: at this share of its stroke. */
static const double OPENS_AT_STROKE_RATIO = 0.02;

/* A person's ankle can extend at any time: its extension opens no latch. */
void plant_run_latch(struct plant *plant, enum side side, double ankle_m, double now_s)
{
    struct sea *sea = &plant->sea[side];
    const enum plant_latch_fault fault = latch_fault(plant, side, now_s);
    if (fault == PLANT_LATCH_OPENS && sea->latch == SEA_LATCH_CLOSED &&
        sea->position_m > OPENS_AT_STROKE_RATIO * sea->params.stroke_max_m) {
        sea->release_pending = true;
        sea->release_time_s = now_s;
    } else if (fault == PLANT_LATCH_STAYS_CLOSED) {
        sea->release_pending = false;
    } else if (sea_may_release(sea) && contact_wire_has_edge(&plant->other_foot[side], now_s)) {
        sea_other_foot_contact(sea, now_s);
    }
    const bool due = sea->release_pending && sea->release_time_s <= now_s;
    if ((due || sea_lets_go(sea)) && sea_release_now(sea)) {
        walk_post(&plant->walk, WALK_EVENT_RELEASE, side, now_s, sea->position_m);
    }
    /* Within the latch's own tolerance: a motor that is back at zero stands on either side of it. */
    if (sea->latch == SEA_LATCH_RELEASED && sea->position_m <= ankle_m + sea->params.reclose_m) {
        sea_lift_off(sea);
        walk_post(&plant->walk, WALK_EVENT_LIFT_OFF, side, now_s, ankle_m);
    }
    /* A slack spring's output stands at its motor, wherever the ankle is. */
    if (fault != PLANT_LATCH_STAYS_OPEN && sea_reclose(sea, 0.0)) {
        walk_post(&plant->walk, WALK_EVENT_RECLOSED, side, now_s, sea->position_m);
    }
}

double plant_ankle_lever_m(const struct plant *plant, enum side side, double ankle_m)
{
    const struct recording_format *format = &plant->config.recording_format;
    const struct recording_ankle *ankle = &format->ankle[side];
    return plant->config.kind != PLANT_WALKER
               ? sea_lever_at_way_m(&ankle->lever_table, ankle->lever_m, ankle_m)
               : 0.0;
}
