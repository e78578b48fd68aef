/* Renders a picture of an open scene from the start view of the viewer's page. */
#ifndef SCENE_PICTURE_H
#define SCENE_PICTURE_H

#include <fixsplat/image.h>
#include <fixsplat/renderer.h>

enum { PICTURE_WIDTH = 1280, PICTURE_HEIGHT = 720, PICTURE_QUALITY = 85 };

/* Encodes the picture as .jpg. `threads` 0: one for each processor; `background`: red, green, blue. Returns 0 and an
   `encoded` for fxs_encoded_free, or an error and a message. */
int scene_picture(const fxs_opened *opened, int width, int height, const uint8_t background[3], uint32_t threads,
                  fxs_encoded *encoded, fxs_message *message);

#endif
