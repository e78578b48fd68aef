/* More functions on films, for the command. */
#ifndef FXS_INTERNAL_FILM_H
#define FXS_INTERNAL_FILM_H

#include <fixsplat/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Begins a film like fxs_film_open, of rate[0] / rate[1] frames a second (each at least 1), such as 24000 / 1001. */
FXS_EXPERIMENTAL int fxs_film_open_rate(fxs_film **film, const char *path, enum fxs_image_format format, int width,
                                        int height, const int rate[2], fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
