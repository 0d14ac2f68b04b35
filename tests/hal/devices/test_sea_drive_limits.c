/* Three drive protocols at their limits and in their variants: states by the masks of CiA 402-2, times by the headers,
 * both legs. */
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "hal/devices/sea_drive_cia402.h"
#include "hal/devices/sea_drive_mit.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static struct fake_bus fake;
static struct can_bus bus;
static struct sea_drives drives;
static struct sea_drive_command command[SIDE_COUNT];

static void setup(void)
{
    fake_bus_init(&fake);
    bus = fake_bus_interface(&fake);
    memset(command, 0, sizeof command);
}

static bool give(uint32_t id, uint8_t length, uint64_t data)
{
    struct can_msg frame = {.id = id, .length = length};
    for (int i = 0; i < 8; i++) {
        frame.data[i] = (uint8_t)(data >> (8 * i) & 0xFFu);
    }
    return sea_drives_receive(&drives, &frame);
}

static struct sea_drive_reading read_leg(enum side leg)
{
    struct sea_drive_reading reading;
    sea_drives_read(&drives, leg, &reading);
    return reading;
}

static void send_commands(void)
{
    fake_bus_clear(&fake);
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_OK);
}

static void grow_old(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        sea_drives_age(&drives);
    }
}

/* ---- CiA 402 ------------------------------------------------------------------------------- */

static struct cia402_drives cia402;

static void begin_cia402(const struct cia402_axis_config *left,
                         const struct cia402_axis_config *right)
{
    const struct cia402_axis_config config[SIDE_COUNT] = {*left, *right};
    setup();
    cia402_drives_init(&cia402, config);
    drives = cia402_drives_interface(&cia402);
}

static const struct cia402_axis_config usual = {
    .counts_per_m = 1.0e6f, .direction = 1, .rated_force_N = 50.0f};

static void setup_cia402(void)
{
    begin_cia402(&usual, &usual);
}

static void tell(enum side leg, uint16_t statusword)
{
    ck_assert(give(leg == SIDE_LEFT ? 0x181 : 0x182, 6, statusword));
}

/* The controlword that goes out for a statusword; -1 for none. */
static int answer_to(enum side leg, uint16_t statusword)
{
    tell(leg, statusword);
    cia402.axis[leg].sender.ticks_since_sent = SLOW_PDO_TICKS;
    send_commands();
    const struct can_msg *frame = fake_bus_last(&fake, leg == SIDE_LEFT ? 0x301 : 0x302);
    return frame == NULL ? -1 : frame->data[0] | frame->data[1] << 8;
}

/* CiA 402-2, table of statusword bits: mask, value, state. What matches none is not ready. */
static enum drive_state state_by_masks(unsigned word)
{
    static const struct {
        unsigned mask, value;
        enum drive_state state;
    } rows[] = {{0x4F, 0x40, DRIVE_DISABLED}, {0x6F, 0x21, DRIVE_DISABLED},
                {0x6F, 0x23, DRIVE_STARTING}, {0x6F, 0x27, DRIVE_ENABLED},
                {0x6F, 0x07, DRIVE_STOPPING}, {0x4F, 0x0F, DRIVE_STOPPING},
                {0x4F, 0x08, DRIVE_FAULT}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if ((word & rows[i].mask) == rows[i].value) {
            return rows[i].state;
        }
    }
    return DRIVE_DISABLED;
}

START_TEST(every_statusword_is_read_by_the_standard_s_masks)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned low = 0; low < 256; low++) {
            tell((enum side)leg, (uint16_t)(low | 0x1200u));
            ck_assert_msg(read_leg((enum side)leg).state == state_by_masks(low), "statusword %02x",
                          low);
            ck_assert_int_eq(read_leg((enum side)leg).warning, (low & 0x80u) != 0);
        }
    }
}
END_TEST

