#include "firmware/params_guard.h"

#include <assert.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"

static_assert(PARAMS_GUARD_OWN_BYTES ==
                      sizeof(float) * (CONTROL_PARAM_COUNT + 3 + SPEED_TABLE_MAX) &&
                  sizeof(struct gait_branch) ==
                      sizeof(float) * (5 + GAIT_BRANCH_MAX * (9 + GAIT_BRANCH_COSTS)),
              "the parameters' checksum covers no padding, whose bytes nobody defines");

static size_t covered_bytes(const struct control_params *params)
{
    return PARAMS_GUARD_OWN_BYTES + (params->branch != NULL ? sizeof *params->branch : 0);
}

uint32_t params_guard_crc(const struct control_params *params)
{
    const uint32_t crc = crc32_update(CRC32_INIT, params, PARAMS_GUARD_OWN_BYTES);
    return params->branch != NULL ? crc32_update(crc, params->branch, sizeof *params->branch) : crc;
}

void params_guard_change(struct control_params *params, uint32_t *crc, size_t offset, float value)
{
    float *field = (float *)((char *)params + offset);
    *crc ^= crc32_change(bytes_of_f32(*field) ^ bytes_of_f32(value),
                         covered_bytes(params) - offset - sizeof *field);
    *field = value;
}

/* The next bytes of what the CRC covers, from `at` on: at most `most` of them. */
static const uint8_t *covered(const struct control_params *params, size_t at, size_t most,
                              size_t *count)
{
    const bool own = at < PARAMS_GUARD_OWN_BYTES;
    const uint8_t *bytes = own ? (const uint8_t *)params + at
                               : (const uint8_t *)params->branch + (at - PARAMS_GUARD_OWN_BYTES);
    const size_t left =
        own ? PARAMS_GUARD_OWN_BYTES - at : PARAMS_GUARD_OWN_BYTES + sizeof *params->branch - at;
    *count = left < most ? left : most;
    return bytes;
}

void params_guard_scan(struct params_guard *guard, const struct control_params *params,
                       uint32_t crc)
{
    if (guard->at == 0) {
        guard->so_far = CRC32_INIT;
        guard->expected = crc;
    }
    size_t part;
    const uint8_t *bytes = covered(params, guard->at, PARAMS_GUARD_SCAN_BYTES, &part);
    guard->so_far = crc32_update(guard->so_far, bytes, part);
    guard->at = (uint16_t)(guard->at + part);
    if (guard->at == covered_bytes(params)) {
        guard->at = 0;
        if (guard->expected == crc) {
            guard->corrupt = guard->so_far != guard->expected;
        }
    }
}
