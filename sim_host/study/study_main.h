/* The whole of build/afo-study behind its main. Plain types: callable from float-compiled code. */
#ifndef SIM_HOST_STUDY_STUDY_MAIN_H
#define SIM_HOST_STUDY_STUDY_MAIN_H

/* Runs the command named in argv[1]. Returns the exit status: 0 found, 1 not found, 2 usage.
 * version: what --version prints. */
int study_main(int argc, char **argv, const char *version);

#endif
