/* The controller's own node, asked over SDO as a tool asks it (CiA 301 clause 7.2.4): what may be
 * written when, with which abort code it is refused, and what is told of faults and zero offsets. */
#include "firmware/controller_node.h"
#include "hal/devices/device_verdict.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "firmware/version.h"

#include "hal/bus/bytes.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum { TOO_HIGH = 0x06090031, TOO_LOW = 0x06090032, VALUE = 0x06090030, DEVICE_STATE = 0x08000022 };
enum { READ_ONLY = 0x06010002 };
enum {
    PARAMS = 0x2010,
    COMMANDS = 0x2000,
    STATE = 0x2001,
    CHANGE = 0x2004,
    UNLOCK = 5,
    CLIENT = 17
};

static struct fake_bus fake;
static struct controller_node node;
static struct controller controller;
static struct controller_output output;
static uint64_t now_ns;

static bool scan_params(void)
{
    params_guard_scan(&node.guard, &node.objects.params, node.objects.params_crc);
    return node.guard.corrupt;
}

static void setup(void)
{
    struct control_params params;
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    fake_bus_init(&fake);
    ck_assert_int_eq(controller_node_init(&node, &params, 0.4f, true, fake_bus_interface(&fake)),
                     0);
    memset(&controller, 0, sizeof controller);
    memset(&output, 0, sizeof output);
    output.state = SUPERVISOR_STANDBY;
    now_ns = 1000000000;
}

static void run(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        now_ns += 1000000;
        controller_node_update(&node, &controller, &output, false, now_ns);
    }
}

/* One request; the answer's bytes. */
static const uint8_t *ask(uint8_t command, uint16_t index, uint8_t sub, uint32_t value)
{
    struct can_msg request = {.id = 0x610, .length = 8, .data = {command}};
    bytes_put_u16(request.data + 1, index);
    request.data[3] = sub;
    bytes_put_u32(request.data + 4, value);
    fake_bus_clear(&fake);
    ck_assert(controller_node_receive(&node, &request, now_ns));
    const struct can_msg *answer = fake_bus_last(&fake, 0x590);
    ck_assert_ptr_nonnull(answer);
    return answer->data;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The abort code, 0 when it was written. */
static uint32_t write_float(uint16_t index, uint8_t sub, float value)
{
    const uint8_t *answer = ask(0x23, index, sub, bits_of(value));
    return answer[0] == 0x60 ? 0 : bytes_get_u32(answer + 4);
}

static uint32_t read_u32(uint16_t index, uint8_t sub)
{
    return bytes_get_u32(ask(0x40, index, sub, 0) + 4);
}

static uint32_t write_key(uint32_t key)
{
    const uint8_t *answer = ask(0x23, COMMANDS, UNLOCK, key);
    return answer[0] == 0x60 ? 0 : bytes_get_u32(answer + 4);
}

static void unlock(void)
{
    ck_assert_uint_eq(write_key(settings_lock_key_of(CLIENT)), 0);
}

static unsigned pulses;

static uint32_t write_mark(uint32_t number)
{
    const uint8_t *answer = ask(0x23, COMMANDS, 7, number);
    return answer[0] == 0x60 ? 0 : bytes_get_u32(answer + 4);
}

static void give(void *context)
{
    pulses += *(unsigned *)context;
}

START_TEST(a_mark_gives_a_pulse_and_is_read_back)
{
    static const struct sync_pulse_ops ops = {give};
    static unsigned one = 1;
    static const struct sync_pulse pulse = {&ops, &one};

    pulses = 0;
    ck_assert_uint_eq(write_mark(41), 0); /* a board without such a line */
    node.rules.sync_pulse = &pulse;
    output.state = SUPERVISOR_WALKING;
    run(3);
    ck_assert_uint_eq(pulses, 0);
    ck_assert_uint_eq(write_mark(42), 0);
    ck_assert_uint_eq(write_mark(42), 0);
    ck_assert_uint_eq(pulses, 2);
    ck_assert_uint_eq(read_u32(COMMANDS, 7), 42);
}
END_TEST

static void unlocked_setup(void)
{
    setup();
    unlock();
}

static bool is_locked(int i)
{
    static const char *const locked[] = {"kp_low_m_s_rad", "kp_high_m_s_rad", "r0_ceiling_m",
                                         "r0_change_ceiling_m"};
    for (size_t k = 0; k < sizeof locked / sizeof locked[0]; k++) {
        if (strcmp(control_param_descriptors[i].name, locked[k]) == 0) {
            return true;
        }
    }
    return false;
}

static float *field(int i)
{
    return (float *)((char *)&node.objects.params + control_param_descriptors[i].offset);
}

/* CRC-32 of ISO-HDLC, bit by bit, over the parameters' floats and their table. */
static uint32_t crc_of_params(void)
{
    const struct control_params *params = &node.objects.params;
    const size_t own = offsetof(struct control_params, table) + sizeof params->table;
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < own + sizeof *params->branch; i++) {
        crc ^= i < own ? ((const uint8_t *)params)[i] : ((const uint8_t *)params->branch)[i - own];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
        }
    }
    return ~crc;
}

