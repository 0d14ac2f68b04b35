#include "sim_host/study/size/latch_study.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/loop/walk_record.h"
#include "sim_host/loop/walk_watch.h"

static int configure(const struct latch_trial *trial, struct loop_config *config)
{
    struct subject subject;
    struct control_params params;
    char message[LOOP_MESSAGE_MAX];
    subject_default(&subject);
    person_override(&subject.person, "law", (double)trial->law);
    for (int side = 0; side < SIDE_COUNT; side++) {
        device_file_set(&subject.device, (enum side)side, DEVICE_LEG_latch_delay_s,
                        trial->declared_s);
    }
    if (subject_control_params(&subject, &params, message) != 0 ||
        loop_configure(config, &subject, &params, trial->speed_rad_s, SENSORS_17BIT, trial->seed,
                       message) != 0) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        config->plant.sea[side].release_latency_s = trial->delay_s;
        config->plant.sea[side].release_jitter_s = trial->jitter_s;
    }
    return 0;
}

static void walk(const struct latch_trial *trial, struct loop *loop, struct walk_record *record,
                 struct latch_result *result)
{
    struct walk_watch watch;
    walk_watch_init(&watch, trial->steps, false);
    do {
        loop_tick(loop);
        (void)walk_record_take(record, loop);
    } while (walk_watch_tick(&watch, record, loop) == WALK_GOES_ON);
    result->walked = record->count < trial->steps ? record->count : trial->steps;
    result->speed_rad_s = walk_record_summary(record, result->walked / 3 + 1).mean_rad_s;
}

int latch_trial_run(const struct latch_trial *trial, struct latch_result *result)
{
    struct loop_config *config = (struct loop_config *)malloc(sizeof *config);
    struct loop *loop = (struct loop *)malloc(sizeof *loop);
    struct walk_record record;
    char message[LOOP_MESSAGE_MAX];
    const bool room = walk_record_init(&record, trial->steps + 2, 0.0);
    int status = -1;
    *result = (struct latch_result){0};
    if (config != NULL && loop != NULL && room && configure(trial, config) == 0 &&
        loop_init(loop, config, NULL, message) == 0) {
        walk(trial, loop, &record, result);
        loop_free(loop);
        status = 0;
    }
    walk_record_free(&record);
    free(loop);
    free(config);
    return status;
}
