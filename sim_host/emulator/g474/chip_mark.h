/* Marks that a tool writes while the image walks, and the pulses that PA1 gives for them. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_MARK_H
#define SIM_HOST_EMULATOR_G474_CHIP_MARK_H

#include "sim_host/emulator/g474/chip_session.h"
#include "sim_host/log/sdo_upload.h"

/* Writes marks at times spread over the tick, and notes in session->marks how long after the end of
 * the mark's frame the line rises, and how long it stays high. Complains of a mark without its pulse, of
 * one that comes later than a tick, and of one whose length is wrong. */
void chip_mark_run(struct chip_session *session, struct sdo_upload *tool);

#endif