/* A parameter's sub-index. */
static uint8_t place_of(const char *name)
{
    int i = 0;
    while (i < CONTROL_PARAM_COUNT && strcmp(control_param_descriptors[i].name, name) != 0) {
        i++;
    }
    ck_assert_int_lt(i, CONTROL_PARAM_COUNT);
    return (uint8_t)(i + 1);
}

/* CiA 301, 7.4.3.1: sub-index 0 of a record or an array tells the highest sub-index that there is. */
START_TEST(each_record_tells_its_highest_sub_index)
{
    unsigned records = 0;
    for (unsigned i = 0; i < CO_DICTIONARIES; i++) {
        const struct co_dictionary *dictionary = &node.device.dictionaries[i];
        for (unsigned at = 0; at + 1 < dictionary->count; at++) {
            const struct co_entry *entry = &dictionary->entries[at];
            unsigned last = at;
            while (last + 1 < dictionary->count && entry[last + 1 - at].index == entry->index) {
                last++;
            }
            /* 0x1003 counts its errors, 0x1600 to 0x1A03 what is mapped. */
            const bool varies = entry->index == 0x1003 ||
                                (entry->index >= 0x1600 && entry->index <= 0x17FF) ||
                                (entry->index >= 0x1A00 && entry->index <= 0x1BFF);
            if (entry->sub == 0 && last > at && !varies) {
                ck_assert_msg(ask(0x40, entry->index, 0, 0)[4] == entry[last - at].sub,
                              "%04X: %u, not %u", entry->index, ask(0x40, entry->index, 0, 0)[4],
                              entry[last - at].sub);
                records++;
            }
        }
    }
    ck_assert_uint_gt(records, 15);
}
END_TEST

START_TEST(each_parameter_is_held_to_its_range)
{
    const struct control_param_descriptor *d = &control_param_descriptors[_i];
    const uint8_t sub = (uint8_t)(_i + 1);
    const float before = *field(_i);
    if (is_locked(_i)) {
        ck_assert_uint_eq(write_float(PARAMS, sub, before), READ_ONLY);
        return;
    }
    ck_assert_uint_eq(write_float(PARAMS, sub, nextafterf(d->maximum, INFINITY)), TOO_HIGH);
    ck_assert_uint_eq(write_float(PARAMS, sub, nextafterf(d->minimum, -INFINITY)), TOO_LOW);
    ck_assert_uint_eq(write_float(PARAMS, sub, NAN), VALUE);
    ck_assert_uint_eq(write_float(PARAMS, sub, INFINITY), VALUE);
    ck_assert(*field(_i) == before);
    ck_assert_uint_eq(write_float(PARAMS, sub, before), 0);
}
END_TEST

/* While a spring may be loaded the law may be tuned, the body not. */
START_TEST(with_power_on_only_the_law_may_change)
{
    static const char *const live[] = {"kp_m_s_rad", "speed_ramp_rad_s", "r0_min_m", "r0_max_m",
                                       "r0_change_max_m"};
    bool is_live = false;
    if (is_locked(_i)) {
        return;
    }
    for (size_t i = 0; i < sizeof live / sizeof live[0]; i++) {
        is_live = is_live || strcmp(control_param_descriptors[_i].name, live[i]) == 0;
    }
    output.state = SUPERVISOR_WALKING;
    run(1);
    ck_assert_uint_eq(write_float(PARAMS, (uint8_t)(_i + 1), *field(_i)),
                      is_live ? 0 : DEVICE_STATE);
    output.state = SUPERVISOR_FAULT; /* torque off */
    run(1);
    ck_assert_uint_eq(write_float(PARAMS, (uint8_t)(_i + 1), *field(_i)), 0);
}
END_TEST

START_TEST(a_parameter_that_does_not_fit_the_others_is_refused)
{
    const uint8_t start_r0 = 8; /* its place in the table, as the EDS says */
    ck_assert_str_eq(control_param_descriptors[start_r0 - 1].name, "start_r0_m");
    const float beyond = 1.01f * node.objects.params.r0_max_m;
    ck_assert_uint_eq(write_float(PARAMS, start_r0, beyond), VALUE);
    ck_assert(node.objects.params.start_r0_m < beyond);
    ck_assert_uint_eq(write_float(PARAMS, start_r0, node.objects.params.r0_max_m), 0);
    assert_close(node.objects.params.start_r0_m, node.objects.params.r0_max_m, 0, 1e-7);
}
END_TEST

/* ---- the lock ------------------------------------------------------------------------------- */

