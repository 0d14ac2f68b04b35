#include "sim_host/cli/output_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int output_file_open(struct output_file *file, const char *path, char *message, size_t size)
{
    struct stat status;
    file->stream = NULL;
    if (strlen(path) >= OUTPUT_PATH_MAX) {
        snprintf(message, size, "output path is too long");
        return -1;
    }
    if (strcmp(path, "-") == 0) {
        snprintf(message, size, "\"-\" names no file: standard output is /dev/stdout");
        return -1;
    }
    if (path[0] == '\0' || path[strlen(path) - 1] == '/') {
        snprintf(message, size, "cannot write \"%s\": that is no file name", path);
        return -1;
    }
    snprintf(file->path, sizeof file->path, "%s", path);
    snprintf(file->temporary, sizeof file->temporary, "%s.%ld.part", path, (long)getpid());
    const bool exists = stat(path, &status) == 0;
    file->direct = exists && !S_ISREG(status.st_mode);
    if (exists && S_ISDIR(status.st_mode)) {
        errno = EISDIR;
    } else if (exists && access(path, W_OK) != 0) {
        /* errno says why: a write-protected file is not replaced either */
    } else {
        /* "x": two outputs under one name would share the temporary file. */
        file->stream =
            fopen(file->direct ? file->path : file->temporary, file->direct ? "w" : "wx");
    }
    if (file->stream == NULL) {
        snprintf(message, size, "cannot write %s: %s", path, strerror(errno));
        return -1;
    }
    return 0;
}

static int complete(struct output_file *file, const char *path, char *message, size_t size)
{
    const bool failed = fflush(file->stream) != 0 || ferror(file->stream) != 0;
    int reason = errno;
    if (fclose(file->stream) != 0 && !failed) {
        reason = errno;
    } else if (!failed) {
        reason = 0;
    }
    file->stream = NULL;
    if (reason == 0 && !file->direct && rename(file->temporary, path) != 0) {
        reason = errno;
    }
    if (reason == 0) {
        return 0;
    }
    if (!file->direct) {
        unlink(file->temporary);
    }
    snprintf(message, size, "cannot write %s: %s", path, strerror(reason));
    return -1;
}

int output_file_commit(struct output_file *file, char *message, size_t size)
{
    return complete(file, file->path, message, size);
}

int output_file_keep_part(struct output_file *file, char *message, size_t size)
{
    char path[OUTPUT_PATH_MAX + OUTPUT_SUFFIX_MAX];
    snprintf(path, sizeof path, "%s%s", file->path, file->direct ? "" : ".part");
    return complete(file, path, message, size);
}

void output_file_discard(struct output_file *file)
{
    if (file->stream == NULL) {
        return;
    }
    fclose(file->stream);
    file->stream = NULL;
    if (!file->direct) {
        unlink(file->temporary);
    }
}
