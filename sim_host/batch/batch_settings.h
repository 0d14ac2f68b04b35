/* The batch engine's settings and errors: how exactly a stride is computed, and what can go wrong. */
#ifndef SIM_HOST_BATCH_BATCH_SETTINGS_H
#define SIM_HOST_BATCH_BATCH_SETTINGS_H

enum batch_error {
    BATCH_OK = 0,
    BATCH_BAD_ACCURACY = -1, /* outside BATCH_ACCURACY_LOW..HIGH */
    BATCH_BAD_WALKER = -2,   /* a parameter outside model/walker.h's limits */
    BATCH_BAD_INDEX = -3,    /* an item's walker is none of those given */
    BATCH_OUT_OF_MEMORY = -4,
    BATCH_NO_SUCH_VECTORS = -5 /* this processor or build has not that instruction set */
};

/* Largest error of a stride's next apex (rad/s, rad, for the paper's walker) that the settings aim at. */
#define BATCH_ACCURACY_LOW 1e-12
#define BATCH_ACCURACY_HIGH 1e-4
#define BATCH_ACCURACY_DEFAULT 1e-9

struct batch_settings {
    double accuracy; /* BATCH_ACCURACY_LOW..HIGH; 0: the default */
    int want_times;  /* also the double support's duration; costs about a tenth */
    /* Strides from just before one heel strike to just before the next, through the apex. An item's apex[] then
     * holds stance rate, swing angle and swing rate there. The swing angle is 0 to pi/2, the stance angle its negative.
     * Level ground and no derivatives, else the item's fault is STRIDE_BAD_INPUT. */
    int from_strike;
};

#endif
