#include "sim_host/batch/choice.h"

#include <stddef.h>
#include <time.h>

#include "sim_host/batch/choice_internal.h"

/* Order and tolerance per accuracy: the cheapest of those measured (scripts/bench-method). */
struct method {
    double accuracy;
    int order;
    double log2_tolerance;
};
static const struct method methods[] = {
    {1e-4, 12, -20.0}, {1e-6, 12, -26.0}, {1e-9, 18, -38.0}, {1e-11, 20, -45.0}, {1e-12, 20, -49.0},
};
#define METHOD_COUNT (sizeof methods / sizeof methods[0])

static struct {
    int lanes, order;
    double log2_tolerance;
} chosen;

static block_stride_fn *stride_of_lanes(int lanes)
{
#ifdef __x86_64__
    if (lanes == 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        return batch_stride_lanes8;
    }
    if (lanes == 4 && __builtin_cpu_supports("avx2")) {
        return batch_stride_lanes4;
    }
#endif
    return lanes == 2 ? batch_stride_lanes2 : NULL;
}

int choice_lanes(void)
{
    int lanes = chosen.lanes != 0 ? chosen.lanes : 8;
    while (stride_of_lanes(lanes) == NULL) {
        lanes /= 2;
    }
    return lanes;
}

enum batch_error batch_use_lanes(int lanes)
{
    if (lanes != 0 && stride_of_lanes(lanes) == NULL) {
        return BATCH_NO_SUCH_VECTORS;
    }
    chosen.lanes = lanes;
    return BATCH_OK;
}

const char *batch_lanes_name(void)
{
    switch (choice_lanes()) {
    case 8:
        return "8 lanes (AVX-512)";
    case 4:
        return "4 lanes (AVX2)";
    default:
        return "2 lanes";
    }
}

void batch_use_method(int order, double log2_tolerance)
{
    chosen.order = order;
    chosen.log2_tolerance = log2_tolerance;
}

int choice_precision(const struct batch_settings *settings, struct block_precision *precision)
{
    const double accuracy = settings->accuracy == 0.0 ? BATCH_ACCURACY_DEFAULT : settings->accuracy;
    if (!(accuracy >= BATCH_ACCURACY_LOW && accuracy <= BATCH_ACCURACY_HIGH)) {
        return 0;
    }
    size_t i = 0;
    while (i + 1 < METHOD_COUNT && methods[i].accuracy > accuracy) {
        i++;
    }
    precision->order = chosen.order != 0 ? chosen.order : methods[i].order;
    precision->log2_tolerance =
        chosen.order != 0 ? chosen.log2_tolerance : methods[i].log2_tolerance;
    precision->want_times = settings->want_times;
    return 1;
}

block_stride_fn *choice_stride(void)
{
    return stride_of_lanes(choice_lanes());
}

double batch_series_flops(const struct batch_settings *settings)
{
    struct block_precision precision;
    if (!choice_precision(settings, &precision)) {
        return 0.0;
    }
    /* taylor_convolve: 16 a term, 10 at the end; taylor_next: 46; two sines and cosines, and the step: 150. */
    const double n = (double)precision.order;
    return 8.0 * (n - 1.0) * (n - 2.0) + 56.0 * (n - 1.0) + 16.0 * n + 150.0;
}

double batch_peak_flops(void)
{
    block_peak_fn *peak = batch_peak_lanes2;
    const long rounds = 1000000;
    volatile double kept = 0.0;
    double best = 0.0;
#ifdef __x86_64__
    peak =
        choice_lanes() == 8 ? batch_peak_lanes8 : (choice_lanes() == 4 ? batch_peak_lanes4 : peak);
#endif
    for (int i = 0; i < 20; i++) {
        struct timespec before, after;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
        kept = kept + peak(rounds);
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
        const double took = (double)(after.tv_sec - before.tv_sec) +
                            1e-9 * (double)(after.tv_nsec - before.tv_nsec);
        const double rate = (double)rounds * BATCH_PEAK_OPERATIONS * choice_lanes() / took;
        best = rate > best ? rate : best;
    }
    return best;
}
