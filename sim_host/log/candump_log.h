/* Logs of CAN frames in the format of can-utils' `candump -L` (and canplayer):
 *
 *     (0000000012.000345) vcan0 181#37160000E803
 *
 * Seconds and microseconds, interface, identifier (3 hex digits, or 8 for a
 * 29-bit one), data; `#R` for a remote frame (with a length digit if not 0).
 * Error frames have an 8-digit identifier with bit 29 set, as Linux prints it.
 * Read are also short seconds, a direction behind the frame (` R`, ` T`), line ends with CR, and the
 * columns that candump prints on the screen with -t a, d or z (their times as they stand there).
 * Facts: can-utils lib.c (snprintf_canframe, parse_canframe) and candump.c.
 */
#ifndef SIM_HOST_LOG_CANDUMP_LOG_H
#define SIM_HOST_LOG_CANDUMP_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/bus/can_frame.h"

enum { CANDUMP_LINE_MAX = 96, CANDUMP_INTERFACE_MAX = 16 };

struct candump_record {
    uint64_t time_us;
    char interface_name[CANDUMP_INTERFACE_MAX];
    struct can_msg message; /* flags as they can be read from a log: never OWN */
};

/* Where and why a line is not a log line. Columns and lines count from 1. */
struct candump_error {
    unsigned long line;
    unsigned column;
    const char *reason; /* static text */
};

/* Writes one line with its newline (no terminating 0) into line, which holds
 * CANDUMP_LINE_MAX bytes. interface_name at most 15 characters. Returns the
 * number of bytes. About 50 ns. */
size_t candump_format(char *line, uint64_t time_us, const char *interface_name,
                      const struct can_msg *message);

/* Reads one line of `length` bytes (with or without newline). What candump or python-can would not
 * have written is refused, and so are CAN FD frames, by their name. Returns true and fills *record, or
 * false and fills error->column and error->reason. */
bool candump_parse(const char *line, size_t length, struct candump_record *record,
                   struct candump_error *error);

/* Appends one frame to a file; false when writing failed (ferror is set). */
bool candump_write(FILE *file, uint64_t time_us, const char *interface_name,
                   const struct can_msg *message);

enum candump_read_result { CANDUMP_RECORD = 1, CANDUMP_END = 0, CANDUMP_BAD = -1 };

/* Reads the next record of an open file, past blank lines; *line_number starts at 0 and counts
 * the lines. CANDUMP_BAD fills *error (also for a read error). */
enum candump_read_result candump_read(FILE *file, unsigned long *line_number,
                                      struct candump_record *record, struct candump_error *error);

#endif
