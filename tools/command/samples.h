/* Pictures that are the mean of several renderings (samples): motion blur, and depth of field. */
#ifndef SAMPLES_H
#define SAMPLES_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/camera.h>

/* Codes of 8 bits as light of 16 bits, and back. */
typedef struct light_codes {
    uint16_t light[256];
    uint8_t code[65536];
} light_codes;

/* is_srgb: 1 if the codes are sRGB; 0: light is in proportion to the codes. */
void light_codes_make(light_codes *codes, int is_srgb);

/* Sums of light, for the red, green, blue and alpha of each pixel. */
typedef struct light_sums {
    uint32_t *sums;
    size_t room;
} light_sums;

/* Adds `count` bytes from byte `first` on of sample number `sample` of a picture. Sample 0 starts the sums. */
void light_add(light_sums *sums, const light_codes *codes, const uint8_t *rgba, size_t first, size_t count, int sample);

/* Writes `count` bytes of the mean of `samples` pictures, exactly rounded. */
void light_mean(const light_sums *sums, const light_codes *codes, int samples, size_t first, size_t count,
                uint8_t *rgba);

/* Moves a camera from the middle of a lens to one of `samples` points on it. Points at depth `focus` stay where they
   are in the picture. */
void lens_move(fxs_view *view, double aperture, double focus, int sample, int samples);

#endif
