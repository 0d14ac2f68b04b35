/* Feeds a recorded log to the control task and compares what it commands.
 *
 * The log's order is all that is needed: a tick's input is the frames between two
 * SYNCs (firmware/control_task.h). Frames of the controller itself are not fed but
 * compared, byte by byte, in order for each identifier; the emergency stop is read
 * back from the controller's own state frames, which say what it was. A log of a black
 * box (black_box_log.h) begins in the middle of a walk, with a snapshot.
 *
 * Another node may have sent with an identifier of the controller, which hears it and stops. A
 * frame that the task did not make is taken for such a one: it is fed, the task's own must be
 * in the log besides, and its next digest must agree; if not, that frame is the difference. What
 * no controller hears (an NMT command, a record of a step) is in no digest: whether another node sent it or the recorded
 * controller did, which the task did not, only the caller can say (unheard_frames). A
 * foreign SYNC cannot be told so from an own one; a black box knows which was which.
 *
 * A log may hold frames of several interfaces, and may lack frames that the recorder lost:
 * replay_interface.c, replay_gaps.c.
 *
 * A log that begins in the middle of a run replays from the next boot-up in it: from_boot.
 *
 * A log recorded on a bus may hold what others said before the controller was switched on,
 * and more than one run of it, each begun by a boot-up frame. How much the controller had
 * still heard of what lies before its first SYNC is not in the log's order; the first digest
 * that it told decides.
 */
#ifndef SIM_HOST_LOG_REPLAY_H
#define SIM_HOST_LOG_REPLAY_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/storage/black_box.h"
#include "sim_host/log/candump_log.h"
#include "sim_host/subjects/host_task.h"

/* A bus that is busy shows a frame some cycles late, but not for so many ticks. */
enum { REPLAY_BEHIND_TICKS = 20 };
enum { REPLAY_CYCLE_FRAMES = 256, REPLAY_QUEUE = 64, REPLAY_IDS = 32, REPLAY_MESSAGE_MAX = 512 };

enum replay_verdict {
    REPLAY_EQUAL = 0,
    REPLAY_DIFFERS = 1,  /* message says frame, tick and field */
    REPLAY_BAD_LOG = -1, /* message says line, column and reason */
    REPLAY_NO_SYNC = -2  /* the log holds no SYNC: nothing to replay */
};

struct replay_frame {
    struct can_msg message;
    unsigned long line; /* of the log */
    uint64_t time_us;
    bool foreign; /* another node's, with an identifier of the controller that it hears */
};

/* What the task sent and the log has not shown yet, per identifier. */
struct replay_queue {
    uint32_t id;
    unsigned head, count;
    struct can_msg sent[REPLAY_QUEUE];
    uint64_t tick[REPLAY_QUEUE];
    struct can_msg first_unseen; /* the oldest in the queue when it last began to be behind */
    uint64_t unseen_tick;        /* ... and the tick that sent it */
    unsigned behind_ticks;       /* the log has lagged behind for so long */
};

/* Signs that the log lacks frames: replay_gaps.c. */
struct replay_gaps {
    uint64_t present; /* cyclic frames of the cycle before */
    bool has_sign, step_seen;
    uint8_t step;
    uint64_t sign_tick, pause_tick;
    uint64_t sync_us, mean_period_us, mean_deviation_us, periods, pause_us;
    unsigned long pause_line;
    char sign[160];
};

struct replay {
    char interface[CANDUMP_INTERFACE_MAX]; /* of the log; "" before it is chosen */
    unsigned interfaces;                   /* in the log; 0 = not known, it is a pipe */
    struct replay_gaps gaps;
    const struct subject *subject;
    const struct control_params *params;
    double desired_speed_rad_s;
    struct host_task rig;
    struct replay_frame cycle[REPLAY_CYCLE_FRAMES];  /* input of the tick that runs next */
    struct replay_frame next[REPLAY_CYCLE_FRAMES];   /* being read: what followed its SYNC */
    struct replay_frame before[REPLAY_CYCLE_FRAMES]; /* what lies before a run's first SYNC */
    unsigned cycle_count, next_count;
    unsigned next_fed;
    bool sync_pending; /* the own SYNC waits to be fetched by the task */
    struct replay_queue queue[REPLAY_IDS];
    unsigned queue_count;
    bool running; /* a SYNC of this run was seen */
    bool fresh;   /* ... and no tick of it yet: it begins with the controller switched on */
    bool cut;     /* the last run ended in a silence that only a boot-up can end */
    bool boot_seen;
    bool from_boot; /* set by the caller: what lies before the first boot-up is left out */
    unsigned runs;
    uint64_t ticks;          /* of this run */
    uint64_t all_ticks;      /* of all runs */
    uint64_t digest_tick;    /* of all_ticks: the last one whose digest agreed */
    uint64_t frames;         /* read from the log */
    uint64_t compared;       /* command frames found equal */
    uint64_t foreign_frames; /* another node's, with the controller's identifiers */
    uint64_t
        unheard_frames; /* ... of identifiers that it does not hear: its digest proves nothing */
    uint32_t suspects;  /* the same, but the controller has told no digest since */
    uint64_t suspected_tick; /* of the first of them */
    bool next_is_foreign;    /* by a note of a black box */
    uint8_t snapshot[BLACK_BOX_SNAPSHOT_MAX];
    uint32_t snapshot_bytes, snapshot_tick; /* announced; 0 = none under way */
    uint32_t snapshots;                     /* gone on from */
    uint32_t build_id, parameter_crc;       /* what recorded, by its own word; 0 = it says not */
    uint32_t own_parameter_crc;             /* of the task here, as it was switched on */
    bool differs;
    char message[REPLAY_MESSAGE_MAX];
    char unheard_message[REPLAY_MESSAGE_MAX]; /* of the first unheard frame; "" = none */
};

/* Sets up the control task as the run that was recorded. Do not move *replay afterwards;
 * *subject and *params must outlive it. Returns 0, or -1 when the task refuses the
 * parameters. */
int replay_init(struct replay *replay, const struct subject *subject,
                const struct control_params *params, double desired_speed_rad_s);

/* The interface to be replayed of a log that has several; without, it is the one with the most kinds of
 * frames that the controller sends. Returns false when the name is too long. Before replay_run(). */
bool replay_set_interface(struct replay *replay, const char *name);

/* Replays a whole log. A log that is not seekable may have one interface only. A difference that
 * missing frames explain is told as missing frames. replay->message explains every verdict but REPLAY_EQUAL, which may leave unheard_frames. */
enum replay_verdict replay_run(struct replay *replay, FILE *log);

/* Whether a frame of this identifier comes from the controller of that device; NULL: of one with the numbers of
 * the frame table. */
bool replay_is_controllers(const struct device_description *device, uint32_t id);

/* The name of the field in byte `byte` of a frame that the controller sends. */
const char *replay_field_name(uint32_t id, unsigned byte);

#endif
