/* What afo g474 tells at its end. */
#ifndef SIM_HOST_CLI_G474_REPORT_H
#define SIM_HOST_CLI_G474_REPORT_H

#include "sim_host/emulator/g474/chip_session.h"

/* One JSON object on standard output. wall_s: how long it took. */
void g474_report_json(const struct chip_session *session, double wall_s);
/* The same for a reader. */
void g474_report_text(const struct chip_session *session, double wall_s);

#endif
