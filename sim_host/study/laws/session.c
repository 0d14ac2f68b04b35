#include "sim_host/study/laws/session.h"

#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/session_internal.h"
#include "sim_host/study/pool.h"

struct chain_jobs {
    const struct laws_options *options;
    const struct session_config *configs;
    struct session_result *results;
};

static void compute_chain(void *context, int i)
{
    const struct chain_jobs *jobs = (const struct chain_jobs *)context;
    jobs->results[i].failed =
        session_run_chain(jobs->options, &jobs->configs[i], &jobs->results[i]) != 0;
}

int session_run(const struct laws_options *options, const struct session_config *configs, int count,
                struct session_result *results)
{
    for (int i = 0; i < count; i++) {
        struct session_step *const step = results[i].step;
        results[i] = (struct session_result){.reason = "", .step = step};
    }
    if (!options->chain) {
        return session_run_map(options, configs, count, results);
    }
    struct chain_jobs all = {options, configs, results};
    const int threads = count < options->threads ? count : options->threads;
    const struct pool_jobs jobs = {0, count, threads, &all, compute_chain, laws_count_part};
    int status = pool_run(&jobs) == 1 ? 0 : -1;
    for (int i = 0; i < count; i++) {
        status = results[i].failed ? -1 : status;
    }
    return status;
}

int session_records(const struct session_config *configs, int count, struct session_result *results)
{
    size_t steps = 1; /* of nothing calloc may give nothing */
    for (int i = 0; i < count; i++) {
        steps += (size_t)configs[i].steps;
    }
    results[0].step = calloc(steps, sizeof *results[0].step);
    if (results[0].step == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
        return -1;
    }
    for (int i = 1; i < count; i++) {
        results[i].step = results[i - 1].step + configs[i - 1].steps;
    }
    return 0;
}

void session_records_free(struct session_result *results)
{
    free(results[0].step);
    results[0].step = NULL;
}

int session_settled(const struct session_result *result, double target_rad_s, double share)
{
    int settled = 0;
    for (int k = 0; k < result->steps; k++) {
        if (fabs(result->step[k].speed_rad_s - target_rad_s) > share * target_rad_s) {
            settled = k + 1;
        }
    }
    return settled + 1;
}

double session_mean_speed(const struct session_result *result, int over)
{
    const int first = result->steps > over ? result->steps - over : 0;
    double sum = 0.0;
    for (int k = first; k < result->steps; k++) {
        sum += result->step[k].speed_rad_s;
    }
    return result->steps > first ? sum / (result->steps - first) : 0.0;
}
