/* The commands of afo study that walk in closed loop. They see the controller in its own
 * precision; the caller is compiled for the other, so only plain types pass. */
#ifndef SIM_HOST_STUDY_OBSERVER_COMMANDS_H
#define SIM_HOST_STUDY_OBSERVER_COMMANDS_H

/* Each runs one command, argv[0] being its name, and returns the exit status. */
int command_observe(int argc, char **argv);
int command_observer_gains(int argc, char **argv);

#endif
