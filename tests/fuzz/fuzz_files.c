/* Fuzzer: the files that a user gives. The first letter chooses what the rest is: a person, a device, an old
 * subject, a maker's EDS, a recording.
 *
 * What is refused has a reason. A person and a device that are taken are written and read again: the same
 * numbers, and a device that hal/devices takes, too. A recording that is taken ascends in time and is finite. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/devices/device_check.h"
#include "sim_host/devices/device_import.h"
#include "sim_host/plant/recording.h"
#include "sim_host/subjects/old_subject.h"
#include "sim_host/subjects/subject.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int file = -1;
static char path[64];

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    file = memfd_create("input", 0);
    if (file < 0) {
        abort();
    }
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    return 0;
}

static void hold(const void *bytes, size_t size)
{
    if (ftruncate(file, 0) != 0 || pwrite(file, bytes, size, 0) != (ssize_t)size) {
        abort();
    }
}

static void must(bool holds)
{
    if (!holds) {
        abort();
    }
}

/* What a writer makes of it stands in the file then. */
static void hold_written(void (*write)(FILE *stream, const void *what), const void *what)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    must(stream != NULL);
    write(stream, what);
    must(fclose(stream) == 0);
    hold(text, size);
    free(text);
}

static void write_person(FILE *stream, const void *what)
{
    person_write(stream, what);
}

static void read_person(void)
{
    static struct person person, again;
    char message[PERSON_MESSAGE_MAX] = "";
    if (person_read(&person, path, message) != 0) {
        must(message[0] != '\0');
        return;
    }
    hold_written(write_person, &person);
    must(person_read(&again, path, message) == 0);
    must(again.torso_mass_kg == person.torso_mass_kg && again.leg_mass_kg == person.leg_mass_kg &&
         again.leg_length_m == person.leg_length_m && again.gravity_m_s2 == person.gravity_m_s2 &&
         again.speed_rad_s == person.speed_rad_s);
    const struct person_muscles *one = &person.muscles, *two = &again.muscles;
    must(memcmp(&one->gains, &two->gains, sizeof one->gains) == 0 &&
         memcmp(one->strength, two->strength, sizeof one->strength) == 0 &&
         one->noise_percent == two->noise_percent && one->start_speed_m_s == two->start_speed_m_s &&
         one->start_lean_rad == two->start_lean_rad && one->tuned_value == two->tuned_value);
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        must(again.control_overridden[i] == person.control_overridden[i]);
        must(!person.control_overridden[i] ||
             again.control_override[i] == person.control_override[i]);
    }
}

static void write_device(FILE *stream, const void *what)
{
    device_file_write(stream, what);
}

static void read_device(void)
{
    static struct device_file device, again;
    char message[DEVICE_MESSAGE_MAX] = "";
    struct device_refusal refusal;
    if (device_file_read(&device, path, message) != 0) {
        must(message[0] != '\0');
        return;
    }
    must(device_check(&device.description, &refusal) == DEVICE_OK);
    hold_written(write_device, &device);
    must(device_file_read(&again, path, message) == 0);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (int key = 0; key < DEVICE_LEG_COUNT; key++) {
            must(device_file_number(&again, (enum side)leg, (enum device_leg_key)key) ==
                 device_file_number(&device, (enum side)leg, (enum device_leg_key)key));
        }
    }
    must(again.plant_keys == device.plant_keys);
}

static void read_old_subject(void)
{
    static struct old_subject old;
    static struct person person;
    static struct device_file device;
    char message[OLD_SUBJECT_MESSAGE_MAX] = "";
    if (old_subject_read(&old, path, message) != 0) {
        must(message[0] != '\0');
        return;
    }
    old_subject_part(&old, &person, &device);
}

static void read_data_sheet(void)
{
    struct eds_file eds;
    struct device_import import;
    char message[EDS_MESSAGE_MAX] = "";
    if (eds_file_read(&eds, path, message) != 0) {
        must(message[0] != '\0');
        return;
    }
    for (size_t i = 1; i < eds.count; i++) {
        const struct eds_object *low = &eds.objects[i - 1], *high = &eds.objects[i];
        must(low->index < high->index || (low->index == high->index && low->sub < high->sub));
        must(eds_find(&eds, high->index, high->sub) == high);
    }
    device_import_judge(&eds, &import);
    must(import.fits || import.reason[0] != '\0');
    eds_file_free(&eds);
}

static void read_recording(void)
{
    struct recording recording;
    struct recording_format format;
    char message[RECORDING_ERROR_MAX] = "";
    recording_format_default(&format);
    if (recording_load(&recording, path, &format, message) != RECORDING_OK) {
        must(message[0] != '\0' && recording.samples == NULL);
        return;
    }
    must(recording.count >= 2 && recording.samples[0].time_s == 0.0);
    for (size_t i = 0; i < recording.count; i++) {
        const struct recording_sample *sample = &recording.samples[i];
        must(i == 0 || sample->time_s > sample[-1].time_s);
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            must(isfinite(sample->leg_angle_rad[leg]) && isfinite(sample->plantarflexion_rad[leg]));
            must(sample->ankle_m[leg] >= 0.0 && isfinite(sample->ankle_m[leg]));
        }
    }
    recording_free(&recording);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) {
        return 0;
    }
    hold(data + 1, size - 1);
    switch (data[0]) {
    case 'p':
        read_person();
        break;
    case 'd':
        read_device();
        break;
    case 's':
        read_old_subject();
        break;
    case 'e':
        read_data_sheet();
        break;
    default:
        read_recording();
        break;
    }
    return 0;
}
