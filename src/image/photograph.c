/* Reads the EXIF data of photographs with libexif: orientation, exposure, and a name of camera and lens. */
#include "photograph_internal.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/image.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"

#ifdef FXS_WITH_EXIF
#include <libexif/exif-data.h>
#endif

const char fxs_no_memory[] = "out of memory";
#ifdef _WIN32
const char fxs_no_heif[] = "a .heic, which the build for Windows does not read";
#else
const char fxs_no_heif[] = "a .heic, which needs libheif: apt install libheif1"
#ifndef FXS_WITH_HEIF
                           " libheif-dev, and build fixsplat again"
#endif
    ;
#endif

enum fxs_photograph_kind fxs_photograph_kind_of(const char *name)
{
    static const struct {
        const char *ending;
        enum fxs_photograph_kind kind;
    } known[] = {{".png", FXS_PHOTOGRAPH},       {".jpg", FXS_PHOTOGRAPH},       {".jpeg", FXS_PHOTOGRAPH},
                 {".ppm", FXS_PHOTOGRAPH},       {".webp", FXS_PHOTOGRAPH},      {".heic", FXS_PHOTOGRAPH_HEIF},
                 {".heif", FXS_PHOTOGRAPH_HEIF}, {".hif", FXS_PHOTOGRAPH_HEIF}};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && dot > name && i < sizeof known / sizeof *known; i++)
        if (!strcasecmp(dot, known[i].ending))
            return known[i].kind;
    return FXS_PHOTOGRAPH_NONE;
}

void fxs_exif_keep(fxs_exif_bytes *exif, const void *bytes, size_t size)
{
    if (exif->bytes || !(exif->bytes = malloc(size + 1)))
        return;
    memcpy(exif->bytes, bytes, size);
    exif->size = size;
}

#ifdef FXS_WITH_EXIF

/* Parses EXIF bytes without libexif's corrections of non-standard data. Returns NULL if out of memory. */
static ExifData *load(const fxs_exif_bytes *bytes)
{
    ExifData *data = exif_data_new();
    if (data) {
        exif_data_unset_option(data, EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
        exif_data_set_option(data, EXIF_DATA_OPTION_DONT_CHANGE_MAKER_NOTE);
        exif_data_load_data(data, bytes->bytes, (unsigned)bytes->size);
    }
    return data;
}

static double number_of(ExifData *data, ExifIfd ifd, ExifTag tag)
{
    const ExifEntry *entry = exif_content_get_entry(data->ifd[ifd], tag);
    const ExifByteOrder order = exif_data_get_byte_order(data);
    if (!entry || !entry->components || entry->size < exif_format_get_size(entry->format))
        return 0;
    if (entry->format == EXIF_FORMAT_SHORT)
        return exif_get_short(entry->data, order);
    if (entry->format == EXIF_FORMAT_LONG)
        return exif_get_long(entry->data, order);
    if (entry->format != EXIF_FORMAT_RATIONAL)
        return 0;
    const ExifRational r = exif_get_rational(entry->data, order);
    return r.denominator ? (double)r.numerator / (double)r.denominator : 0;
}

static void say_text(ExifData *data, ExifTag tag, char text[40])
{
    const ExifEntry *entry = exif_content_get_entry(data->ifd[EXIF_IFD_0], tag);
    size_t length = 0;
    if (entry && entry->format == EXIF_FORMAT_ASCII)
        for (size_t i = 0; i < entry->size && entry->data[i] && length < 39; i++)
            if (entry->data[i] >= ' ' && entry->data[i] < 127)
                text[length++] = (char)entry->data[i];
    text[length] = 0;
}

void fxs_exif_parse(const fxs_exif_bytes *bytes, fxs_exif *exif)
{
    ExifData *data = bytes->bytes ? load(bytes) : NULL;
    char maker[40], model[40];
    memset(exif, 0, sizeof *exif);
    exif->orientation = 1;
    if (!data)
        return;
    const double orientation = number_of(data, EXIF_IFD_0, EXIF_TAG_ORIENTATION);
    const double seconds = number_of(data, EXIF_IFD_EXIF, EXIF_TAG_EXPOSURE_TIME);
    const double aperture = number_of(data, EXIF_IFD_EXIF, EXIF_TAG_FNUMBER);
    const double sensitivity = number_of(data, EXIF_IFD_EXIF, EXIF_TAG_ISO_SPEED_RATINGS);
    if (!bytes->is_upright && orientation >= 1 && orientation <= 8)
        exif->orientation = (int)orientation;
    /* A sensitivity of 65535 means that the value does not fit the EXIF field. */
    if (seconds > 1e-6 && seconds < 1e5 && aperture > 0.1 && aperture < 1e3 && sensitivity > 0 && sensitivity < 65535)
        exif->exposure = seconds * sensitivity / (aperture * aperture);
    say_text(data, EXIF_TAG_MAKE, maker);
    say_text(data, EXIF_TAG_MODEL, model);
    snprintf(exif->lens, sizeof exif->lens, "%s %s %.3f %.3f", maker, model,
             number_of(data, EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH),
             number_of(data, EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM));
    exif_data_unref(data);
}

void fxs_exif_set_upright(fxs_exif_bytes *bytes)
{
    enum { SEGMENT = 65533 };
    ExifData *data = bytes->bytes ? load(bytes) : NULL;
    unsigned char *saved = NULL;
    unsigned size = 0;
    if (data) {
        ExifEntry *entry = exif_content_get_entry(data->ifd[EXIF_IFD_0], EXIF_TAG_ORIENTATION);
        if (entry && entry->format == EXIF_FORMAT_SHORT && entry->size >= 2)
            exif_set_short(entry->data, exif_data_get_byte_order(data), 1);
        else if (entry)
            exif_content_remove_entry(data->ifd[EXIF_IFD_0], entry);
        free(data->data);
        data->data = NULL;
        data->size = 0;
        exif_data_save_data(data, &saved, &size);
        exif_data_unref(data);
    }
    free(bytes->bytes);
    const int fits = saved && size <= SEGMENT;
    if (!fits)
        free(saved);
    bytes->bytes = fits ? saved : NULL;
    bytes->size = fits ? size : 0;
}

#else

void fxs_exif_parse(const fxs_exif_bytes *bytes, fxs_exif *exif)
{
    (void)bytes;
    memset(exif, 0, sizeof *exif);
    exif->orientation = 1;
}

void fxs_exif_set_upright(fxs_exif_bytes *bytes)
{
    free(bytes->bytes);
    bytes->bytes = NULL;
}

#endif

int fxs_photograph_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif *exif, fxs_message *message)
{
    fxs_exif_bytes bytes = {NULL, 0, 0};
    const int error = fxs_photograph_read_bytes(path, rgba, width, height, &bytes, message);
    fxs_exif_parse(&bytes, exif);
    free(bytes.bytes);
    return error;
}
