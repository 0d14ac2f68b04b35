/* Fuzzer: a whole log through the replay, and with it through the control task; also one that begins in the
 * middle of a walk, with a snapshot. A log that is not reproduced has its reason. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/log/replay.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct subject subject;
static struct control_params params;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    char message[SUBJECT_MESSAGE_MAX];
    (void)argc;
    (void)argv;
    subject_default(&subject);
    if (subject_control_params(&subject, &params, message) != 0) {
        abort();
    }
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct replay replay;
    if (size == 0) {
        return 0;
    }
    FILE *log = fmemopen((void *)(uintptr_t)data, size, "r");
    if (log == NULL || replay_init(&replay, &subject, &params, 0.45) != 0) {
        abort();
    }
    if (replay_run(&replay, log) != REPLAY_EQUAL && replay.message[0] == '\0') {
        abort();
    }
    (void)fclose(log);
    return 0;
}
