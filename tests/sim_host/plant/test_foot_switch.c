/* Simulated foot switches with their errors and faults, and the wire to a latch. */
#include "sim_host/plant/contact_wire.h"
#include "sim_host/plant/foot_switch.h"
#include "tests/support/assert_close.h"

enum { STRIDE_MS = 1000, DOWN_MS = 600, STRIDES = 40 };

struct heard {
    int closings, openings, unknown;
    double close_lag_s[STRIDES + 4],
        open_lag_s[STRIDES + 4]; /* of the first edge in each half stride */
};

/* Strides of 600 ms down, 400 ms up; the first closing and the last opening of each are noted. */
static void play(const struct foot_switch_params *params, uint64_t seed, struct heard *heard)
{
    struct foot_switch foot;
    *heard = (struct heard){0};
    foot_switch_init(&foot, params, false, seed, 7);
    for (int stride = 0; stride < STRIDES; stride++) {
        bool closed = false, opened = false;
        for (int ms = 0; ms < STRIDE_MS; ms++) {
            const bool down = ms < DOWN_MS;
            const double now_s = 1e-3 * (stride * STRIDE_MS + ms);
            const enum foot_contact says = foot_switch_update(&foot, down, true, now_s);
            heard->unknown += says == FOOT_UNKNOWN;
            if (!closed && down && says == FOOT_DOWN && ms < 300) {
                heard->close_lag_s[heard->closings++] = 1e-3 * ms;
                closed = true;
            }
            if (!opened && !down && says == FOOT_UP) {
                heard->open_lag_s[heard->openings++] = 1e-3 * (ms - DOWN_MS);
                opened = true;
            }
        }
    }
}

START_TEST(an_exact_switch_is_the_foot)
{
    struct foot_switch_params params;
    struct heard heard;
    foot_switch_preset(FOOT_SWITCH_EXACT, 1, 1, &params);
    play(&params, 1, &heard);
    ck_assert_int_eq(heard.closings, STRIDES);
    ck_assert_int_eq(heard.openings, STRIDES);
    for (int i = 0; i < STRIDES; i++) {
        assert_close(heard.close_lag_s[i], 0.0, 1e-9, 0.0);
        assert_close(heard.open_lag_s[i], 0.0, 1e-9, 0.0);
    }
}
END_TEST

START_TEST(edges_come_late_by_bias_and_jitter)
{
    static const enum foot_switch_preset_kind kinds[] = {FOOT_SWITCH_10MS, FOOT_SWITCH_20MS,
                                                         FOOT_SWITCH_40MS, FOOT_SWITCH_SEEDED};
    struct foot_switch_params params;
    struct heard heard;
    foot_switch_preset(kinds[_i], 5, 1, &params);
    ck_assert_ptr_null(foot_switch_params_check(&params));
    play(&params, 2, &heard);
    double least_s = 1.0, most_s = 0.0;
    ck_assert_int_eq(heard.closings, STRIDES);
    for (int i = 0; i < STRIDES; i++) {
        least_s = heard.close_lag_s[i] < least_s ? heard.close_lag_s[i] : least_s;
        most_s = heard.close_lag_s[i] > most_s ? heard.close_lag_s[i] : most_s;
    }
    ck_assert(least_s >= params.close_bias_s - 1e-9 && least_s < params.close_bias_s + 0.002);
    ck_assert(most_s <= params.close_bias_s + 0.003 + 0.006 && most_s > least_s);
    ck_assert_int_eq(heard.unknown, 0);
}
END_TEST

START_TEST(a_seed_is_a_person_s_switches)
{
    struct foot_switch_params a, b, again;
    foot_switch_preset(FOOT_SWITCH_SEEDED, 1, 1, &a);
    foot_switch_preset(FOOT_SWITCH_SEEDED, 1, 2, &b);
    foot_switch_preset(FOOT_SWITCH_SEEDED, 1, 1, &again);
    ck_assert(a.close_bias_s != b.close_bias_s && a.close_bias_s != a.open_bias_s);
    assert_close(a.close_bias_s, again.close_bias_s, 0.0, 0.0);
    double sum = 0.0;
    for (uint64_t seed = 0; seed < 500; seed++) {
        foot_switch_preset(FOOT_SWITCH_SEEDED, seed, 1, &a);
        ck_assert(a.close_bias_s >= 0.0 && a.close_bias_s <= 0.04);
        sum += a.close_bias_s;
    }
    assert_close(sum / 500.0, 0.02, 0.0015, 0.0);
}
END_TEST

START_TEST(faults)
{
    struct foot_switch_params params;
    struct heard heard;
    foot_switch_preset(FOOT_SWITCH_EXACT, 1, 1, &params);
    params.fault = (enum foot_switch_fault)_i;
    play(&params, 3, &heard);
    switch (params.fault) {
    case FOOT_SWITCH_STUCK_UP:
        ck_assert_int_eq(heard.closings, 0);
        break;
    case FOOT_SWITCH_STUCK_DOWN:
        ck_assert_int_eq(heard.openings, 0);
        break;
    case FOOT_SWITCH_MISSING:
        ck_assert_int_eq(heard.unknown, STRIDES * STRIDE_MS);
        break;
    default:
        ck_assert_int_eq(heard.closings, STRIDES);
        break;
    }
}
END_TEST

static int wire_edges(const struct foot_switch_params *params, int *in_swing)
{
    struct foot_switch foot;
    struct contact_wire wire;
    int edges = 0;
    double last_s = -1.0;
    *in_swing = 0;
    foot_switch_init(&foot, params, false, 1, 7);
    contact_wire_init(&wire);
    for (int ms = 0; ms < STRIDES * STRIDE_MS; ms++) {
        const bool down = ms % STRIDE_MS < DOWN_MS;
        const double now_s = 1e-3 * ms;
        contact_wire_update(&wire, foot_switch_update(&foot, down, true, now_s), now_s);
        if (wire.edge && wire.edge_s != last_s) {
            last_s = wire.edge_s;
            edges++;
            *in_swing += !down;
        }
        ck_assert(!contact_wire_has_edge(&wire, last_s + CONTACT_EDGE_S + 0.001));
    }
    return edges;
}

START_TEST(a_wire_has_one_edge_a_landing)
{
    struct foot_switch_params params;
    int in_swing;
    foot_switch_preset(FOOT_SWITCH_20MS, 1, 1, &params);
    ck_assert_int_eq(wire_edges(&params, &in_swing), STRIDES - 1); /* the first: not seen open */
    ck_assert_int_eq(in_swing, 0);
    params.fault = FOOT_SWITCH_CHATTER;
    ck_assert_int_le(wire_edges(&params, &in_swing), 1);
    params.fault = FOOT_SWITCH_MISSING;
    ck_assert_int_eq(wire_edges(&params, &in_swing), 0);
    params.fault = FOOT_SWITCH_FALSE;
    (void)wire_edges(&params, &in_swing);
    ck_assert_int_gt(in_swing, STRIDES / 4);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("foot_switch");
    TCase *all = tcase_create("all");
    tcase_add_test(all, an_exact_switch_is_the_foot);
    tcase_add_loop_test(all, edges_come_late_by_bias_and_jitter, 0, 4);
    tcase_add_test(all, a_seed_is_a_person_s_switches);
    tcase_add_loop_test(all, faults, 0, FOOT_SWITCH_FAULT_COUNT);
    tcase_add_test(all, a_wire_has_one_edge_a_landing);
    suite_add_tcase(suite, all);
    return run_suite(suite);
}
