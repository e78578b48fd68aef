#include "foreign.h"

#include <string.h>
#include <strings.h>

/* Four bytes at least, so that numbers of a file without a name of its kind are hardly taken for one. */
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
};

/* Beginnings of pages, in letters of either case. */
static const char *const pages[] = {"<!doctype html", "<html", "<head"};

const char *fxs_foreign(const void *bytes, size_t size)
{
    const char *text = bytes, *const end = text + size;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i].at + kinds[i].size <= size && !memcmp(text + kinds[i].at, kinds[i].bytes, kinds[i].size))
            return kinds[i].words;
    while (text < end && *text && strchr(" \t\r\n\xef\xbb\xbf", *text))   /* also the mark of UTF-8 */
        text++;
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if ((size_t)(end - text) >= strlen(pages[i]) && !strncasecmp(text, pages[i], strlen(pages[i])))
            return "an HTML page";
    return NULL;
}
