/* The command `laws` of afo study. Plain types: callable from double-compiled code. */
#ifndef SIM_HOST_STUDY_LAWS_LAWS_MAIN_H
#define SIM_HOST_STUDY_LAWS_LAWS_MAIN_H

/* argv[0] is "laws". Returns the exit status: 0 done, 1 failed, 2 usage. */
int laws_main(int argc, char **argv);

#endif
