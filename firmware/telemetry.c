#include "firmware/telemetry.h"

#include <assert.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/canopen/co_device.h"
#include "hal/storage/crash_record.h"

enum { TPDO_STEP = 0, TPDO_STATE = 1 };

#define SPEED_UNITS_PER_RAD_S 10000.0f
#define R0_UNITS_PER_METRE 100000.0f
#define EMERGENCY_STOP_BIT 0x80u
#define WEARER_BIT 0x40u
#define RIGHT_BIT 0x80u
#define FELL_BACK_BIT 0x40u

static_assert(SUPERVISOR_FAULTS <= FELL_BACK_BIT,
              "a fault's number fits beside the bits of a step");

void telemetry_default_pdos(struct co_comm *comm)
{
    comm->tpdo[TPDO_STEP].cob_id = FRAME_TELEMETRY;
    comm->tpdo[TPDO_STEP].map[0] = UINT32_C(0x20020110);
    comm->tpdo[TPDO_STEP].map[1] = UINT32_C(0x20020210);
    comm->tpdo[TPDO_STEP].map[2] = UINT32_C(0x20020310);
    comm->tpdo[TPDO_STEP].map[3] = UINT32_C(0x20020408);
    comm->tpdo[TPDO_STEP].map[4] = UINT32_C(0x20020508);
    comm->tpdo[TPDO_STEP].map_count = 5;
    comm->tpdo[TPDO_STATE].cob_id = FRAME_CONTROLLER_STATE;
    comm->tpdo[TPDO_STATE].event_ms = (uint16_t)(SLOW_PDO_TICKS * TICK_PERIOD_US / 1000);
    comm->tpdo[TPDO_STATE].map[0] = UINT32_C(0x20010108);
    comm->tpdo[TPDO_STATE].map[1] = UINT32_C(0x20010208);
    comm->tpdo[TPDO_STATE].map[2] = UINT32_C(0x20010320);
    comm->tpdo[TPDO_STATE].map_count = 3;
}

static uint16_t scaled_u16(float value, float units)
{
    return (uint16_t)bytes_saturate_i32(value * units, 0, UINT16_MAX);
}

static void show_step(struct controller_objects *objects, const struct step_record *step)
{
    objects->step_measured = scaled_u16(step->measured_speed_rad_s, SPEED_UNITS_PER_RAD_S);
    objects->step_commanded = scaled_u16(step->commanded_speed_rad_s, SPEED_UNITS_PER_RAD_S);
    objects->step_r0 = scaled_u16(step->r0_m, R0_UNITS_PER_METRE);
    objects->step_number = (uint8_t)(step->number & 0xFFu);
    objects->step_side_fault = (uint8_t)((step->side == SIDE_RIGHT ? RIGHT_BIT : 0u) |
                                         (step->used_fallback ? FELL_BACK_BIT : 0u) |
                                         (objects->fault & (FELL_BACK_BIT - 1u)));
    objects->record_number = step->number;
    objects->record_measured_rad_s = step->measured_speed_rad_s;
    objects->record_commanded_rad_s = step->commanded_speed_rad_s;
    objects->record_r0_m = step->r0_m;
}

static void report_fault(struct co_device *device, const struct controller_objects *objects,
                         uint8_t before)
{
    const bool written = objects->fault == (uint8_t)SUPERVISOR_FAULT_NODE_WRITTEN;
    const uint8_t vendor[5] = {objects->state, objects->fault, written ? objects->tool_node : 0,
                               written ? (uint8_t)(objects->tool_index & 0xFFu) : 0,
                               written ? (uint8_t)(objects->tool_index >> 8) : 0};
    if (objects->fault != 0) {
        co_device_raise_for(device, CONTROLLER_EMCY_FAULT, objects->fault, CO_ERROR_GENERIC,
                            vendor);
    }
    co_device_clear_for(device, CONTROLLER_EMCY_FAULT, before);
}

void telemetry_init(struct telemetry *telemetry)
{
    telemetry->sent_state = UINT8_MAX; /* whatever the state is: tell it at the first tick */
    telemetry->sent_fault = 0;
}

void telemetry_update(struct telemetry *telemetry, struct controller_objects *objects,
                      struct co_device *device, const struct controller *controller,
                      const struct controller_output *output, bool emergency_stop)
{
    objects->state =
        (uint8_t)((emergency_stop ? EMERGENCY_STOP_BIT : 0u) |
                  (objects->wearer_pin != 0 ? WEARER_BIT : 0u) | ((unsigned)output->state & 0x3Fu));
    objects->fault = (uint8_t)((unsigned)output->fault & 0x7Fu);
    if (objects->state != telemetry->sent_state || objects->fault != telemetry->sent_fault) {
        if (objects->fault != telemetry->sent_fault) {
            report_fault(device, objects, telemetry->sent_fault);
        }
        objects->misplaced = controller->observer.state.misplaced;
        telemetry->sent_state = objects->state;
        telemetry->sent_fault = objects->fault;
        co_device_trigger_tpdo(device, TPDO_STATE);
    }
    if (output->new_step) {
        show_step(objects, &controller->last_step);
        co_device_trigger_tpdo(device, TPDO_STEP);
    }
    objects->zeroing = (uint8_t)output->zeroing;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        objects->last_push[leg] = controller->springs.watch.leg[leg].last;
    }
}

void telemetry_report_crashes(struct controller_objects *objects, struct co_device *device,
                              uint32_t streak)
{
    const uint8_t shown = streak < UINT8_MAX ? (uint8_t)streak : UINT8_MAX;
    const uint8_t vendor[5] = {shown, 0, 0, 0, 0};

    objects->crash_streak = shown;
    if (streak >= (uint32_t)CRASH_STREAK_LIMIT) {
        co_device_raise(device, CONTROLLER_EMCY_CRASHES, CO_ERROR_GENERIC, vendor);
    }
}

void telemetry_report_refused_node(struct controller_objects *objects, struct co_device *device,
                                   const struct setup_failure *failure)
{
    objects->refused_node = failure->node;
    objects->refused_verdict = (uint8_t)(-(int)failure->verdict);
    objects->refused_index = failure->index;
    objects->refused_sub = failure->sub;
    objects->refused_expected = failure->expected;
    objects->refused_found = failure->found;
    const uint8_t vendor[5] = {failure->node, (uint8_t)(failure->index & 0xFFu),
                               (uint8_t)(failure->index >> 8), failure->sub,
                               objects->refused_verdict};
    co_device_raise_for(device, CONTROLLER_EMCY_SETUP_REFUSED, failure->node, CO_ERROR_GENERIC,
                        vendor);
}

void telemetry_clear_refused_node(struct controller_objects *objects, struct co_device *device,
                                  uint8_t node)
{
    if (objects->refused_node == node) {
        objects->refused_node = 0;
    }
    co_device_clear_for(device, CONTROLLER_EMCY_SETUP_REFUSED, node);
}
