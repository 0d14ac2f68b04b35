#include "tests/support/assert_close.h"

#include <math.h>
#include <stdlib.h>

int is_close(double got, double want, double absolute, double relative)
{
    if (!isfinite(got) || !isfinite(want)) {
        return 0;
    }
    return fabs(got - want) <= absolute + relative * fabs(want);
}

int run_suite(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
