#include "sim_host/reflex/exponential.h"

#include <stdint.h>
#include <string.h>

#define LOG2E 1.4426950408889634
/* ln 2 in two parts; the first has zeros at its end, so that a small whole number of it is exact */
#define LN2_HIGH 0.693147180369123816490
#define LN2_LOW 1.90821492927058770002e-10
#define LOWEST (-700.0)

/* 1 / n!, of Taylor's series */
static const double PART[] = {1.0,
                              1.0,
                              1.0 / 2,
                              1.0 / 6,
                              1.0 / 24,
                              1.0 / 120,
                              1.0 / 720,
                              1.0 / 5040,
                              1.0 / 40320,
                              1.0 / 362880,
                              1.0 / 3628800,
                              1.0 / 39916800,
                              1.0 / 479001600,
                              1.0 / 6227020800.0};

enum { TERMS = sizeof PART / sizeof PART[0], EXPONENT_BIAS = 1023, FRACTION_BITS = 52 };

double exponential(double x)
{
    if (!(x < 0.0)) {
        return 1.0;
    }
    if (x < LOWEST) {
        return 0.0;
    }
    const int halvings = (int)(0.5 - x * LOG2E);                        /* nearest, for x < 0 */
    const double rest = (x + halvings * LN2_HIGH) + halvings * LN2_LOW; /* within +-ln 2 / 2 */
    double sum = 0.0;
    for (int i = TERMS; i > 0; i--) { /* from the smallest on */
        sum = PART[i - 1] + sum * rest;
    }
    const uint64_t bits = (uint64_t)(EXPONENT_BIAS - halvings) << FRACTION_BITS;
    double power;
    memcpy(&power, &bits, sizeof power);
    return sum * power;
}
