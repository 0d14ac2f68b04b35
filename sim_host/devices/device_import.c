#include "sim_host/devices/device_import.h"

#include <stdio.h>
#include <strings.h>

#include "hal/bus/frame_table.h"

enum { MODE_BIT_INTERPOLATED = 6, MODE_BIT_CSP = 7, DUMMY_INTEGER32 = 4, TYPE_INTEGER16 = 3 };

static const struct {
    const char *objects, *cost;
} lack_texts[DEVICE_LACKS_COUNT] = {
    [DEVICE_LACKS_SUPPORTED_MODES] = {"0x6502", "nothing: the mode is read back when it is set"},
    [DEVICE_LACKS_RPDO_TIMER] = {"0x1400:05", "targets that stay away are noticed by the heartbeat "
                                              "only, after 250 ms instead of 50 ms"},
    [DEVICE_LACKS_OPTION_CODES] = {"0x605A to 0x605E",
                                   "what the drive does on quick stop, shutdown "
                                   "and fault is the maker's"},
    [DEVICE_LACKS_BUS_VOLTAGE] = {"0x6079", "0x2021 tells no supply voltage"},
    [DEVICE_LACKS_TEMPERATURE] = {"0x2100", "0x2021 tells no temperature"},
    [DEVICE_LACKS_RATED_TORQUE] = {"0x6076",
                                   "the force's scale is the file's alone: a wrong motor is "
                                   "not noticed at set-up"},
    [DEVICE_LACKS_TORQUE] = {"0x6077",
                             "the force is not judged: a broken spring is not noticed by it"},
    [DEVICE_LACKS_SCALING] = {"0x608F, 0x6091, 0x6092",
                              "the scale is the file's alone: another gear is "
                              "not noticed at set-up"},
    [DEVICE_LACKS_ABORT_OPTION] = {"0x6007",
                                   "what the drive does when the link is lost is the maker's"},
    [DEVICE_LACKS_FOLLOWING_TIME] = {"0x6066", "the time of a following error is the maker's"},
    [DEVICE_LACKS_FOLLOWING_WINDOW] = {"0x6065", "the controller alone judges following errors"},
    [DEVICE_LACKS_OUTPUT_MASK] = {"0x60FE:02", "nothing: all outputs follow"},
    [DEVICE_LACKS_OUTPUTS] = {"0x60FE:01", "no latch at the drive: it needs a board of its own"},
    [DEVICE_LACKS_DUMMY] = {"Dummy0004",
                            "each drive has a target frame of its own: 19 us more a cycle "
                            "at 1 Mbit/s"},
    [DEVICE_LACKS_HEARTBEAT_CONSUMER] = {"0x1016",
                                         "the drive does not notice that the controller is gone"},
    [DEVICE_LACKS_MAX_SPEED] = {"0x6080 in counts/s",
                                "a motor that is too slow is not noticed at set-up"},
    [DEVICE_LACKS_POSITION_LIMITS] = {"0x607D", "the controller alone limits the stroke"},
    [DEVICE_LACKS_INTERPOLATION] = {"0x60C2",
                                    "how the drive goes from target to target is the maker's"},
    [DEVICE_LACKS_FOLLOWS_BIT] = {"bit 12 of 0x6041",
                                  "a drive that is enabled and ignores its target is "
                                  "noticed by its position only"},
};

const char *device_lack_cost(enum device_lack lack)
{
    return lack_texts[lack].cost;
}

const char *device_lack_objects(enum device_lack lack)
{
    return lack_texts[lack].objects;
}

static bool takes(const struct eds_file *eds, uint16_t index, uint8_t sub, int64_t value)
{
    return eds_takes(eds_find(eds, index, sub), value);
}

static bool reads(const struct eds_file *eds, uint16_t index, uint8_t sub)
{
    const struct eds_object *object = eds_find(eds, index, sub);
    return object != NULL && object->readable && object->type != 0;
}

static bool sends(const struct eds_file *eds, uint16_t index, uint8_t sub)
{
    const struct eds_object *object = eds_find(eds, index, sub);
    return object != NULL && object->readable && object->mappable;
}

static bool hears(const struct eds_file *eds, uint16_t index, uint8_t sub)
{
    const struct eds_object *object = eds_find(eds, index, sub);
    return object != NULL && object->writable && object->mappable;
}

static void refuse(struct device_import *import, const char *reason)
{
    if (import->fits) {
        import->fits = false;
        snprintf(import->reason, sizeof import->reason, "%s", reason);
    }
}

static void need(struct device_import *import, bool there, const char *object)
{
    if (!there && import->fits) {
        import->fits = false;
        snprintf(import->reason, sizeof import->reason, "it needs %s", object);
    }
}

static void want(struct device_import *import, bool there, enum device_lack lack)
{
    import->lacks |= there ? 0u : UINT32_C(1) << (unsigned)lack;
}

/* Cyclic synchronous position where there is, else interpolated position. A sheet without 0x6502's value leaves
 * the question to the drive: the mode is read back. */
static void choose_mode(const struct eds_file *eds, struct device_import *import)
{
    const struct eds_object *modes = eds_find(eds, 0x6502, 0);
    const bool told = modes != NULL && modes->has_default && modes->default_value != 0;
    const int64_t bits = told ? modes->default_value : 1 << MODE_BIT_CSP;
    if ((bits >> MODE_BIT_CSP & 1) != 0) {
        import->mode = DEVICE_MODE_CSP;
        need(import, hears(eds, 0x607A, 0), "0x607A, the target position, in an RPDO");
    } else if ((bits >> MODE_BIT_INTERPOLATED & 1) != 0) {
        import->mode = DEVICE_MODE_INTERPOLATED;
        need(import, hears(eds, 0x60C1, 1), "0x60C1:01, the interpolated position, in an RPDO");
    } else {
        char reason[DEVICE_IMPORT_REASON_MAX];
        snprintf(reason, sizeof reason,
                 "0x6502 (supported drive modes) is 0x%llX: neither cyclic synchronous position "
                 "(bit 7) nor interpolated position (bit 6)",
                 (unsigned long long)bits);
        refuse(import, reason);
    }
}

