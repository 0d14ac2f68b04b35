/* What afo pil says of its walk at the end, on standard output. */
#ifndef SIM_HOST_CLI_PIL_REPORT_H
#define SIM_HOST_CLI_PIL_REPORT_H

#include "sim_host/emulator/pil_session.h"

void pil_report_text(const struct pil_session *session, double wall_s);
void pil_report_json(const struct pil_session *session, double wall_s);

#endif
