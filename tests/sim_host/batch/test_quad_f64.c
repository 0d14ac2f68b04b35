/* The batch engine against quadruple precision, at each accuracy it offers.
 *
 * tests/sim_host/batch/reference_strides.csv holds whole strides of two walkers from random apexes, made by
 *     build/tests/batch/test_quad_f64 --write tests/sim_host/batch/reference_strides.csv
 * (some minutes). make bench measures every method against the same file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/batch.h"
#include "sim_host/batch/reference.h"
#include "tests/support/assert_close.h"
#include "tests/support/quad_stride.h"

#define TABLE "tests/sim_host/batch/reference_strides.csv"
#define WANTED 240
#define MAX_ROWS 1000

static struct reference_stride rows[MAX_ROWS];

static int table(void)
{
    const int count = reference_read(TABLE, rows, MAX_ROWS);
    ck_assert_int_ge(count, WANTED);
    return count;
}

static struct quad_stride in_quad(const struct reference_stride *row)
{
    const struct quad_walker walker = {row->walker.hip_mass_kg, row->walker.leg_mass_kg,
                                       row->walker.leg_length_m, row->walker.ankle_stiffness_N_m,
                                       row->walker.gravity_m_s2};
    return quad_stride(&walker, row->apex, row->push_m);
}

START_TEST(the_table_is_what_quadruple_precision_gives)
{
    const int count = table();
    for (int i = 7; i < count; i += 47) {
        const struct quad_stride want = in_quad(&rows[i]);
        ck_assert_int_eq(want.whole, 1);
        ck_assert(want.change < 1e-17);
        for (int k = 0; k < 3; k++) {
            assert_close(rows[i].next[k], want.next[k], 1e-300, 0.0);
            assert_close(rows[i].times_s[k], want.times_s[k], 1e-300, 0.0);
        }
    }
}
END_TEST

static void run_one(const struct reference_stride *row, double accuracy, struct batch_item *item)
{
    const struct batch_settings settings = {.accuracy = accuracy, .want_times = 1};
    const struct batch_job job = {
        .walkers = &row->walker, .walker_count = 1, .items = item, .count = 1, .strides = 1};
    *item = (struct batch_item){.push_m = row->push_m};
    memcpy(item->apex, row->apex, sizeof item->apex);
    (void)batch_run(&settings, &job); /* an error leaves the item where it was: far off */
}

/* Largest error of the apexes, and of the times. */
static void errors(double accuracy, double *apex, double *time)
{
    const int count = table();
    *apex = *time = 0.0;
    for (int i = 0; i < count; i++) {
        struct batch_item item;
        run_one(&rows[i], accuracy, &item);
        ck_assert_int_eq(item.fault, 0);
        for (int k = 0; k < 3; k++) {
            *apex = fmax(*apex, fabs(item.apex[k] - rows[i].next[k]));
            *time = fmax(*time, fabs(item.times_s[k] - rows[i].times_s[k]));
        }
    }
}

START_TEST(each_accuracy_is_kept)
{
    static const double accuracies[] = {1e-4, 1e-6, 1e-9, 1e-11, 1e-12};
    for (size_t i = 0; i < sizeof accuracies / sizeof accuracies[0]; i++) {
        double apex, time;
        errors(accuracies[i], &apex, &time);
        printf("accuracy %.0e: largest error %.1e in the apex, %.1e s in the times\n",
               accuracies[i], apex, time);
        ck_assert_msg(apex <= accuracies[i], "asked for %g, got %g", accuracies[i], apex);
        ck_assert_msg(time <= accuracies[i] + 2e-11, "asked for %g, got %g s", accuracies[i], time);
    }
}
END_TEST

static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Quadruple precision follows the equations through any fall; the map does not. */
static int falls(const struct reference_stride *row)
{
    struct batch_item item;
    run_one(row, 1e-12, &item);
    return item.fault != 0;
}

/* A walker's apex somewhere in and around its basin; 1 when the stride from it is whole and not about to stall. */
static int draw(uint64_t *seed, int index, struct reference_stride *row)
{
    static const struct batch_walker both[2] = {{1.0, 0.01, 1.0, 100.0, 9.80665},
                                                {65.0, 2.5, 0.93, 7000.0, 9.80665}};
    const int fast = index % 4 == 3; /* far strides, where the clamp may act */
    row->walker = both[index % 3 == 2];
    row->apex[0] = -(fast ? 0.6 : 0.2) - (fast ? 1.0 : 0.6) * next_random(seed);
    row->apex[1] = (fast ? -0.6 : -0.3) + (fast ? 0.9 : 0.4) * next_random(seed);
    row->apex[2] = (fast ? 3.0 : 0.8) + (fast ? 1.0 : 1.7) * next_random(seed);
    row->push_m =
        row->walker.leg_length_m * ((fast ? 0.24 : 0.01) + (fast ? 0.06 : 0.2) * next_random(seed));
    const struct quad_stride want = in_quad(row);
    memcpy(row->next, want.next, sizeof row->next);
    memcpy(row->times_s, want.times_s, sizeof row->times_s);
    return want.whole && want.next[0] < -0.15 && !falls(row);
}

static int write_table(const char *path)
{
    FILE *file = fopen(path, "w");
    uint64_t seed = 1;
    if (file == NULL) {
        perror(path);
        return EXIT_FAILURE;
    }
    fputs(REFERENCE_HEADING, file);
    for (int i = 0; i < WANTED;) {
        struct reference_stride row;
        if (draw(&seed, i, &row)) {
            reference_write(file, &row);
            fprintf(stderr, "\r%d of %d", ++i, WANTED);
        }
    }
    fputc('\n', stderr);
    return fclose(file) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0) {
        return write_table(argv[2]);
    }
    Suite *suite = suite_create("quad");
    TCase *tests = tcase_create("quad");
    tcase_set_timeout(tests, 120);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_table_is_what_quadruple_precision_gives);
    tcase_add_test(tests, each_accuracy_is_kept);
    return run_suite(suite);
}
