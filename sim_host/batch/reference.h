/* Reads and writes strides known in higher precision, as a CSV file: the reference of speed measurements. */
#ifndef SIM_HOST_BATCH_REFERENCE_H
#define SIM_HOST_BATCH_REFERENCE_H

#include <stdio.h>

#include "sim_host/batch/batch.h"

struct reference_stride {
    struct batch_walker walker;
    double apex[3], push_m; /* from */
    double next[3];         /* to */
    double times_s[3];      /* apex to strike, double support, lift-off to apex */
};

#define REFERENCE_HEADING                                                                  \
    "M_kg,m_kg,l_m,k_N_m,g_m_s2,stance_rate,swing_angle,swing_rate,r0_m,"                  \
    "next_stance_rate,next_swing_angle,next_swing_rate,apex_to_strike_s,double_support_s," \
    "lift_off_to_apex_s\n"

/* Reads at most `room` rows. Returns how many; negative when the file cannot be read or a row is not one. */
int reference_read(const char *path, struct reference_stride *rows, int room);

/* Writes one row, every digit of it. */
void reference_write(FILE *file, const struct reference_stride *row);

#endif
