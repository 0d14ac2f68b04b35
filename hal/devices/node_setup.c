#include "hal/devices/node_setup.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/devices/setup_steps.h"

#define NS_PER_MS UINT64_C(1000000)

static bool is_drive(const struct node_setup *setup)
{
    return setup->role == NETWORK_DRIVE_LEFT || setup->role == NETWORK_DRIVE_RIGHT;
}

static struct setup_step step_now(const struct node_setup *setup)
{
    const struct setup_place place = {setup->role, setup->node, setup->with_rtr, setup->step};
    return setup_step_at(setup->config, &place);
}

/* Goes past what there is nothing to do about; the steps of a node end. */
static struct setup_step current_step(struct node_setup *setup)
{
    struct setup_step step = step_now(setup);
    while (step.kind == STEP_SKIP) {
        setup->step++;
        step = step_now(setup);
    }
    return step;
}

static uint8_t role_of(const struct node_setup_config *config, uint8_t node)
{
#define NODE_ROLE(name, number, profile) [number] = NETWORK_##name,
    static const uint8_t standard[] = {NODE_TABLE(NODE_ROLE)};
#undef NODE_ROLE
    for (unsigned role = 0; role < NETWORK_NODES; role++) {
        if (node != 0 && config->node[role] == node) {
            return (uint8_t)role;
        }
    }
    return node < sizeof standard ? standard[node] : (uint8_t)NETWORK_LATCH_LEFT;
}

void node_setup_start(struct node_setup *setup, const struct node_setup_config *config,
                      uint8_t node, uint64_t now_ns)
{
    (void)now_ns;
    *setup = (struct node_setup){.config = config, .node = node, .role = role_of(config, node)};
    co_sdo_client_init(&setup->client, node, SETUP_TIMEOUT_MS * NS_PER_MS);
}

bool node_setup_is_waiting(const struct node_setup *setup)
{
    return setup->under_way && co_sdo_client_is_busy(&setup->client);
}

bool node_setup_receive(struct node_setup *setup, const struct can_msg *message, uint64_t now_ns)
{
    return setup->under_way && co_sdo_client_receive(&setup->client, message, now_ns);
}

static enum setup_verdict fail(struct node_setup *setup, enum setup_verdict verdict,
                               const struct setup_step *step, uint32_t found)
{
    setup->failure =
        (struct setup_failure){verdict, setup->node, step->sub, step->index, step->value, found};
    return verdict;
}

static uint32_t value_read(const struct co_sdo_client *client)
{
    uint8_t bytes[4] = {0};
    for (unsigned i = 0; i < client->length && i < sizeof bytes; i++) {
        bytes[i] = client->buffer[i];
    }
    return bytes_get_u32(bytes);
}

/* Shaft turns of the motor per nanometre of spring: gear ratio / feed constant. The feed
 * constant is in nanometres per shaft turn (its unit, 0x60A8, is the maker's). 0 when the
 * drive gives none. */
static float turns_per_nm(const uint32_t *v)
{
    if (v[3] == 0 || v[4] == 0) {
        return 0.0f;
    }
    return ((float)v[2] / (float)v[3]) * ((float)v[5] / (float)v[4]);
}

/* counts per metre = counts per motor turn * motor turns per metre. */
static enum setup_verdict check_scaling(struct node_setup *setup, enum side leg)
{
    const uint32_t *v = setup->scaling;
    const uint32_t expected = setup->config->counts_per_m[leg];
    const struct setup_step step = {STEP_SCALING, 0x6092, 1, 4, expected, SETUP_ALL_BITS};
    const float found = v[1] != 0 ? ((float)v[0] / (float)v[1]) * turns_per_nm(v) * 1.0e9f : 0.0f;
    const float difference = found - (float)expected;
    const float tolerance = 1.0e-4f * (float)expected;
    if (difference <= tolerance && difference >= -tolerance) {
        return SETUP_DONE;
    }
    return fail(setup, SETUP_DIFFERS, &step, found < 4.0e9f ? (uint32_t)found : SETUP_ALL_BITS);
}

