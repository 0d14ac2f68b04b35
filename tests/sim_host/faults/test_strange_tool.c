/* A tool writes over SDO to every object of every node, one after the other, in all phases of walking; the
 * plant says whether the person was safe. */
#include "hal/bus/frame_table.h"
#include "sim_host/faults/campaign.h"
#include "sim_host/faults/strange_tool.h"
#include "sim_host/nodes/walker_nodes.h"
#include "tests/support/injected_walk.h"

#include <stdlib.h>

enum { CONTROLLER = WALKER_NODES, PASSES = 2, PHASE_STEP = 619, CONTROLWORD = 0x604000 };

/* What nobody can help, and why: voltage off (0x6040 = 0) lets a loaded spring drive its motor back, which
 * takes a quarter of their period, however soon it is seen. */
static bool is_forced_by_physics(unsigned node, uint32_t object)
{
    return (node == WALKER_DRIVE_LEFT || node == WALKER_DRIVE_RIGHT) && object == CONTROLWORD;
}

static struct loop some_loop;

START_TEST(every_object_of_every_node_can_be_written_and_nobody_is_hurt)
{
    injected_walk_prepare(&some_loop, NULL, 0);
    const struct campaign_walker paper = {NULL, NULL};
    struct campaign *campaign = campaign_create(&paper);
    ck_assert_ptr_nonnull(campaign);
    unsigned run = 0, effective = 0, all = 0;
    for (unsigned node = 0; node <= CONTROLLER; node++) {
        const unsigned objects = strange_tool_objects(&some_loop, node);
        ck_assert_uint_gt(objects, 60);
        all += objects;
        for (unsigned i = 0; i < objects * PASSES; i++, run++) {
            struct campaign_plan plan = {
                .index = run, .scene = (uint8_t)(run % CAMPAIGN_SCENES), .count = 1};
            plan.shot[0] = (struct fault_shot){
                .kind = node == CONTROLLER ? FAULT_FOREIGN_SDO_CONTROLLER : FAULT_FOREIGN_SDO,
                .node = (uint8_t)(node % WALKER_NODES),
                .start_tick = run * PHASE_STEP % CAMPAIGN_PHASE_TICKS,
                .duration_ticks = 1 + run * 7 % TICKS_OF_MS(60),
                .magnitude = (i % objects + 0.5) / objects,
                .seed = run};
            const uint32_t object = strange_tool_object(&some_loop, &plan.shot[0]);
            struct campaign_result result;
            campaign_run(campaign, &plan, NULL, NULL, &result);
            effective += result.effective ? 1 : 0;
            ck_assert_msg(
                result.unsafe == 0 || is_forced_by_physics(node, object),
                "run %u: node %u, object %#x: unsafe %#x, unloaded %d ms after the notice", run,
                node, object, result.unsafe, (int)(result.unloaded_tick - result.noticed_tick));
            ck_assert_msg(!result.effective || node == CONTROLLER ||
                              result.fault == SUPERVISOR_FAULT_NODE_WRITTEN,
                          "run %u: node %u, object %#x: fault %d", run, node, object,
                          (int)result.fault);
            ck_assert_msg(!result.late, "run %u: node %u, object %#x: noticed late", run, node,
                          object);
        }
    }
    ck_assert_uint_gt(all, 500);
    ck_assert_uint_gt(effective, run / 2);
    campaign_destroy(campaign);
}
END_TEST

/* The magnitude that chooses this object of a node. */
static double magnitude_of(unsigned node, uint32_t object)
{
    const unsigned objects = strange_tool_objects(&some_loop, node);
    for (unsigned i = 0; i < objects; i++) {
        const struct fault_shot shot = {
            .kind = FAULT_FOREIGN_SDO, .node = (uint8_t)node, .magnitude = (i + 0.5) / objects};
        if (strange_tool_object(&some_loop, &shot) == object) {
            return shot.magnitude;
        }
    }
    ck_abort_msg("node %u has no object %#x", node, object);
    return 0.0;
}

/* First what a drive does when it is stopped or its targets cease, then what makes it follow. */
START_TEST(what_a_stop_would_leave_loaded_is_unloaded)
{
    static const uint32_t pairs[][2] = {
        {0x600700, 0x140005}, {0x600700, 0x608000}, {0x600700, 0x140001}, {0x140005, 0x140001},
        {0x600700, 0x160000}, {0x605E00, 0x608000}, {0x600700, 0x607D01}, {0x101601, 0x600700}};
    injected_walk_prepare(&some_loop, NULL, 0);
    const struct campaign_walker paper = {NULL, NULL};
    struct campaign *campaign = campaign_create(&paper);
    ck_assert_ptr_nonnull(campaign);
    for (unsigned run = 0; run < 8 * sizeof pairs / sizeof pairs[0]; run++) {
        const uint32_t *objects = pairs[run % (sizeof pairs / sizeof pairs[0])];
        struct campaign_plan plan = {.scene = (uint8_t)(run % CAMPAIGN_SCENES), .count = 2};
        for (unsigned i = 0; i < 2; i++) {
            plan.shot[i] =
                (struct fault_shot){.kind = FAULT_FOREIGN_SDO,
                                    .node = WALKER_DRIVE_LEFT,
                                    .start_tick = run * PHASE_STEP % CAMPAIGN_PHASE_TICKS + 2 * i,
                                    .duration_ticks = TICKS_OF_MS(200),
                                    .magnitude = magnitude_of(WALKER_DRIVE_LEFT, objects[i]),
                                    .seed = run + 1000 * i};
        }
        struct campaign_result result;
        campaign_run(campaign, &plan, NULL, NULL, &result);
        ck_assert_msg(result.unsafe == 0, "run %u: %#x and %#x: unsafe %#x", run, objects[0],
                      objects[1], result.unsafe);
    }
    campaign_destroy(campaign);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("strange_tool");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_test(tests, every_object_of_every_node_can_be_written_and_nobody_is_hurt);
    tcase_add_test(tests, what_a_stop_would_leave_loaded_is_unloaded);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
