#include "sim_host/batch/reference.h"

#include <stdlib.h>

#define NUMBERS 15
#define LINE_ROOM 1000

static void numbers_of(struct reference_stride *row, double *number[NUMBERS])
{
    double *const all[NUMBERS] = {&row->walker.hip_mass_kg,
                                  &row->walker.leg_mass_kg,
                                  &row->walker.leg_length_m,
                                  &row->walker.ankle_stiffness_N_m,
                                  &row->walker.gravity_m_s2,
                                  &row->apex[0],
                                  &row->apex[1],
                                  &row->apex[2],
                                  &row->push_m,
                                  &row->next[0],
                                  &row->next[1],
                                  &row->next[2],
                                  &row->times_s[0],
                                  &row->times_s[1],
                                  &row->times_s[2]};
    for (int i = 0; i < NUMBERS; i++) {
        number[i] = all[i];
    }
}

static int parse(const char *line, struct reference_stride *row)
{
    double *number[NUMBERS];
    numbers_of(row, number);
    for (int i = 0; i < NUMBERS; i++) {
        char *end;
        *number[i] = strtod(line, &end);
        if (end == line || (i + 1 < NUMBERS && *end != ',')) {
            return 0;
        }
        line = end + 1;
    }
    return 1;
}

int reference_read(const char *path, struct reference_stride *rows, int room)
{
    char line[LINE_ROOM];
    int count = 0;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return -1;
    }
    if (fgets(line, LINE_ROOM, file) == NULL) {
        count = -1;
    }
    while (count >= 0 && count < room && fgets(line, LINE_ROOM, file) != NULL) {
        count = parse(line, &rows[count]) ? count + 1 : -1;
    }
    fclose(file);
    return count;
}

void reference_write(FILE *file, const struct reference_stride *row)
{
    struct reference_stride copy = *row;
    double *number[NUMBERS];
    numbers_of(&copy, number);
    for (int i = 0; i < NUMBERS; i++) {
        fprintf(file, "%.17g%c", *number[i], i + 1 < NUMBERS ? ',' : '\n');
    }
}
