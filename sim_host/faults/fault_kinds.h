/* The kinds of faults that the campaign injects.
 *
 * Each has the ranges from which strength and length are drawn, and a time limit for its notice.
 * X(NAME, name, group, lasting_ms, notice_ms, shortest_ms, longest_ms, least, greatest, unit)
 *   lasting_ms, notice_ms: a fault that lasts at least lasting_ms must be noticed within
 *   notice_ms of its first effect on bus or plant, by the supervisor or by a drive.
 *   notice_ms 0: it need not be noticed, but must do no harm.
 * The limits follow from sensor_age_max_s 10 ms, target timeout 50 ms, heartbeats 250 ms and the
 * counts of controller/screening/.
 */
#ifndef SIM_HOST_FAULTS_FAULT_KINDS_H
#define SIM_HOST_FAULTS_FAULT_KINDS_H

#include <stdbool.h>
#include <stdint.h>

enum fault_group {
    FAULT_GROUP_BUS = 0,
    FAULT_GROUP_SENSOR = 1,
    FAULT_GROUP_DRIVE = 2,
    FAULT_GROUP_PLANT = 3,
    FAULT_GROUP_TIME = 4,
    FAULT_GROUP_COMMAND = 5,
    FAULT_GROUP_ASSEMBLY = 6, /* how the device was put together, or has come loose */
    FAULT_GROUP_CONTACT = 7,  /* latches and foot switches */
    FAULT_GROUP_NODE = 8,
    FAULT_GROUP_PERSON = 9
};