/* 0x6076 is the motor's rated torque in mNm (CiA 402-2), and the force is that torque times
 * the motor's angle per metre of spring: what 1000 per mille of 0x6077 mean. Without it
 * every force would be judged by a made-up scale. */
static enum setup_verdict check_rated_force(struct node_setup *setup, enum side leg)
{
    const float turn_rad_per_nm_to_N_per_mNm = 6.28318531f * 1.0e9f * 1.0e-3f;
    const float unit_N = turns_per_nm(setup->scaling) * turn_rad_per_nm_to_N_per_mNm;
    const float told_mNm = (float)setup->config->rated_torque_mNm[leg];
    const float expected_mNm = setup_lacks(setup->config, leg, DEVICE_LACKS_SCALING)
                                   ? told_mNm
                                   : setup->config->rated_force_N[leg] / unit_N;
    const uint32_t found = setup->scaling[SETUP_SCALING_VALUES - 1];
    const float difference = (float)found - expected_mNm;
    const float tolerance = 0.5f + 0.02f * expected_mNm; /* it is whole mNm */
    const struct setup_step step = {STEP_SCALING,  0x6076, 0, 4, (uint32_t)(expected_mNm + 0.5f),
                                    SETUP_ALL_BITS};
    if (expected_mNm == 0.0f || (difference <= tolerance && difference >= -tolerance)) {
        return SETUP_DONE; /* 0: nobody told what it should be */
    }
    return fail(setup, SETUP_DIFFERS, &step, found);
}

/* In counts, so only where a count is what it is believed to be. 0: the drive has no limit. */
static enum setup_verdict check_speed(struct node_setup *setup, enum side leg)
{
    const uint32_t needed = setup->config->speed_needed_counts_s[leg];
    const struct setup_step step = {STEP_SPEED, 0x6080, 0, 4, needed, SETUP_ALL_BITS};
    return setup->speed_found == 0 || setup->speed_found >= needed
               ? SETUP_DONE
               : fail(setup, SETUP_DIFFERS, &step, setup->speed_found);
}

/* What the drive says of itself must be what the settings say of it. */
static enum setup_verdict check_drive(struct node_setup *setup)
{
    const enum side leg = setup_leg(setup->role);
    const bool has_scaling = !setup_lacks(setup->config, leg, DEVICE_LACKS_SCALING);
    enum setup_verdict verdict = has_scaling ? check_scaling(setup, leg) : SETUP_DONE;
    verdict = verdict == SETUP_DONE ? check_speed(setup, leg) : verdict;
    const bool has_force = setup->config->rated_force_N[leg] > 0.0f &&
                           !setup_lacks(setup->config, leg, DEVICE_LACKS_RATED_TORQUE);
    return verdict == SETUP_DONE && has_force ? check_rated_force(setup, leg) : verdict;
}

/* Where a scaling value is kept: 0x608F, 0x6091, 0x6092 with two each, then 0x6076. */
static unsigned scaling_place(const struct setup_step *step)
{
    switch (step->index) {
    case 0x608F:
        return step->sub - 1u;
    case 0x6091:
        return step->sub + 1u;
    case 0x6092:
        return step->sub + 3u;
    default:
        return SETUP_SCALING_VALUES - 1u;
    }
}

