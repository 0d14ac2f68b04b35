/* What `afo ctl` does with a node, verb by verb. The verbs know a ctl_link and streams, no port and no
 * clock, so that tests run them against the real controller's node on an in-process bus.
 */
#ifndef SIM_HOST_CTL_CTL_H
#define SIM_HOST_CTL_CTL_H

#include <stdbool.h>
#include <stdio.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/ctl/ctl_link.h"
#include "sim_host/ctl/object_list.h"

struct ctl {
    struct ctl_link link;
    struct object_list objects; /* of the node; filled by ctl_open */
    bool json;
    bool all;             /* dump and diff: what is only shown, too */
    unsigned period_ms;   /* watch: between two looks, > 0 */
    unsigned looks;       /* watch: how many; 0 = until the end is asked for */
    unsigned patience_ms; /* walk, stop, reset, zero: how long to wait for it */
    FILE *out;            /* values and answers */
    FILE *complaints;     /* one line each */
};

/* The dictionary of a node by its number alone: the controller's (16), those of the drives and sensors
 * of this bus (1 to 4), else what every node has. */
enum object_list_kind ctl_kind_of_node(uint8_t node);

/* Fills ctl->objects for ctl->link.node. A drive is asked first whether it is the virtual one: a
 * maker's has other objects where that has its own. */
void ctl_open(struct ctl *ctl);

/* A verb. count words follow it. Returns EXIT_GOOD; EXIT_BAD for a refusal, a silent node, a difference,
 * or what did not happen in time; EXIT_USAGE for words that make no sense, with nothing sent. */
typedef enum exit_status (*ctl_verb)(struct ctl *ctl, int count, char **words);

enum exit_status ctl_names(struct ctl *ctl, int count, char **words);
enum exit_status ctl_get(struct ctl *ctl, int count, char **words);
enum exit_status ctl_set(struct ctl *ctl, int count, char **words);
enum exit_status ctl_watch(struct ctl *ctl, int count, char **words);
enum exit_status ctl_dump(struct ctl *ctl, int count, char **words);
enum exit_status ctl_diff(struct ctl *ctl, int count, char **words);
enum exit_status ctl_changes(struct ctl *ctl, int count, char **words);
enum exit_status ctl_save(struct ctl *ctl, int count, char **words);
enum exit_status ctl_walk(struct ctl *ctl, int count, char **words);
enum exit_status ctl_stop(struct ctl *ctl, int count, char **words);
enum exit_status ctl_press(struct ctl *ctl, int count, char **words);
enum exit_status ctl_reset(struct ctl *ctl, int count, char **words);
enum exit_status ctl_zero(struct ctl *ctl, int count, char **words);
enum exit_status ctl_board(struct ctl *ctl, int count, char **words);

/* All verbs by name, with what --help says of them. */
struct ctl_verb_row {
    const char *name;
    ctl_verb run;
    int least_words, most_words; /* most -1: as many as there are */
    const char *words, *summary;
    bool controllers; /* only the controller can do that */
};
extern const struct ctl_verb_row ctl_verbs[];
extern const size_t ctl_verb_count;

/* Runs the verb that words[0] names; count >= 0. Without one, or with one that is none, it complains,
 * names the nearest, and returns EXIT_USAGE. */
enum exit_status ctl_run(struct ctl *ctl, int count, char **words);

/* "afo ctl: " and a line on ctl->complaints. */
void ctl_complain(const struct ctl *ctl, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
