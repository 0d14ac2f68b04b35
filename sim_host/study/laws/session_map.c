/* Walks of a session on the return map, side by side on the batch engine. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/study/laws/session_internal.h"
#include "sim_host/study/laws/walks.h"

/* All walks of a call; a walk's setup is its own, for its body may be. */
struct map_walk {
    const struct session_config *config;
    struct session_result *result;
    struct law_setup setup;
    struct session_ground ground;
    struct rng rng;
    int strides; /* answered */
};

static void look(void *context, size_t i, struct laws_ahead *ahead)
{
    struct map_walk *walk = (struct map_walk *)context + i;
    const struct session_config *config = walk->config;
    for (int k = 0; k < 3; k++) {
        ahead->seen[k] *= 1.0 + config->noise_rms * rng_normal(&walk->rng);
    }
    const double rise = session_ground_rise(&walk->ground, config);
    const double incline = config->heights ? 0.0 : atan(rise / walk->ground.step_share);
    ahead->desired_rad_s = config->to_rad_s;
    ahead->slope_rad = session_slope_rad(config, walk->strides++) + incline;
    ahead->rise = config->heights ? rise : 0.0;
}

static int record_stride(void *context, size_t i, const struct laws_walk *walk)
{
    const struct map_walk *mine = (const struct map_walk *)context + i;
    struct session_result *result = mine->result;
    result->fallbacks += walk->law.used_fallback ? 1 : 0;
    if (walk->stride.fault != 0) {
        result->fell = true;
        result->reason = laws_fault_name(walk->stride.fault);
        return 1;
    }
    if (result->step != NULL) {
        result->step[result->steps] =
            (struct session_step){-walk->apex[0], walk->r0_m, walk->stride.step_length_m};
    }
    result->steps++;
    return result->steps >= mine->config->steps;
}

static void start_on_map(const struct laws_options *options, struct map_walk *walk,
                         struct laws_course *course)
{
    const struct session_config *config = walk->config;
    double apex[3];
    walk->setup = law_case_setup(options, config->law_case);
    if (config->truth != NULL) {
        walk->setup.truth = subject_gait_walker(config->truth);
    }
    rng_init(&walk->rng, config->seed, 72);
    session_ground_init(&walk->ground, &walk->setup, config);
    const double r0_m = law_setup_gait(&walk->setup, config->from_rad_s, apex);
    struct gait_point own; /* a body that differs starts in its own gait of this r0 */
    if (config->truth != NULL &&
        gait_curve(&walk->setup.truth, r0_m, 0.0, 1, &own, NULL) == GAIT_CURVE_OK) {
        memcpy(apex, own.apex, sizeof apex);
    }
    course->setup = &walk->setup;
    laws_walk_start(&walk->setup, &course->walk, apex, r0_m, config->from_rad_s);
}

int session_run_map(const struct laws_options *options, const struct session_config *configs,
                    int count, struct session_result *results)
{
    struct map_walk *walks = calloc((size_t)count, sizeof *walks);
    struct laws_course *courses = calloc((size_t)count, sizeof *courses);
    int status = -1, strides = 0;
    if (walks == NULL || courses == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
    } else {
        for (int i = 0; i < count; i++) {
            walks[i].config = &configs[i];
            walks[i].result = &results[i];
            start_on_map(options, &walks[i], &courses[i]);
            strides = configs[i].steps > strides ? configs[i].steps : strides;
        }
        status = laws_walks_run(courses, (size_t)count, strides, look, record_stride, walks,
                                options->threads);
    }
    free(walks);
    free(courses);
    return status;
}