#define FAULT_TABLE(X)                                                                          \
    X(SENSOR_FRAMES_LOST, "sensor frames lost", BUS, 15, 30, 1, 1000, 0, 0, "")                 \
    X(DRIVE_FRAMES_LOST, "drive frames lost", BUS, 15, 30, 1, 1000, 0, 0, "")                   \
    X(TARGETS_LOST, "targets lost to one drive", BUS, 60, 120, 1, 1000, 0, 0, "")               \
    X(COMMANDS_LOST, "commands lost to one drive", BUS, 0, 0, 100, 3000, 0, 0, "")              \
    X(SLOW_LOST, "slow drive frames lost", BUS, 600, 600, 100, 2000, 0, 0, "")                  \
    X(NODE_HEARTBEAT_LOST, "heartbeat of a node lost", BUS, 360, 400, 50, 1500, 0, 0, "")       \
    X(MASTER_HEARTBEAT_LOST, "controller's heartbeat lost", BUS, 360, 400, 50, 1500, 0, 0, "")  \
    X(SYNC_LOST, "SYNC lost to one node", BUS, 15, 40, 1, 500, 0, 0, "")                        \
    X(NODE_UNPLUGGED, "node unplugged", BUS, 15, 60, 1, 2000, 0, 0, "")                         \
    X(CONTROLLER_UNPLUGGED, "controller unplugged", BUS, 60, 120, 1, 2000, 0, 0, "")            \
    X(RANDOM_LOSS, "frames lost at random", BUS, 0, 0, 50, 2000, 0.01, 0.5, "")                 \
    X(DELAYED, "sensor frames delayed, reordered", BUS, 0, 0, 10, 2000, 0.1, 10, "ms")          \
    X(DUPLICATED, "frames duplicated", BUS, 0, 0, 10, 2000, 0.05, 1, "")                        \
    X(CORRUPT_ANGLE, "leg angle bits flipped", BUS, 0, 0, 1, 1000, 0.01, 1, "")                 \
    X(CORRUPT_DRIVE, "drive frame bits flipped", BUS, 0, 0, 1, 1000, 0.01, 1, "")               \
    X(CORRUPT_TARGETS, "target bits flipped", BUS, 0, 0, 1, 1000, 0.01, 1, "")                  \
    X(CORRUPT_COMMAND, "command bits flipped", BUS, 0, 0, 1, 1000, 0.1, 1, "")                  \
    X(CORRUPT_ANY, "any bits flipped", BUS, 0, 0, 1, 1000, 0.01, 0.5, "")                       \
    X(ERROR_BURSTS, "error frames", BUS, 0, 0, 1, 1000, 0.02, 1, "")                            \
    X(BUS_OFF, "node driven to bus-off", BUS, 40, 80, 40, 500, 0, 0, "")                        \
    X(BABBLE_HIGH, "babbling at high priority", BUS, 60, 150, 1, 1000, 0, 0, "")                \
    X(BABBLE_LOW, "babbling at low priority", BUS, 0, 0, 1, 1000, 0, 0, "")                     \
    X(FOREIGN_SENSOR, "foreign node with a sensor's id", BUS, 0, 0, 10, 1500, -0.6, 0.6, "rad") \
    X(FOREIGN_DRIVE, "foreign node with a drive's id", BUS, 0, 0, 10, 1500, 0, 0.3, "m")        \
    X(FOREIGN_TARGETS, "foreign node sends targets", BUS, 1, 20, 10, 1500, 0, 0.3, "m")         \
    X(FOREIGN_COMMAND, "foreign node sends commands", BUS, 1, 20, 10, 1500, 0, 1, "")           \
    X(FOREIGN_SYNC, "foreign node sends SYNC", BUS, 1, 20, 10, 1500, 0, 0, "")                  \
    X(FOREIGN_NMT, "foreign node sends NMT", BUS, 1, 300, 1, 5, 0, 3, "")                       \
    X(ANGLE_STUCK, "leg angle stuck", SENSOR, 2500, 2500, 50, 3000, 0, 0, "")                   \
    X(ANKLE_STUCK, "ankle stuck", SENSOR, 0, 0, 50, 3000, 0, 0, "")                             \
    X(ANGLE_OFFSET, "leg angle offset", SENSOR, 0, 0, 100, 3000, -0.6, 0.6, "rad")              \
    X(ANGLE_DRIFT, "leg angle drifts", SENSOR, 0, 0, 100, 3000, -0.6, 0.6, "rad/s")             \
    X(ANGLE_JUMP, "leg angle spikes", SENSOR, 0, 0, 1, 8, -1, 1, "rad")                         \
    X(ANGLE_NOISE, "leg angle noise", SENSOR, 0, 0, 100, 3000, 0.001, 0.1, "rad")               \
    X(ANKLE_OFFSET, "ankle offset", SENSOR, 0, 0, 100, 3000, -0.1, 0.1, "m")                    \
    X(ANKLE_NOISE, "ankle noise", SENSOR, 0, 0, 100, 3000, 0.0005, 0.03, "m")                   \
    X(SENSOR_DEAD, "sensor dead: zeros", SENSOR, 2500, 2500, 20, 3000, 0, 0, "")                \
    X(SENSOR_SILENT, "sensor silent", SENSOR, 15, 30, 1, 1000, 0, 0, "")                        \
    X(SENSORS_SWAPPED, "left and right swapped", SENSOR, 2500, 2500, 20, 3000, 0, 0, "")        \
    X(SENSOR_NOT_FINITE, "sensor reads no number", SENSOR, 2500, 2500, 20, 3000, 0, 0, "")      \
    X(DRIVE_FAULT, "drive fault", DRIVE, 1, 20, 1, 500, 0, 0, "")                               \
    X(DRIVE_RESET, "drive resets", DRIVE, 1, 60, 1, 1, 0, 0, "")                                \
    X(DRIVE_DEAF, "drive hears SYNC only", DRIVE, 60, 120, 1, 2000, 0, 0, "")                   \
    X(DRIVE_FORCELESS, "drive without force (wrong mode)", DRIVE, 0, 0, 50, 3000, 0, 0, "")     \
    X(DRIVE_WEAK, "drive force limited", DRIVE, 0, 0, 50, 3000, 0.01, 0.3, "")                  \
    X(DRIVE_SLOW, "drive speed limited", DRIVE, 0, 0, 50, 3000, 0.02, 0.5, "")                  \
    X(DRIVE_HANGS, "drive hangs, holds its motor", DRIVE, 15, 60, 50, 3000, 0, 0, "")           \
    X(MOTOR_JAMMED, "motor jammed", DRIVE, 0, 0, 500, 3000, 0, 0, "")                           \
    X(LATCH_STUCK_ARMED, "latch always armed", DRIVE, 0, 0, 50, 3000, 0, 0, "")                 \
    X(LATCH_NEVER_ARMED, "latch never armed", DRIVE, 0, 0, 500, 3000, 0, 0, "")                 \
    X(ENCODER_OFFSET, "motor encoder offset", DRIVE, 0, 0, 500, 3000, -0.05, 0.05, "m")         \
    X(ENCODER_STUCK, "motor encoder stuck", DRIVE, 0, 0, 100, 3000, 0, 0, "")                   \
    X(SPRING_BROKEN, "spring broken", PLANT, 2500, 2500, 3000, 3000, 0, 0, "")                  \
    X(SPRING_SOFT, "spring softer", PLANT, 0, 0, 3000, 3000, 0.2, 0.9, "")                      \
    X(SPRING_STIFF, "spring stiffer", PLANT, 0, 0, 3000, 3000, 1.1, 3, "")                      \
    X(PUSH, "push", PLANT, 0, 0, 1, 1, -0.4, 0.4, "Ns")                                         \
    X(SLIP, "slippery ground", PLANT, 0, 0, 100, 2000, 0.02, 0.3, "")                           \
    X(TRIP, "trip", PLANT, 0, 0, 100, 1000, 0, 0, "")                                           \
    X(STAIRS, "stair", PLANT, 0, 0, 1000, 3000, -0.06, 0.06, "m")                               \
    X(TICKS_MISSED, "controller misses ticks", TIME, 60, 350, 1, 1000, 0, 0, "")                \
    X(TICK_JITTER, "SYNC jitter", TIME, 0, 0, 100, 2000, 0.05, 0.4, "ms")                       \
    X(CONTROLLER_RESET, "controller resets", TIME, 1, 350, 1, 1, 0, 0, "")                      \
    X(EMERGENCY_STOP, "emergency stop", COMMAND, 1, 10, 5, 500, 0, 0, "")                       \
    X(REQUEST_ENDS, "walk request withdrawn", COMMAND, 1, 10, 5, 1000, 0, 0, "")                \
    X(SPEED_JUMPS, "speed command jumps", COMMAND, 0, 0, 100, 3000, 0.2, 1.1, "rad/s")          \
    X(PARAMETER_FLIPS, "parameter changes in memory", COMMAND, 1, 700, 3000, 3000, 0, 0, "")    \
    X(CONTROLLER_BUS_OFF, "controller driven to bus-off", BUS, 60, 120, 5, 1000, 0, 0, "")      \
    X(FOREIGN_SDO, "strange tool writes to a node", BUS, 1, 20, 1, 1500, 0, 1, "")              \
    X(FOREIGN_SDO_CONTROLLER, "strange tool writes to the controller", BUS, 0, 0, 1, 1500, 0, 1, "")