static void judge_needed(const struct eds_file *eds, struct device_import *import)
{
    const struct eds_object *profile = eds_find(eds, 0x1000, 0);
    if (profile != NULL && profile->has_default && profile->default_value != 0 &&
        (profile->default_value & 0xFFFF) != 402) {
        refuse(import, "0x1000 (device type) is not of profile 402: it is no drive");
    }
    need(import, takes(eds, 0x1017, 0, HEARTBEAT_PERIOD_MS), "0x1017, a heartbeat, to be written");
    need(import, takes(eds, 0x1400, 1, 0x201) && eds_find(eds, 0x1600, 1) != NULL, "RPDO1");
    need(import, takes(eds, 0x1401, 1, 0x301) && eds_find(eds, 0x1601, 1) != NULL, "RPDO2");
    need(import, takes(eds, 0x1800, 1, 0x181) && eds_find(eds, 0x1A00, 1) != NULL, "TPDO1");
    need(import, takes(eds, 0x1600, 1, 0x607A0020) && takes(eds, 0x1A00, 1, 0x60410010),
         "PDO mappings that can be written");
    need(import, hears(eds, 0x6040, 0), "0x6040, the controlword, in an RPDO");
    need(import, sends(eds, 0x6041, 0), "0x6041, the statusword, in a TPDO");
    need(import, sends(eds, 0x6064, 0), "0x6064, the position, in a TPDO");
    need(import, takes(eds, 0x6060, 0, 8) && reads(eds, 0x6061, 0), "0x6060 and 0x6061, the mode");
}

static bool has_scaling(const struct eds_file *eds)
{
    static const uint16_t pairs[] = {0x608F, 0x6091, 0x6092};
    for (unsigned i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        if (!reads(eds, pairs[i], 1) || !reads(eds, pairs[i], 2)) {
            return false;
        }
    }
    return true;
}

/* The maker's objects mean what they mean here only if they are called so. */
static bool has_named(const struct eds_file *eds, uint16_t index, const char *name, uint8_t type)
{
    const struct eds_object *object = eds_find(eds, index, 0);
    return object != NULL && object->type == type && sends(eds, index, 0) &&
           strcasecmp(object->name, name) == 0;
}

static void judge_wanted(const struct eds_file *eds, struct device_import *import)
{
    const bool slow = takes(eds, 0x1802, 1, 0x381) && eds_find(eds, 0x1A02, 1) != NULL;
    const struct eds_object *speed = eds_find(eds, 0x6080, 0);
    want(import, reads(eds, 0x6502, 0), DEVICE_LACKS_SUPPORTED_MODES);
    want(import, takes(eds, 0x1400, 5, 50), DEVICE_LACKS_RPDO_TIMER);
    want(import,
         takes(eds, 0x605A, 0, 2) && takes(eds, 0x605B, 0, 1) && takes(eds, 0x605C, 0, 1) &&
             takes(eds, 0x605E, 0, 2),
         DEVICE_LACKS_OPTION_CODES);
    want(import, slow && sends(eds, 0x6079, 0), DEVICE_LACKS_BUS_VOLTAGE);
    want(import, slow && has_named(eds, 0x2100, "Temperature 0.1 degC", TYPE_INTEGER16),
         DEVICE_LACKS_TEMPERATURE);
    want(import, reads(eds, 0x6076, 0), DEVICE_LACKS_RATED_TORQUE);
    want(import, slow && sends(eds, 0x6077, 0), DEVICE_LACKS_TORQUE);
    want(import, has_scaling(eds), DEVICE_LACKS_SCALING);
    want(import, takes(eds, 0x6007, 0, 1), DEVICE_LACKS_ABORT_OPTION);
    want(import, takes(eds, 0x6066, 0, 50), DEVICE_LACKS_FOLLOWING_TIME);
    want(import, takes(eds, 0x6065, 0, 1), DEVICE_LACKS_FOLLOWING_WINDOW);
    want(import, takes(eds, 0x60FE, 2, DRIVE_OUTPUT_LATCH_ARMED), DEVICE_LACKS_OUTPUT_MASK);
    want(import, hears(eds, 0x60FE, 1), DEVICE_LACKS_OUTPUTS);
    want(import, eds->dummy[DUMMY_INTEGER32], DEVICE_LACKS_DUMMY);
    want(import, takes(eds, 0x1016, 1, (int64_t)NODE_CONTROLLER << 16 | HEARTBEAT_TIMEOUT_MS),
         DEVICE_LACKS_HEARTBEAT_CONSUMER);
    want(import, speed != NULL && strcasecmp(speed->name, "Max motor speed counts/s") == 0,
         DEVICE_LACKS_MAX_SPEED);
    want(import, takes(eds, 0x607D, 1, 0) && takes(eds, 0x607D, 2, 1),
         DEVICE_LACKS_POSITION_LIMITS);
    want(import, takes(eds, 0x60C2, 1, 1) && takes(eds, 0x60C2, 2, -3), DEVICE_LACKS_INTERPOLATION);
}

void device_import_judge(const struct eds_file *eds, struct device_import *import)
{
    *import = (struct device_import){.fits = true};
    judge_needed(eds, import);
    choose_mode(eds, import);
    judge_wanted(eds, import);
}
