/* Lists the scene file formats. A new format needs a reader or writer, a row in the table, and a test. */
#include "formats_internal.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/internal/message.h>
#include "src/base/foreign.h"

/* With FXS_TO_PACK, the build only converts scenes to the packed format .fxs. Such a build has no writers of other
   formats. */
#ifdef FXS_TO_PACK
#define WRITE(name) NULL
#define READ_PACKED NULL
#define SAYS(text) NULL
#else
#define WRITE(name) &fxs_write_##name
#define READ_PACKED &fxs_read_fxs
#define SAYS(text) text
#endif

/* The first format that matches a file is chosen. Formats without a magic number therefore come last. */
static const fxs_format_row formats[] = {
    /* Columns of the table of formats: name, file name endings, description, can be read, can be written, highest SH
       degree, stores anti-aliasing, loss when written, stores a distant origin, stores motion, reader, writer. */
    {{"fxs", ".fxs", SAYS("packed: opens at once, and is rendered from the file as it lies"),
      1, 1, 3, 1, SAYS("by its profile"), 1, 1},
     READ_PACKED, NULL},
    {{"compressed ply", ".compressed.ply", SAYS("PlayCanvas's: 16 bytes a Gaussian, and one for each SH coefficient"),
      1, 1, 3, 1, SAYS("positions, scales and rotations have 10 or 11 bits, the rest 8"), 0, 0},
     &fxs_read_compressed_ply, WRITE(compressed_ply)},
    {{"ply", ".ply", SAYS("Inria's (text, floats, halves; 2D Gaussians; moving: Spacetime Gaussians' lite, FTGS)"),
      1, 1, 3, 1, NULL, 1, 0},
     &fxs_read_ply, WRITE(ply)},
    {{"ksplat", ".ksplat", SAYS("of GaussianSplats3D"),
      1, 0, 0, 0, NULL, 0, 0},
     &fxs_read_ksplat, NULL},
    {{"spz", ".spz", SAYS("Niantic's, versions 1 to 4; 3 and 4 are written"),
      1, 1, 3, 1, SAYS("SH have 4 or 5 bits (8 with --spz-fine), positions 24, the rest 8 to 10"), 0, 0},
     &fxs_read_spz, WRITE(spz)},
    {{"rad", ".rad", SAYS("Spark's, its tree of levels too"),
      1, 1, 3, 0, SAYS("SH have 8 bits, colours, opacities and scales 16"), 0, 0},
     &fxs_read_rad, WRITE(rad)},
    {{"lcc2", ".lcc2", SAYS("of XGRIDS, with the .sog files of its tree beside it"),
      1, 0, 0, 0, NULL, 0, 0},
     &fxs_read_lcc2, NULL},
    {{"tileset", "tileset.json", SAYS("3D Tiles of .gltf and .glb, nested ones too: the finest tiles"),
      1, 0, 0, 0, NULL, 0, 0},
     &fxs_read_tileset, NULL},
    {{"gltf", ".glb .gltf", SAYS("glTF with KHR_gaussian_splatting; .glb is written"),
      1, 1, 3, 0, NULL, 1, 0},
     &fxs_read_gltf, WRITE(glb)},
    {{"lcc", ".lcc", SAYS("of XGRIDS, with its index.bin, data.bin, shcoef.bin and environment.bin beside it"),
      1, 0, 0, 0, NULL, 0, 0},
     &fxs_read_lcc, NULL},
    {{"tsog", ".tsog", SAYS("moving, of OpsiClear-4DGS: a .sog whose Gaussians have times"),
      1, 0, 0, 0, NULL, 0, 1},
     &fxs_read_tsog, NULL},
    {{"sog", ".sog lod-meta.json meta.json",
      SAYS("PlayCanvas's, 1 and 2, also streamed: a file, its folder or its index; 2 is written"),
      1, 1, 3, 1, SAYS("positions have 16 bits, the rest 8, SH are of a palette"), 0, 0},
     &fxs_read_sog, WRITE(sog)},
    {{"gsplat", "meta.json", SAYS("of gsplat's PngCompression: its folder of .png and shN.npz"),
      1, 0, 0, 0, NULL, 0, 0},
     &fxs_read_gsplat, NULL},
    {{"splatv", ".splatv", SAYS("of splaTV: Gaussians that move"),
      1, 0, 0, 0, NULL, 0, 1},
     &fxs_read_splatv, NULL},
    {{"streamed sog", "lod-meta.json", SAYS("streamed .sog with its levels of detail, in folders beside it"),
      0, 1, 3, 1, SAYS("as in a .sog"), 0, 0},
     NULL, WRITE(streamed_sog)},
    {{"4dgs", ".4dgs", SAYS("moving, of Avala: the temporal model gaussian-birth"),
      1, 0, 0, 0, NULL, 0, 1},
     &fxs_read_fourdgs, NULL},
    {{"splat4d", ".splat4d", SAYS("moving, of splats4D: frames, each a change of the one before"),
      1, 1, 0, 0, SAYS("no SH above degree 0; steps of 2 % for scales, 1/128 for rotations, 1/51 for opacities"), 0, 1},
     &fxs_read_splat4d, WRITE(splat4d)},
    {{"splat", ".splat", SAYS("32 bytes a Gaussian"),
      1, 1, 0, 0, SAYS("no SH above degree 0, 8 bits for all but positions and scales"), 0, 0},
     &fxs_read_splat, WRITE(splat)},
    {{"csv", ".csv", SAYS("text, a line a Gaussian, columns as in a .ply"),
      0, 1, 3, 0, NULL, 1, 0},
     NULL, WRITE(csv)},
};

