#include "photograph_internal.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/internal/message.h>
#include "src/base/output_internal.h"
#include "png_internal.h"
#include "src/base/try_internal.h"

/* Writes a .jpg with EXIF: inserts an APP1 segment after its start marker. */
static int write_jpg(const char *path, const fxs_encoded *jpg, const fxs_exif_bytes *exif, fxs_message *message)
{
    fxs_output output;
    const uint8_t head[4] = {0xff, 0xe1, (uint8_t)((exif->size + 2) >> 8), (uint8_t)(exif->size + 2)};
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    fxs_output_write(&output, jpg->bytes, 2, message);
    if (exif->bytes) {
        fxs_output_write(&output, head, sizeof head, message);
        fxs_output_write(&output, exif->bytes, exif->size, message);
    }
    fxs_output_write(&output, jpg->bytes + 2, jpg->size - 2, message);
    return fxs_output_close(&output, message);
}

int fxs_photograph_to_jpg(const char *from, const char *to, fxs_message *message)
{
    uint8_t *rgba;
    int width, height;
    fxs_exif_bytes exif = {NULL, 0, 0};
    fxs_encoded jpg = {NULL, 0, NULL, 0};
    int error = fxs_photograph_read_bytes(from, &rgba, &width, &height, &exif, message);
    if (!error && !fxs_image_opaque(rgba, (size_t)width * (size_t)height))
        error = fxs_fail(message, "%s: transparent, which a .jpg cannot be: make it a .png", from);
    if (!error)
        error = fxs_image_encode(FXS_IMAGE_JPG, 98, rgba, width, height, &jpg, message);
    free(rgba);
    fxs_exif_set_upright(&exif);
    if (!error)
        error = write_jpg(to, &jpg, &exif, message);
    fxs_encoded_free(&jpg);
    free(exif.bytes);
    return error;
}