START_TEST(parameters_are_locked_until_a_client_says_who_it_is)
{
    const float before = node.objects.params.kp_m_s_rad;
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.04f), DEVICE_STATE);
    ck_assert_uint_eq(write_key(0x12345678), VALUE);
    ck_assert_uint_eq(write_key(SETTINGS_LOCK_KEY), VALUE); /* nobody */
    ck_assert_uint_eq(write_key(settings_lock_key_of(128)), VALUE);
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.04f), DEVICE_STATE);
    ck_assert(node.objects.params.kp_m_s_rad == before);
    ck_assert_uint_eq(ask(0x40, STATE, 7, 0)[4], 0);
    unlock();
    ck_assert_uint_eq(ask(0x40, STATE, 7, 0)[4], CLIENT);
    ck_assert_uint_eq(ask(0x40, STATE, 8, 0)[4], SETTINGS_LOCK_S);
    ck_assert_uint_eq(read_u32(COMMANDS, UNLOCK), 0); /* the key is not told */
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.045f), 0);
    ck_assert(node.objects.params.kp_m_s_rad == 0.045f);
}
END_TEST

START_TEST(the_lock_closes_by_itself_and_when_it_is_told_to)
{
    unlock();
    run(1000 * SETTINGS_LOCK_S - 1);
    ck_assert_uint_eq(ask(0x40, STATE, 8, 0)[4], 1);
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.045f), 0);
    run(1);
    ck_assert_uint_eq(ask(0x40, STATE, 7, 0)[4], 0);
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.041f), DEVICE_STATE);
    unlock();
    ck_assert_uint_eq(write_key(0), 0);
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.041f), DEVICE_STATE);
    unlock();
    ck_assert_uint_eq(write_key(1), VALUE); /* a wrong key closes it, too */
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.041f), DEVICE_STATE);
}
END_TEST

START_TEST(a_change_is_told_with_who_made_it)
{
    const float before = node.objects.params.kp_m_s_rad;
    unlock();
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.045f), 0);
    ck_assert_uint_eq(write_float(PARAMS, 7, 2.0f), TOO_HIGH); /* no change */
    ck_assert_uint_eq(read_u32(CHANGE, 1), 1);
    ck_assert_uint_eq(ask(0x40, CHANGE, 2, 0)[4], CLIENT);
    ck_assert_uint_eq(ask(0x40, CHANGE, 3, 0)[4], 7);
    ck_assert_uint_eq(read_u32(CHANGE, 4), bits_of(before));
    ck_assert_uint_eq(read_u32(CHANGE, 5), bits_of(0.045f));
}
END_TEST

/* kp = 1 gave pushes of 71 J where 12 J were prescribed. */
START_TEST(a_gain_that_the_gait_does_not_bear_is_refused)
{
    const struct control_params *params = &node.objects.params;
    ck_assert(params->kp_low_m_s_rad < 0.042f && params->kp_high_m_s_rad > 0.042f);
    ck_assert_uint_eq(write_float(PARAMS, 7, 1.0f), TOO_HIGH);
    ck_assert_uint_eq(write_float(PARAMS, 7, nextafterf(params->kp_high_m_s_rad, 1.0f)), TOO_HIGH);
    ck_assert_uint_eq(write_float(PARAMS, 7, nextafterf(params->kp_low_m_s_rad, 0.0f)), TOO_LOW);
    ck_assert_uint_eq(write_float(PARAMS, 7, params->kp_high_m_s_rad), 0);
    node.objects.params.kp_low_m_s_rad = node.objects.params.kp_high_m_s_rad = 0.0f;
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.042f), DEVICE_STATE); /* no range was made */
}
END_TEST

START_TEST(limits_stay_below_the_persons_ceilings)
{
    static const char *const limits[] = {"r0_max_m", "r0_change_max_m"};
    for (int i = 0; i < 2; i++) {
        const uint8_t place = place_of(limits[i]);
        const float prescribed = *field(place - 1);
        ck_assert_uint_eq(write_float(PARAMS, place, 1.01f * prescribed), TOO_HIGH);
        ck_assert_uint_eq(write_float(PARAMS, place, 0.9f * prescribed), 0);
        ck_assert_uint_eq(write_float(PARAMS, place, prescribed), 0); /* back to it */
    }
    node.objects.params.r0_ceiling_m = 0.0f; /* none was made: it may be lowered only */
    const uint8_t place = place_of("r0_max_m");
    const float prescribed = *field(place - 1);
    ck_assert_uint_eq(write_float(PARAMS, place, 0.9f * prescribed), 0);
    ck_assert_uint_eq(write_float(PARAMS, place, prescribed), TOO_HIGH);
}
END_TEST

