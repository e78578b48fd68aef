/* Bus of a simulated display panel, which writes to the file panel.stream on the host computer. An event in the file
 * is two bytes: 0 and a command, 1 and a data byte, or 2 and milliseconds to wait. */
#ifndef FXS_RECORDER_H
#define FXS_RECORDER_H

#include "port/board/panel.h"

/* Opens the recorded file and fills in the functions of the bus. Returns 0 or FXS_ERR_DEVICE. */
int recorder_open(fxs_panel_bus *bus);

#endif
