/* Every jump of the commanded speed between 0.2 and 1.0 rad/s in steps of 0.1. */
#include <stdlib.h>

#include "sim_host/study/laws/session.h"

enum { SPEEDS = 9, PAIRS = SPEEDS * SPEEDS, TAIL = 20, MAP_STEPS = 150, CHAIN_STEPS = 80 };
#define SETTLED_RATIO 0.01

struct jump {
    bool fell, settled;
    int steps; /* until settled, or walked until the fall */
};

struct jumps {
    const struct laws_options *options;
    enum law_case law_case;
    double unit; /* rad/s of this subject per rad/s of the paper's walker */
    struct session_config config[PAIRS];
    struct session_result result[PAIRS];
    struct jump jump[PAIRS];
};

static double speed_of(int index)
{
    return 0.2 + 0.1 * index;
}

static struct session_config pair(const struct jumps *jumps, int i)
{
    struct session_config config = {.law_case = jumps->law_case,
                                    .from_rad_s = speed_of(i / SPEEDS) * jumps->unit,
                                    .to_rad_s = speed_of(i % SPEEDS) * jumps->unit,
                                    .seed = jumps->options->seed};
    config.steps = jumps->options->chain ? CHAIN_STEPS : MAP_STEPS;
    if (jumps->law_case == LAW_CASE_RAMP) {
        config.steps += 200; /* the ramp itself takes up to 160 */
    }
    return config;
}

static void evaluate(const struct session_config *config, const struct session_result *result,
                     struct jump *jump)
{
    jump->fell = result->fell;
    jump->steps =
        result->fell ? result->steps + 1 : session_settled(result, config->to_rad_s, SETTLED_RATIO);
    jump->settled = !result->fell && jump->steps <= result->steps - TAIL;
}

static int run(struct jumps *jumps)
{
    for (int i = 0; i < PAIRS; i++) {
        jumps->config[i] = pair(jumps, i);
    }
    if (session_records(jumps->config, PAIRS, jumps->result) != 0) {
        return -1;
    }
    const int status = session_run(jumps->options, jumps->config, PAIRS, jumps->result);
    for (int i = 0; i < PAIRS && status == 0; i++) {
        evaluate(&jumps->config[i], &jumps->result[i], &jumps->jump[i]);
    }
    session_records_free(jumps->result);
    return status;
}

static void print(const struct jumps *jumps, FILE *csv)
{
    int falls = 0, unsettled = 0, most_up = 0, most_down = 0;
    printf("  %s%s\n  from\\to ", law_case_names[jumps->law_case],
           jumps->options->chain ? ", whole chain" : ", map");
    for (int j = 0; j < SPEEDS; j++) {
        printf("%6.1f", speed_of(j));
    }
    for (int i = 0; i < PAIRS; i++) {
        const struct jump *jump = &jumps->jump[i];
        const int from = i / SPEEDS, to = i % SPEEDS;
        if (to == 0) {
            printf("\n  %6.1f  ", speed_of(from));
        }
        if (csv != NULL) {
            fprintf(csv, "%s,%.1f,%.1f,%d,%d,%d\n", law_case_names[jumps->law_case], speed_of(from),
                    speed_of(to), jump->fell, jump->settled, jump->steps);
        }
        if (jump->fell) {
            printf("%6s", "fell");
            falls++;
            continue;
        }
        if (!jump->settled) {
            printf("%6s", "-");
            unsettled++;
            continue;
        }
        printf("%6d", jump->steps);
        if (to > from && jump->steps > most_up) {
            most_up = jump->steps;
        } else if (to < from && jump->steps > most_down) {
            most_down = jump->steps;
        }
    }
    printf(
        "\n  falls %d, never within 1 %% %d of %d; settled within %d steps upward, %d downward\n\n",
        falls, unsettled, PAIRS, most_up, most_down);
}

int laws_jumps(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    FILE *csv =
        laws_csv(options, "jumps", "law,from_rad_s,to_rad_s,fell,settled,steps", &file, &failed);
    struct jumps *jumps = malloc(sizeof *jumps);
    failed = failed || jumps == NULL;
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        if (!options->law_case[e]) {
            continue;
        }
        *jumps = (struct jumps){
            .options = options, .law_case = (enum law_case)e, .unit = laws_speed_unit(options)};
        failed = run(jumps) != 0;
        if (!failed) {
            print(jumps, csv);
        }
    }
    free(jumps);
    return laws_csv_close(options, &file, failed);
}
