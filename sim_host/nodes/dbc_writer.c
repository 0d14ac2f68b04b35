#include "sim_host/nodes/dbc_writer.h"

#include <string.h>

#include "hal/bus/frame_table.h"

/* One turn over 2^24 and 2^16 counts, as decimals that read back to the same double. */
#define ANGLE_STEP_RAD "3.7450702829239286e-07"

/* X(frame, signal, first bit, bits, sign, factor, unit): little-endian, as CANopen maps. */
#define SIGNAL_TABLE(X)                                          \
    X(NMT, Command, 0, 8, "+", "1", "")                          \
    X(NMT, Node, 8, 8, "+", "1", "")                             \
    DRIVE_SIGNALS(X, LEFT)                                       \
    DRIVE_SIGNALS(X, RIGHT)                                      \
    LEG_SIGNALS(X, LEFT)                                         \
    LEG_SIGNALS(X, RIGHT)                                        \
    X(DRIVE_TARGETS, TargetLeft, 0, 32, "-", "1", "counts")      \
    X(DRIVE_TARGETS, TargetRight, 32, 32, "-", "1", "counts")    \
    X(TELEMETRY, MeasuredSpeed, 0, 16, "+", "0.0001", "rad/s")   \
    X(TELEMETRY, CommandedSpeed, 16, 16, "+", "0.0001", "rad/s") \
    X(TELEMETRY, Precompression, 32, 16, "+", "1e-05", "m")      \
    X(TELEMETRY, StepNumber, 48, 8, "+", "1", "")                \
    X(TELEMETRY, Fault, 56, 6, "+", "1", "")                     \
    X(TELEMETRY, FellBack, 62, 1, "+", "1", "")                  \
    X(TELEMETRY, RightSide, 63, 1, "+", "1", "")                 \
    X(CONTROLLER_STATE, SupervisorState, 0, 7, "+", "1", "")     \
    X(CONTROLLER_STATE, EmergencyStop, 7, 1, "+", "1", "")       \
    X(CONTROLLER_STATE, LatchedFault, 8, 8, "+", "1", "")        \
    X(CONTROLLER_STATE, InputDigest, 16, 32, "+", "1", "")       \
    COMMON_SIGNALS(X, CONTROLLER)

#define COMMON_SIGNALS(X, node)                        \
    X(EMCY_##node, ErrorCode, 0, 16, "+", "1", "")     \
    X(EMCY_##node, ErrorRegister, 16, 8, "+", "1", "") \
    X(EMCY_##node, Vendor, 24, 40, "+", "1", "")       \
    X(HEARTBEAT_##node, State, 0, 8, "+", "1", "")

#define DRIVE_SIGNALS(X, side)                                        \
    COMMON_SIGNALS(X, DRIVE_##side)                                   \
    X(DRIVE_STATE_##side, Statusword, 0, 16, "+", "1", "")            \
    X(DRIVE_STATE_##side, PositionActual, 16, 32, "-", "1", "counts") \
    X(DRIVE_COMMAND_##side, Controlword, 0, 16, "+", "1", "")         \
    X(DRIVE_COMMAND_##side, Brake, 16, 1, "+", "1", "")               \
    X(DRIVE_COMMAND_##side, LatchArmed, 32, 1, "+", "1", "")          \
    X(DRIVE_SLOW_##side, Torque, 0, 16, "-", "0.1", "%")              \
    X(DRIVE_SLOW_##side, Temperature, 16, 16, "-", "0.1", "degC")     \
    X(DRIVE_SLOW_##side, DcLink, 32, 32, "+", "0.001", "V")

#define LEG_SIGNALS(X, side)                                         \
    COMMON_SIGNALS(X, SENSOR_##side)                                 \
    X(LEG_STATE_##side, LegAngle, 0, 24, "-", ANGLE_STEP_RAD, "rad") \
    X(LEG_STATE_##side, Ankle, 24, 16, "-", "1e-05", "m")            \
    X(FOOT_##side, Down, 0, 1, "+", "1", "")                         \
    X(FOOT_##side, Fault, 1, 1, "+", "1", "")

struct frame {
    const char *name;
    unsigned id;
    unsigned bytes;
    unsigned node;
    unsigned period_us;
};

struct signal {
    const char *frame;
    const char *name;
    unsigned start;
    unsigned bits;
    const char *sign;
    const char *factor;
    const char *unit;
};

#define FRAME_ENTRY(name, id, bytes, period_us, deadline_us, node, kind) \
    {#name, id, bytes, node, period_us},
static const struct frame frames[] = {FRAME_TABLE(FRAME_ENTRY)};
#undef FRAME_ENTRY

#define SIGNAL_ENTRY(frame, name, start, bits, sign, factor, unit) \
    {#frame, #name, start, bits, sign, factor, unit},
static const struct signal signals[] = {SIGNAL_TABLE(SIGNAL_ENTRY)};
#undef SIGNAL_ENTRY

static const char *node_name(unsigned node)
{
    switch (node) {
    case NODE_DRIVE_LEFT:
        return "DriveLeft";
    case NODE_DRIVE_RIGHT:
        return "DriveRight";
    case NODE_SENSOR_LEFT:
        return "SensorLeft";
    case NODE_SENSOR_RIGHT:
        return "SensorRight";
    case NODE_CONTROLLER:
        return "Controller";
    default:
        return "Tool";
    }
}

/* Who listens: a node's own identifiers end in its number (CiA 301, predefined
 * connection set), except where two nodes share a frame. */
static const char *receivers(const struct frame *frame)
{
    const unsigned own = frame->id & 0x7Fu;
    if (frame->id == FRAME_NMT || frame->id == FRAME_HEARTBEAT_CONTROLLER) {
        return "DriveLeft,DriveRight,SensorLeft,SensorRight";
    }
    if (frame->id == FRAME_DRIVE_TARGETS) {
        return "DriveLeft,DriveRight";
    }
    if (own != frame->node) {
        return node_name(own);
    }
    return frame->node == NODE_CONTROLLER ? "Tool" : "Controller";
}

static void write_frame(FILE *stream, const struct frame *frame)
{
    fprintf(stream, "BO_ %u %s: %u %s\n", frame->id, frame->name, frame->bytes,
            node_name(frame->node));
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        const struct signal *signal = &signals[i];
        if (strcmp(signal->frame, frame->name) == 0) {
            fprintf(stream, " SG_ %s : %u|%u@1%s (%s,0) [0|0] \"%s\" %s\n", signal->name,
                    signal->start, signal->bits, signal->sign, signal->factor, signal->unit,
                    receivers(frame));
        }
    }
    fputc('\n', stream);
}

bool dbc_write(FILE *stream)
{
    fputs("VERSION \"\"\n\nNS_ :\n\nBS_:\n\n"
          "BU_: DriveLeft DriveRight SensorLeft SensorRight Controller Tool\n\n",
          stream);
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        write_frame(stream, &frames[i]);
    }
    fputs(
        "CM_ \"Frames of the ankle-foot orthosis bus, written by afo eds from "
        "hal/bus/frame_table.h. With a lever ankle the unit of Ankle is 2*pi/2^16 rad / 1e-05.\";\n"
        "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 100000;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n",
        stream);
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        if (frames[i].period_us >= 1000) {
            fprintf(stream, "BA_ \"GenMsgCycleTime\" BO_ %u %u;\n", frames[i].id,
                    frames[i].period_us / 1000);
        }
    }
    return fflush(stream) == 0 && ferror(stream) == 0;
}
