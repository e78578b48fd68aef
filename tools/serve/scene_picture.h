/* Renders a picture of a scene, from the first view of the viewer's page. */
#ifndef SCENE_PICTURE_H
#define SCENE_PICTURE_H

#include <fixsplat/image.h>
#include <fixsplat/renderer.h>

enum { PICTURE_WIDTH = 1280, PICTURE_HEIGHT = 720, PICTURE_QUALITY = 85 };

/* Renders a scene and encodes the picture as .jpg. `threads` 0: one per processor. Returns 0, or an error code and a
   message. Free `encoded` with fxs_encoded_free. */
int scene_picture(const fxs_opened *opened, int width, int height, const uint8_t background[3], uint32_t threads,
                  fxs_encoded *encoded, fxs_message *message);

#endif
