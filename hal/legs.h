/* Index of per-leg arrays in hal/; the same values as model/'s enum side. */
#ifndef HAL_LEGS_H
#define HAL_LEGS_H

enum leg { LEG_LEFT = 0, LEG_RIGHT = 1, LEG_COUNT = 2 };

#endif