/* The law's parameters move while a spring may be loaded; the checksum goes along. */
START_TEST(under_torque_a_change_comes_by_a_ramp)
{
    const float before = node.objects.params.kp_m_s_rad, after = 0.0405f;
    output.state = SUPERVISOR_WALKING;
    run(1);
    ck_assert_uint_eq(write_float(PARAMS, 7, after), 0);
    const float step = (before - after) / (1000.0f * SETTINGS_RAMP_S);
    float last = node.objects.params.kp_m_s_rad;
    assert_close((double)last, (double)before, 1.1 * (double)step + 1e-8, 0);
    for (int i = 0; i < 1000 * SETTINGS_RAMP_S - 10; i++) {
        run(1);
        const float now = node.objects.params.kp_m_s_rad;
        ck_assert(now <= last && last - now < 1.01f * step + 1e-8f);
        ck_assert(!scan_params());
        last = now;
    }
    run(20);
    ck_assert(node.objects.params.kp_m_s_rad == after);
    ck_assert_uint_eq(read_u32(0x2030, 3), crc_of_params());
    ck_assert_uint_eq(write_float(PARAMS, 7, before), 0);
    run(100);
    ck_assert(node.objects.params.kp_m_s_rad < before);
    output.state = SUPERVISOR_STANDBY; /* nothing is loaded any more: it is there */
    run(1);
    ck_assert(node.objects.params.kp_m_s_rad == before);
    output.state = SUPERVISOR_WALKING;
    run(1);
    ck_assert_uint_eq(write_float(PARAMS, 7, after), 0);
    ck_assert_uint_eq(write_float(PARAMS, place_of("r0_min_m"), 0.02f), 0);
    ck_assert_uint_eq(write_float(PARAMS, place_of("r0_max_m"), 0.2f), DEVICE_STATE); /* a third */
    ck_assert_uint_eq(write_float(PARAMS, 7, before), 0); /* one of the two, elsewhere */
}
END_TEST

START_TEST(the_checksum_is_the_parameters_own)
{
    ck_assert_uint_eq(read_u32(0x2030, 3), crc_of_params());
    const uint32_t before = crc_of_params();
    ck_assert_uint_eq(write_float(PARAMS, 7, 0.05f), 0); /* kp */
    ck_assert_uint_ne(crc_of_params(), before);
    ck_assert_uint_eq(read_u32(0x2030, 3), crc_of_params());
}
END_TEST

/* A value that is written while the check runs is no fault; a bit that flips is. */
START_TEST(writing_is_no_corruption)
{
    const int round = (int)((sizeof(struct control_params) + sizeof(struct gait_branch)) /
                            PARAMS_GUARD_SCAN_BYTES) +
                      2;
    for (int i = 0; i < 3 * round; i++) {
        if (i % 40 == 7) {
            ck_assert_uint_eq(write_float(PARAMS, 7, 0.042f + 1e-4f * (float)(i % 64)), 0);
        }
        ck_assert(!scan_params());
    }
    node.objects.params.kp_m_s_rad = 0.9f; /* not by a write */
    bool corrupt = false;
    for (int i = 0; i < 2 * round; i++) {
        corrupt = scan_params();
    }
    ck_assert(corrupt);
}
END_TEST

/* The highest speed that is taken, found by halving; of two neighbours in between. */
static double highest_speed(void)
{
    float taken = 0.4f, refused = 5.0f;
    ck_assert_uint_eq(write_float(COMMANDS, 1, taken), 0);
    ck_assert_uint_eq(write_float(COMMANDS, 1, refused), TOO_HIGH);
    while (nextafterf(taken, refused) < refused) {
        const float middle = 0.5f * (taken + refused);
        const uint32_t verdict = write_float(COMMANDS, 1, middle);
        ck_assert(verdict == 0 || verdict == TOO_HIGH);
        *(verdict == 0 ? &taken : &refused) = middle;
    }
    return (double)taken;
}

