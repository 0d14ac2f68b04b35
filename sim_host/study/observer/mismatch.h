/* Closed-loop walks where walker, ground or sensors differ from the controller's parameters. */
#ifndef SIM_HOST_STUDY_OBSERVER_MISMATCH_H
#define SIM_HOST_STUDY_OBSERVER_MISMATCH_H

/* Prints a table for each law: one row a difference, `steps` steps that count after `settle` and the
 * ramp to the speed. Returns 0, or 1 after a message. */
int mismatch_run(int steps, int settle);

#endif
