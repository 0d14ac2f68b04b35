#include "firmware/tool_watch.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"

/* Client command specifiers, the upper three bits of the first byte (CiA 301, 7.2.4.3). */
enum { DOWNLOAD_SEGMENT = 0, INITIATE_DOWNLOAD = 1, BLOCK_DOWNLOAD = 6, SDO_BYTES = 8 };
enum { ABORT_CONNECTION_OPTION = 0x6007 }; /* CiA 402-2: what a drive does when it is stopped */

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static bool is_download(unsigned command)
{
    return command == DOWNLOAD_SEGMENT || command == INITIATE_DOWNLOAD || command == BLOCK_DOWNLOAD;
}

void tool_watch_distrust(struct tool_watch *watch, unsigned index, uint16_t changed)
{
    watch->distrusted = (uint8_t)(watch->distrusted | 1u << index);
    if (changed == 0 || changed == ABORT_CONNECTION_OPTION) {
        watch->unstoppable = (uint8_t)(watch->unstoppable | 1u << index);
    }
}

bool tool_watch_receive(struct tool_watch *watch, const struct network *network,
                        const struct bring_up *bring_up, const struct can_msg *message,
                        struct controller_objects *objects)
{
    if (!frame_is_node_request(message->id) || message->length != SDO_BYTES ||
        message->flags != 0) {
        return false; /* no server takes another length */
    }
    const uint8_t node = (uint8_t)(message->id - (uint32_t)FRAME_SDO_REQUEST_BASE);
    const unsigned index = network_index(network, node);
    if (index >= NETWORK_NODES) {
        return false; /* of another device on this bus */
    }
    const unsigned command = (unsigned)message->data[0] >> 5;
    if (!is_download(command)) {
        count(&objects->counters.foreign_uploads);
        return true;
    }
    count(&objects->counters.foreign_downloads);
    if (command == INITIATE_DOWNLOAD ||
        objects->tool_node != node) { /* a segment names no object */
        const bool named = command == INITIATE_DOWNLOAD;
        objects->tool_node = node;
        objects->tool_index = named ? bytes_get_u16(message->data + 1) : 0;
        objects->tool_sub = named ? message->data[3] : 0;
    }
    if (bring_up_is_configured(bring_up, index)) {
        watch->written = (uint8_t)(watch->written | 1u << index);
        tool_watch_distrust(watch, index, objects->tool_index);
    }
    return true;
}

unsigned tool_watch_find_stuck(struct tool_watch *watch, const struct sea_drives *drives,
                               const struct sea_request *request, float leg_length_m)
{
    unsigned stuck = 0;
    for (int leg = 0; leg < SIDE_COUNT && watch->distrusted != 0; leg++) {
        const unsigned node = 1u << (NETWORK_DRIVE_LEFT + (unsigned)leg);
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)leg, &drive);
        const bool behind = (watch->distrusted & node) != 0 && drive.state == DRIVE_ENABLED &&
                            drive.precompression_m - request[leg].precompression_m >
                                TOOL_WATCH_BEHIND_RATIO * leg_length_m;
        if (!behind) {
            watch->behind_ticks[leg] = 0;
        } else if (watch->behind_ticks[leg] < TOOL_WATCH_BEHIND_TICKS) {
            watch->behind_ticks[leg]++;
        } else if ((watch->unstoppable & node) != 0) {
            watch->shut_down = (uint8_t)(watch->shut_down | 1u << leg);
        } else {
            stuck |= 1u << leg;
            watch->behind_ticks[leg] = 0; /* once more if it goes on */
        }
    }
    return stuck;
}

static bool is_off(const struct sea_drives *drives)
{
    bool off = true;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)leg, &drive);
        off = off && (drive.state == DRIVE_DISABLED || drive.state == DRIVE_FAULT);
    }
    return off;
}

void tool_watch_end_tick(struct tool_watch *watch, struct bring_up *bring_up,
                         const struct sea_drives *drives, bool powered)
{
    watch->written = 0;
    if (watch->distrusted != 0 && !powered && is_off(drives)) {
        bring_up->configured = (uint8_t)(bring_up->configured & ~(unsigned)watch->distrusted);
        watch->distrusted = watch->unstoppable = watch->shut_down = 0;
    }
}
