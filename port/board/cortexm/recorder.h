/* Bus of a display panel that writes to the file ili9341.stream on the host. An event is two bytes: 0 and a command,
 * 1 and a data byte, or 2 and milliseconds to wait. */
#ifndef FXS_RECORDER_H
#define FXS_RECORDER_H

#include "port/board/ili9341.h"

/* Opens the file and fills in the bus. Returns 0 or FXS_ERR_DEVICE. */
int recorder_open(fxs_ili9341_bus *bus);

#endif