static double gait_speed(double r0_m)
{
    struct subject subject;
    struct gait_point gait;
    subject_default(&subject);
    const struct gait_walker walker = subject_gait_walker(&subject);
    ck_assert_int_eq(gait_curve(&walker, r0_m, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    return -gait.apex[0];
}

/* Whoever needs nearly the largest push-off for the gait alone has none left to catch an excursion:
 * the limit is the gait of 95 % of it, by the model's own fixed points. */
START_TEST(the_speed_asked_for_leaves_push_off_in_reserve)
{
    const float low = node.objects.params.table.speed_rad_s[0];
    output.state = SUPERVISOR_WALKING;
    run(1);
    ck_assert_uint_eq(write_float(COMMANDS, 1, 1.16f), TOO_HIGH);
    ck_assert_uint_eq(write_float(COMMANDS, 1, 0.5f * low), TOO_LOW);
    ck_assert_uint_eq(write_float(COMMANDS, 1, -INFINITY), VALUE);
    ck_assert_uint_eq(write_float(COMMANDS, 1, NAN), VALUE);
    ck_assert(node.objects.desired_speed_rad_s == 0.4f);
    ck_assert_uint_eq(write_float(COMMANDS, 1, 1.14f), 0);
    ck_assert(node.objects.desired_speed_rad_s == 1.14f);
    assert_close(highest_speed(), gait_speed(0.95 * (double)node.objects.params.r0_max_m), 0, 1e-4);
    ck_assert_uint_eq(write_float(PARAMS, place_of("r0_max_m"), 0.2f), 0); /* it follows */
    run(1000 * SETTINGS_RAMP_S);
    assert_close(highest_speed(), gait_speed(0.95 * 0.2), 0, 1e-4);
}
END_TEST

/* A law that knows its gaits by a table serves none beyond it. */
START_TEST(the_speed_asked_for_lies_on_the_laws_branch)
{
    const struct gait_branch *branch = node.objects.params.branch;
    const double last = (double)branch->speed_min_rad_s +
                        (double)branch->speed_step_rad_s * (double)(branch->count - 1);
    ck_assert(highest_speed() > 1.05 * last); /* eq. (16) goes beyond */
    ck_assert_uint_eq(write_float(PARAMS, place_of("law"), (float)LAW_PREDICTIVE), 0);
    assert_close(highest_speed(), last, 0, 3e-7);
}
END_TEST

START_TEST(a_flag_is_0_or_1)
{
    const uint8_t *answer = ask(0x2F, COMMANDS, 2, 2);
    ck_assert_uint_eq(bytes_get_u32(answer + 4), TOO_HIGH);
    ck_assert_uint_eq(ask(0x2F, COMMANDS, 2, 0)[0], 0x60);
    ck_assert_uint_eq(node.objects.walk_requested, 0);
}
END_TEST

/* TPDO1's last byte: bit 7 the side, bit 6 that the predictive law left the step to eq. (16), below them the fault. */
START_TEST(a_steps_last_byte_holds_side_fallback_and_fault)
{
    for (unsigned bits = 0; bits < 4; bits++) {
        controller.last_step = (struct step_record){.number = 7 + bits,
                                                    .side = bits & 1u ? SIDE_RIGHT : SIDE_LEFT,
                                                    .r0_m = 0.05f,
                                                    .used_fallback = (bits & 2u) != 0};
        output.fault = bits == 3 ? SUPERVISOR_FAULT_FOREIGN : SUPERVISOR_FAULT_NONE;
        output.new_step = true;
        run(1);
        output.new_step = false;
        fake_bus_clear(&fake);
        const unsigned wanted = (bits & 1u) << 7 | (bits & 2u) << 5 | (bits == 3 ? 18u : 0u);
        ck_assert_uint_eq(read_u32(0x2002, 5) & 0xFFu, wanted);
    }
}
END_TEST

static const struct can_msg *emergency(void)
{
    return fake_bus_last(&fake, 0x090);
}

/* A latched fault is an emergency (0xFF10, vendor bytes state and fault), its reset the all clear. */
START_TEST(a_fault_and_its_reset_are_told)
{
    run(20);
    fake_bus_clear(&fake);
    output.state = SUPERVISOR_UNLOADING;
    output.fault = SUPERVISOR_FAULT_SPRING;
    run(20);
    ck_assert_ptr_nonnull(emergency());
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0xFF10);
    ck_assert_uint_eq(emergency()->data[3], SUPERVISOR_UNLOADING);
    ck_assert_uint_eq(emergency()->data[4], SUPERVISOR_FAULT_SPRING);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x090), 1);
    output.state = SUPERVISOR_INIT;
    output.fault = SUPERVISOR_FAULT_NONE;
    run(20);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0x0000);
    ck_assert_uint_eq(emergency()->data[2], 0); /* nothing is left in the error register */
}
END_TEST

START_TEST(each_fault_and_each_refused_node_is_told)
{
    struct setup_failure failure = {.verdict = SETUP_DIFFERS, .node = 1, .index = 0x6092};
    telemetry_report_refused_node(&node.objects, &node.device, &failure);
    run(15);
    fake_bus_clear(&fake);
    failure.node = 2;
    telemetry_report_refused_node(&node.objects, &node.device, &failure);
    run(15);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x090), 1);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x090)->data[3], 2);
    telemetry_clear_refused_node(&node.objects, &node.device, 1);
    run(15);
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&fake, 0x090)->data), 0);
    ck_assert_uint_eq(read_u32(0x1001, 0), 1); /* the other is still refused */
    telemetry_clear_refused_node(&node.objects, &node.device, 2);
    ck_assert_uint_eq(read_u32(0x1001, 0), 0);
    output.fault = SUPERVISOR_FAULT_SENSOR_STALE;
    run(15);
    fake_bus_clear(&fake);
    output.fault = SUPERVISOR_FAULT_EMERGENCY_STOP;
    run(15);
    bool told = false;
    for (unsigned i = 0; i < fake.sent_count; i++) {
        told = told || (fake.sent[i].id == 0x090 &&
                        bytes_get_u16(fake.sent[i].data) == CONTROLLER_EMCY_FAULT &&
                        fake.sent[i].data[4] == SUPERVISOR_FAULT_EMERGENCY_STOP);
    }
    ck_assert(told);
    ck_assert_uint_eq(read_u32(0x1001, 0), 1);
}
END_TEST

