#include <fixsplat/image.h>

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/output_internal.h"
#include "src/base/try_internal.h"

struct fxs_film {
    fxs_output output;
};

static int check(const char *path, enum fxs_image_format format, int width, int height, int rate, fxs_message *message)
{
    const int is_film = format == FXS_IMAGE_Y4M || format == FXS_IMAGE_RGBA;
    if (!is_film && (strcmp(path, "-") || format == FXS_IMAGE_UNKNOWN))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a film is a .y4m or an .rgba", path);
    if (width < 1 || height < 1 || rate < 1)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a film of %dx%d and %d frames a second", path, width, height,
                           rate);
    return 0;
}

/* Opens a film without buffering its output, because readers of a pipe wait for whole frames. */
int fxs_film_open(fxs_film **film, const char *path, enum fxs_image_format format, int width, int height, int rate,
                  fxs_message *message)
{
    *film = NULL;
    FXS_TRY(check(path, format, width, height, rate, message));
    fxs_film *made = *film = malloc(sizeof *made);
    const int error = made ? fxs_output_open(&made->output, path, 0, message)
                           : fxs_fail_memory(message, path, sizeof *made);
    if (error) {
        free(made);
        *film = NULL;
        return error;
    }
    setvbuf(made->output.file, NULL, _IONBF, 0);
    if (format == FXS_IMAGE_Y4M)
        fprintf(made->output.file, "YUV4MPEG2 W%d H%d F%d:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n", width, height, rate);
    return 0;
}

int fxs_film_write(fxs_film *film, const fxs_encoded *frame, fxs_message *message)
{
    return fxs_output_write(&film->output, frame->bytes, frame->size, message);
}

int fxs_film_close(fxs_film *film, int complete, fxs_message *message)
{
    if (!film)
        return 0;
    if (!complete && !film->output.error)
        film->output.error = ECANCELED;
    const int error = fxs_output_close(&film->output, message);
    free(film);
    return error;
}
