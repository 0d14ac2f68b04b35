/* Many walkers at once: the return map of model/stride.h on the lanes of SIMD registers and all cores.
 *
 * The map and its faults are the model's; the method differs. Single support is a power series in time, whose
 * order and step follow from the accuracy asked for. Double support is in closed form, by its energy. A
 * walker's result depends on its own numbers and the accuracy alone, bit for bit. It does not depend on its
 * neighbours, the instruction set, the number of threads or the machine.
 *
 * Plain doubles in SI units, whatever the caller is compiled for. Signs as in model/stride.h: a forward
 * walker's stance rate is negative.
 */
#ifndef SIM_HOST_BATCH_BATCH_H
#define SIM_HOST_BATCH_BATCH_H

#include <stddef.h>
#include <stdint.h>

#include "sim_host/batch/batch_settings.h"
#include "sim_host/batch/choice.h"

struct batch_walker {
    double hip_mass_kg, leg_mass_kg, leg_length_m, ankle_stiffness_N_m, gravity_m_s2;
};

/* One walker on its way. The caller fills the first group; the engine keeps it, and writes the rest. */
struct batch_item {
    double apex[3]; /* in and out: stance rate rad/s, swing angle rad, swing rate rad/s */
    double push_m;  /* r0 >= 0 when gain is 0; else the push at the aimed speed */
    double
        gain_m_s; /* kp: r0[k] = push + kp (v[k] - aim), v = -stance rate (paper eq. 16, signs of forward
                             speed); not below 0. 0: no law */
    double target_speed_rad_s; /* v* */
    double
        slope_rad; /* ground of the next stride, as in model/ground.h: > 0 uphill, below pi/2 in size */
    double height_rise; /* next foothold above the slope line, leg lengths; both 0: level */
    uint32_t walker;    /* index into the walkers given */
    int32_t fault;      /* in: 0, else the item is left alone; out: enum stride_fault's values */
    int64_t strides;    /* in: 0; out: strides completed; the last is in the fields below */
    double times_s[3];  /* apex to strike, double support (0 unless want_times), lift-off to apex */
    double step_length_m;  /* toe to toe */
    double inter_leg_rad;  /* angle between the legs at heel strike */
    double ankle_rate_m_s; /* after collision and clamp */
    int32_t clamped;       /* 1 where the clamp acted */
    int32_t series;        /* power series that the last stride took: its cost */
};

/* Derivatives of the next apex, on level ground (else the item's fault is STRIDE_BAD_INPUT). With a law, r0's dependence on the apex is not in by_apex: the whole
 * derivative is by_apex[i][j] - (j == 0 ? gain_m_s * by_push[i] : 0). */
struct batch_slopes {
    double by_apex[3][3]; /* [i][j]: d next[i] / d apex[j] */
    double by_push[3];    /* d next[i] / d r0 */
};

/* Called for each item after each stride, and once with fault != 0 when it fails. The calling thread is the one
 * that runs the item; other threads call for other items at the same time. `index`: of the item in the array.
 * It may change apex, push_m, gain_m_s, target_speed_rad_s, slope_rad and height_rise for the next stride. A law
 * of any kind sets push_m here; the caller writes its first answer into the item. slopes is NULL unless they
 * were asked for. Returns 0 to go on, else the item is done. */
typedef int batch_stride_done_fn(void *context, size_t index, struct batch_item *item,
                                 const struct batch_slopes *slopes);

/* What runs, and what is told. */
struct batch_job {
    const struct batch_walker *walkers; /* at least one */
    uint32_t walker_count;
    struct batch_item *items;
    struct batch_slopes
        *slopes; /* one per item, of the last stride; NULL: not wanted (they cost eightfold) */
    size_t count;
    int64_t strides;                   /* per item, at most */
    batch_stride_done_fn *stride_done; /* NULL: nothing to tell */
    void *context;                     /* its first argument */
};

/* Runs the job's items in the calling thread, each for `strides` strides or until it fails.
 * The caller owns all; nothing is kept. Allocates about 50 kB a thread and 32 bytes a walker while it runs.
 * Returns BATCH_OK; on an error nothing was run (out of memory on the way: part was, item by item complete). An item's own bad numbers are its fault STRIDE_BAD_INPUT.
 * Not for interrupts or the control loop. Cost: about a microsecond per stride (make bench). */
enum batch_error batch_run(const struct batch_settings *settings, const struct batch_job *job);

/* The same on `threads` cores (0: all there are), by pieces of neighbouring items.
 * Same results bit for bit. stride_done is called from several threads, for different items. */
enum batch_error batch_run_threads(const struct batch_settings *settings,
                                   const struct batch_job *job, int threads);

/* What went wrong, and what to do about it. A static string, never NULL. */
const char *batch_error_name(enum batch_error error);

#endif
