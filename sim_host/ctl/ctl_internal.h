/* What the verbs' files share. */
#ifndef SIM_HOST_CTL_CTL_INTERNAL_H
#define SIM_HOST_CTL_CTL_INTERNAL_H

#include "controller/supervisor/supervisor.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/ctl/ctl.h"

enum { CTL_STATE_INDEX = 0x2001, CTL_STATE_SUB = 1 };
/* The client number under which this program changes parameters (firmware/settings_lock.h). */
enum {
    CTL_UNLOCK_INDEX = 0x2000,
    CTL_UNLOCK_SUB = 5,
    CTL_PARAMETERS_INDEX = 0x2010,
    CTL_CLIENT = 100
};

/* An object known by its address alone, and its entry. */
struct ctl_address_object {
    struct named_object object;
    struct co_entry entry;
};

/* The object at a word like "0x6041" in *room, or NULL: the word is no address. */
struct named_object *ctl_address(const char *word, struct ctl_address_object *room);

/* Marks what a word means. A whole name, the only one with this part behind the point, or the only one
 * that begins so, is one object; the name of a group, or an index without a sub-index, is all of it. Returns 0, or -1 after a complaint. */
int ctl_mark(const struct ctl *ctl, const char *word, bool *is_meant);

/* Which of the objects the words mean (all without words); is_meant: OBJECT_LIST_MAX. Returns 0, or -1 after a complaint. */
int ctl_mark_all(const struct ctl *ctl, int count, char **words, bool *is_meant);

/* Whether a word is an address that the node's dictionary here does not have. */
bool ctl_is_foreign(const struct ctl *ctl, const char *word);

/* Reads the number that the object of this whole name holds. Returns 0, or -1 after a complaint. */
int ctl_read_named(const struct ctl *ctl, const char *name, uint32_t *number);

/* "NAME = VALUE UNIT (NAME OF THE VALUE)". */
void ctl_print_value(const struct ctl *ctl, const struct named_object *object,
                     const struct object_value *value);
void ctl_value_json(struct json_writer *json, const struct named_object *object,
                    const struct object_value *value);

/* The supervisor's state in a value of 0x2001:01, without the bit of the emergency stop. */
static inline enum supervisor_state ctl_state_of(const struct object_value *value)
{
    return (enum supervisor_state)(value->bytes[0] & 0x7Fu);
}

#endif
