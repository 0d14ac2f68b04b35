/* afo study tune-person and validate-person. argv[0] is the whole name; they return enum exit_status. */
#ifndef SIM_HOST_STUDY_PERSON_COMMANDS_H
#define SIM_HOST_STUDY_PERSON_COMMANDS_H

int tune_person_main(int argc, char **argv);
int validate_person_main(int argc, char **argv);

#endif