/* CiA 301 clauses 7.5.2.5 and 7.5.2.6: who sends SYNC has bit 30 of 0x1005 set, and its period in us in
 * 0x1006. Neither can be written: the control loop is its clock. */
START_TEST(it_says_that_it_sends_sync)
{
    ck_assert_uint_eq(read_u32(0x1005, 0), 0x40000080);
    ck_assert_uint_eq(read_u32(0x1006, 0), 1000);
    ck_assert_uint_eq(ask(0x23, 0x1005, 0, 0x80)[0], 0x80);
    ck_assert_uint_eq(ask(0x23, 0x1005, 0, 0x40000081)[0], 0x80);
    ck_assert_uint_eq(ask(0x23, 0x1005, 0, 0x40000080)[0], 0x60);
    ck_assert_uint_eq(ask(0x23, 0x1006, 0, 0)[0], 0x80);
    ck_assert_uint_eq(ask(0x23, 0x1006, 0, 1000)[0], 0x60);
}
END_TEST

/* A text longer than four characters: by segments. */
static void read_text(uint16_t index, uint8_t sub, char text[36])
{
    memset(text, 0, 36);
    (void)ask(0x40, index, sub, 0);
    for (unsigned i = 0, toggle = 0x60; i < 5; i++, toggle ^= 0x10) {
        const uint8_t *segment = ask((uint8_t)toggle, 0, 0, 0);
        memcpy(text + 7 * i, segment + 1, 7);
        if ((segment[0] & 1) != 0) {
            break;
        }
    }
}

START_TEST(it_says_which_hardware_and_software_it_is)
{
    char software[36];
    ck_assert_uint_ne(ask(0x40, 0x1009, 0, 0)[4], 0);
    read_text(0x100A, 0, software);
    ck_assert_str_eq(software, version_text());
    read_text(0x2030, 1, software);
    ck_assert_str_eq(software, version_text());
    ck_assert_uint_eq(read_u32(0x2030, 2), version_build_id());
}
END_TEST

/* CiA 301 clause 7.4.6: sub-index 0 of an array or record is its highest sub-index. */
START_TEST(sub_index_0_is_the_highest_one)
{
    const struct co_dictionary *own = &node.device.dictionaries[2];
    unsigned records = 0;
    for (size_t i = 0; i < own->count; i++) {
        const uint16_t index = own->entries[i].index;
        unsigned highest = 0;
        for (size_t k = 0; k < own->count; k++) {
            if (own->entries[k].index == index && own->entries[k].sub > highest) {
                highest = own->entries[k].sub;
            }
        }
        if (own->entries[i].sub == 0 && highest > 0) {
            records++;
            ck_assert_msg(ask(0x40, index, 0, 0)[4] == highest, "%04X has %u, and says %u", index,
                          highest, ask(0x40, index, 0, 0)[4]);
        }
    }
    ck_assert_uint_ge(records, 15);
}
END_TEST

START_TEST(a_refused_node_is_told_until_it_is_set_up)
{
    const struct setup_failure failure = {SETUP_DIFFERS, 2, 1, 0x6091, 1000, 2000};
    telemetry_report_refused_node(&node.objects, &node.device, &failure);
    run(20);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0x6320);
    ck_assert_uint_eq(emergency()->data[3], 2);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data + 4), 0x6091);
    ck_assert_uint_eq(read_u32(0x2031, 5), 1000);
    ck_assert_uint_eq(read_u32(0x2031, 6), 2000);
    fake_bus_clear(&fake);
    telemetry_clear_refused_node(&node.objects, &node.device, 1); /* another one */
    run(20);
    ck_assert_ptr_null(emergency());
    telemetry_clear_refused_node(&node.objects, &node.device, 2);
    run(20);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0x0000);
    ck_assert_uint_eq(node.objects.refused_node, 0);
}
END_TEST

START_TEST(found_offsets_become_parameters)
{
    controller.zeroing.mean =
        (struct zero_offsets){.angle_rad = {0.011f, -0.012f}, .ankle_m = {0.0013f, -0.0014f}};
    run(1);
    ck_assert(node.objects.params.angle_zero_left_rad == 0.0f);
    output.new_zero = true;
    run(1);
    output.new_zero = false;
    ck_assert(node.objects.params.angle_zero_left_rad == 0.011f);
    ck_assert(node.objects.params.angle_zero_right_rad == -0.012f);
    ck_assert(node.objects.params.ankle_zero_left_m == 0.0013f);
    ck_assert(node.objects.params.ankle_zero_right_m == -0.0014f);
    ck_assert_uint_eq(node.objects.params_crc, crc_of_params());
}
END_TEST

