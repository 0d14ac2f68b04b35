/* When the audit of the drives asks: beside no heartbeat, no SYNC of slow PDOs and no work, and
 * only a drive that is set up, runs and has said what it holds. */
#include "firmware/drive_audit.h"

#include <assert.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum {
    LEFT = 1, /* the drives' nodes */
    RIGHT = 2,
    PERIOD_TICKS = TICKS_OF_MS(HEARTBEAT_PERIOD_MS),
    NOBODY_DUE = PERIOD_TICKS / 2,
    ITS_TICK = DRIVE_AUDIT_TICKS * SIDE_COUNT, /* asks the left drive for its second object */
    SLOW_TICK = 10 * DRIVE_AUDIT_TICKS         /* and with this one slow PDOs come, too */
};
static_assert(ITS_TICK % SLOW_PDO_TICKS != 0 && SLOW_TICK % SLOW_PDO_TICKS == 0, "as they say");

static struct fake_bus fake;
static struct drive_audit audit;
static struct bring_up bring_up;
static struct network network;

static void setup(void)
{
    fake_bus_init(&fake);
    audit = (struct drive_audit){0};
    audit.memory.known[SIDE_LEFT] = audit.memory.known[SIDE_RIGHT] = UINT32_MAX;
    bring_up = (struct bring_up){0};
    bring_up_skip(&bring_up);
    memset(&network, 0, sizeof network);
    for (unsigned side = 0; side < SIDE_COUNT; side++) {
        network.node[NETWORK_DRIVE_LEFT + side] = (struct network_node){
            .id = (uint8_t)(LEFT + side), .state = NMT_OPERATIONAL, .silent_ticks = NOBODY_DUE};
    }
}

static bool asks(uint32_t tick, bool busy)
{
    const struct can_bus bus = fake_bus_interface(&fake);
    struct setup_failure failure;
    uint32_t unanswered = 0;
    ck_assert(!drive_audit_update(&audit, &bring_up, &network, &bus, tick, busy,
                                  UINT64_C(1000000) * tick, &failure, &unanswered));
    ck_assert_uint_eq(unanswered, 0);
    return audit.under_way;
}

START_TEST(it_asks_each_drive_in_turn)
{
    for (uint32_t slot = 2; slot < 6; slot++) {
        setup();
        ck_assert(asks(slot * DRIVE_AUDIT_TICKS, false));
        ck_assert_uint_eq(audit.leg, slot % 2);
        ck_assert_uint_eq(audit.object, slot / 2);
        const struct can_msg *request = fake_bus_last(&fake, 0x600 + LEFT + slot % 2);
        ck_assert_ptr_nonnull(request);
        ck_assert_uint_eq(request->data[0], 0x40); /* upload, CiA 301 7.2.4.3.5 */
    }
    setup();
    ck_assert(!asks(ITS_TICK - 1, false));
    ck_assert(!asks(ITS_TICK + 1, false));
}
END_TEST

/* The next heartbeat of a node may fall into this tick or the two around it: those are left to it. */
START_TEST(beside_a_heartbeat_it_waits)
{
    static const struct {
        uint16_t silent_ticks;
        bool waits;
    } cases[] = {{PERIOD_TICKS - 3, false},
                 {PERIOD_TICKS - 2, true},
                 {PERIOD_TICKS - 1, true},
                 {PERIOD_TICKS, true},
                 {PERIOD_TICKS + 1, false},
                 {PERIOD_TICKS + 2, false},
                 {0, false},
                 {3 * PERIOD_TICKS / 2, false}};
    for (unsigned node = 0; node < NETWORK_NODES; node++) {
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
            setup();
            network.node[node].silent_ticks = cases[i].silent_ticks;
            const bool is_there = network.node[node].id != 0;
            ck_assert_msg(asks(ITS_TICK, false) == !(is_there && cases[i].waits),
                          "node %u, silent for %u ticks", node, cases[i].silent_ticks);
            network.node[node].silent_ticks = NOBODY_DUE;
            ck_assert(asks(ITS_TICK + 1, false));
        }
    }
}
END_TEST

START_TEST(beside_slow_pdos_and_work_it_waits)
{
    ck_assert(!asks(SLOW_TICK, false));
    ck_assert(asks(SLOW_TICK + 1, false));
    setup();
    ck_assert(!asks(ITS_TICK, true)); /* and what that tick put off takes the two after it */
    ck_assert(!asks(ITS_TICK + 1, false));
    ck_assert(!asks(ITS_TICK + 2, false));
    ck_assert(asks(ITS_TICK + 3, false));
}
END_TEST

START_TEST(it_asks_nobody_who_cannot_answer)
{
    network.node[NETWORK_DRIVE_LEFT].state = NMT_PRE_OPERATIONAL;
    ck_assert(!asks(ITS_TICK, false));
    setup();
    bring_up.configured = 1u << (NETWORK_DRIVE_LEFT + 1);
    ck_assert(!asks(ITS_TICK, false));
    setup();
    bring_up.setup.node = RIGHT; /* somebody is set up */
    ck_assert(!asks(ITS_TICK, false));
    setup();
    audit.memory.known[SIDE_LEFT] = ~UINT32_C(2); /* its second object it has never told */
    ck_assert(!asks(ITS_TICK, false));
    ck_assert(asks(2 * ITS_TICK, false));
}
END_TEST

/* Somebody else's transfer is not cut short; a tool that never ends does not stop the audit. */
START_TEST(it_gives_way_so_long_and_so_often)
{
    drive_audit_give_way(&audit);
    for (uint32_t tick = 1; tick < DRIVE_AUDIT_QUIET_TICKS; tick++) {
        ck_assert(!asks(ITS_TICK - DRIVE_AUDIT_QUIET_TICKS + tick, false));
    }
    ck_assert(asks(ITS_TICK, false));
    setup();
    for (uint32_t slot = 2; slot < 2 + DRIVE_AUDIT_SKIPS; slot++) {
        drive_audit_give_way(&audit);
        ck_assert(!asks(slot * DRIVE_AUDIT_TICKS + 1u, false));
        audit.memory.waits = true;
        ck_assert(!asks(slot * DRIVE_AUDIT_TICKS + 1u, false));
    }
    drive_audit_give_way(&audit);
    audit.memory.waits = true;
    ck_assert(asks((2 + DRIVE_AUDIT_SKIPS) * DRIVE_AUDIT_TICKS + 1u, false));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("when the audit asks");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, it_asks_each_drive_in_turn);
    tcase_add_test(tests, beside_a_heartbeat_it_waits);
    tcase_add_test(tests, beside_slow_pdos_and_work_it_waits);
    tcase_add_test(tests, it_asks_nobody_who_cannot_answer);
    tcase_add_test(tests, it_gives_way_so_long_and_so_often);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