/* The transfer of this step is done; compares, and goes on to the next one. */
static enum setup_verdict finish_step(struct node_setup *setup, const struct setup_step *step,
                                      uint64_t now_ns)
{
    if (step->kind == STEP_WRITE && !setup->reading_back) {
        setup->reading_back = true;
        return SETUP_BUSY;
    }
    const uint32_t found = value_read(&setup->client);
    if (step->kind == STEP_SCALING) {
        setup->scaling[scaling_place(step)] = found;
    } else if (step->kind == STEP_SPEED) {
        setup->speed_found = found;
    } else if (step->kind != STEP_TRY) {
        const uint32_t width =
            step->bytes == 4 ? SETUP_ALL_BITS : (UINT32_C(1) << (8 * step->bytes)) - 1;
        const uint32_t mask = step->mask & width;
        if ((found & mask) != (step->value & mask)) {
            if (setup->differs_since_ns == 0) {
                setup->differs_since_ns = now_ns;
            }
            if (step->kind != STEP_EXPECT &&
                now_ns - setup->differs_since_ns < SETUP_SETTLE_MS * NS_PER_MS) {
                return SETUP_BUSY; /* read once more */
            }
            return fail(setup, SETUP_DIFFERS, step, found & mask);
        }
    }
    setup->reading_back = false;
    setup->differs_since_ns = 0;
    setup->step++;
    return SETUP_BUSY;
}

/* A node that knows no PDO without remote requests refuses the value: once more, with them. */
static bool try_with_rtr(struct node_setup *setup, const struct setup_step *step)
{
    const bool refused = step->kind == STEP_WRITE && step->index >= 0x1800 &&
                         step->index < 0x1A00 && step->sub == 1 && !setup->with_rtr;
    setup->with_rtr = setup->with_rtr || refused;
    return refused;
}

static void begin_transfer(struct node_setup *setup, const struct setup_step *step, uint64_t now_ns)
{
    if (step->kind == STEP_TRY || (step->kind == STEP_WRITE && !setup->reading_back)) {
        uint8_t bytes[4];
        bytes_put_u32(bytes, step->value);
        co_sdo_client_write(&setup->client, step->index, step->sub, bytes, step->bytes, now_ns);
    } else {
        co_sdo_client_read(&setup->client, step->index, step->sub, now_ns);
    }
    setup->under_way = true;
}

enum setup_verdict node_setup_poll(struct node_setup *setup, const struct can_bus *bus,
                                   uint64_t now_ns)
{
    if (setup->failure.verdict != SETUP_DONE) {
        return setup->failure.verdict;
    }
    struct setup_step step = current_step(setup);
    if (setup->under_way) {
        const enum co_sdo_result result = co_sdo_client_poll(&setup->client, bus, now_ns);
        if (result == CO_SDO_BUSY) {
            return SETUP_BUSY;
        }
        setup->under_way = false;
        if (result == CO_SDO_ABORTED) {
            const uint32_t code = setup->client.abort_code;
            if (code == CO_ABORT_TIMEOUT && ++setup->timeouts < SETUP_TRIES) {
                begin_transfer(setup, &step, now_ns);
                (void)co_sdo_client_poll(&setup->client, bus, now_ns);
                return SETUP_BUSY;
            }
            if (code != CO_ABORT_TIMEOUT && step.kind == STEP_TRY) {
                setup
                    ->step++; /* there is no such PDO, or it cannot be switched off: then it is off */
                return SETUP_BUSY;
            }
            if (code != CO_ABORT_TIMEOUT && try_with_rtr(setup, &step)) {
                step = current_step(setup);
                begin_transfer(setup, &step, now_ns);
                (void)co_sdo_client_poll(&setup->client, bus, now_ns);
                return SETUP_BUSY;
            }
            return fail(setup, code == CO_ABORT_TIMEOUT ? SETUP_SILENT : SETUP_ABORTED, &step,
                        code);
        }
        setup->timeouts = 0;
        if (finish_step(setup, &step, now_ns) < SETUP_DONE) {
            return setup->failure.verdict;
        }
        step = current_step(setup);
    }
    if (step.kind == STEP_END) {
        return is_drive(setup) ? check_drive(setup) : SETUP_DONE;
    }
    begin_transfer(setup, &step, now_ns);
    (void)co_sdo_client_poll(&setup->client, bus, now_ns);
    return SETUP_BUSY;
}
