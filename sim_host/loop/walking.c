#include "sim_host/loop/walking.h"

#include <math.h>

#include "sim_host/plant/walking_units.h"

struct mean {
    double sum;
    uint32_t count;
};

static void add(struct mean *mean, double value)
{
    if (value == value) {
        mean->sum += value;
        mean->count++;
    }
}

static double of(const struct mean *mean)
{
    return mean->count > 0 ? mean->sum / mean->count : (double)NAN;
}

double walking_step_time_s(const struct walk_record *record, uint32_t row)
{
    if (row == 0 || record->rows[row - 1].side == record->rows[row].side) {
        return (double)NAN;
    }
    return record->rows[row].heel_strike_s - record->rows[row - 1].heel_strike_s;
}

struct sums {
    struct mean length_m, time_s, stance, both, work_J, margin_m, side_s[SIDE_COUNT];
};

/* One step, and the stride around it: from this leg's heel strike to its next one. */
static void take(struct sums *sums, const struct walk_record *record, uint32_t i)
{
    const struct walk_row *row = &record->rows[i];
    const double step_s = walking_step_time_s(record, i);
    if (!(step_s > 0.0 && step_s < 0.5 * WALKING_STRIDE_MAX_S)) {
        return;
    }
    add(&sums->time_s, step_s);
    add(&sums->side_s[row->side == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT], step_s);
    add(&sums->length_m, row->step_length_m > 0.0 ? row->step_length_m : (double)NAN);
    add(&sums->work_J, row->push_off_J);
    add(&sums->margin_m, row->margin_m);
    const double next_s = i + 1 < record->count ? walking_step_time_s(record, i + 1) : (double)NAN;
    const double stride_s = step_s + next_s;
    if (stride_s < WALKING_STRIDE_MAX_S) {
        const struct walk_row *before = &record->rows[i - 1];
        add(&sums->stance, (row->toe_off_s - before->heel_strike_s) / stride_s);
        add(&sums->both,
            (before->toe_off_s - before->heel_strike_s + row->toe_off_s - row->heel_strike_s) /
                stride_s);
    }
}

void walking_of(const struct walk_record *record, const struct loop *loop, uint32_t over,
                struct walking *walking)
{
    const struct walker3_params *body = &loop->nodes.plant.config.walk.body;
    const double mass_kg = body->hip_mass_kg + 2.0 * body->leg_mass_kg;
    const uint32_t whole =
        record->count > 0 ? record->count - 1 : 0; /* the last step is not over */
    struct sums sums = {0};
    for (uint32_t i = whole > over ? whole - over : 0; i < whole; i++) {
        take(&sums, record, i);
    }
    const double length_m = of(&sums.length_m), time_s = of(&sums.time_s),
                 work_J = of(&sums.work_J);
    *walking = (struct walking){
        .strides = sums.stance.count,
        .speed_m_s = walking_speed_m_s(length_m, time_s),
        .step_length_m = length_m,
        .step_time_s = time_s,
        .cadence_per_min = walking_cadence_per_min(time_s),
        .stance_share = of(&sums.stance),
        .double_support_share = of(&sums.both),
        .step_time_symmetry_percent =
            walking_symmetry_percent(of(&sums.side_s[SIDE_LEFT]), of(&sums.side_s[SIDE_RIGHT])),
        .push_off_J = work_J,
        .push_off_J_per_kg = work_J / mass_kg,
        .cost_of_transport =
            walking_cost_of_transport(work_J, mass_kg, body->gravity_m_s2, length_m),
        .margin_of_stability_m = of(&sums.margin_m),
        .by_compass = loop->nodes.plant.config.kind != PLANT_WALKER,
    };
}
