/* The bus of a panel, written to the file ili9341.stream of the host: two bytes for each byte on the bus, 0 and a
 * command or 1 and data; or 2 and milliseconds. */
#ifndef FXS_RECORDER_H
#define FXS_RECORDER_H

#include "port/board/ili9341.h"

/* Returns 0 or FXS_ERR_DEVICE. */
int recorder_open(fxs_ili9341_bus *bus);

#endif