/* What is not enabled is told to stay off in its own way; the word that was sent last stands. */
START_TEST(a_drive_that_is_off_is_left_in_peace)
{
    static const struct {
        uint16_t statusword;
        int sent, kept;
    } cases[] = {{0x0221, 0x06, 0x06}, {0x0240, 0x00, 0x00}, {0x0200, 0x00, 0x00}};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
            setup_cia402();
            command[leg].enable = true;
            ck_assert_int_eq(answer_to((enum side)leg, 0x1227), 0x0F);
            command[leg].enable = false;
            ck_assert_int_eq(answer_to((enum side)leg, cases[i].statusword), cases[i].sent);
            ck_assert_int_eq(answer_to((enum side)leg, 0x0240), cases[i].kept);
            ck_assert_int_eq(answer_to((enum side)leg, 0x0221), cases[i].kept);
            ck_assert_int_eq(answer_to((enum side)leg, 0x0200), cases[i].kept);
        }
    }
}
END_TEST

START_TEST(each_state_has_its_controlword)
{
    static const struct {
        bool enable;
        uint16_t statusword;
        int word;
    } cases[] = {{true, 0x0200, 0x06},  {true, 0x0240, 0x06},  {true, 0x0221, 0x07},
                 {true, 0x0223, 0x0F},  {true, 0x1227, 0x0F},  {true, 0x0207, 0x02},
                 {true, 0x020F, 0x06},  {true, 0x0208, 0x00},  {false, 0x0223, 0x06},
                 {false, 0x1227, 0x06}, {false, 0x0207, 0x02}, {false, 0x020F, 0x06},
                 {false, 0x0208, 0x00}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setup_cia402();
        command[SIDE_RIGHT].enable = cases[i].enable;
        const int word = answer_to(SIDE_RIGHT, cases[i].statusword);
        ck_assert_msg(word == cases[i].word, "case %zu: %02x", i, (unsigned)word);
    }
    struct cia402_axis_config interpolated = usual;
    interpolated.interpolated = true; /* bit 4 runs it */
    begin_cia402(&usual, &interpolated);
    command[SIDE_LEFT].enable = command[SIDE_RIGHT].enable = true;
    ck_assert_int_eq(answer_to(SIDE_RIGHT, 0x1227), 0x1F);
    ck_assert_int_eq(answer_to(SIDE_RIGHT, 0x0223), 0x0F);
    ck_assert_int_eq(answer_to(SIDE_LEFT, 0x1227), 0x0F);
}
END_TEST

/* The slow PDO of a drive that lacks some of its values: torque, temperature and voltage close up. */
START_TEST(a_slow_pdo_holds_what_the_drive_has)
{
    for (unsigned lacks = 0; lacks < 8; lacks++) {
        struct cia402_axis_config config = usual;
        config.no_torque = (lacks & 1u) != 0;
        config.no_temperature = (lacks & 2u) != 0;
        config.no_voltage = (lacks & 4u) != 0;
        begin_cia402(&usual, &config);
        uint64_t data = 0;
        unsigned bytes = 0;
        if (!config.no_torque) {
            data |= (uint64_t)(uint16_t)-300; /* per mille of 50 N */
            bytes = 2;
        }
        if (!config.no_temperature) {
            data |= (uint64_t)456 << (8 * bytes);
            bytes += 2;
        }
        if (!config.no_voltage) {
            data |= (uint64_t)23950 << (8 * bytes);
            bytes += 4;
        }
        ck_assert(give(0x382, (uint8_t)(bytes ^ 1u), data)); /* of another length: none */
        ck_assert_uint_eq(cia402.rx_malformed, 1);
        ck_assert(!read_leg(SIDE_RIGHT).has_temperature && !read_leg(SIDE_RIGHT).has_supply);
        ck_assert(give(0x382, (uint8_t)bytes, data));
        const struct sea_drive_reading reading = read_leg(SIDE_RIGHT);
        ck_assert_int_eq(reading.has_temperature, !config.no_temperature);
        ck_assert_int_eq(reading.has_supply, !config.no_voltage);
        ck_assert_uint_eq(reading.force_age_ticks, config.no_torque ? UINT16_MAX : 0);
        assert_close(reading.force_N, config.no_torque ? 0.0 : -15.0, 1e-5, 0.0);
        assert_close(reading.temperature_degC, config.no_temperature ? 0.0 : 45.6, 1e-4, 0.0);
        assert_close(reading.supply_V, config.no_voltage ? 0.0 : 23.95, 1e-4, 0.0);
        ck_assert(!read_leg(SIDE_LEFT).has_supply);
    }
}
END_TEST

