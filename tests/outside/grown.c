/* grown: a program that uses the library's structs whose first field is their size. Prints hashes of two pictures and
 * of a packed scene. tests/scripts/grown.sh also builds it with headers in which these structs are shorter. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>

enum { COUNT = 600, WIDTH = 96, HEIGHT = 64 };

static uint64_t hash = 14695981039346656037u;

static void add(const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 1099511628211u;
}

static long make(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)argument;
    const size_t left = COUNT - (size_t)first, count = left < capacity ? left : capacity;
    for (size_t i = 0; i < count; i++) {
        const int n = (int)(first + i);
        const fxs_gaussian g = {{(float)(n % 10) - 5, (float)(n / 10 % 10) - 5, (float)(n / 100) + 8}, {-1.5f, -2, -1},
                                {1, 0.25f * (float)(n % 3), 0, 0.5f}, 2, {(float)(n % 7) / 4, 1, -0.5f}, {0}};
        out[i] = g;
    }
    return (long)count;
}

static int pack(fxs_packed_scene *packed, fxs_message *message)
{
    const fxs_gaussian_source source = {.count = COUNT, .read = make};
    fxs_scene_file_options reading;
    fxs_scene_filter filter;
    fxs_pack_options packing;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_filter_report kept;
    fxs_pack_report report;
    fxs_scene_file_options_init(&reading);
    fxs_scene_filter_init(&filter);
    fxs_pack_options_init(&packing);
    reading.max_gaussians = COUNT;
    filter.low[0] = -4.5;
    packing.profile = FXS_PROFILE_COMPACT;
    int error = fxs_scene_file_open_gaussians("made", &source, &reading, &file, &info, message);
    error = error ? error : fxs_scene_file_filter(file, &filter, &info, &kept, NULL, message);
    error = error ? error : fxs_pack(file, &info, packed, &report, &packing, message);
    fxs_scene_file_close(file);
    return error ? error : kept.kept == COUNT * 9 / 10 ? 0 : FXS_ERR_FILE;
}

/* Requests a picture of two objects. The library must step through the array by the program's struct size. */
static void ask(fxs_request *request, fxs_object objects[2], const fxs_scene *scene, unsigned char *pixels)
{
    fxs_object_init(&objects[0], scene);
    fxs_object_init(&objects[1], scene);
    objects[1].translation_q32[1] = (int64_t)3 << 32;
    objects[1].opacity_q16 = 40000;
    fxs_request_init(request, objects, 2);
    fxs_camera_init(&request->cameras[0], WIDTH, HEIGHT);
    request->targets[0].colour.pixels = pixels;
    request->targets[0].colour.stride = WIDTH * 4;
    request->options.background[1] = 90;
    request->options.sh_degree = 0;
}

static int draw(const fxs_scene *scene, fxs_message *message)
{
    static unsigned char pixels[2][WIDTH * HEIGHT * 4];
    fxs_backend_options options;
    fxs_config config;
    fxs_context context;
    fxs_renderer *renderer;
    fxs_object objects[2];
    fxs_request request;
    fxs_backend_options_init(&options);
    fxs_config_init(&config);
    options.threads = 2;
    int error = fxs_renderer_create("cpu", &options, &renderer, message);
    ask(&request, objects, scene, pixels[0]);
    error = error ? error : fxs_renderer_render(renderer, &request, NULL, message);
    fxs_renderer_destroy(renderer);
    error = error ? error : fxs_context_init(&context, &config);
    request.targets[0].colour.pixels = pixels[1];
    const size_t bytes = fxs_request_bytes(&context, &request, NULL);
    unsigned char *memory = malloc(bytes + 63);
    if (!memory)
        return FXS_ERR_MEMORY;
    error = error ? error : fxs_render(&context, &request, memory + (64 - (uintptr_t)memory % 64) % 64, bytes, NULL);
    free(memory);
    add(pixels, sizeof pixels);
    return error ? error : memcmp(pixels[0], pixels[1], sizeof pixels[0]) ? FXS_ERR_TARGET : 0;
}

/* Passes a struct whose init function was not called. The library must refuse it. */
static int refused(fxs_message *message)
{
    fxs_backend_options options;
    fxs_renderer *renderer;
    memset(&options, 0, sizeof options);
    return fxs_renderer_create("cpu", &options, &renderer, message) == FXS_ERR_STRUCT && !renderer &&
           strstr(message->text, "init");
}

int main(void)
{
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_message message;
    if (pack(&packed, &message) || fxs_scene_open(&scene, packed.data, packed.bytes) || draw(&scene, &message))
        return fprintf(stderr, "%s\n", message.text), 1;
    add(packed.data, packed.bytes);
    fxs_packed_scene_free(&packed);
    if (!refused(&message))
        return fputs("a struct without its size was accepted\n", stderr), 1;
    printf("%016llx\n", (unsigned long long)hash);
    return 0;
}
