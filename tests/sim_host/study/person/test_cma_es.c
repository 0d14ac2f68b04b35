/* The search on functions whose least value is known: the sphere, an ellipsoid a million times longer than wide, and
 * Rosenbrock's valley; dimension 10. CMA-ES needs some 1,500, 6,000 and 8,000 tries for 1e-9 (Hansen 2016). */
#include "sim_host/study/person/cma_es.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <string.h>

enum { COUNT = 10 };

typedef double function(const double *x);

static double sphere(const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < COUNT; i++) {
        sum += (x[i] - 1.0) * (x[i] - 1.0);
    }
    return sum;
}

static double ellipsoid(const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < COUNT; i++) {
        const double next = i + 1 < COUNT ? x[i + 1] : x[0];
        const double along = x[i] + 0.5 * next - 1.5; /* not along the axes */
        sum += pow(1e6, i / (COUNT - 1.0)) * along * along;
    }
    return sum;
}

static double rosenbrock(const double *x)
{
    double sum = 0.0;
    for (int i = 0; i + 1 < COUNT; i++) {
        const double rise = x[i + 1] - x[i] * x[i], rest = 1.0 - x[i];
        sum += 100.0 * rise * rise + rest * rest;
    }
    return sum;
}

/* Generations until the best is below `value`; `most` if it does not come. */
static int search_for(struct cma_es *search, function *of, double value, int most)
{
    while (search->best_value >= value && search->generations < most) {
        double values[CMA_LAMBDA_MOST];
        cma_es_ask(search);
        for (int k = 0; k < search->lambda; k++) {
            double x[CMA_MOST];
            cma_es_try(search, k, x);
            values[k] = of(x);
        }
        cma_es_tell(search, values);
    }
    return search->generations;
}

static void check(function *of, int most_tries, uint64_t seed)
{
    struct cma_es search;
    const double start[COUNT] = {0.0};
    cma_es_init(&search, COUNT, start, 0.5, seed);
    ck_assert_int_eq(search.lambda, 10);
    const int generations = search_for(&search, of, 1e-9, most_tries);
    ck_assert_msg(generations * search.lambda < most_tries, "%d tries left %g",
                  generations * search.lambda, search.best_value);
    for (int i = 0; i < COUNT; i++) {
        assert_close(search.best[i], 1.0, 2e-3, 0.0);
    }
}

START_TEST(it_finds_what_is_known)
{
    for (uint64_t seed = 1; seed <= 3; seed++) {
        check(sphere, 3000, seed);
        check(ellipsoid, 12000, seed);
        check(rosenbrock, 14000, seed);
    }
}
END_TEST

START_TEST(a_copy_goes_on_alike)
{
    struct cma_es one, two;
    const double start[COUNT] = {0.3};
    cma_es_init(&one, COUNT, start, 0.5, 4);
    (void)search_for(&one, rosenbrock, 0.0, 30);
    memcpy(&two, &one, sizeof one);
    (void)search_for(&one, rosenbrock, 0.0, 60);
    (void)search_for(&two, rosenbrock, 0.0, 60);
    ck_assert_mem_eq(&one, &two, sizeof one);
}
END_TEST

/* Half of the space has no value. */
static double halved(const double *x)
{
    return x[0] > 1.0 ? (double)NAN : sphere(x);
}

START_TEST(what_is_no_number_is_worst)
{
    struct cma_es search;
    const double start[COUNT] = {0.0};
    cma_es_init(&search, COUNT, start, 0.5, 1);
    (void)search_for(&search, halved, 1e-6, 1000);
    ck_assert(search.best_value < 1e-6);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cma_es");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, it_finds_what_is_known);
    tcase_add_test(tests, a_copy_goes_on_alike);
    tcase_add_test(tests, what_is_no_number_is_worst);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
