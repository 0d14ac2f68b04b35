#include "sim_host/programs/python_tool.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/cli/program.h"

enum { ROOM_PATH_MAX = 64 };

static bool is_there(char *path, const char *folder, const char *rest, const char *name)
{
    return (size_t)snprintf(path, PATH_MAX, "%s/%s%s", folder, rest, name) < PATH_MAX &&
           access(path, R_OK) == 0;
}

/* The folder of this program, without a slash at the end. */
static bool find_folder(struct python_tool *tool, char *folder)
{
    const ssize_t length = readlink("/proc/self/exe", tool->program, sizeof tool->program - 1);
    if (length <= 0) {
        return false;
    }
    tool->program[length] = '\0';
    memcpy(folder, tool->program, (size_t)length + 1);
    char *slash = strrchr(folder, '/');
    *(slash != NULL ? slash : folder) = '\0';
    return true;
}

int python_tool_find(struct python_tool *tool, const char *room, const char *name)
{
    static const char *const up[] = {"/..", "/../..", "/../../.."};
    char folder[PATH_MAX], base[PATH_MAX], python[PATH_MAX], in_tree[ROOM_PATH_MAX],
        installed[ROOM_PATH_MAX];
    snprintf(in_tree, sizeof in_tree, "sim_host/%s/", room);
    snprintf(installed, sizeof installed, "../share/afo/%s/", room);
    if (!find_folder(tool, folder)) {
        return program_complain("/proc/self/exe: %s", strerror(errno));
    }
    const char *chosen = getenv("AFO_PYTHON");
    snprintf(tool->python, sizeof tool->python, "%s", chosen != NULL ? chosen : "/usr/bin/python3");
    for (size_t i = 0; i < sizeof up / sizeof up[0]; i++) {
        const bool fits = (size_t)snprintf(base, sizeof base, "%s%s", folder, up[i]) < sizeof base;
        if (fits && is_there(tool->script, base, in_tree, name)) {
            if (chosen == NULL && is_there(python, base, "build/venv/bin/", "python")) {
                memcpy(tool->python, python, sizeof python);
            }
            return 0;
        }
    }
    if (is_there(tool->script, folder, installed, name)) {
        return 0;
    }
    return program_complain("%s is neither in sim_host/%s of a tree around %s nor in "
                            "%s/../share/afo/%s: `make install' puts it there",
                            name, room, folder, folder, room);
}

void python_tool_become(const struct python_tool *tool, const char **arguments)
{
    arguments[0] = tool->python;
    arguments[1] = tool->script;
    fflush(stdout);
    char *const *words;
    memcpy(&words, &arguments,
           sizeof words); /* execv() changes none of them, and its type cannot say so */
    execv(tool->python, words);
    program_complain("%s: %s; install it: sudo apt-get install python3", tool->python,
                     strerror(errno));
}
