#include "hal/bus/slcan_channel.h"

#include <string.h>

#include "hal/bus/slcan_rate.h"

enum { OPEN_COMMANDS = 4 }; /* the empty line before them may be answered or not */

const char slcan_open_commands[SLCAN_OPEN_COMMANDS_LENGTH + 1] = {
    '\r', 'C', '\r', 'S', SLCAN_RATE_DIGIT, '\r', 'Z', '0', '\r', 'O', '\r', '\0'};

void slcan_channel_init(struct slcan_channel *channel)
{
    memset(channel, 0, sizeof *channel);
    slcan_decoder_init(&channel->decoder);
    channel->commands_unanswered = OPEN_COMMANDS;
}

bool slcan_channel_sent(struct slcan_channel *channel, uint32_t id)
{
    if (channel->pending_count == SLCAN_PENDING_MAX) {
        return false;
    }
    channel->pending[channel->pending_count++] = (uint16_t)id;
    return true;
}

/* The oldest frame was answered. */
static enum slcan_event retire(struct slcan_channel *channel, enum slcan_event event)
{
    if (channel->pending_count == 0u) {
        return SLCAN_NOTHING;
    }
    channel->answered_id = channel->pending[0];
    channel->pending_count--;
    memmove(&channel->pending[0], &channel->pending[1],
            channel->pending_count * sizeof channel->pending[0]);
    return event;
}

enum slcan_event slcan_channel_receive(struct slcan_channel *channel, char byte)
{
    const enum slcan_event event = slcan_decode(&channel->decoder, byte);
    switch (event) {
    case SLCAN_ACKNOWLEDGED:
        channel->commands_unanswered = 0; /* they came before, or come never */
        return retire(channel, event);
    case SLCAN_REFUSED:
        if (channel->commands_unanswered == 0u) {
            return retire(channel, event);
        }
        channel->commands_unanswered--;
        channel->commands_refused++;
        return SLCAN_DONE;
    case SLCAN_DONE:
        if (channel->commands_unanswered > 0u) {
            channel->commands_unanswered--;
        }
        return event;
    default:
        return event;
    }
}
