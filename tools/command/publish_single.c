/* Writes a page as one HTML file with a poster picture. Scripts, WebAssembly and scene are inside as gzip in base64. */
#include "publish_single.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "command.h"
#include "publish_scene.h"
#include "tools/serve/scene_pages.h"
#include "tools/serve/scene_picture.h"
#include "task.h"

#ifdef FXS_WITH_ZLIB
#include <zlib.h>

/* Browsers limit a text to less than 2^29 characters. SCENE_MOST bytes give at most 512,000,000 characters of
   base64. */
enum { SCENE_MOST = 384 * 1000 * 1000, CARRIED_MOST = 256, CARRIED_NAME = 128 };

static void write_base64(FILE *file, const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const unsigned group = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                               (left > 2 ? bytes[i + 2] : 0);
        putc(digits[group >> 18], file);
        putc(digits[group >> 12 & 63], file);
        putc(left > 1 ? digits[group >> 6 & 63] : '=', file);
        putc(left > 2 ? digits[group & 63] : '=', file);
    }
}

static int write_packed(FILE *file, const void *bytes, size_t size)
{
    z_stream stream = {0};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return fail(EXIT_FAILED, "out of memory");
    const size_t room = deflateBound(&stream, (uLong)size);
    unsigned char *out = malloc(room);
    stream.next_in = (Bytef *)(uintptr_t)bytes;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    const int ended = out ? deflate(&stream, Z_FINISH) : Z_MEM_ERROR;
    if (ended == Z_STREAM_END)
        write_base64(file, out, stream.total_out);
    deflateEnd(&stream);
    free(out);
    return ended == Z_STREAM_END ? 0 : fail(EXIT_FAILED, "out of memory");
}

/* True if a file is a script, WebAssembly or style sheet that the page needs. */
static int is_carried(const char *name)
{
    static const char *const endings[] = {".js", ".wasm", ".css"};
    static const char *const left_out[] = {
        "threads.wasm", "import_threads.wasm", "import_core.wasm", "editor.js", "placed.js", "playcanvas.js",
        "three.js", "viewer/edit.js", "viewer/fit.js", "viewer/page.js", "viewer/published.js", "viewer/served.js",
        "viewer/single.js", "viewer/voxels.js"
    };
    int is = 0;
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        is |= ends_with(name, endings[i]);
    for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++)
        is &= strcmp(name, left_out[i]) != 0;
    return is;
}

typedef struct carrier {
    FILE *file;
    const char *package;
    int count;
} carrier;

static int carry_file(carrier *c, const char *name)
{
    char path[TASK_PATH];
    fxs_mapping mapping;
    fxs_message why;
    join_path(path, c->package, name);
    if (fxs_map_open(&mapping, path, &why))
        return fail_for(&why);
    fputs(c->count++ ? ",\n" : "{", c->file);
    write_json_string(c->file, name);
    fputs(": \"", c->file);
    const int status = write_packed(c->file, mapping.data, mapping.bytes);
    putc('"', c->file);
    fxs_map_close(&mapping);
    return status;
}

typedef struct carried {
    const char *inside;
    char names[CARRIED_MOST][CARRIED_NAME];
    int count, fits;
} carried;

static void list_carried(void *argument, const char *file)
{
    carried *list = argument;
    char name[CARRIED_NAME];
    const int length = snprintf(name, sizeof name, "%s%s", list->inside, file);
    if (length >= CARRIED_NAME || !is_carried(name))
        return;
    list->fits &= list->count < CARRIED_MOST;
    if (list->fits)
        strcpy(list->names[list->count++], name);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(a, b);
}

static int carry_folder(carrier *c, const char *inside)
{
    char path[TASK_PATH];
    carried list = {.inside = inside, .fits = 1};
    join_path(path, c->package, inside);
    if (fxs_folder_each(path, list_carried, &list))
        return fail(EXIT_FAILED, "%s: %s", path, strerror(errno));
    if (!list.fits)
        return fail(EXIT_FAILED, "%s: more than %d files", path, CARRIED_MOST);
    qsort(list.names, (size_t)list.count, sizeof *list.names, compare_names);
    int status = 0;
    for (int i = 0; i < list.count && !status; i++)
        status = carry_file(c, list.names[i]);
    return status;
}

static int print_file(FILE *file, const char *package, const char *name, const char *before)
{
    char path[TASK_PATH];
    fxs_mapping mapping;
    fxs_message why;
    join_path(path, package, name);
    if (fxs_map_open(&mapping, path, &why))
        return fail_for(&why);
    fputs(before, file);
    fwrite(mapping.data, 1, mapping.bytes, file);
    fputs("</script>\n", file);
    fxs_map_close(&mapping);
    return 0;
}

static int print_carried(FILE *file, const char *package)
{
    carrier c = {file, package, 0};
    fputs("<script type=\"application/json\" id=\"files\">", file);
    int status = carry_folder(&c, "");
    status = status ? status : carry_folder(&c, "viewer/");
    fputs("}</script>\n", file);
    return status ? status : print_file(file, package, "LICENSE", "<script type=\"text/plain\" id=\"licence\">\n");
}

