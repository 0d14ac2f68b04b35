#include "sim_host/cli/program_output.h"

#include "sim_host/cli/program.h"

enum { MESSAGE_BYTES = OUTPUT_PATH_MAX + 256 };

int program_open_output(struct output_file *file, const char *path)
{
    char message[MESSAGE_BYTES];
    *file = (struct output_file){0};
    return path == NULL || output_file_open(file, path, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

int program_commit_output(struct output_file *file)
{
    char message[MESSAGE_BYTES];
    return file->stream == NULL || output_file_commit(file, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

int program_commit_table(struct output_file *table, int argc, char *const *argv,
                         void (*tell)(struct json_writer *json, const void *context),
                         const void *context)
{
    char message[MESSAGE_BYTES];
    if (table->stream == NULL) {
        return 0;
    }
    return output_file_commit(table, message, sizeof message) == 0 &&
                   experiment_write(table, argc, argv, tell, context, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}
