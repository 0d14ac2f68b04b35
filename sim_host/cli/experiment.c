#include "sim_host/cli/experiment.h"

#include <stdio.h>

#include "firmware/version.h"
#include "sim_host/cli/program.h"

void experiment_identity(struct json_writer *json, int argc, char *const *argv)
{
    char build[16];
    (void)snprintf(build, sizeof build, "%08x", (unsigned)version_build_id());
    json_text(json, "program", program_name());
    json_text(json, "version", version_text());
    json_text(json, "build_id", build);
    json_open_list(json, "arguments");
    for (int i = 1; i < argc; i++) {
        json_text(json, NULL, argv[i]);
    }
    json_close_list(json);
}

int experiment_write(const struct output_file *table, int argc, char *const *argv,
                     void (*tell)(struct json_writer *json, const void *context),
                     const void *context, char *message, size_t size)
{
    char path[OUTPUT_PATH_MAX + 8];
    struct output_file file;
    struct json_writer json;
    if (table->direct) {
        return 0;
    }
    (void)snprintf(path, sizeof path, "%s.json", table->path);
    if (output_file_open(&file, path, message, size) != 0) {
        return -1;
    }
    json_begin(&json, file.stream);
    json_open_object(&json, NULL);
    experiment_identity(&json, argc, argv);
    if (tell != NULL) {
        tell(&json, context);
    }
    json_close_object(&json);
    json_end(&json);
    return output_file_commit(&file, message, size);
}

int experiment_commit_table(struct output_file *table, int argc, char *const *argv, char *message,
                            size_t size)
{
    return output_file_commit(table, message, size) != 0
               ? -1
               : experiment_write(table, argc, argv, NULL, NULL, message, size);
}
