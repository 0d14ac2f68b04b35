/* The stride of a latch that opens late, with its derivative: what late_gait.h and laws_table.h are made of.
 * Double only.
 */
#ifndef SIM_HOST_GAIT_LATE_STRIDE_H
#define SIM_HOST_GAIT_LATE_STRIDE_H

#include "sim_host/gait/stride_derivative.h"

/* The stride of model/timed_stride.h, and its derivative by the apex and r0 (central differences; the
 * other columns are not written). delay_s 0: stride_differentiate(). Returns the fault. */
enum stride_fault late_gait_differentiate(const struct walker *walker, double delay_s,
                                          const struct apex *from, double spring_rest_m,
                                          struct stride_result *result,
                                          struct stride_derivative *derivative);

#endif