/* What befalls people and what they wear; only the campaign of people has it. A magnitude that is one of
 * few values is chosen by people_plan.c. The same columns. */
#define PEOPLE_FAULT_TABLE(X)                                                                 \
    X(NOTHING, "no fault", PERSON, 0, 0, 9000, 9000, 0, 0, "")                                \
    X(LEGS_SWAPPED, "assembly: leg sensors swapped", ASSEMBLY, 0, 0, 3000, 3000, 0, 3, "")    \
    X(DRIVES_CROSSED, "assembly: drives crossed", ASSEMBLY, 0, 0, 3000, 3000, 0, 0, "")       \
    X(SENSORS_BACKWARDS, "assembly: sensors backwards", ASSEMBLY, 0, 0, 3000, 3000, 0, 4, "") \
    X(ANKLE_STUCK_AT_START, "assembly: ankle stuck", ASSEMBLY, 0, 0, 3000, 3000, 0, 0, "")    \
    X(ANKLE_SLIPPED, "assembly: ankle slipped", ASSEMBLY, 0, 0, 3000, 3000, -0.01, 0.01, "m") \
    X(LEG_SCALE, "assembly: leg angle's scale", ASSEMBLY, 0, 0, 3000, 3000, 0.9, 1.1, "")     \
    X(ANKLE_SCALE, "assembly: ankle's scale", ASSEMBLY, 0, 0, 3000, 3000, 0.9, 1.1, "")       \
    X(MOTOR_SCALE, "assembly: motor's scale", ASSEMBLY, 0, 0, 3000, 3000, 0.9, 1.1, "")       \
    X(NEUTRAL_OFF, "assembly: neutral angle off", ASSEMBLY, 0, 0, 3000, 3000, -5, 5, "deg")   \
    X(LATCH_OPENS, "latch opens by itself", CONTACT, 0, 0, 1, 3000, 0, 0, "")                 \
    X(LATCH_STAYS_OPEN, "latch does not close again", CONTACT, 0, 0, 1000, 3000, 0, 0, "")    \
    X(LATCH_STAYS_CLOSED, "latch does not open", CONTACT, 0, 0, 1000, 3000, 0, 0, "")         \
    X(FOOT_STUCK_UP, "foot switch stuck open", CONTACT, 0, 0, 50, 3000, 0, 0, "")             \
    X(FOOT_STUCK_DOWN, "foot switch stuck closed", CONTACT, 0, 0, 50, 3000, 0, 0, "")         \
    X(FOOT_MISSING, "foot switch missing", CONTACT, 0, 0, 50, 3000, 0, 0, "")                 \
    X(FOOT_CHATTER, "foot switch chatters", CONTACT, 0, 0, 50, 3000, 0, 0, "")                \
    X(FOOT_FALSE, "foot switch closes falsely", CONTACT, 0, 0, 500, 3000, 0, 0, "")           \
    X(FOOT_LATE, "foot switch late", CONTACT, 0, 0, 1000, 3000, 0.04, 0.15, "s")              \
    X(FORCE_SHARE, "drive: share of its force", DRIVE, 0, 0, 500, 3000, 0.1, 0.5, "")         \
    X(SPEED_SHARE, "drive: share of its speed", DRIVE, 0, 0, 500, 3000, 0.1, 0.5, "")         \
    X(BATTERY_LOW, "drive: low battery", DRIVE, 0, 0, 500, 3000, 0.4, 0.9, "")                \
    X(DRIVE_HOT, "drive: hot", DRIVE, 0, 0, 500, 3000, 80, 160, "degC")                       \
    X(CLOCK_SKEW, "node's clock is off", NODE, 0, 0, 1000, 3000, -0.3, 0.3, "")               \
    X(SENSOR_LATE, "leg sensor 20 ms late", NODE, 0, 0, 500, 3000, 20, 20, "ms")              \
    X(PERSON_STOPS, "person stops", PERSON, 0, 0, 3000, 3000, 0, 0, "")                       \
    X(PERSON_FALLS, "person falls", PERSON, 0, 0, 3000, 3000, -1.5, 1.5, "rad")               \
    X(PERSON_TURNS_BACK, "person walks backwards", PERSON, 0, 0, 3000, 3000, 0, 0, "")        \
    X(PERSON_HURRIES, "person's pace changes", PERSON, 0, 0, 1000, 3000, 0.7, 1.4, "")

#define FAULT_ENUM(NAME, ...) FAULT_##NAME,
enum fault_kind {
    FAULT_TABLE(FAULT_ENUM) FAULT_KINDS, /* of the compass' campaign */
    FAULT_BEFORE_PEOPLE = FAULT_KINDS - 1,
    PEOPLE_FAULT_TABLE(FAULT_ENUM) FAULT_ALL_KINDS
};
#undef FAULT_ENUM

struct fault_kind_info {
    const char *name;
    enum fault_group group;
    uint32_t lasting_ms, notice_ms, shortest_ms, longest_ms;
    double least, greatest;
    const char *unit;
};
extern const struct fault_kind_info fault_kinds[FAULT_ALL_KINDS];

/* Whether a foreign node sends in this kind of fault. */
bool fault_kind_is_foreign(enum fault_kind kind);

#endif
