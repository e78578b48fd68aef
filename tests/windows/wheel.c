/* wheel DLL SCENE CAMERAS DECLARATIONS: calls the library as the Python package does. Draws a scene, and prints the
   called functions and the picture's hash. Writes the library's C declarations to the file DECLARATIONS. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#include <fixsplat/backend.h>
#include <fixsplat/camera.h>
#include <fixsplat/renderer.h>
#include <fixsplat/system.h>
#include <fixsplat/world.h>
#include <fixsplat/internal/declarations.h>

static HMODULE library;

static FARPROC found(const char *name)
{
    const FARPROC function = GetProcAddress(library, name);
    puts(name);
    if (function)
        return function;
    fprintf(stderr, "%s: not in the library\n", name);
    exit(1);
}

#define CALL(name) ((__typeof__(&name))(void (*)(void))found(#name))

static void must(long result, const fxs_message *message)
{
    if (result >= 0)
        return;
    fprintf(stderr, "%s\n", message->text);
    exit(1);
}

static int go_on(void *argument, double done)
{
    (void)argument;
    return !(done >= 0 && done <= 1);
}

static uint64_t fnv1a64(const uint8_t *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

static int write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    const int result = file && fputs(text, file) >= 0 ? 0 : -1;
    return file && !fclose(file) ? result : -1;
}

static void draw(const fxs_object *object, const fxs_camera *camera, fxs_targets *targets)
{
    fxs_message message;
    fxs_request request = {.objects = object, .count = 1, .eyes = 1, .cameras = {*camera}, .targets = {*targets}};
    request.options.sh_degree = 3;
    const fxs_backend *table = CALL(fxs_backend_find)("auto");
    const fxs_backend_options options = {.size = sizeof(fxs_backend_options), .threads = 1};
    void *handle;
    must(table ? table->open(&handle, &options, &message) : -1, &message);
    must(table->render(handle, &request, NULL, &message), &message);
    table->close(handle);
}

int main(int argc, char **argv)
{
    fxs_message message = {.text = "not found"};
    fxs_open_options options = {.size = sizeof(fxs_open_options), .file.progress = go_on, .progress.call = go_on};
    fxs_opened *opened;
    fxs_view *views;
    fxs_placement placement;
    fxs_object object;
    fxs_crop crops[FXS_MAX_CROPS];
    fxs_camera camera;
    if (argc != 5 || !(library = LoadLibraryA(argv[1])))
        return 1;
    must(CALL(fxs_version)() == FXS_VERSION_NUMBER ? 0 : -1, &message);
    must(write_text(argv[4], CALL(fxs_declarations)()), &message);
    CALL(fxs_map_guard)();
    must(CALL(fxs_open)(argv[2], &options, &opened, &message), &message);
    void (*const close)(fxs_opened *) = CALL(fxs_close);
    must(CALL(fxs_camera_file_read)(argv[3], &views, &message), &message);
    const fxs_view view = views[0];
    CALL(fxs_release)(NULL, views);
    CALL(fxs_placement_init)(&placement, 0, 0);
    must(CALL(fxs_object_place)(&object, opened->scene, &placement, crops, &message), &message);
    must(CALL(fxs_camera_from_view)(&camera, &view, &message), &message);
    const size_t stride = (size_t)view.width * 4, bytes = stride * (size_t)view.height;
    uint8_t *pixels = malloc(bytes);
    fxs_targets targets = {.size = sizeof(fxs_targets), .colour = {.pixels = pixels, .stride = stride},
                           .format = FXS_FORMAT_RGBA8};
    if (!pixels)
        return 1;
    draw(&object, &camera, &targets);
    must(CALL(fxs_opened_check)(opened, &message), &message);
    printf("%016" PRIx64 "\n", fnv1a64(pixels, bytes));
    close(opened);
    free(pixels);
    return 0;
}
