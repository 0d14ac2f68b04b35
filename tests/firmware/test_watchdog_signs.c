/* Each sign of progress by itself: whatever stalls, the watchdog is not fed any more. */
#include <string.h>

#include "firmware/orthosis.h"
#include "hal/bus/frame_table.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"
#include "tests/support/nv_memory.h"

/* What stops; all else goes on. The linker puts the functions below in the place of the real
 * ones (tests/firmware/firmware.mk). */
static enum stall {
    STALL_NONE,
    STALL_SUPERVISOR,
    STALL_CONTROLLER,
    STALL_COMMANDS,
    STALL_BUS
} stall;

bool __real_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault);
bool __wrap_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault);
void __real_controller_update_f32(struct controller *controller,
                                  const struct controller_input *input,
                                  struct controller_output *output);
void __wrap_controller_update_f32(struct controller *controller,
                                  const struct controller_input *input,
                                  struct controller_output *output);

bool __wrap_supervisor_update_f32(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                                  enum supervisor_fault fault)
{
    return stall != STALL_SUPERVISOR &&
           __real_supervisor_update_f32(supervisor, tick, conditions, fault);
}

void __wrap_controller_update_f32(struct controller *controller,
                                  const struct controller_input *input,
                                  struct controller_output *output)
{
    if (stall != STALL_CONTROLLER) {
        __real_controller_update_f32(controller, input, output);
    }
}

static struct orthosis orthosis;
static struct fake_bus bus;
static struct nv_memory memory;
static struct black_box black_box;
static int feeds;

static bool not_pressed(void *context)
{
    (void)context;
    return false;
}

static void count_feed(void *context)
{
    (void)context;
    feeds++;
}

static const struct emergency_stop_ops stop_ops = {not_pressed};
static const struct watchdog_ops watchdog_ops = {count_feed};
static const struct watchdog watchdog = {&watchdog_ops, NULL};

static void put(uint32_t id, uint8_t length, uint8_t first, uint32_t flags)
{
    struct can_msg frame = {.id = id, .length = length, .flags = (uint8_t)flags};
    frame.data[0] = first;
    fake_bus_put(&bus, &frame);
}

static void run(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        orthosis_start_cycle(&orthosis);
        for (uint32_t node = 1; node <= 4; node++) {
            put(0x700 + node, 1, NMT_OPERATIONAL, 0);
        }
        put(FRAME_DRIVE_STATE_LEFT, FRAME_BYTES_DRIVE_STATE_LEFT, 0x40, 0);
        put(FRAME_DRIVE_STATE_RIGHT, FRAME_BYTES_DRIVE_STATE_RIGHT, 0x40, 0);
        if (stall != STALL_BUS) {
            put(FRAME_SYNC, FRAME_BYTES_SYNC, 0, CAN_FRAME_OWN);
        }
        bus.verdict = stall == STALL_COMMANDS ? CAN_FULL : CAN_OK;
        (void)orthosis_poll(&orthosis);
        bus.verdict = CAN_OK;
        fake_bus_clear(&bus);
    }
}

START_TEST(what_stalls_starves_the_watchdog)
{
    const struct nv_store nv = (nv_memory_init(&memory), nv_memory_store(&memory));
    fake_bus_init(&bus);
    const struct orthosis_config config = {.bus = fake_bus_interface(&bus),
                                           .stop = {&stop_ops, NULL},
                                           .watchdog = &watchdog,
                                           .nv = &nv,
                                           .black_box = &black_box};
    orthosis_init(&orthosis, &config);
    orthosis.task.bring_up.configured = 0xF; /* else nothing would be sent to the drives */
    stall = STALL_NONE;
    run(50);
    ck_assert_int_eq(feeds, 50); /* a feed a tick */
    ck_assert_uint_eq(orthosis.task.tick, 50);

    stall = (enum stall)_i;
    run(200);
    ck_assert_int_eq(feeds, stall == STALL_NONE ? 250 : 50);
    ck_assert_uint_eq(orthosis.task.tick, stall == STALL_BUS ? 50 : 250);

    stall = STALL_NONE;
    run(10);
    ck_assert_int_ge(feeds, 60);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("watchdog_signs");
    TCase *tcase = tcase_create("signs");

    tcase_add_loop_test(tcase, what_stalls_starves_the_watchdog, STALL_NONE, STALL_BUS + 1);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
