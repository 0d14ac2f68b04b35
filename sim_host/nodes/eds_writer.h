/* Electronic data sheets (CiA 306) written from the object dictionaries themselves. */
#ifndef SIM_HOST_NODES_EDS_WRITER_H
#define SIM_HOST_NODES_EDS_WRITER_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/canopen/co_device.h"

struct eds_text {
    const char *file_name; /* as it stands in [FileInfo] */
    const char *description;
};

/* A data sheet describes a type, not one device. So `other` is a second device of the type in its power-on
 * state, with another node number and other settings. What both have alike is a default;
 * what moved with the node number is one relative to $NODEID; all else has none. */
struct eds_subject {
    struct co_device *device, *other;
};

/* Writes the data sheet: every object of all dictionaries with type, access, limits and default
 * value. Defaults are left out where they are measured. False when the stream failed, or a name has
 * a character that the file cannot hold (= ; line end). */
bool eds_write(FILE *stream, const struct eds_subject *subject, const struct eds_text *text);

#endif