/* The latch's bit and that of the other foot's contact are the maker's; unknown before the first word. */
START_TEST(bits_of_latch_and_contact_are_the_maker_s)
{
    struct cia402_axis_config config = usual;
    config.latch_bit = 8;
    config.contact_bit = 11;
    begin_cia402(&config, &usual);
    ck_assert_int_eq(read_leg(SIDE_LEFT).latch, LATCH_UNKNOWN);
    ck_assert_int_eq(read_leg(SIDE_LEFT).contact, FOOT_UNKNOWN);
    ck_assert(!read_leg(SIDE_LEFT).warning);
    tell(SIDE_LEFT, 0x1127);
    ck_assert_int_eq(read_leg(SIDE_LEFT).latch, LATCH_CLOSED);
    ck_assert_int_eq(read_leg(SIDE_LEFT).contact, FOOT_UP);
    tell(SIDE_LEFT, 0x5827); /* bit 14 is nothing here */
    ck_assert_int_eq(read_leg(SIDE_LEFT).latch, LATCH_OPEN);
    ck_assert_int_eq(read_leg(SIDE_LEFT).contact, FOOT_DOWN);
    tell(SIDE_RIGHT, 0x5927);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_CLOSED);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).contact, FOOT_UNKNOWN); /* it has none */
    tell(SIDE_RIGHT, 0x1927);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_OPEN);
    config.no_latch_bit = true;
    begin_cia402(&config, &usual);
    tell(SIDE_LEFT, 0x5927);
    ck_assert_int_eq(read_leg(SIDE_LEFT).latch, LATCH_UNKNOWN);
    grow_old(70000);
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, UINT16_MAX);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert_int_eq(read_leg(SIDE_LEFT).contact, FOOT_UNKNOWN);
}
END_TEST

/* Enabled without bit 12: it ignores its target, where that bit says so. */
START_TEST(a_drive_whose_bit_12_says_nothing_follows)
{
    struct cia402_axis_config config = usual;
    config.no_follows_bit = true;
    begin_cia402(&config, &usual);
    tell(SIDE_LEFT, 0x0227);
    tell(SIDE_RIGHT, 0x0227);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).state, DRIVE_STOPPING);
}
END_TEST

/* A leg without such a drive: its frames are another's, and it is told nothing. */
START_TEST(an_absent_drive_is_not_spoken_with)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct cia402_axis_config here = usual, away = usual;
        here.own_target = true;
        away.absent = true;
        begin_cia402(leg == SIDE_LEFT ? &away : &here, leg == SIDE_LEFT ? &here : &away);
        const uint32_t gone = leg == SIDE_LEFT ? 0x181 : 0x182,
                       other = leg == SIDE_LEFT ? 0x182 : 0x181;
        ck_assert(!give(gone, 6, 0x1227));
        ck_assert(!give(gone + 0x200, 8, 0));
        ck_assert(give(other, 6, 0x1227));
        ck_assert(give(other + 0x200, 8, 0));
        ck_assert_int_eq(read_leg((enum side)leg).state, DRIVE_UNKNOWN);
        command[1 - leg].enable = true;
        command[1 - leg].precompression_m = 0.05f;
        send_commands();
        ck_assert_uint_eq(fake.sent_count, 2); /* one target, one controlword */
        const struct can_msg *target =
            fake_bus_last(&fake, leg == SIDE_LEFT ? FRAME_DRIVE_TARGET_RIGHT : 0x201);
        ck_assert_ptr_nonnull(target);
        ck_assert_uint_eq(target->length, 4);
        ck_assert_uint_eq(target->data[0] | target->data[1] << 8 | target->data[2] << 16, 50000);
        ck_assert_ptr_nonnull(fake_bus_last(&fake, leg == SIDE_LEFT ? 0x302 : 0x301));
    }
}
END_TEST

