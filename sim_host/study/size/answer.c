/* How well a drive follows, and what the ankle feels of it: answers to sines. */
#include <math.h>

#include "model/tick.h"
#include "sim_host/plant/sea.h"
#include "sim_host/study/size/size.h"

#define TWO_PI 6.283185307179586

static const double TICK_S = TICK_PERIOD_US / 1e6;

/* Waves that are measured, and time before them for the start to die away. */
enum { WAVES = 8 };
#define SETTLE_S 0.5

/* The part of a signal that goes with sine and cosine of its time. */
struct wave {
    double in, across;
    int count;
};

static void add(struct wave *wave, double value, double angle)
{
    wave->in += value * sin(angle);
    wave->across += value * cos(angle);
    wave->count++;
}

/* Begins in the middle of its stroke's use, following. */
static void begin(const struct size_setup *setup, struct sea *sea, double middle_m)
{
    struct sea_params params;
    sea_params_as_built(&setup->config, &params);
    sea_init(sea, &params, setup->seed);
    sea->position_m = sea->built.motor.position_m = middle_m;
    sea->built.next = sea->built.motor;
}

static int periods_of(const struct sea *sea)
{
    return (int)(TICK_S / sea->params.drive_period_s + 0.5);
}

void size_answer(const struct size_setup *setup, double frequency_hz, double amplitude_m,
                 double *gain, double *lag_rad)
{
    struct sea sea;
    struct wave wave = {0.0, 0.0, 0};
    const double middle_m = 0.5 * (double)setup->params.start_r0_m;
    const int settle = (int)(SETTLE_S / TICK_S);
    const int ticks = settle + (int)(WAVES / (frequency_hz * TICK_S) + 0.5);
    begin(setup, &sea, middle_m);
    for (int tick = 0; tick < ticks; tick++) {
        const double angle = TWO_PI * frequency_hz * tick * TICK_S;
        const struct sea_command command = {SEA_POSITION, middle_m + amplitude_m * sin(angle),
                                            false};
        if (tick >= settle) {
            add(&wave, sea.position_m - middle_m, angle);
        }
        sea_set_command(&sea, &command, tick * TICK_S);
        for (int i = 0; i < periods_of(&sea); i++) {
            sea_drive_period(&sea, 0.0);
            sea_finish_period(&sea);
        }
    }
    *gain = 2.0 * hypot(wave.in, wave.across) / wave.count / amplitude_m;
    *lag_rad = -atan2(wave.across, wave.in);
}

double size_impedance_Nm_rad(const struct size_setup *setup, double frequency_hz)
{
    static const double SHAKE_RAD = 0.02;
    struct sea sea;
    struct wave wave = {0.0, 0.0, 0};
    const double middle_m = 0.5 * (double)setup->params.start_r0_m;
    const double lever_m = sea_config_lever_at_m(&setup->config, 0.0);
    const int settle = (int)(SETTLE_S / TICK_S);
    const int ticks = settle + (int)(WAVES / (frequency_hz * TICK_S) + 0.5);
    begin(setup, &sea, middle_m);
    (void)sea_release_now(&sea);
    for (int tick = 0; tick < ticks; tick++) {
        const struct sea_command command = {SEA_POSITION, middle_m, false};
        sea_set_command(&sea, &command, tick * TICK_S);
        for (int i = 0; i < periods_of(&sea); i++) {
            const double time_s = tick * TICK_S + i * sea.params.drive_period_s;
            const double angle = TWO_PI * frequency_hz * time_s;
            const double ankle_m = lever_m * SHAKE_RAD * sin(angle);
            sea_drive_period(&sea, ankle_m);
            if (tick >= settle) {
                add(&wave, sea_ankle_force_N(&sea, ankle_m) * lever_m, angle);
            }
            sea_finish_period(&sea);
        }
    }
    return 2.0 * hypot(wave.in, wave.across) / wave.count / SHAKE_RAD;
}