static uint32_t write_u32(uint8_t command, uint16_t index, uint8_t sub, uint32_t value)
{
    const uint8_t *answer = ask(command, index, sub, value);
    return answer[0] == 0x60 ? 0 : bytes_get_u32(answer + 4);
}

/* A node that keeps and records nothing (a host's) says so, and is asked in vain. */
START_TEST(without_a_memory_nothing_is_kept)
{
    ck_assert_uint_eq(read_u32(0x1010, 1), 0);                             /* saves nothing */
    ck_assert_uint_eq(write_u32(0x23, 0x1010, 1, 0x65766173), 0x08000020); /* "save" */
    ck_assert_uint_eq(write_u32(0x23, 0x1011, 1, 0x64616F6C), 0x08000020); /* "load" */
    ck_assert_uint_eq(write_u32(0x2F, 0x2032, 1, 0), DEVICE_STATE);        /* no crash record */
    ck_assert_uint_eq(write_u32(0x2F, 0x2040, 1, 1), DEVICE_STATE);        /* no black box: */
    ck_assert_uint_eq(read_u32(0x2040, 1) & 0xFFu, 0);                     /* no state of it, */
    ck_assert_uint_eq(read_u32(0x2040, 3), DEVICE_STATE);                  /* and no image */
}
END_TEST

/* The task's counters are fetched when they are asked for; a node without a task shows what it was given. */
static void show_41(void *context, uint16_t index)
{
    ck_assert_uint_eq(index, 0x2020);
    ((struct controller_node *)context)->objects.counters.late_answers = 41;
}

START_TEST(counters_are_fetched_when_asked_for)
{
    node.objects.counters.late_answers = 7;
    ck_assert_uint_eq(read_u32(0x2020, 6), 7);
    node.rules.show = show_41;
    node.rules.show_context = &node;
    (void)read_u32(0x2001, 1); /* not by another object */
    ck_assert_uint_eq(node.objects.counters.late_answers, 7);
    ck_assert_uint_eq(read_u32(0x2020, 6), 41);
}
END_TEST

static void note_shown(void *context, uint16_t index)
{
    *(unsigned *)context = index;
}

/* What changes in every tick is brought up to now in the reading: counters, drives, the cue, commissioning. */
START_TEST(what_is_shown_is_of_now)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
        bool shown;
    } objects[] = {{0x2020, 1, true},  {0x2021, 1, true},   {0x2001, 10, true}, {0x2060, 1, true},
                   {0x2062, 1, true},  {0x2001, 1, false},  {0x2001, 9, false}, {0x2022, 1, false},
                   {0x1018, 1, false}, {0x2010, 10, false}, {0x2005, 1, false}};
    unsigned shown = 0;
    node.rules.show = note_shown;
    node.rules.show_context = &shown;
    for (size_t i = 0; i < sizeof objects / sizeof objects[0]; i++) {
        shown = 0;
        (void)ask(0x40, objects[i].index, objects[i].sub, 0);
        ck_assert_msg(shown == (objects[i].shown ? objects[i].index : 0), "%04X:%u: %04X",
                      objects[i].index, objects[i].sub, shown);
    }
}
END_TEST