/* A frame of the controlword without outputs has two bytes; with them six. */
START_TEST(a_drive_without_outputs_gets_a_controlword_alone)
{
    struct cia402_axis_config config = usual;
    config.no_outputs = true;
    begin_cia402(&config, &usual);
    tell(SIDE_LEFT, 0x1227);
    tell(SIDE_RIGHT, 0x1227);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        command[leg] = (struct sea_drive_command){.enable = true, .latch_armed = true};
    }
    send_commands();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x301)->length, 2);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x302)->length, 6);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x302)->data[4], 1);
    send_commands(); /* nothing is new */
    ck_assert_ptr_null(fake_bus_last(&fake, 0x301));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x302));
    command[SIDE_RIGHT].repeat = true; /* but somebody else may have told it otherwise */
    send_commands();
    ck_assert_ptr_null(fake_bus_last(&fake, 0x301));
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x302));
}
END_TEST

/* Half of the range of 32 bits to either side of its zero. */
START_TEST(a_target_saturates)
{
    struct cia402_axis_config config = usual;
    config.zero_counts = 500;
    begin_cia402(&config, &config);
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            tell((enum side)leg, 0x1227);
            command[leg] =
                (struct sea_drive_command){.enable = true, .precompression_m = 1e30f * (float)sign};
        }
        send_commands();
        int32_t targets[SIDE_COUNT];
        memcpy(targets, fake_bus_last(&fake, 0x201)->data, sizeof targets);
        ck_assert_int_eq(targets[SIDE_LEFT], 500 + sign * (INT32_MAX / 2));
        ck_assert_int_eq(targets[SIDE_RIGHT], targets[SIDE_LEFT]);
    }
}
END_TEST

/* ---- CANSimple ----------------------------------------------------------------------------- */

static struct cansimple_drives odrive;
static const uint64_t at_1_turn = 0x3F800000, idle = UINT64_C(1) << 32,
                      closed_loop = UINT64_C(8) << 32;

static void setup_odrive(void)
{
    static const struct cansimple_axis_config config[SIDE_COUNT] = {{1, 200.0f, 0.0f, 1},
                                                                    {2, 200.0f, 0.5f, -1}};
    setup();
    cansimple_drives_init(&odrive, config);
    drives = cansimple_drives_interface(&odrive);
}

START_TEST(cansimple_a_heartbeat_counts_until_its_time_out)
{
    ck_assert(give(0x021, 8, idle));
    ck_assert(give(0x029, 8, at_1_turn));
    grow_old(HEARTBEAT_TIMEOUT_TICKS);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    grow_old(1);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, HEARTBEAT_TIMEOUT_TICKS + 1);
    ck_assert_uint_eq(read_leg(SIDE_RIGHT).age_ticks, UINT16_MAX);
    ck_assert(!read_leg(SIDE_LEFT).has_temperature && !read_leg(SIDE_LEFT).has_supply);
}
END_TEST

/* A reversed axis with its own zero, read and commanded: 0.5 - 0.1 * 200 turns. */
START_TEST(cansimple_the_other_way_round)
{
    ck_assert(give(0x041, 8, closed_loop));
    ck_assert(give(0x049, 8, at_1_turn));
    assert_close(read_leg(SIDE_RIGHT).precompression_m, (1.0 - 0.5) * -1.0 / 200.0, 1e-8, 0.0);
    command[SIDE_RIGHT] = (struct sea_drive_command){.enable = true, .precompression_m = 0.1f};
    send_commands();
    float turns;
    memcpy(&turns, fake_bus_last(&fake, 0x04C)->data, sizeof turns);
    assert_close(turns, 0.5 - 0.1 * 200.0, 1e-5, 0.0);
    for (int i = 4; i < 8; i++) { /* no feed-forward */
        ck_assert_uint_eq(fake_bus_last(&fake, 0x04C)->data[i], 0);
    }
    ck_assert_uint_eq(fake.sent_count, 1); /* the left one was never heard */
}
END_TEST

