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

int experiment_begin(struct experiment *experiment, const struct output_file *table, int argc,
                     char *const *argv, char *message, size_t size)
{
    char path[OUTPUT_PATH_MAX + 8];
    experiment->file.stream = NULL;
    if (table->direct) {
        return 0;
    }
    (void)snprintf(path, sizeof path, "%s.json", table->path);
    if (output_file_open(&experiment->file, path, message, size) != 0) {
        return -1;
    }
    json_begin(&experiment->json, experiment->file.stream);
    json_open_object(&experiment->json, NULL);
    experiment_identity(&experiment->json, argc, argv);
    return 0;
}

int experiment_commit(struct experiment *experiment, char *message, size_t size)
{
    if (experiment->file.stream == NULL) {
        return 0;
    }
    json_close_object(&experiment->json);
    json_end(&experiment->json);
    return output_file_commit(&experiment->file, message, size);
}

int experiment_commit_table(struct output_file *table, int argc, char *const *argv, char *message,
                            size_t size)
{
    struct experiment experiment;
    if (output_file_commit(table, message, size) != 0 ||
        experiment_begin(&experiment, table, argc, argv, message, size) != 0) {
        return -1;
    }
    return experiment_commit(&experiment, message, size);
}
