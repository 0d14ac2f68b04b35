/* afo size: what an actuator has to bear over cadence, and what limits it. */
#ifndef SIM_HOST_STUDY_SIZE_SIZE_MAIN_H
#define SIM_HOST_STUDY_SIZE_SIZE_MAIN_H

int size_main(int argc, char **argv);

#endif