/* 100 ms between two requests of a kind. */
START_TEST(cansimple_a_request_is_repeated_after_100_ms)
{
    ck_assert(give(0x021, 8, closed_loop));
    send_commands(); /* it is to leave closed loop */
    ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 1);
    for (int i = 1; i <= 100; i++) {
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 0);
    }
    send_commands();
    ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 1);
    setup_odrive();
    ck_assert(give(0x041, 8, idle | 2));
    command[SIDE_RIGHT].clear_fault = true; /* held: Clear_Errors, 0x18 of node 2 */
    send_commands();
    ck_assert_uint_eq(fake_bus_count(&fake, 0x058), 1);
    for (int i = 1; i <= 100; i++) {
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, 0x058), 0);
    }
    send_commands();
    ck_assert_uint_eq(fake_bus_count(&fake, 0x058), 1);
}
END_TEST

/* A request to start that the drive does not follow is made again from its beginning. */
START_TEST(cansimple_a_start_is_repeated_after_100_ms)
{
    ck_assert(give(0x021, 8, idle));
    ck_assert(give(0x029, 8, at_1_turn));
    command[SIDE_LEFT].enable = true;
    for (int round = 0; round < 2; round++) {
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, 0x02B), 1);
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 1);
        for (int i = 1; i <= 100; i++) {
            send_commands();
            ck_assert_uint_eq(fake.sent_count, 1); /* the position alone */
        }
    }
}
END_TEST

/* Node 0 is none: no frame is its own. */
START_TEST(cansimple_a_leg_without_a_drive)
{
    static const struct cansimple_axis_config config[SIDE_COUNT] = {{0, 200.0f, 0.0f, 1},
                                                                    {2, 200.0f, 0.0f, 1}};
    setup();
    cansimple_drives_init(&odrive, config);
    drives = cansimple_drives_interface(&odrive);
    ck_assert(!give(0x001, 8, idle));
    ck_assert(!give(0x009, 8, at_1_turn));
    ck_assert(give(0x049, 8, at_1_turn));
    send_commands();
    ck_assert_uint_eq(fake.sent_count, 1);
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x04C));
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, UINT16_MAX);
}
END_TEST

/* ---- MIT mode ------------------------------------------------------------------------------ */

static struct mit_drives motors;

static void setup_mit(void)
{
    struct mit_axis_config config[SIDE_COUNT];
    setup();
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        config[leg] = (struct mit_axis_config){.motor_id = (uint8_t)(1 + leg),
                                               .answer_id = (uint16_t)(0x11 + leg),
                                               .rad_per_m = 50.0f,
                                               .zero_rad = leg == SIDE_LEFT ? -12.0f : 10.0f,
                                               .direction = (int8_t)(leg == SIDE_LEFT ? 1 : -1),
                                               .kp_Nm_rad = 250.0f,
                                               .kd_Nms_rad = 2.5f,
                                               .spring_N_per_m = 1000.0f,
                                               .stroke_max_m = 0.35f,
                                               .ranges = {12.5f, 50.0f, 18.0f, 500.0f, 5.0f}};
    }
    mit_drives_init(&motors, config);
    drives = mit_drives_interface(&motors);
}

/* An answer: identifier, position and the rest as the makers lay it out, high byte first. */
static void answer(enum side leg, double position_rad, uint8_t length, uint8_t degC, uint8_t error)
{
    const unsigned field = (unsigned)((position_rad + 12.5) / 25.0 * 65535.0 + 0.5);
    const uint8_t bytes[8] = {(uint8_t)(1 + leg),
                              (uint8_t)(field >> 8),
                              (uint8_t)(field & 0xFFu),
                              0x7F,
                              0xF7,
                              0xFF,
                              degC,
                              error};
    struct can_msg frame = {.id = (uint32_t)(0x11 + leg), .length = length};
    memcpy(frame.data, bytes, length);
    ck_assert(sea_drives_receive(&drives, &frame));
}

