/* The sub-commands of afo, a file each. argv[0] is the whole name ("afo sim"); each returns enum
 * exit_status (sim_host/cli/exit_status.h). */
#ifndef SIM_HOST_PROGRAMS_COMMANDS_H
#define SIM_HOST_PROGRAMS_COMMANDS_H

int afo_sim(int argc, char **argv);
int afo_compare(int argc, char **argv);
int afo_walker(int argc, char **argv);
int afo_host(int argc, char **argv);
int afo_replay(int argc, char **argv);
int afo_blackbox(int argc, char **argv);
int afo_ctl(int argc, char **argv);
int afo_update(int argc, char **argv);
int afo_commission(int argc, char **argv);
int afo_settings(int argc, char **argv);
int afo_device(int argc, char **argv);
int afo_eds(int argc, char **argv);
int afo_study(int argc, char **argv);
int afo_faults(int argc, char **argv);
int afo_soak(int argc, char **argv);
int afo_pil(int argc, char **argv);
int afo_g474(int argc, char **argv);
int afo_slcan(int argc, char **argv);
int afo_size(int argc, char **argv);
int afo_view(int argc, char **argv);
int afo_report(int argc, char **argv);
int afo_import(int argc, char **argv);
int afo_export(int argc, char **argv);

/* Studies that are files here: a table for the controller, maps of points, the paper's page. */
int afo_study_table(int argc, char **argv);
int afo_study_page(int argc, char **argv);
int afo_study_atlas(int argc, char **argv);

#endif
