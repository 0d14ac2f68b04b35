/* afo faults --people: the campaign of people from the command line. */
#ifndef SIM_HOST_FAULTS_PEOPLE_MAIN_H
#define SIM_HOST_FAULTS_PEOPLE_MAIN_H

#include "sim_host/faults/fault_options.h"

/* The exit status. */
int people_main(const struct fault_options *options);

#endif
