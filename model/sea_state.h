/* What a series-elastic actuator's drive and latch report, whatever protocol they speak.
 *
 * hal/ fills these in from frames and controller/ decides by them, so both share this one
 * declaration. The values appear on the bus and in logs: they never change meaning.
 */
#ifndef MODEL_SEA_STATE_H
#define MODEL_SEA_STATE_H

enum drive_state {
    DRIVE_UNKNOWN = 0,  /* no valid status received */
    DRIVE_DISABLED = 1, /* alive, no torque */
    DRIVE_STARTING = 2, /* on its way to enabled */
    DRIVE_ENABLED = 3,  /* follows its target */
    DRIVE_STOPPING = 4, /* quick stop or fault reaction under way */
    DRIVE_FAULT = 5
};

/* The latch that holds the loaded spring's output, as its node reports it. */
enum latch_state {
    LATCH_UNKNOWN = 0, /* the drive's protocol does not tell */
    LATCH_CLOSED = 1,
    LATCH_OPEN = 2
};

#endif