static bool is_special(enum side leg, uint8_t what)
{
    const struct can_msg *frame = fake_bus_last(&fake, (uint32_t)(1 + leg));
    ck_assert_ptr_nonnull(frame);
    bool is = frame->length == 8 && frame->data[7] == what;
    for (int i = 0; i < 7; i++) {
        is = is && frame->data[i] == 0xFF;
    }
    return is;
}

/* A reversed motor: 10 - 0.1 * 50 = 5 rad; its spring's load counts backwards, too: -1000 * 0.1 / 50 = -2 Nm. */
START_TEST(mit_the_other_way_round)
{
    command[SIDE_RIGHT] = (struct sea_drive_command){.enable = true, .precompression_m = 0.1f};
    answer(SIDE_RIGHT, 10.0 - 50.0 * 0.02, 8, 30, 0);
    assert_close(read_leg(SIDE_RIGHT).precompression_m, 0.02, 1e-5, 0.0);
    send_commands();
    ck_assert(is_special(SIDE_RIGHT, MIT_ENTER));
    send_commands();
    const uint8_t *data = fake_bus_last(&fake, 2)->data;
    assert_close(data[0] << 8 | data[1], (5.0 + 12.5) / 25.0 * 65535.0, 0.51, 0.0);
    assert_close(data[2] << 4 | data[3] >> 4, 2047.5, 0.51, 0.0); /* at rest */
    assert_close((data[3] & 15) << 8 | data[4], 250.0 / 500.0 * 4095.0, 0.51, 0.0);
    assert_close(data[5] << 4 | data[6] >> 4, 2.5 / 5.0 * 4095.0, 0.51, 0.0);
    assert_close((data[6] & 15) << 8 | data[7], (-2.0 + 18.0) / 36.0 * 4095.0, 0.51, 0.0);
    /* The left one has not answered: it is asked, at zero, without torque. */
    const uint8_t *asked = fake_bus_last(&fake, 1)->data;
    ck_assert_uint_eq((asked[3] & 15) << 8 | asked[4], 0);
    ck_assert_uint_eq(asked[5] << 4 | asked[6] >> 4, 0);
}
END_TEST

/* An answer counts until the heartbeat's time-out, its temperature for a second. */
START_TEST(mit_an_answer_grows_old)
{
    answer(SIDE_LEFT, -12.0, 8, 41, 0);
    grow_old(HEARTBEAT_TIMEOUT_TICKS);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    grow_old(1);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    grow_old(SEA_DRIVE_SLOW_TICKS - HEARTBEAT_TIMEOUT_TICKS - 1);
    ck_assert(read_leg(SIDE_LEFT).has_temperature);
    grow_old(1);
    ck_assert(!read_leg(SIDE_LEFT).has_temperature);
    answer(SIDE_LEFT, -12.0, 7, 41,
           0); /* an answer without an error byte has no temperature, either */
    ck_assert(!read_leg(SIDE_LEFT).has_temperature);
    assert_close(read_leg(SIDE_LEFT).temperature_degC, 0.0, 0.0, 0.0);
    answer(SIDE_LEFT, -12.0, 8, 41, 3);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_FAULT);
    answer(SIDE_LEFT, -12.0, 6, 0, 0);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
}
END_TEST

/* 100 ms between two requests to enter; only on a fresh answer. */
START_TEST(mit_enters_again_after_100_ms)
{
    command[SIDE_LEFT].enable = true;
    answer(SIDE_LEFT, -12.0, 8, 30, 0);
    grow_old(1);
    send_commands();
    ck_assert(!is_special(SIDE_LEFT, MIT_ENTER)); /* a cycle old */
    answer(SIDE_LEFT, -12.0, 8, 30, 0);
    send_commands();
    ck_assert(is_special(SIDE_LEFT, MIT_ENTER));
    command[SIDE_LEFT].enable = false;
    send_commands();
    ck_assert(is_special(SIDE_LEFT, MIT_EXIT));
    command[SIDE_LEFT].enable = true;
    for (int i = 2; i < 100; i++) {
        send_commands();
        ck_assert(!is_special(SIDE_LEFT, MIT_ENTER));
    }
    send_commands();
    ck_assert(is_special(SIDE_LEFT, MIT_ENTER));
}
END_TEST

