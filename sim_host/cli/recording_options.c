#include "sim_host/cli/recording_options.h"

#include <stdio.h>
#include <string.h>

/* A person's other foot lands as early as 0.17 s after the apex, so the fit around
 * it ends sooner than on the paper's walker. */
#define PERSON_APEX_WINDOW_S REAL(0.03)

/* A person walks without the device, too: it joins in after so many steady steps (unless
 * told otherwise), and again after they have stopped. */
#define PERSON_ENGAGE_STEPS REAL(4.0)

const char recording_options_roles[] =
    "time, thigh_l, thigh_r, shank_l, shank_r, ankle_l, ankle_r, contact_l, contact_r";

static char *column_of(struct recording_format *format, const char *role, size_t length)
{
    const struct {
        const char *role;
        char *column;
    } table[] = {
        {"time", format->time_column},
        {"thigh_l", format->thigh_column[SIDE_LEFT]},
        {"thigh_r", format->thigh_column[SIDE_RIGHT]},
        {"shank_l", format->shank_column[SIDE_LEFT]},
        {"shank_r", format->shank_column[SIDE_RIGHT]},
        {"ankle_l", format->ankle_column[SIDE_LEFT]},
        {"ankle_r", format->ankle_column[SIDE_RIGHT]},
        {"contact_l", format->contact_column[SIDE_LEFT]},
        {"contact_r", format->contact_column[SIDE_RIGHT]},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (strlen(table[i].role) == length && strncmp(table[i].role, role, length) == 0) {
            return table[i].column;
        }
    }
    return NULL;
}

bool recording_options_column(struct recording_format *format, const char *text)
{
    const char *equals = strchr(text, '=');
    if (equals == NULL || strlen(equals + 1) >= RECORDING_NAME_MAX) {
        return false;
    }
    char *column = column_of(format, text, (size_t)(equals - text));
    if (column == NULL) {
        return false;
    }
    memcpy(column, equals + 1, strlen(equals + 1) + 1);
    return true;
}

int recording_options_apply(const char *path, const struct recording_format *format, bool open_loop,
                            struct loop_config *config, char *message)
{
    struct control_params *params = &config->params;
    if (strlen(path) >= PLANT_PATH_MAX) {
        snprintf(message, LOOP_MESSAGE_MAX, "the path of the recording is too long");
        return -1;
    }
    config->plant.kind = PLANT_RECORDED_PERSON;
    snprintf(config->plant.recording_path, PLANT_PATH_MAX, "%s", path);
    config->plant.recording_format = *format;
    params->body = (real)BODY_PERSON;
    params->apex_window_s = PERSON_APEX_WINDOW_S;
    if (params->engage_steps == REAL(0.0)) {
        params->engage_steps = PERSON_ENGAGE_STEPS;
    }
    if (!open_loop) {
        params->law = (real)LAW_PERSON;
    }
    return 0;
}
