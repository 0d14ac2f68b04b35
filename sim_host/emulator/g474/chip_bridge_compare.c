/* Frames of the image against those of the host's build. */
#include <string.h>

#include "sim_host/emulator/g474/chip_bridge.h"

enum { EXPECTED_PATIENCE_TICKS = 50 };

static void differ(struct chip_bridge *bridge, const char *how, const struct can_msg *host,
                   const struct can_msg *image)
{
    const struct can_msg *frames[2] = {host, image};
    char text[2][32] = {"none", "none"};

    if (bridge->differences++ > 0) {
        return;
    }
    for (int i = 0; i < 2; i++) {
        int at = frames[i] == NULL
                     ? 0
                     : snprintf(text[i], sizeof text[i], "%03X#", (unsigned)frames[i]->id);
        for (int j = 0; frames[i] != NULL && j < frames[i]->length; j++) {
            at += snprintf(text[i] + at, sizeof text[i] - (size_t)at, "%02X", frames[i]->data[j]);
        }
    }
    snprintf(bridge->first_difference, sizeof bridge->first_difference,
             "tick %u: %s; host %s, image %s", bridge->ticks, how, text[0], text[1]);
}

static void forget_expected(struct chip_bridge *bridge, uint32_t place)
{
    bridge->expected_count--;
    memmove(&bridge->expected[place], &bridge->expected[place + 1],
            (bridge->expected_count - place) * sizeof bridge->expected[0]);
}

void chip_bridge_compare(struct chip_bridge *bridge, const struct can_msg *sent)
{
    struct can_msg image = *sent;

    if (!bridge->comparing) {
        return;
    }
    bridge->compared++;
    if (bridge->compared == bridge->corrupt_frame) {
        image.data[0] ^= 1u;
    }
    for (uint32_t i = 0; i < bridge->expected_count; i++) {
        const struct can_msg host = bridge->expected[i].message;
        if (host.id == image.id) {
            if (host.length != image.length ||
                memcmp(host.data, image.data, sizeof host.data) != 0) {
                differ(bridge, "data differ", &host, &image);
            }
            forget_expected(bridge, i);
            return;
        }
    }
    differ(bridge, "only the image sends", NULL, &image);
}

void chip_bridge_check_missing(struct chip_bridge *bridge)
{
    while (bridge->expected_count > 0 &&
           bridge->ticks - bridge->expected[0].tick > EXPECTED_PATIENCE_TICKS) {
        if (bridge->comparing) {
            differ(bridge, "the image does not send", &bridge->expected[0].message, NULL);
        }
        forget_expected(bridge, 0);
    }
}

void chip_bridge_stop_comparing(struct chip_bridge *bridge)
{
    bridge->comparing = false;
    bridge->expected_count = 0;
}
