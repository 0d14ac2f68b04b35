/* A device's keys and refusals in words. */
#ifndef SIM_HOST_DEVICES_DEVICE_TEXT_H
#define SIM_HOST_DEVICES_DEVICE_TEXT_H

#include <stddef.h>

#include "hal/devices/device_check.h"

enum { DEVICE_VALUE_TEXT_MAX = 320 };

/* "left leg", "right leg" or "device" for -1. A static string. */
const char *device_leg_name(int leg);

/* A value as a file has it: a number, a word, words with commas between, or 0x2101:00. */
void device_value_text(const struct device_key *row, double value, char *text, size_t size);

/* Reads it back. Returns 0, or -1 with what is allowed in message. */
int device_value_read(const struct device_key *row, const char *text, double *value, char *message,
                      size_t size);

/* What a verdict says: "is out of range". A static string. */
const char *device_verdict_text(enum device_verdict verdict);

/* Why a description is refused, in one sentence: leg, key, found, allowed, unit. */
void device_refusal_text(const struct device_refusal *refusal, char *message, size_t size);

#endif
