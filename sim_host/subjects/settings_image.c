#include "sim_host/subjects/settings_image.h"

#include <string.h>

#include "hal/storage/param_store.h"

static void settings_of(struct settings *settings, const struct subject *subject,
                        const struct control_params *params, double desired_speed_rad_s,
                        bool autostart)
{
    memset(settings, 0, sizeof *settings);
    settings->control = *params;
    settings->device = subject->device.description;
    settings->desired_speed_rad_s = (float)desired_speed_rad_s;
    settings->walk_at_start = autostart ? 1u : 0u;
}

static uint32_t bank_words(void *context)
{
    (void)context;
    return SETTINGS_IMAGE_WORDS;
}

static uint8_t *word_of(void *context, uint32_t bank, uint32_t index)
{
    return (uint8_t *)context + (bank * SETTINGS_IMAGE_WORDS + index) * NV_WORD_BYTES;
}

static enum nv_result read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    memcpy(out, word_of(context, bank, index), NV_WORD_BYTES);
    return NV_OK;
}

static enum nv_result erase(void *context, uint32_t bank)
{
    memset(word_of(context, bank, 0), 0xFF, (size_t)SETTINGS_IMAGE_WORDS * NV_WORD_BYTES);
    return NV_OK;
}

static enum nv_result write_word(void *context, uint32_t bank, uint32_t index, const uint8_t *word)
{
    memcpy(word_of(context, bank, index), word, NV_WORD_BYTES);
    return NV_OK;
}

static const uint8_t *map(void *context, uint32_t bank)
{
    return word_of(context, bank, 0);
}

static const struct nv_store_ops image_ops = {bank_words, read_word, map, erase, write_word};

int settings_image(const struct settings *settings, uint8_t image[SETTINGS_IMAGE_BYTES])
{
    const struct nv_store nv = {&image_ops, image};
    struct settings saved = *settings;
    struct param_store store;

    memset(image, 0xFF, SETTINGS_IMAGE_BYTES);
    if (param_store_open(&store, &nv, SETTINGS_VERSION, sizeof(struct settings_record)) !=
        PARAM_STORE_EMPTY) {
        return -1;
    }
    return settings_save(&saved, &store, true) == PARAM_STORE_OK ? 0 : -1;
}

int settings_image_of(const struct subject *subject, const struct control_params *params,
                      double desired_speed_rad_s, bool autostart,
                      uint8_t image[SETTINGS_IMAGE_BYTES])
{
    struct settings settings;
    settings_of(&settings, subject, params, desired_speed_rad_s, autostart);
    return settings_check(&settings) == SETTINGS_OK ? settings_image(&settings, image) : -1;
}