static int print_scene(FILE *file, const single_page *page, const loaded_scene *scene, const fxs_encoded *poster,
                       const char *frame)
{
    const fxs_sound *sound = &scene->sound;
    print_page_head(file, page->title);
    print_html(file, "<style>\nhtml, body { height: 100%; margin: 0 }\n"
               "fixsplat-viewer { height: 100vh; height: 100dvh }\n</style>\n"
               "<noscript>This page draws with WebAssembly, which needs JavaScript.</noscript>\n"
               "<fixsplat-viewer label=\"%s\" threads=\"1\" background=\"#000000\" poster=\"data:image/jpeg;base64,",
               page->title);
    write_base64(file, poster->bytes, poster->size);
    fprintf(file, "\"%s", frame);
    if (sound->data) {
        fprintf(file, " volume=\"%g\" sound=\"data:%s;base64,", sound->volume, sound->type);
        write_base64(file, sound->data, sound->bytes);
        putc('"', file);
    }
    print_html(file, "></fixsplat-viewer>\n<script type=\"text/plain\" id=\"scene\" data-name=\"%s.fxs\">",
               page->name);
    const int status = write_packed(file, scene->opened->data, scene->opened->bytes);
    fputs("</script>\n", file);
    return status;
}

static int print_page(FILE *file, const single_page *page, const loaded_scene *scene, const fxs_encoded *poster,
                       const char *frame)
{
    int status = print_scene(file, page, scene, poster, frame);
    status = status ? status : print_carried(file, page->package);
    return status ? status : print_file(file, page->package, "viewer/single.js", "<script type=\"module\">\n");
}

/* Copies the HTML page from a temporary file to `out`. A temporary file is used because a stream in memory does not
   report a lack of memory. */
static int write_printed(FILE *file, const char *out, size_t *bytes)
{
    fxs_message why;
    const long size = fflush(file) || ferror(file) ? -1 : ftell(file);
    void *data = size < 0 ? 0 : malloc((size_t)size);
    if (!data || fseek(file, 0, SEEK_SET) || fread(data, 1, (size_t)size, file) != (size_t)size) {
        free(data);
        return fail(EXIT_FAILED, "%s: a temporary file: %s", out, strerror(errno));
    }
    const fxs_encoded whole = {.bytes = data, .size = (size_t)size};
    const int error = fxs_encoded_write(out, &whole, &why);
    free(data);
    *bytes = (size_t)size;
    return error ? fail_for(&why) : 0;
}

static int write_page(const single_page *page, const loaded_scene *scene, const fxs_encoded *poster,
                      const char *frame, const char *out, size_t *bytes)
{
    FILE *file = fxs_stream_temporary();
    if (!file)
        return fail(EXIT_FAILED, "%s: a temporary file: %s", out, strerror(errno));
    int status = print_page(file, page, scene, poster, frame);
    status = status ? status : write_printed(file, out, bytes);
    fclose(file);
    return status;
}

static int write_of_scene(const single_page *page, const frame_options *frame, loaded_scene *scene, const char *out,
                          size_t *bytes)
{
    const int width = frame->width ? frame->width : PICTURE_WIDTH;
    const int height = frame->width ? frame->height : PICTURE_HEIGHT;
    char fitted[POSTER_FRAME];
    fxs_encoded poster;
    fxs_message why;
    publish_frame(fitted, scene->opened, width, height);
    const size_t bytes_inside = scene->opened->bytes + scene->sound.bytes;
    if (bytes_inside > SCENE_MOST)
        return fail(EXIT_FAILED, "%s: %.0f MB packed, and one page takes %d at most: publish a folder", page->scene,
                    (double)bytes_inside * 1e-6, SCENE_MOST / 1000000);
    int status = scene_picture(scene->opened, width, height, frame->render.background, frame->threads, &poster, &why)
               ? fail_for(&why) : 0;
    status = status ? status : write_page(page, scene, &poster, fitted, out, bytes);
    fxs_encoded_free(&poster);
    return status;
}

int write_single(const single_page *page, const frame_options *frame, const char *out, size_t *bytes)
{
    loaded_scene scene;
    if (publish_load(&scene, page->scene, &frame->load, page->has_profile, page->start))
        return EXIT_FAILED;
    if (!page->has_profile)
        publish_say_gain(&scene, page->words);
    int status = write_of_scene(page, frame, &scene, out, bytes);
    status = status ? status : check_scene(&scene);
    free_scene(&scene);
    return status;
}

#else

int write_single(const single_page *page, const frame_options *frame, const char *out, size_t *bytes)
{
    (void)page;
    (void)frame;
    (void)bytes;
    return fail(EXIT_FAILED, "%s: cannot be written: this program was built without zlib", out);
}

#endif
