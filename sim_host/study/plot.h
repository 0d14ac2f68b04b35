/* --plot FILE of every study: its table, kept in memory beside what it prints, and drawn when it is done.
 *
 * What a study's picture shows is a row of the table in pictures.c, by the names of its columns. A study writes its table
 * to plot_table(), or makes it by report.h, which does that by itself.
 */
#ifndef SIM_HOST_STUDY_PLOT_H
#define SIM_HOST_STUDY_PLOT_H

#include <argp.h>
#include <stdio.h>

/* option_parse() with --plot FILE among the options. A FILE that is no .svg, or that cannot be written, ends the process
 * as any wrong option does, before the study begins. */
void plot_option_parse(const struct argp *parser, int argc, char **argv, void *input);

/* Whether a picture is asked for. */
int plot_is_asked(void);

/* Where the table of `study` goes as comma-separated text, its line of names first; empty fields are numbers that there are
 * not. NULL: no picture is asked for. A second call begins anew. Any thread, one at a time. */
FILE *plot_table(const char *study);

/* Copies what the table has so far, for a study that also writes it to a file. */
void plot_copy_table(FILE *to);

/* What the picture calls a column, in the place of its name. Both texts are kept as they are. */
void plot_name(const char *column, const char *title);

/* Draws and keeps the file. status: the study's; where its table has no row, nothing is written, and standard error says so.
 * Returns the status, or EXIT_USAGE behind a complaint. */
int plot_finish(int status);

#endif
