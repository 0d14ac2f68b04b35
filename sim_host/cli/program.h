/* The running command: its name, its complaints, and the check that all of its output was written. */
#ifndef SIM_HOST_CLI_PROGRAM_H
#define SIM_HOST_CLI_PROGRAM_H

#include <stdio.h>

/* A sub-command. run: argv[0] is the whole name ("afo sim"); returns enum exit_status. */
struct program_command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary; /* one line, for the list of commands */
};

/* A table of them. */
struct program_commands {
    const char *what; /* one of them: "command", "study" */
    const char *doc;  /* what they are, above the list; one paragraph */
    const struct program_command *table;
    size_t count;
};

/* Runs the command that argv[1] names and returns its status. argv[0] is the name up to here ("afo",
 * "afo study"). help, --help and --version are answered here; a name that is none is refused with the
 * nearest. Commands may themselves hold a table. */
int program_dispatch(const struct program_commands *commands, int argc, char **argv);

/* The name of the running command, "afo sim"; "afo" before one was chosen. */
const char *program_name(void);

/* "NAME: ", the message and an end of line, on standard error. Returns -1, for the caller to return. */
int program_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* What a long command is about to do, and how long that takes, on standard error; nothing when it takes
 * less than ten seconds. The estimate is of a processor of 2020 and only says whether to wait. */
void program_announce(double seconds, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The words of a command with spaces between, as whole letters as far as they fit: for people to read. size > 0. */
void program_command_text(int argc, char *const argv[], char *text, size_t size);

/* "NAME VERSION (build ID)" and an end of line. */
void program_print_version(FILE *stream);

/* From here on the end of the process checks that standard output was written, help and versions
 * among it: if not, it complains and ends with EXIT_USAGE. Call once, at the start of main(). */
void program_check_output_at_exit(void);

/* The same check by a command that has more to do, or another output to keep. Returns 0 or -1, and
 * complains once. */
int program_output_done(void);

#endif
