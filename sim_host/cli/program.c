#include "sim_host/cli/program.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firmware/version.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/text/nearest.h"

enum { NAME_MAX_BYTES = 64, COMPLAINT_MAX = 2048 };

#define LONG_S 10.0

static char running[NAME_MAX_BYTES] = "afo";
static bool complained_of_output;

const char *program_name(void)
{
    return running;
}

int program_complain(const char *format, ...)
{
    char line[COMPLAINT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    (void)fflush(stdout); /* where both go to one file, lines stay whole and in their order */
    fprintf(stderr, "%s: %s\n", running, line);
    return -1;
}

void program_announce(double seconds, const char *format, ...)
{
    va_list arguments;
    if (seconds < LONG_S) {
        return;
    }
    fprintf(stderr, "%s: ", running);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    if (seconds < 120.0) {
        fprintf(stderr, ", about %.0f s\n", seconds);
    } else if (seconds < 7200.0) {
        fprintf(stderr, ", about %.0f min\n", seconds / 60.0);
    } else {
        fprintf(stderr, ", about %.1f h\n", seconds / 3600.0);
    }
}

void program_command_text(int argc, char *const argv[], char *text, size_t size)
{
    size_t used = 0;
    for (int i = 0; i < argc && used < size; i++) {
        used += (size_t)snprintf(text + used, size - used, "%s%s", i > 0 ? " " : "", argv[i]);
    }
    if (used >= size) { /* no part of a letter is left (UTF-8) */
        size_t lead = size - 1;
        while (lead > 0 && ((unsigned char)text[lead - 1] & 0xC0u) == 0x80u) {
            lead--;
        }
        const unsigned char first = lead > 0 ? (unsigned char)text[lead - 1] : 0u;
        const size_t bytes = first >= 0xF0u ? 4 : first >= 0xE0u ? 3 : first >= 0xC0u ? 2 : 1;
        if (bytes > 1 && size - lead < bytes) {
            text[lead - 1] = '\0';
        }
    }
}

void program_print_version(FILE *stream)
{
    fprintf(stream, "%s %s (build %08x)\n", running, version_text(), (unsigned)version_build_id());
}

/* ---- output ---------------------------------------------------------------- */

int program_output_done(void)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout)) {
        return 0;
    }
    if (!complained_of_output) {
        complained_of_output = true;
        program_complain("cannot write to standard output%s%s", errno != 0 ? ": " : "",
                         errno != 0 ? strerror(errno) : "");
    }
    return -1;
}

static void check_output(void)
{
    if (program_output_done() != 0) {
        _exit(EXIT_USAGE);
    }
}

void program_check_output_at_exit(void)
{
    (void)atexit(check_output);
}

/* ---- the table ------------------------------------------------------------- */

static void print_list(FILE *stream, const struct program_commands *commands)
{
    size_t width = 0;
    for (size_t i = 0; i < commands->count; i++) {
        const size_t length = strlen(commands->table[i].name);
        width = length > width ? length : width;
    }
    fprintf(stream, "Usage: %s %s [OPTION...]\n%s\n\n", running,
            strcmp(commands->what, "study") == 0 ? "STUDY" : "COMMAND", commands->doc);
    for (size_t i = 0; i < commands->count; i++) {
        fprintf(stream, "  %-*s  %s\n", (int)width, commands->table[i].name,
                commands->table[i].summary);
    }
    fprintf(
        stream,
        "\n`%s help NAME' or `%s NAME --help' shows a %s's options, `%s --version' the version.\n"
        "Exit status: 0 yes (walked, equal, found, written, safe), 1 no (fell, stopped by a fault, "
        "differs,\nnot found, unsafe), 2 wrong usage, input or interface, or output that could "
        "not be written.\n",
        running, running, commands->what, running);
}

static int refuse(const struct program_commands *commands, const char *name)
{
    const char *best =
        nearest_name(name, commands->table, commands->count, sizeof commands->table[0]);
    if (best != NULL) {
        program_complain("no %s \"%s\"; nearest: %s", commands->what, name, best);
    } else {
        program_complain("no %s \"%s\"", commands->what, name);
    }
    fprintf(stderr, "Try `%s help' for the list.\n", running);
    return EXIT_USAGE;
}

static int enter(const struct program_command *command, int argc, char **argv)
{
    const size_t used = strlen(running);
    (void)snprintf(running + used, sizeof running - used, " %s", command->name);
    argv[0] = running;
    return command->run(argc, argv);
}

static const struct program_command *find(const struct program_commands *commands, const char *name)
{
    for (size_t i = 0; i < commands->count; i++) {
        if (strcmp(commands->table[i].name, name) == 0) {
            return &commands->table[i];
        }
    }
    return NULL;
}

/* help NAME...: the same as NAME... --help. */
static int help_on(const struct program_commands *commands, int argc, char **argv)
{
    static char option[] = "--help";
    const struct program_command *command = find(commands, argv[0]);
    if (command == NULL) {
        return refuse(commands, argv[0]);
    }
    char **words = (char **)calloc((size_t)argc + 2, sizeof *words);
    if (words == NULL) {
        program_complain("out of memory");
        return EXIT_USAGE;
    }
    memcpy(words, argv, (size_t)argc * sizeof *words);
    words[argc] = option;
    const int status = enter(command, argc + 1, words);
    free(words);
    return status;
}

int program_dispatch(const struct program_commands *commands, int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : NULL;
    if (name == NULL) {
        print_list(stderr, commands);
        return EXIT_USAGE;
    }
    const bool asks = strcmp(name, "help") == 0;
    if (asks && argc > 2 && strcmp(argv[2], "--help") != 0) {
        return help_on(commands, argc - 2, argv + 2);
    }
    if (asks || strcmp(name, "--help") == 0 || strcmp(name, "-?") == 0) {
        print_list(stdout, commands);
        return EXIT_GOOD;
    }
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        program_print_version(stdout);
        return EXIT_GOOD;
    }
    const struct program_command *command = find(commands, name);
    return command != NULL ? enter(command, argc - 1, argv + 1) : refuse(commands, name);
}
