/* Left and right: the index of every per-leg array, and a value in logs. */
#ifndef MODEL_SIDE_H
#define MODEL_SIDE_H

enum side { SIDE_LEFT = 0, SIDE_RIGHT = 1, SIDE_COUNT = 2 };

static inline enum side side_other(enum side side)
{
    return side == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
}

#endif
