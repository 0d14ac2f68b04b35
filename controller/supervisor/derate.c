#include "controller/supervisor/derate.h"

#include "controller/signals.h"

void derate_init(struct derate *derate)
{
    *derate = (struct derate){.share = REAL(1.0), .least_share = REAL(1.0)};
    derate->leg[SIDE_LEFT].share = derate->leg[SIDE_RIGHT].share = REAL(1.0);
}

/* 0 for what is no finite number. */
static real share_of(real x)
{
    return real_is_finite(x) ? real_clamp(x, REAL(0.0), REAL(1.0)) : REAL(0.0);
}

static void bear(struct derate_leg *leg, real share, enum derate_cause cause)
{
    if (share < leg->share) {
        leg->share = share;
        leg->cause = (uint8_t)cause;
    }
}

static void judge_temperature(struct derate_leg *leg, const struct derate_limits *limit,
                              const struct derate_reading *reading)
{
    const real room_K = limit->temperature_stop_degC - limit->temperature_warn_degC;
    if (!(limit->temperature_stop_degC > REAL(0.0))) {
        return;
    }
    if (reading->has_temperature && room_K > REAL(0.0)) {
        bear(leg, share_of((limit->temperature_stop_degC - reading->temperature_degC) / room_K),
             DERATE_TEMPERATURE);
    }
}

static void judge_supply(struct derate_leg *leg, const struct derate_limits *limit,
                         const struct derate_reading *reading)
{
    const real low_V = limit->supply_min_V, high_V = limit->supply_max_V;
    if (!reading->has_supply) {
        return;
    }
    if (low_V > REAL(0.0)) {
        bear(leg, share_of((reading->supply_V - low_V) / (DERATE_SUPPLY_MARGIN * low_V)),
             DERATE_SUPPLY_LOW);
    }
    if (high_V > REAL(0.0)) {
        bear(leg, share_of((high_V - reading->supply_V) / (DERATE_SUPPLY_MARGIN * high_V)),
             DERATE_SUPPLY_HIGH);
    }
}

/* How long it has been true, up to the time that is asked about; it takes as long to be forgotten. */
static real lasting_s(real before_s, bool now, real period_s, real asked_s)
{
    const real after_s = now ? before_s + period_s : before_s - period_s;
    return real_clamp(after_s, REAL(0.0), asked_s);
}

static bool is_silent(const struct derate_limits *limit, const struct derate_reading *reading)
{
    const bool asks_supply = limit->supply_min_V > REAL(0.0) || limit->supply_max_V > REAL(0.0);
    return (limit->temperature_stop_degC > REAL(0.0) && !reading->has_temperature) ||
           (asks_supply && !reading->has_supply);
}

static void judge(struct derate_leg *leg, const struct derate_limits *limit,
                  const struct derate_reading *reading, real period_s)
{
    if (!reading->heard) {
        return;
    }
    leg->share = REAL(1.0);
    leg->cause = (uint8_t)DERATE_NONE;
    judge_temperature(leg, limit, reading);
    judge_supply(leg, limit, reading);
    leg->silent_s = lasting_s(leg->silent_s, is_silent(limit, reading), period_s, DERATE_SILENT_S);
    if (leg->silent_s >= DERATE_SILENT_S) {
        bear(leg, REAL(0.0), DERATE_SILENT);
    }
    leg->beyond_s = lasting_s(leg->beyond_s, leg->share <= REAL(0.0), period_s, DERATE_WITHDRAW_S);
    leg->warned_s = lasting_s(leg->warned_s, reading->warning, period_s, DERATE_WARNING_S);
    if (leg->warned_s >= DERATE_WARNING_S) {
        bear(leg, DERATE_WARNING_SHARE, DERATE_WARNING);
    }
}

/* Both legs at once. */
static void withdraw_or_return(struct derate *derate)
{
    bool all_well = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct derate_leg *leg = &derate->leg[side];
        if (!derate->withdrawn && leg->beyond_s >= DERATE_WITHDRAW_S) {
            derate->withdrawn = true;
            derate->withdrew_cause = leg->cause;
            derate->withdrew_leg = (uint8_t)side;
        }
        all_well = all_well && (leg->share >= REAL(1.0) || leg->cause == (uint8_t)DERATE_WARNING);
    }
    derate->withdrawn = derate->withdrawn && !all_well;
}

static void move_share(struct derate *derate, real period_s)
{
    const real left = derate->leg[SIDE_LEFT].share, right = derate->leg[SIDE_RIGHT].share;
    const real least = left < right ? left : right;
    const real target = derate->withdrawn ? REAL(0.0) : least;
    const real gain = target - derate->share;
    if (gain <= REAL(0.0)) {
        const real lower = derate->share - DERATE_FALL_1_S * period_s;
        derate->share = lower > target ? lower : target;
        derate->rising = false;
    } else if (derate->rising || gain >= DERATE_HYSTERESIS || target >= REAL(1.0)) {
        const real higher = derate->share + DERATE_RISE_1_S * period_s;
        derate->share = higher < target ? higher : target;
        derate->rising = true;
    }
    if (derate->share < derate->least_share) {
        derate->least_share = derate->share;
    }
}

bool derate_update(struct derate *derate, const struct derate_limits *limit,
                   const struct derate_reading *reading, uint32_t tick)
{
    const uint8_t left = derate->leg[SIDE_LEFT].cause, right = derate->leg[SIDE_RIGHT].cause;
    const bool withdrawn = derate->withdrawn;
    const real period_s = derate->begun ? real_clamp(seconds_since(tick, derate->tick), REAL(0.0),
                                                     DERATE_PERIOD_MAX_S)
                                        : REAL(0.0);
    derate->tick = tick;
    derate->begun = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        judge(&derate->leg[side], &limit[side], &reading[side], period_s);
    }
    withdraw_or_return(derate);
    move_share(derate, period_s);
    return derate->leg[SIDE_LEFT].cause != left || derate->leg[SIDE_RIGHT].cause != right ||
           derate->withdrawn != withdrawn;
}

const char *derate_cause_name(enum derate_cause cause)
{
    static const char *const names[DERATE_CAUSES] = {
        "nothing",         "temperature",         "supply too low",
        "supply too high", "its maker's warning", "it does not tell"};
    return (unsigned)cause < DERATE_CAUSES ? names[cause] : "unknown";
}
