/* Writes films. The program ffmpeg encodes .mp4, .webm and .gif: it reads a .y4m from a pipe and writes the temporary
   file of the output. */
#include <fixsplat/internal/film.h>

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "src/base/output_internal.h"
#include "src/base/try_internal.h"

enum { WORDS_MOST = 48 };

/* How ffmpeg encodes each format. H.264 and VP9 halve the size of the colour planes. A palette for each frame of a .gif
   needs no second pass. */
static const struct encoder {
    enum fxs_image_format format;
    int even;                      /* 1: width and height must be even */
    const char *words[20];
} encoders[] = {
    {FXS_IMAGE_MP4, 1, {"-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
                        "-f", "mp4"}},
    {FXS_IMAGE_WEBM, 0, {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-deadline", "good",
                         "-cpu-used", "4", "-pix_fmt", "yuv420p", "-f", "webm"}},
    {FXS_IMAGE_GIF, 0, {"-filter_complex", "split[a][b];[a]palettegen=stats_mode=single[p];"
                        "[b][p]paletteuse=new=1:dither=bayer:bayer_scale=3", "-f", "gif"}},
};

struct fxs_film {
    fxs_output output;
    int is_fed;                    /* 1: ffmpeg runs */
    fxs_fed ffmpeg;
    FILE *log;                     /* what ffmpeg says */
};

static const struct encoder *encoder_of(enum fxs_image_format format)
{
    for (size_t i = 0; i < sizeof encoders / sizeof *encoders; i++)
        if (encoders[i].format == format)
            return &encoders[i];
    return NULL;
}

static int check(const char *path, enum fxs_image_format format, int width, int height, const int rate[2],
                 fxs_message *message)
{
    const struct encoder *encoder = encoder_of(format);
    const int is_film = format == FXS_IMAGE_Y4M || format == FXS_IMAGE_RGBA || encoder, is_pipe = !strcmp(path, "-");
    if (is_pipe ? format == FXS_IMAGE_UNKNOWN || encoder : !is_film)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, is_pipe ? "%s: a stream is a .y4m, an .rgba or pictures"
                           : "%s: a film is a .y4m, .rgba, .mp4, .webm or .gif", path);
    if (width < 1 || height < 1 || rate[0] < 1 || rate[1] < 1)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a film of %dx%d and %d/%d frames a second", path, width,
                           height, rate[0], rate[1]);
    return encoder && encoder->even && (width % 2 || height % 2)
               ? fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: an .mp4 needs an even width and height, not %dx%d", path,
                             width, height) : 0;
}

/* Writes an error message with the last line that ffmpeg said. Returns FXS_ERR_FILE. */
static int fail_ffmpeg(fxs_film *film, const char *otherwise, fxs_message *message)
{
    char line[256], last[256];
    snprintf(last, sizeof last, "%s", otherwise);
    rewind(film->log);
    while (fgets(line, sizeof line, film->log)) {
        line[strcspn(line, "\r\n")] = 0;
        if (*line)
            memcpy(last, line, sizeof last);
    }
    return fxs_fail(message, "%s: ffmpeg: %s", film->output.path, last);
}

static int start_ffmpeg(fxs_film *film, const struct encoder *encoder, fxs_message *message)
{
    /* The film's colours, for the decoder and again for the encoder, because a .y4m does not state them. */
    const char *words[WORDS_MOST] = {
        "ffmpeg", "-v", "error", "-y", "-colorspace", "bt709", "-f", "yuv4mpegpipe", "-i", "-",
        "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"};
    char name[4096];
    const char *path = film->output.path, *temporary = fxs_output_lend(&film->output);
    int count = 16;
    if (!temporary)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: ffmpeg writes regular files only: give -o - | ffmpeg -i "
                           "- and its options", path);
    for (int i = 0; encoder->words[i]; i++)
        words[count++] = encoder->words[i];
    const int is_short = snprintf(name, sizeof name, "file:%s", temporary) < (int)sizeof name;
    words[count] = name;
    errno = ENAMETOOLONG;
    const int status = is_short ? fxs_program_feed(words, film->log, &film->ffmpeg) : -1;
    film->is_fed = !status;
    if (!status)
        return 0;
    fxs_output_take_back(&film->output);
    return status == FXS_PROGRAM_MISSING
               ? fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: needs ffmpeg, which is not installed: apt install "
                             "ffmpeg, or write a .y4m (-o - pipes it to another encoder)", path)
               : fail_ffmpeg(film, strerror(errno), message);
}

static int begin(fxs_film *film, enum fxs_image_format format, int width, int height, const int rate[2],
                 fxs_message *message)
{
    const struct encoder *encoder = encoder_of(format);
    char head[96];
    /* unbuffered, because readers of a pipe wait for whole frames */
    setvbuf(film->output.file, NULL, _IONBF, 0);
    if (encoder && !(film->log = fxs_stream_temporary()))
        return fxs_fail(message, "%s: no temporary file: %s", film->output.path, strerror(errno));
    if (encoder)
        FXS_TRY(start_ffmpeg(film, encoder, message));
    snprintf(head, sizeof head, "YUV4MPEG2 W%d H%d F%d:%d Ip A1:1 C444 XCOLORRANGE=LIMITED\n", width, height, rate[0],
             rate[1]);
    if (encoder || format == FXS_IMAGE_Y4M)
        return fxs_film_write(film, &(fxs_encoded){.bytes = (uint8_t *)head, .size = strlen(head)}, message);
    return 0;
}

int fxs_film_open_rate(fxs_film **film, const char *path, enum fxs_image_format format, int width, int height,
                       const int rate[2], fxs_message *message)
{
    fxs_message why;
    *film = NULL;
    FXS_TRY(check(path, format, width, height, rate, message));
    fxs_film *made = *film = calloc(1, sizeof *made);
    int error = made ? fxs_output_open(&made->output, path, 0, message)
                     : fxs_fail_memory(message, path, sizeof *made);
    if (error) {
        free(made);
        *film = NULL;
        return error;
    }
    if ((error = begin(made, format, width, height, rate, message)) != 0) {
        fxs_film_close(made, 0, &why);
        *film = NULL;
    }
    return error;
}

int fxs_film_open(fxs_film **film, const char *path, enum fxs_image_format format, int width, int height, int rate,
                  fxs_message *message)
{
    return fxs_film_open_rate(film, path, format, width, height, (int[2]){rate, 1}, message);
}

/* Waits until ffmpeg has ended. */
static int end_ffmpeg(fxs_film *film, fxs_message *message)
{
    const int status = film->is_fed ? fxs_fed_end(&film->ffmpeg) : 0;
    if (film->is_fed)
        fxs_output_take_back(&film->output);
    film->is_fed = 0;
    return status ? fail_ffmpeg(film, "it failed", message) : 0;
}

int fxs_film_write(fxs_film *film, const fxs_encoded *frame, fxs_message *message)
{
    if (!film->log)
        return fxs_output_write(&film->output, frame->bytes, frame->size, message);
    if (film->is_fed && !fxs_fed_write(&film->ffmpeg, frame->bytes, frame->size))
        return 0;
    const int error = end_ffmpeg(film, message);
    return error ? error : fail_ffmpeg(film, "it ended early", message);
}

int fxs_film_close(fxs_film *film, int complete, fxs_message *message)
{
    fxs_message why;
    if (!film)
        return 0;
    const int failed = end_ffmpeg(film, message);
    if ((!complete || failed) && !film->output.error)
        film->output.error = ECANCELED;
    const int error = fxs_output_close(&film->output, failed ? &why : message);
    if (film->log)
        fclose(film->log);
    free(film);
    return failed ? failed : error;
}
