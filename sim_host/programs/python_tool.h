/* The commands that are Python programs: where their files are, and how this process becomes one. */
#ifndef SIM_HOST_PROGRAMS_PYTHON_TOOL_H
#define SIM_HOST_PROGRAMS_PYTHON_TOOL_H

#include <limits.h>

struct python_tool {
    char program[PATH_MAX]; /* this program */
    char script[PATH_MAX];
    char python[PATH_MAX]; /* AFO_PYTHON, else the tree's own (build/venv), else the system's */
};

/* Finds script `name` of sim_host/ROOM ("view", "formats"): in the tree that this program was built in, or where `make
 * install' puts it. Returns 0, or -1 behind a complaint. */
int python_tool_find(struct python_tool *tool, const char *room, const char *name);

/* Becomes the tool. arguments: ends with NULL; the first two are filled in here. Comes back only behind a complaint. */
void python_tool_become(const struct python_tool *tool, const char **arguments);

#endif