/* 1 starts the recording, 3 freezes it; that it is closing is its own to say. */
START_TEST(a_black_box_is_started_and_frozen)
{
    static struct black_box box;
    controller_node_attach(&node, NULL, NULL, &box, NULL, NULL);
    ck_assert_uint_eq(write_u32(0x2F, 0x2040, 1, BLACK_BOX_CLOSING), DEVICE_STATE);
    ck_assert(!black_box_is_valid(&box));
    ck_assert_uint_eq(write_u32(0x2F, 0x2040, 1, BLACK_BOX_RECORDING), 0);
    ck_assert(black_box_is_valid(&box));
    ck_assert_uint_eq(read_u32(0x2040, 1) & 0xFFu, BLACK_BOX_RECORDING);
    ck_assert_uint_eq(write_u32(0x2F, 0x2040, 1, BLACK_BOX_FROZEN), 0);
    ck_assert_uint_eq(read_u32(0x2040, 1) & 0xFFu, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(read_u32(0x2040, 3), sizeof box); /* its image's length */
}
END_TEST

/* Nobody else is its master. */
START_TEST(it_obeys_no_nmt_and_no_sync)
{
    const struct can_msg stop = {.id = 0x000, .length = 2, .data = {2, 0}};
    const struct can_msg sync = {.id = 0x080};
    ck_assert(controller_node_receive(&node, &stop, now_ns));
    ck_assert(controller_node_receive(&node, &sync, now_ns));
    ck_assert(co_device_is_operational(&node.device));
}
END_TEST

/* What hangs on the bus is written key by key, held to each key's range, and not while drives may be
 * powered; whether it fits together 0x2053 tells. */
START_TEST(the_device_is_described_over_sdo)
{
    const uint8_t direction = DEVICE_LEG_direction + 1, node_number = DEVICE_LEG_drive_node + 1;
    const uint8_t stroke = DEVICE_LEG_stroke_max_m + 1;
    ck_assert_uint_eq(read_u32(0x2052, 0) & 0xFF, DEVICE_LEG_COUNT);
    ck_assert_uint_eq(read_u32(0x2052, direction), 1);
    ck_assert_uint_eq(write_u32(0x23, 0x2052, direction, (uint32_t)-1), 0);
    ck_assert_int_eq(node.objects.device.leg[SIDE_RIGHT].direction, -1);
    ck_assert_int_eq(node.objects.device.leg[SIDE_LEFT].direction, 1);
    ck_assert_uint_eq(write_u32(0x23, 0x2052, direction, 2), TOO_HIGH);
    ck_assert_uint_eq(write_u32(0x23, 0x2051, node_number, 0), TOO_LOW);
    ck_assert_uint_eq(write_float(0x2051, stroke, NAN), VALUE);
    ck_assert_uint_eq(write_float(0x2051, stroke, 0.2f), 0);
    assert_close(node.objects.device.leg[SIDE_LEFT].stroke_max_m, 0.2, 1e-7, 0.0);
    ck_assert_uint_eq(read_u32(0x2053, 1) & 0xFF, DEVICE_OK);
    ck_assert_uint_eq(write_u32(0x23, 0x2052, node_number, 3), 0); /* the left sensor's number */
    ck_assert_uint_eq(read_u32(0x2053, 1) & 0xFF, DEVICE_BAD_NODE_TAKEN);
    ck_assert_uint_eq(read_u32(0x2053, 2) & 0xFF, SIDE_RIGHT); /* the later one of the two */
    ck_assert_uint_eq(read_u32(0x2053, 3) & 0xFF, node_number);
    node.rules.powered = true;
    ck_assert_uint_ne(write_float(0x2051, stroke, 0.3f), 0);
    assert_close(node.objects.device.leg[SIDE_LEFT].stroke_max_m, 0.2, 1e-7, 0.0);
    ck_assert_uint_eq(read_u32(0x2052, direction), (uint32_t)-1); /* reading goes on */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("controller_node");
    TCase *tests = tcase_create("all");
    TCase *lock = tcase_create("lock");
    tcase_add_checked_fixture(lock, setup, NULL);
    tcase_set_timeout(lock, 20);
    tcase_add_test(lock, each_record_tells_its_highest_sub_index);
    tcase_add_test(lock, parameters_are_locked_until_a_client_says_who_it_is);
    tcase_add_test(lock, the_lock_closes_by_itself_and_when_it_is_told_to);
    tcase_add_test(lock, a_change_is_told_with_who_made_it);
    tcase_add_checked_fixture(tests, unlocked_setup, NULL);
    tcase_add_test(tests, a_gain_that_the_gait_does_not_bear_is_refused);
    tcase_add_test(tests, limits_stay_below_the_persons_ceilings);
    tcase_add_test(tests, under_torque_a_change_comes_by_a_ramp);
    tcase_add_loop_test(tests, each_parameter_is_held_to_its_range, 0, CONTROL_PARAM_COUNT);
    tcase_add_loop_test(tests, with_power_on_only_the_law_may_change, 0, CONTROL_PARAM_COUNT);
    tcase_add_test(tests, a_parameter_that_does_not_fit_the_others_is_refused);
    tcase_add_test(tests, the_checksum_is_the_parameters_own);
    tcase_add_test(tests, writing_is_no_corruption);
    tcase_add_test(tests, the_speed_asked_for_leaves_push_off_in_reserve);
    tcase_add_test(tests, the_speed_asked_for_lies_on_the_laws_branch);
    tcase_add_test(tests, a_flag_is_0_or_1);
    tcase_add_test(tests, a_steps_last_byte_holds_side_fallback_and_fault);
    tcase_add_test(tests, a_fault_and_its_reset_are_told);
    tcase_add_test(tests, each_fault_and_each_refused_node_is_told);
    tcase_add_test(tests, it_says_that_it_sends_sync);
    tcase_add_test(tests, it_says_which_hardware_and_software_it_is);
    tcase_add_test(tests, sub_index_0_is_the_highest_one);
    tcase_add_test(tests, a_refused_node_is_told_until_it_is_set_up);
    tcase_add_test(tests, found_offsets_become_parameters);
    tcase_add_test(tests, without_a_memory_nothing_is_kept);
    tcase_add_test(tests, counters_are_fetched_when_asked_for);
    tcase_add_test(tests, what_is_shown_is_of_now);
    tcase_add_test(tests, a_black_box_is_started_and_frozen);
    tcase_add_test(tests, it_obeys_no_nmt_and_no_sync);
    tcase_add_test(tests, the_device_is_described_over_sdo);
    tcase_add_test(tests, a_mark_gives_a_pulse_and_is_read_back);
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, lock);
    return run_suite(suite);
}
