/* afo-study: studies of the return map, a command each. */
#include <string.h>

#include "firmware/version.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/study/laws/laws_main.h"
#include "sim_host/study/observer/commands.h"
#include "sim_host/study/paper/command.h"

static const struct {
    const char *name;
    command_function *run;
    const char *summary;
} commands[] = {
    {"fixed-point", command_fixed_point, "a periodic gait, its eigenvalues and measures"},
    {"continue", command_continue, "follow a gait in a parameter, with folds and period doublings"},
    {"doublings", command_doublings, "the cascade of period doublings (Tables 1 and 2)"},
    {"bifurcation", command_bifurcation, "long runs over r0: periods, chaos, loss of walking"},
    {"basin", command_basin, "where from the walker finds its gait"},
    {"gain", command_gain, "eigenvalues under the step law, and the best gain"},
    {"noise", command_noise, "Monte Carlo: the step law told speeds with errors"},
    {"map", command_map, "iterate the return map from a state"},
    {"laws", laws_main, "the laws that choose the push-off, beside each other"},
    {"observe", command_observe, "how well the controller knows the gait, and what it costs"},
    {"observer-gains", command_observer_gains, "the model observer's gains, as C"},
};

static void print_help(FILE *file)
{
    fprintf(file,
            "Usage: afo-study COMMAND [OPTION...]\n\n"
            "Studies of the ankle-actuated compass gait: the return map from apex to apex.\n\n");
    for (unsigned i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        fprintf(file, "  %-14s %s\n", commands[i].name, commands[i].summary);
    }
    fprintf(file, "\nafo-study COMMAND --help tells of a command's options.\n"
                  "Exit status: 0 found, 1 not found or fallen, 2 usage.\n");
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return EXIT_FOUND;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("afo-study %s\n", version_text());
        return EXIT_FOUND;
    }
    for (unsigned i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (strcmp(argv[1], commands[i].name) == 0) {
            const int status = commands[i].run(argc - 1, argv + 1);
            return output_standard_done("afo-study") == 0 ? status : EXIT_USAGE;
        }
    }
    fprintf(stderr, "afo-study: no command \"%s\"\n\n", argv[1]);
    print_help(stderr);
    return EXIT_USAGE;
}
