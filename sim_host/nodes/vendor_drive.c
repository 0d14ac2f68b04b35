#include "sim_host/nodes/vendor_drive.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "hal/devices/sea_drive_mit.h"

#define NS_PER_MS UINT64_C(1000000)

enum {
    ESTIMATE_PERIOD_MS = TICK_PERIOD_US / 1000,
    AXIS_HEARTBEAT_MS = 100,
    MIT_SPECIAL_PREFIX = 7
};

/* ODrive's AXIS_ERROR_WATCHDOG_TIMER_EXPIRED (0.5.x). */
static const uint32_t ERROR_WATCHDOG = UINT32_C(0x800);

int vendor_drive_init(struct vendor_drive *drive, const struct vendor_drive_config *config,
                      struct can_bus bus, uint64_t now_ns)
{
    memset(drive, 0, sizeof *drive);
    const bool known = config->protocol == DEVICE_CANSIMPLE ||
                       (config->protocol == DEVICE_MIT && config->answer_id > 0 &&
                        config->ranges.position_rad > 0.0);
    if (!known || !(config->units_per_m > 0.0) || !(config->stroke_m > 0.0) ||
        config->drive_id == 0 || config->drive_id > 63) {
        return -1;
    }
    drive->config = *config;
    drive->now_ns = now_ns;
    drive->bus = bus;
    return 0;
}

/* ---- common ---------------------------------------------------------------- */

/* Units per metre of compression, with the sign that they have. */
static double signed_units_per_m(const struct vendor_drive *drive)
{
    return drive->config.inverted ? -drive->config.units_per_m : drive->config.units_per_m;
}

static double position_units(const struct vendor_drive *drive)
{
    return drive->config.zero_units + drive->feedback.position_m * signed_units_per_m(drive);
}

void vendor_drive_measure(struct vendor_drive *drive, const struct drive_axis_feedback *feedback)
{
    drive->feedback = *feedback;
}

static void send(struct vendor_drive *drive, const struct can_msg *message)
{
    (void)can_bus_send(&drive->bus, message); /* cyclic: the next one replaces it */
}

static void fed(struct vendor_drive *drive, uint64_t now_ns)
{
    drive->last_command_ns = now_ns;
    drive->commanded = true;
}

static void watch(struct vendor_drive *drive)
{
    const uint64_t limit_ns = drive->config.watchdog_ms * NS_PER_MS;
    if (limit_ns != 0 && drive->commanded && drive->closed_loop &&
        drive->now_ns - drive->last_command_ns > limit_ns) {
        drive->closed_loop = false;
        drive->error = true;
    }
}

/* ---- CANSimple ------------------------------------------------------------- */

static uint32_t cansimple_id(const struct vendor_drive *drive, enum cansimple_command command)
{
    return (uint32_t)drive->config.drive_id << 5 | (uint32_t)command;
}

static void cansimple_receive(struct vendor_drive *drive, const struct can_msg *message,
                              uint64_t now_ns)
{
    if (message->id >> 5 != drive->config.drive_id) {
        return;
    }
    switch (message->id & 0x1Fu) {
    case CANSIMPLE_SET_INPUT_POS:
        if (message->length == 8) {
            drive->input_units = (double)bytes_get_f32(message->data);
            fed(drive, now_ns);
        }
        break;
    case CANSIMPLE_SET_CONTROLLER_MODE:
        drive->position_mode = message->length == 8 &&
                               bytes_get_u32(message->data) == CANSIMPLE_MODE_POSITION &&
                               bytes_get_u32(message->data + 4) == CANSIMPLE_INPUT_PASSTHROUGH;
        break;
    case CANSIMPLE_SET_AXIS_STATE:
        if (message->length >= 4) {
            const uint32_t state = bytes_get_u32(message->data);
            drive->closed_loop =
                state == CANSIMPLE_STATE_CLOSED_LOOP && drive->position_mode && !drive->error;
            fed(drive, now_ns);
        }
        break;
    case CANSIMPLE_ESTOP:
        drive->closed_loop = false;
        drive->error = true;
        break;
    case CANSIMPLE_CLEAR_ERRORS:
        drive->error = false;
        break;
    default:
        break;
    }
}

static void cansimple_process(struct vendor_drive *drive, uint64_t now_ns)
{
    if (now_ns >= drive->next_estimate_ns) {
        struct can_msg estimate = {.id = cansimple_id(drive, CANSIMPLE_ENCODER_ESTIMATES),
                                   .length = 8};
        bytes_put_u32(estimate.data, bytes_of_f32((float)position_units(drive)));
        bytes_put_u32(estimate.data + 4, bytes_of_f32((float)(drive->feedback.velocity_m_per_s *
                                                              signed_units_per_m(drive))));
        send(drive, &estimate);
        drive->next_estimate_ns = (now_ns / NS_PER_MS + ESTIMATE_PERIOD_MS) * NS_PER_MS;
    }
    if (now_ns >= drive->next_heartbeat_ns) {
        struct can_msg heartbeat = {.id = cansimple_id(drive, CANSIMPLE_HEARTBEAT), .length = 8};
        bytes_put_u32(heartbeat.data, drive->error ? ERROR_WATCHDOG : 0);
        heartbeat.data[4] = drive->closed_loop ? CANSIMPLE_STATE_CLOSED_LOOP : CANSIMPLE_STATE_IDLE;
        send(drive, &heartbeat);
        drive->next_heartbeat_ns = (now_ns / NS_PER_MS + AXIS_HEARTBEAT_MS) * NS_PER_MS;
    }
}