enum { FORMATS = sizeof formats / sizeof *formats };

const fxs_scene_format *fxs_scene_format_at(int index)
{
    return index >= 0 && index < FORMATS ? &formats[index].about : NULL;
}

static const char *ending_of(const fxs_scene_format *format, int i, size_t *length)
{
    const char *at = format->endings;
    for (; i > 0 && at; i--)
        at = strchr(at, ' ') ? strchr(at, ' ') + 1 : NULL;
    *length = at ? strcspn(at, " ") : 0;
    return at;
}

/* Returns 1 if a path ends with a format's file name ending, ignoring case. An ending without a dot is a complete file
   name. */
static int ends_so(const char *path, const char *ending, size_t length)
{
    const size_t size = strlen(path);
    if (size < length || strncasecmp(path + size - length, ending, length))
        return 0;
    return *ending == '.' ? size > length : size == length || path[size - length - 1] == '/';
}

const fxs_scene_format *fxs_scene_format_of(const char *path, int to_write)
{
    size_t length;
    for (int f = 0; f < FORMATS; f++) {
        const fxs_scene_format *format = &formats[f].about;
        const char *ending;
        if (to_write ? !format->is_written : !format->is_read)
            continue;
        for (int i = 0; (ending = ending_of(format, i, &length)) != NULL && (i == 0 || !to_write); i++)
            if (ends_so(path, ending, length))
                return format;
    }
    return NULL;
}

static int is_listed(const fxs_scene_format *format, const char *name, size_t length, int to_write)
{
    char path[32];
    snprintf(path, sizeof path, "%.*s", (int)length, name);
    return *name != '.' && fxs_scene_format_of(path, to_write) != format;
}

size_t fxs_scene_format_endings(char *text, size_t size, int to_write)
{
    size_t all = 0, length;
    if (size)
        *text = 0;
    for (int f = 0; f < FORMATS; f++) {
        const fxs_scene_format *format = &formats[f].about;
        const char *ending;
        if (to_write ? !format->is_written : !format->is_read)
            continue;
        for (int i = 0; (ending = ending_of(format, i, &length)) != NULL && (i == 0 || !to_write); i++) {
            const char *comma = all ? ", " : "";
            if (is_listed(format, ending, length, to_write))
                continue;
            if (all < size)
                snprintf(text + all, size - all, "%s%.*s", comma, (int)length, ending);
            all += strlen(comma) + length;
        }
    }
    return all;
}

const fxs_format_row *fxs_format_to_write(const char *name, const char *path)
{
    const fxs_scene_format *by_ending = name ? NULL : fxs_scene_format_of(path, 1);
    for (int f = 0; f < FORMATS; f++)
        if (formats[f].writer && (name ? !strcmp(name, formats[f].about.name) : by_ending == &formats[f].about))
            return &formats[f];
    return NULL;
}

const char *fxs_format_index_name(int number)
{
    size_t length;
    for (int f = 0; f < FORMATS; f++) {
        const char *ending;
        for (int i = 0; formats[f].reader && (ending = ending_of(&formats[f].about, i, &length)) != NULL; i++)
            if (*ending != '.' && number-- == 0)
                return ending;
    }
    return NULL;
}

static const char *first_name(const char *bytes)
{
    static const char blanks[] = " \t\r\n";
    bytes += strspn(bytes, blanks);
    if (*bytes != '{')
        return NULL;
    bytes += 1 + strspn(bytes + 1, blanks);
    return *bytes == '"' ? bytes + 1 : NULL;
}

static size_t mark_of(const char *bytes)
{
    const size_t length = strlen(FXS_UTF8_MARK);
    return !strncmp(bytes, FXS_UTF8_MARK, length) && (first_name(bytes + length) || !strncmp(bytes + length, "ply", 3))
               ? length : 0;
}

int fxs_format_by_content(const fxs_scene_source *source, const fxs_format_row **format, fxs_message *message)
{
    char bytes[4096] = "", endings[256];
    const size_t size = source->input.size < sizeof bytes - 1 ? (size_t)source->input.size : sizeof bytes - 1;
    FXS_TRY(fxs_scene_source_read(source, 0, bytes, size, message));
    const size_t mark = mark_of(bytes);
    const fxs_head head = {source, bytes + mark, size - mark, first_name(bytes + mark)};
    const char *foreign = fxs_foreign(bytes, size);
    for (*format = formats; *format < formats + FORMATS; ++*format) {
        if (foreign && (*format)->reader == &fxs_read_splat)
            return fxs_fail(message, "%s: not a scene file, but %s", source->path, foreign);
        const int is = (*format)->reader ? (*format)->reader->is(&head, message) : 0;
        if (is)
            return is < 0 ? is : 0;
    }
    fxs_scene_format_endings(endings, sizeof endings, 0);
    return fxs_fail(message, "%s: not a scene file of a known format (%s; a .splat: whole records of 32 bytes, finite "
                    "positions and scales)", source->path, endings);
}
