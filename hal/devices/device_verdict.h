/* What is wrong with a description of a device: the codes, and their words. */
#ifndef HAL_DEVICES_DEVICE_VERDICT_H
#define HAL_DEVICES_DEVICE_VERDICT_H

/* What the validator finds. Values appear on the bus (0x2050), so they never change their meaning.
 * X(code, number, text): the text goes before the key, what was found and what is allowed. */
#define DEVICE_VERDICTS(X)                                                                                            \
    X(NOTHING, 0, "fits")                                                                                             \
    X(RANGE, 1, "is out of range")                                                                                    \
    X(DIRECTION, 2, "is no direction: 1 or -1")                                                                       \
    X(NO_DRIVE, 3, "at both legs: a device has at least one drive")                                                   \
    X(NODE_TAKEN, 4, "is the number of another unit on this bus, or the controller's, 16")                            \
    X(ID_TAKEN, 5, "gives identifiers that another unit on this bus sends or listens to")                             \
    X(STROKE_FIELD, 6, "and the stroke leave position_range_rad, the field it is commanded in")                       \
    X(SCALE, 7, "is not counts_per_turn * gear / travel_per_turn_m")                                                  \
    X(TORQUE, 8, "is not rated_torque_Nm * 2 pi * gear / travel_per_turn_m")                                          \
    X(SPRINGS, 9, "differs between the legs: the law loads both springs alike")                                       \
    X(LATENCIES, 10, "differs between the sensors: the controller allows for one latency")                            \
    X(LATCH_BIT, 11, "needs a CiA 402 drive: only that has a statusword to tell it in")                               \
    X(MOTOR_SIDE, 12, "does not tell the ankle: the latch lies between them")                                         \
    X(TICK, 13, "is not the tick of this build; make TICK_US=N builds another")                                       \
    X(BITRATE, 14, "is not the bit rate of this build; make BITRATE=N builds another")                                \
    X(UNLOAD_LATCH, 15, "needs a latch that reports that it is closed, and there is none")                            \
    X(BENCH_ONLY, 16,                                                                                                 \
      "does not report CLOSED: this device is for the bench only, not for a person")                                  \
    X(NOT_FINITE, 17, "is not a finite number")                                                                       \
    X(OBJECT, 18, "names no object: its index is 0x1000 to 0xFFFF")                                                   \
    X(NUMBER, 19, "is more than this protocol has room for")                                                          \
    X(BITS, 20, "is no width of whole bytes: 16, 24 or 32")                                                           \
    X(LATCH_OUTPUT, 21, "needs an output of the drive, and it lacks 0x60FE:01")                                       \
    X(LIMIT_ORDER, 22, "leaves nothing between it and its counterpart, which has to be")                              \
    X(NOT_TOLD, 23, "is a limit of what this drive does not tell")                                                    \
    X(UNLOAD_PERSON, 24,                                                                                              \
      "leaves the spring loaded when the link is lost: for the bench only, not for a person; `afo commission' shows " \
      "whether the drive unloads it")                                                                                 \
    X(LEVER_TABLE, 25, "is no lever: a table needs one at each of its four steps, 0.01 m at least")

#define DEVICE_VERDICT_ENTRY(code, number, text) DEVICE_BAD_##code = number,
enum device_verdict { DEVICE_VERDICTS(DEVICE_VERDICT_ENTRY) DEVICE_OK = DEVICE_BAD_NOTHING };
#undef DEVICE_VERDICT_ENTRY

/* Why a description is refused. */
struct device_refusal {
    enum device_verdict verdict;
    int leg;       /* enum side, or -1: common */
    unsigned key;  /* enum device_leg_key, with leg -1 enum device_common_key */
    float found;   /* the key's value */
    float allowed; /* what it had to be, where that is one number; else 0 */
};

#endif
