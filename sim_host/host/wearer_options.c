#include "sim_host/host/wearer_options.h"

#include <string.h>

const char wearer_options_roles[] =
    "time, thigh_l, thigh_r, shank_l, shank_r, ankle_l, ankle_r, contact_l, contact_r";

static char *column_of(struct wearer_format *format, const char *role, size_t length)
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

bool wearer_options_column(struct wearer_format *format, const char *text)
{
    const char *equals = strchr(text, '=');
    if (equals == NULL || strlen(equals + 1) >= WEARER_NAME_MAX) {
        return false;
    }
    char *column = column_of(format, text, (size_t)(equals - text));
    if (column == NULL) {
        return false;
    }
    memcpy(column, equals + 1, strlen(equals + 1) + 1);
    return true;
}