/* A position is judged when it is the first one, or asked for anew: a motor that has run on is no other motor. */
START_TEST(mit_only_the_first_position_is_judged)
{
    answer(SIDE_LEFT, -12.0, 8, 30, 0);
    answer(SIDE_LEFT, 12.0, 8, 30, 0);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    command[SIDE_LEFT].clear_fault = true; /* there is none: nothing is asked for */
    send_commands();
    ck_assert(!is_special(SIDE_LEFT, MIT_EXIT));
    answer(SIDE_LEFT, 12.0, 8, 30, 0);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
}
END_TEST

START_TEST(mit_a_leg_without_a_drive)
{
    motors.axis[SIDE_LEFT].config.motor_id = 0;
    struct can_msg frame = {.id = 0x11, .length = 8};
    ck_assert(!sea_drives_receive(&drives, &frame));
    send_commands();
    ck_assert_uint_eq(fake.sent_count, 1);
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 2));
}
END_TEST

/* All ones would begin a special frame: the field before. */
START_TEST(mit_a_position_at_its_end_is_one_less)
{
    command[SIDE_LEFT] = (struct sea_drive_command){.enable = true, .precompression_m = 1e9f};
    answer(SIDE_LEFT, -12.0, 8, 30, 0);
    send_commands();
    send_commands();
    ck_assert_uint_eq(fake_bus_last(&fake, 1)->data[0], 0xFF);
    ck_assert_uint_eq(fake_bus_last(&fake, 1)->data[1], 0xFE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive limits");
    TCase *cia = tcase_create("CiA 402"), *one = tcase_create("CANSimple"),
          *other = tcase_create("MIT mode");
    tcase_add_checked_fixture(cia, setup_cia402, NULL);
    tcase_add_test(cia, every_statusword_is_read_by_the_standard_s_masks);
    tcase_add_test(cia, a_drive_that_is_off_is_left_in_peace);
    tcase_add_test(cia, each_state_has_its_controlword);
    tcase_add_test(cia, a_slow_pdo_holds_what_the_drive_has);
    tcase_add_test(cia, bits_of_latch_and_contact_are_the_maker_s);
    tcase_add_test(cia, a_drive_whose_bit_12_says_nothing_follows);
    tcase_add_test(cia, an_absent_drive_is_not_spoken_with);
    tcase_add_test(cia, a_drive_without_outputs_gets_a_controlword_alone);
    tcase_add_test(cia, a_target_saturates);
    tcase_add_checked_fixture(one, setup_odrive, NULL);
    tcase_add_test(one, cansimple_a_heartbeat_counts_until_its_time_out);
    tcase_add_test(one, cansimple_the_other_way_round);
    tcase_add_test(one, cansimple_a_request_is_repeated_after_100_ms);
    tcase_add_test(one, cansimple_a_start_is_repeated_after_100_ms);
    tcase_add_test(one, cansimple_a_leg_without_a_drive);
    tcase_add_checked_fixture(other, setup_mit, NULL);
    tcase_add_test(other, mit_the_other_way_round);
    tcase_add_test(other, mit_an_answer_grows_old);
    tcase_add_test(other, mit_enters_again_after_100_ms);
    tcase_add_test(other, mit_only_the_first_position_is_judged);
    tcase_add_test(other, mit_a_leg_without_a_drive);
    tcase_add_test(other, mit_a_position_at_its_end_is_one_less);
    suite_add_tcase(suite, cia);
    suite_add_tcase(suite, one);
    suite_add_tcase(suite, other);
    return run_suite(suite);
}
