/* A DBC of all PDOs and the other frames of the orthosis bus, from the frame table and
 * the table of signals below. */
#ifndef SIM_HOST_NODES_DBC_WRITER_H
#define SIM_HOST_NODES_DBC_WRITER_H

#include <stdbool.h>
#include <stdio.h>

/* Writes the DBC. False when the stream failed. Positions are in the drive's own counts
 * (they belong to the subject); everything else in SI units or as the unit says. */
bool dbc_write(FILE *stream);

#endif
