/* Recognises files that are no scenes, such as archives and images, by their first bytes. */
#include "foreign.h"

#include <string.h>
#include <strings.h>

/* First bytes of many kinds of files. Most signatures have at least four bytes, so random data rarely matches. */
static const struct {
    size_t at, size;
    const char *bytes, *words;
} kinds[] = {
    {0, 18, "version https://gi", "a Git LFS pointer (git lfs pull gets the file that it stands for)"},
    {0, 4, "PK\3\4", "a .zip archive"},
    {0, 4, "PK\5\6", "an empty .zip archive"},
    {0, 3, "\x1f\x8b\x08", "a file compressed by gzip"},
    {4, 6, "1AY&SY", "a file compressed by bzip2"},
    {0, 6, "\xfd" "7zXZ\0", "a file compressed by xz"},
    {0, 4, "\x28\xb5\x2f\xfd", "a file compressed by zstd"},
    {0, 6, "7z\xbc\xaf\x27\x1c", "a .7z archive"},
    {0, 6, "Rar!\x1a\7", "a .rar archive"},
    {257, 5, "ustar", "a .tar archive"},
    {0, 8, "\x89PNG\r\n\x1a\n", "a .png picture"},
    {0, 4, "\xff\xd8\xff\xe0", "a .jpg picture"},
    {0, 4, "\xff\xd8\xff\xe1", "a .jpg picture"},
    {0, 4, "\xff\xd8\xff\xdb", "a .jpg picture"},
    {8, 4, "WEBP", "a .webp picture"},
    {4, 8, "ftypheic", "a .heic picture"},
    {0, 4, "ply\n", "a .ply"},
    {0, 4, "ply\r", "a .ply"},
    {0, 4, "glTF", "a .glb"},
    {0, 4, "NGSP", "an .spz"},
    {0, 4, "FXS1", "an .fxs"},
    {0, 5, "%PDF-", "a .pdf"},
    {0, 4, "LASF", "a .las, " FXS_POINT_CLOUD},
    {0, 8, "ASTM-E57", "an .e57, " FXS_POINT_CLOUD},
    {0, 7, "# .PCD ", "a .pcd, " FXS_POINT_CLOUD},
    {0, 18, "Kaydara FBX Binary", "an .fbx, " FXS_MESH},
    {0, 6, "solid ", "an .stl, " FXS_MESH},
    {0, 8, "PXR-USDC", "a .usdc of OpenUSD"},
};

static const char *const lines[] = {"mtllib ", "usemtl ", "o ", "g ", "v ", "vn ", "vt "};

static const char *const pages[] = {"<!doctype html", "<html", "<head"};

static int begins(const char *line, const char *end, const char *words)
{
    return (size_t)(end - line) >= strlen(words) && !strncasecmp(line, words, strlen(words));
}

/* The file must begin as plain text, because the keywords of .obj meshes are short. */
int fxs_is_obj(const void *bytes, size_t size)
{
    enum { LOOKED_AT = 256 };
    const char *text = bytes, *const end = text + size;
    while (text < end && *text && strchr(" \t\r\n\xef\xbb\xbf", *text))
        text++;
    for (const char *c = text; c < end && c < text + LOOKED_AT; c++)
        if ((unsigned char)*c < ' ' && !strchr("\t\r\n", *c))
            return 0;
    while (text < end && (*text == '#' || *text == '\n' || *text == '\r')) {
        const char *next = memchr(text, '\n', (size_t)(end - text));
        text = next ? next + 1 : end;
    }
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (begins(text, end, lines[i]))
            return 1;
    return 0;
}

int fxs_is_torch(const void *bytes, size_t size)
{
    enum { NAME_LENGTH = 26, NAME = 30 };
    static const char ending[] = "/data.pkl";
    const unsigned char *zip = bytes;
    if (size < NAME || memcmp(zip, "PK\3\4", 4))
        return 0;
    const size_t length = zip[NAME_LENGTH] | (size_t)zip[NAME_LENGTH + 1] << 8, tail = strlen(ending);
    return length >= tail && length <= size - NAME && !memcmp(zip + NAME + length - tail, ending, tail);
}

const char *fxs_foreign(const void *bytes, size_t size)
{
    const char *text = bytes, *const end = text + size;
    if (fxs_is_torch(bytes, size))
        return FXS_NETWORK;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i].at + kinds[i].size <= size && !memcmp(text + kinds[i].at, kinds[i].bytes, kinds[i].size))
            return kinds[i].words;
    while (text < end && *text && strchr(" \t\r\n\xef\xbb\xbf", *text))
        text++;
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if (begins(text, end, pages[i]))
            return "an HTML page";
    return fxs_is_obj(bytes, size) ? "an .obj, " FXS_MESH : NULL;
}
