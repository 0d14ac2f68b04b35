#include "sim_host/study/dose/dose_pairs.h"

#include <math.h>

#define MARGIN_SHARE 0.5

double dose_percent(double now, double before)
{
    return 100.0 * (now / before - 1.0);
}

static void add(const struct dose_result *result, struct dose_result *sum)
{
#define ADD(name, unit, what) sum->name += result->name;
    DOSE_MEASURES(ADD)
#undef ADD
}

static void divide(struct dose_result *sum, uint32_t count)
{
#define DIVIDE(name, unit, what) sum->name /= count;
    DOSE_MEASURES(DIVIDE)
#undef DIVIDE
}

static void add_pair(const struct dose_result *with, const struct dose_result *alone,
                     struct dose_pairs *pairs)
{
    const double change = dose_percent(with->ankle_J_m, alone->ankle_J_m);
    add(with, &pairs->with);
    add(alone, &pairs->alone);
    pairs->least_percent = fmin(pairs->least_percent, change);
    pairs->most_percent = fmax(pairs->most_percent, change);
    if (alone->push_margin_N > 0.0) {
        pairs->least_margin_share =
            fmin(pairs->least_margin_share, with->push_margin_N / alone->push_margin_N);
    }
    pairs->count++;
}

void dose_pair_up(const struct dose_study *study, uint32_t person, uint32_t late, uint32_t r0,
                  struct dose_pairs *pairs)
{
    *pairs = (struct dose_pairs){.earliest = study->steps,
                                 .least_percent = HUGE_VAL,
                                 .most_percent = -HUGE_VAL,
                                 .least_margin_share = HUGE_VAL};
    for (uint32_t seed = 0; seed < study->seeds; seed++) {
        const struct dose_result *with = dose_study_with(study, person, seed, late, r0);
        const struct dose_result *alone = dose_study_alone(study, person, seed);
        pairs->fell += with->fell ? 1 : 0;
        pairs->fell_alone += alone->fell ? 1 : 0;
        pairs->fell_worn_only += with->fell && !alone->fell ? 1 : 0;
        pairs->earliest =
            with->fell && with->steps < pairs->earliest ? with->steps : pairs->earliest;
        if (!with->fell && !alone->fell) {
            add_pair(with, alone, pairs);
        }
    }
    if (pairs->count > 0) {
        divide(&pairs->with, pairs->count);
        divide(&pairs->alone, pairs->count);
    }
}

double dose_margin_holds_m(const struct dose_study *study, uint32_t person, uint32_t late)
{
    double holds_m = 0.0;
    for (uint32_t r0 = 0; r0 < study->r0s; r0++) {
        struct dose_pairs pairs;
        dose_pair_up(study, person, late, r0, &pairs);
        if (pairs.count == 0 || pairs.fell_worn_only > 0 ||
            pairs.least_margin_share < MARGIN_SHARE) {
            break;
        }
        holds_m = study->r0_m[r0];
    }
    return holds_m;
}
