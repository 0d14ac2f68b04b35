/* e to the x, the same bits on every machine. */
#ifndef SIM_HOST_REFLEX_EXPONENTIAL_H
#define SIM_HOST_REFLEX_EXPONENTIAL_H

/* For x <= 0; above 0 it is 1. Below -700 it is 0. Relative error below 4e-16. Constant cost. */
double exponential(double x);

#endif
