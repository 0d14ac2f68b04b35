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

/* Writes the data sheet of a device in its power-on state: every object of both its
 * dictionaries with type, access, limits and default value. Defaults are left out
 * where they are measured or belong to one build. False when the stream failed. */
bool eds_write(FILE *stream, const struct co_device *device, const struct eds_text *text);

#endif
