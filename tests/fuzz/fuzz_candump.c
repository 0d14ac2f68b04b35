/* Fuzzer: what the log reader takes is the same when it is written and read again; what it refuses has
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
    struct candump_record again;
    const size_t length =
        candump_format(back, record.time_us, record.interface_name, &record.message);
    if (!candump_parse(back, length, &again, &error) || again.time_us != record.time_us ||
        strcmp(again.interface_name, record.interface_name) != 0 ||
        memcmp(&again.message, &record.message, sizeof again.message) != 0) {
        abort();
    }
    return 0;
}