/* ---- MIT mode -------------------------------------------------------------- */

static uint32_t field16(double value, double range)
{
    return mit_encode((float)value, (float)range, false, 16);
}

static void mit_answer(struct vendor_drive *drive)
{
    const struct vendor_ranges *ranges = &drive->config.ranges;
    const uint32_t position = field16(position_units(drive), ranges->position_rad);
    const uint32_t velocity =
        mit_encode((float)(drive->feedback.velocity_m_per_s * signed_units_per_m(drive)),
                   (float)ranges->velocity_rad_s, false, 12);
    const uint32_t torque = mit_encode((float)(drive->feedback.force_N / signed_units_per_m(drive)),
                                       (float)ranges->torque_Nm, false, 12);
    const double temperature = drive->feedback.temperature_degC;
    const struct can_msg answer = {
        .id = drive->config.answer_id,
        .length = 8,
        .data = {drive->config.drive_id, (uint8_t)(position >> 8), (uint8_t)(position & 0xFFu),
                 (uint8_t)(velocity >> 4), (uint8_t)((velocity & 0xFu) << 4 | torque >> 8),
                 (uint8_t)(torque & 0xFFu), (uint8_t)(temperature > 0.0 ? temperature : 0.0),
                 drive->error ? 1 : 0}};
    send(drive, &answer);
}

static bool is_special(const struct can_msg *message)
{
    for (unsigned i = 0; i < MIT_SPECIAL_PREFIX; i++) {
        if (message->data[i] != 0xFF) {
            return false;
        }
    }
    return message->data[7] >= MIT_ENTER && message->data[7] <= MIT_ZERO;
}

static void mit_receive(struct vendor_drive *drive, const struct can_msg *message, uint64_t now_ns)
{
    if (message->id != drive->config.drive_id || message->length != 8 || message->flags != 0) {
        return;
    }
    fed(drive, now_ns);
    if (is_special(message)) {
        if (message->data[7] == MIT_ENTER) {
            drive->closed_loop = !drive->error;
            drive->stiffness = 0.0;
        } else if (message->data[7] == MIT_EXIT) {
            drive->closed_loop = false;
            drive->error = false;
        }
    } else {
        const uint32_t field = (uint32_t)message->data[0] << 8 | message->data[1];
        const uint32_t kp = (uint32_t)(message->data[3] & 0x0Fu) << 8 | message->data[4];
        drive->input_units =
            (double)mit_decode(field, (float)drive->config.ranges.position_rad, false, 16);
        drive->stiffness = (double)kp;
    }
    mit_answer(drive);
}

/* ---- both ------------------------------------------------------------------ */

void vendor_drive_receive(struct vendor_drive *drive, const struct can_msg *message,
                          uint64_t now_ns)
{
    drive->now_ns = now_ns;
    if (message->flags == 0) {
        if (drive->config.protocol == DEVICE_MIT) {
            mit_receive(drive, message, now_ns);
        } else {
            cansimple_receive(drive, message, now_ns);
        }
    }
}

void vendor_drive_process(struct vendor_drive *drive, uint64_t now_ns)
{
    drive->now_ns = now_ns;
    if (drive->config.protocol == DEVICE_CANSIMPLE) {
        cansimple_process(drive, now_ns);
    }
}

void vendor_drive_command(struct vendor_drive *drive, struct drive_axis_command *command)
{
    watch(drive);
    const bool loop =
        drive->closed_loop && (drive->config.protocol != DEVICE_MIT || drive->stiffness > 0.0);
    double target_m = (drive->input_units - drive->config.zero_units) / signed_units_per_m(drive);
    target_m = target_m < 0.0 ? 0.0 : target_m;
    target_m = target_m > drive->config.stroke_m ? drive->config.stroke_m : target_m;
    *command = (struct drive_axis_command){
        .powered = loop, .target_m = loop ? target_m : drive->feedback.position_m};
}

void vendor_drive_lose_torque(struct vendor_drive *drive)
{
    drive->error = drive->error || drive->closed_loop;
    drive->closed_loop = false;
}

unsigned vendor_drive_ids(const struct vendor_drive *drive, uint16_t *ids, unsigned count)
{
    if (drive->config.protocol == DEVICE_MIT) {
        ids[count++] = drive->config.drive_id;
        return count;
    }
    ids[count++] = (uint16_t)cansimple_id(drive, CANSIMPLE_SET_INPUT_POS);
    ids[count++] = (uint16_t)cansimple_id(drive, CANSIMPLE_SET_CONTROLLER_MODE);
    ids[count++] = (uint16_t)cansimple_id(drive, CANSIMPLE_SET_AXIS_STATE);
    ids[count++] = (uint16_t)cansimple_id(drive, CANSIMPLE_CLEAR_ERRORS);
    return count;
}
