/* Fuzzer: what the log reader takes, the writer gives back unchanged; what it refuses has
 * a column within the line. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/log/candump_log.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct candump_record record;
    struct candump_error error = {0};
    const char *line = (const char *)data;
    if (!candump_parse(line, size, &record, &error)) {
        if (error.reason == NULL || error.column < 1 || error.column > size + 1) {
            abort();
        }
        return 0;
    }
    char back[CANDUMP_LINE_MAX];
    size_t length = candump_format(back, record.time_us, record.interface_name, &record.message);
    length -= line[size - 1] == '\n' ? 0 : 1; /* the writer always ends the line */
    /* Seconds may have been written with more than ten digits. */
    const char *frame_in = memchr(line, ')', size);
    const char *frame_out = memchr(back, ')', length);
    const size_t left_in = (size_t)(line + size - frame_in);
    const size_t left_out = (size_t)(back + length - frame_out);
    if (left_in != left_out || memcmp(frame_in, frame_out, left_in) != 0) {
        abort();
    }
    return 0;
}
