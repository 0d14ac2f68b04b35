/* Brings a session's fault, and judges what the image made of it. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_TRIAL_H
#define SIM_HOST_EMULATOR_G474_CHIP_TRIAL_H

#include "sim_host/emulator/g474/chip_session.h"

/* After chip_session_walk. The verdict is chip_session_is_good; session->trouble says what is wrong. */
void chip_trial_run(struct chip_session *session);

#endif
