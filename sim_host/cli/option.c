#include "sim_host/cli/option.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/text/nearest.h"

enum { NAMES_MAX = 128, MESSAGE_MAX = 512 };

/* ---- unknown options, before argp sees them -------------------------------- */

struct known {
    const char *name[NAMES_MAX];
    bool takes_value[NAMES_MAX];
    int key[NAMES_MAX];
    size_t count;
};

static void add(struct known *known, const char *name, bool takes_value, int key)
{
    if (known->count < NAMES_MAX) {
        known->name[known->count] = name;
        known->takes_value[known->count] = takes_value;
        known->key[known->count] = key;
        known->count++;
    }
}

static void add_all(struct known *known, const struct argp_option *option)
{
    for (; option != NULL && (option->name != NULL || option->key != 0 || option->doc != NULL);
         option++) {
        if (option->name != NULL) {
            add(known, option->name,
                option->arg != NULL && (option->flags & OPTION_ARG_OPTIONAL) == 0, option->key);
        }
    }
}

/* A parser's own options and those of its children; ours have no grandchildren. */
static void gather(struct known *known, const struct argp *parser)
{
    add_all(known, parser->options);
    for (const struct argp_child *child = parser->children; child != NULL && child->argp != NULL;
         child++) {
        add_all(known, child->argp->options);
    }
}

/* The option of that name, or the first that begins so, for getopt takes beginnings, too; -1: none. */
static int find(const struct known *known, const char *name, size_t length)
{
    int found = -1;
    for (size_t i = 0; i < known->count; i++) {
        if (strncmp(known->name[i], name, length) == 0 &&
            (found < 0 || known->name[i][length] == '\0')) {
            found = (int)i;
        }
    }
    return found;
}

static bool short_takes_next(const struct known *known, char letter)
{
    for (size_t i = 0; i < known->count; i++) {
        if (known->key[i] == (unsigned char)letter) {
            return known->takes_value[i];
        }
    }
    return false;
}

static void refuse_unknown(const struct known *known, const char *word)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
    const char *best = nearest_name(name, known->name, known->count, sizeof known->name[0]);
    program_complain("no option \"--%s\"%s%s", name, best != NULL ? "; nearest: --" : "",
                     best != NULL ? best : "");
    fprintf(stderr, "Try `%s --help' or `%s --usage' for more information.\n", program_name(),
            program_name());
    exit(EXIT_USAGE);
}

/* The studies' letters of a walker, where the walker is a person and a device. */
static void refuse_letter(const struct known *known, const char *word, size_t length)
{
    const int own = find(known, word, length);
    if (length != 1 || strchr("Mmlkg", word[0]) == NULL || find(known, "person", 6) < 0 ||
        (own >= 0 && known->name[own][1] == '\0')) {
        return;
    }
    program_complain("no option \"--%c\": who walks is said by --person FILE, --device FILE (copy "
                     "sim_host/persons/paper.ini and sim_host/devices/virtual.ini)",
                     word[0]);
    exit(EXIT_USAGE);
}

static void check_names(const struct argp *parser, int argc, char **argv)
{
    static const char *const own[] = {"help", "usage", "version"};
    struct known known = {.count = 0};
    gather(&known, parser);
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++) {
        add(&known, own[i], false, 0);
    }
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        const char *word = argv[i];
        if (strncmp(word, "--", 2) == 0) {
            const size_t length = strcspn(word + 2, "=");
            refuse_letter(&known, word + 2, length);
            const int found = find(&known, word + 2, length);
            if (found < 0) {
                refuse_unknown(&known, word + 2);
            }
            i += known.takes_value[found] && word[2 + length] == '\0' ? 1 : 0;
        } else if (word[0] == '-' && word[1] != '\0') {
            i += word[2] == '\0' && short_takes_next(&known, word[1]) ? 1 : 0;
        }
    }
}

/* ---- parsing --------------------------------------------------------------- */

static void print_version(FILE *stream, struct argp_state *state)
{
    (void)state;
    program_print_version(stream);
}

void option_parse(const struct argp *parser, int argc, char **argv, void *input)
{
    argp_err_exit_status = EXIT_USAGE;
    argp_program_version_hook = print_version;
    check_names(parser, argc, argv);
    if (argp_parse(parser, argc, argv, 0, NULL, input) != 0) {
        exit(EXIT_USAGE);
    }
}

double option_number(struct argp_state *state, const char *option, const char *text, double low,
                     double high)
{
    char *end = NULL;
    errno = 0;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || errno == ERANGE || !isfinite(value)) {
        argp_error(state, "%s: \"%s\" is not a number", option, text);
    }
    if (value < low || value > high) {
        argp_error(state, "%s: %s is out of range, allowed is %g to %g", option, text, low, high);
    }
    return value;
}

uint64_t option_whole(struct argp_state *state, const char *option, const char *text, uint64_t low,
                      uint64_t high)
{
    char *end = NULL;
    errno = 0;
    const unsigned long long value = strtoull(text, &end, 10);
    if (end == text || *end != '\0' || errno == ERANGE || text[0] == '-' || value < low ||
        value > high) {
        argp_error(state, "%s: \"%s\" is not a whole number from %llu to %llu", option, text,
                   (unsigned long long)low, (unsigned long long)high);
    }
    return value;
}

int option_choice(struct argp_state *state, const char *option, const char *text, const void *names,
                  size_t count, size_t stride_bytes)
{
    for (size_t i = 0; i < count; i++) {
        const char *name;
        memcpy(&name, (const char *)names + i * stride_bytes, sizeof name);
        if (strcmp(name, text) == 0) {
            return (int)i;
        }
    }
    char message[MESSAGE_MAX];
    nearest_refuse(text, names, count, stride_bytes, message, sizeof message);
    argp_error(state, "%s: %s", option, message);
    return -1;
}

void option_refuse_argument(struct argp_state *state, const char *text)
{
    argp_error(state, "unexpected argument \"%s\"", text);
}

void option_refuse_subject(struct argp_state *state, const char *path)
{
    argp_error(state,
               "--subject was parted into --person FILE and --device FILE; make both from the old "
               "file: afo device convert %s PERSON.ini DEVICE.ini",
               path);
}
