/* A new program for the image, sent over CAN as `afo update` does it. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_UPDATE_H
#define SIM_HOST_EMULATOR_G474_CHIP_UPDATE_H

#include "sim_host/emulator/g474/chip_session.h"
#include "sim_host/log/sdo_upload.h"

/* Sends what the session's fault says: the image's own program with another version, board or
 * build. `tool` speaks with the image. What goes wrong is the session's trouble; where the image
 * must refuse, that it does not. */
void chip_update_run(struct chip_session *session, struct sdo_upload *tool);

/* Complains unless the program that runs is one that may run now: the old or the new one, after a
 * complete update the new one. */
void chip_update_judge(struct chip_session *session, struct sdo_upload *tool);

#endif
