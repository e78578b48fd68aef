/* Tests the writer of streamed SOG: levels, index, and errors that must leave no files. */
#include <sys/stat.h>

#include <fixsplat/scene.h>
#include "scene_bytes.h"

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_CJSON) && defined(FXS_WITH_ZIP)

#include <cjson/cJSON.h>

/* number of Gaussians, which make 157 chunks (256 Gaussians each) in three leaves of the tree; number of levels */
enum { COUNT = 40000, LEVELS = 7 };

static fxs_gaussian wanted[COUNT], got[COUNT];
static char folder[] = "/tmp/fixsplat-streamed-XXXXXX";

static const char *in_folder(const char *name)
{
    static char full[160];
    snprintf(full, sizeof full, "%s/%s", folder, name);
    return full;
}

static void make(void)
{
    for (int i = 0; i < COUNT; i++) {
        const float x = (float)(i % 40), y = (float)(i / 40 % 40), z = (float)(i / 1600);
        wanted[i] = (fxs_gaussian){.position = {x, y, z}, .scale = {-1, -1, -1.5f}, .rotation = {1, 0, 0, 0},
                                   .opacity = (float)(i % 3) - 1, .dc = {x / 40, y / 40, z / 25},
                                   .sh = {x / 100, 0, 0, y / 100}};
    }
}

static int write_scene(const char *name, int count, int announced, const fxs_progress *progress)
{
    const fxs_scene_write_options o = {.size = sizeof(fxs_scene_write_options), .count = (uint64_t)announced,
                                       .sh_degree = 1, .antialiased = 1};
    fxs_scene_writer *writer;
    int result = fxs_scene_writer_open(name, &o, &writer, &message);
    if (result)
        return result;
    result = fxs_scene_writer_put(writer, wanted, (size_t)count, &message);
    const int closed = fxs_scene_writer_close(writer, NULL, progress, &message);
    return result ? result : closed;
}

/* Reads a level of a streamed SOG scene. Returns the number of Gaussians, or an error code. */
static long read_level(const char *name, int level)
{
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .level = level};
    fxs_scene_file *file;
    long n, count = 0;
    const int error = fxs_scene_file_open(name, &options, &file, &info, &message);
    if (error)
        return error;
    while ((n = fxs_scene_file_read(file, got + count, (size_t)(COUNT - count), &message)) > 0)
        count += n;
    fxs_scene_file_close(file);
    return n < 0 ? n : count;
}

static int files_in(const char *name)
{
    char command[256];
    int count = -1;
    snprintf(command, sizeof command, "find %s | wc -l", name);
    FILE *lines = popen(command, "r");
    CHECK(lines && fscanf(lines, "%d", &count) == 1 && pclose(lines) == 0);
    return count - 1;
}

static void finest_level(void)
{
    long off = 0;
    if (write_scene(in_folder("lod-meta.json"), COUNT, COUNT, NULL) == FXS_ERR_UNSUPPORTED)
        SKIP(message.text);
    CHECK(read_level(in_folder("lod-meta.json"), 0) == COUNT && info.sh_degree == 1 && info.antialiased);
    CHECK(info.levels == LEVELS && !strcmp(info.format, "sog"));
    for (int i = 0; i < COUNT; i++) {
        const int x = (int)lroundf(got[i].position[0]), y = (int)lroundf(got[i].position[1]),
                  z = (int)lroundf(got[i].position[2]);
        const fxs_gaussian *want = &wanted[x + 40 * y + 1600 * z];
        int same = x >= 0 && x < 40 && y >= 0 && y < 40 && z >= 0 && z < 25 && rotation_match(&got[i], want) > 0.9999;
        for (int k = 0; k < 3 && same; k++)
            same = fabsf(got[i].position[k] - want->position[k]) < 0.01f &&
                   fabsf(got[i].scale[k] - want->scale[k]) < 0.02f && fabsf(got[i].dc[k] - want->dc[k]) < 0.03f;
        off += !same;
    }
    CHECK(off == 0);
}

typedef struct sums {
    double weight, middle[3], dc[3];
} sums;

static void weigh(sums *s, const fxs_gaussian *gaussian, double weight)
{
    s->weight += weight;
    for (int k = 0; k < 3; k++) {
        s->middle[k] += weight * gaussian->position[k];
        s->dc[k] += weight * gaussian->dc[k];
    }
}

static void has_the_middle(const sums *s, double off)
{
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(s->middle[k] / s->weight - (k < 2 ? 19.5 : 12)) < off);
        CHECK(fabs(s->dc[k] / s->weight - 0.48) < 0.03);
    }
}

/* The coarser levels must keep the means of position and colour. They are weighted by optical depth and by
   opacity. At the coarsest level opacity saturates, so only optical depth is compared. */
static void coarser_levels(void)
{
    long before = COUNT;
    for (int level = 1; level < LEVELS; level++) {
        const long count = read_level(in_folder("lod-meta.json"), level);
        sums depth = {0}, light = {0};
        CHECK(count >= before / 2 && count < before / 2 + 600);
        before = count;
        for (long i = 0; i < count; i++) {
            double area = 0;
            for (int k = 0; k < 3; k++)
                area += exp(2 * ((double)got[i].scale[k] + got[i].scale[(k + 1) % 3]));
            weigh(&light, &got[i], sqrt(area) * opacity_of(&got[i]));
            weigh(&depth, &got[i], -sqrt(area) * log1p(-fmin(opacity_of(&got[i]), 0.9999)));
        }
        has_the_middle(&depth, 0.15);
        if (level < LEVELS - 1)
            has_the_middle(&light, 0.1);
    }
    CHECK(read_level(in_folder("lod-meta.json"), LEVELS) == FXS_ERR_ARGUMENT);
}

static double number(const cJSON *object, const char *name, int i)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return (i < 0 ? item : cJSON_GetArrayItem(item, i))->valuedouble;
}

/* Checks a node of the level-of-detail tree in lod-meta.json, and its children. Returns the number of leaves. */
static int check_node(const cJSON *node, const double low[3], const double high[3])
{
    const cJSON *bound = cJSON_GetObjectItemCaseSensitive(node, "bound"), *child;
    double own[2][3];
    int leaves = 0;
    for (int k = 0; k < 3; k++) {
        own[0][k] = number(bound, "min", k);
        own[1][k] = number(bound, "max", k);
        CHECK(own[0][k] >= low[k] && own[1][k] <= high[k] && own[0][k] < own[1][k]);
    }
    cJSON_ArrayForEach(child, cJSON_GetObjectItemCaseSensitive(node, "children"))
        leaves += check_node(child, own[0], own[1]);
    if (leaves)
        return leaves;
    CHECK(number(node, "errors", 0) == 0 && number(node, "errors", LEVELS - 1) <= 1);
    for (int level = 1; level < LEVELS; level++)
        CHECK(number(node, "errors", level) >= number(node, "errors", level - 1));
    CHECK(number(node, "errors", 1) > 0);
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(node, "lods")) == LEVELS);
    return 1;
}

static void index_of_levels(void)
{
    static const double low[3] = {-1, -1, -1}, high[3] = {41, 41, 41};
    char json[1 << 14] = "";
    FILE *stream = fopen(in_folder("lod-meta.json"), "rb");
    if (!CHECK(stream != NULL))
        return;
    CHECK(fread(json, 1, sizeof json - 1, stream) > 0 && !fclose(stream));
    cJSON *root = cJSON_Parse(json);
    CHECK(number(root, "version", -1) == 1 && number(root, "lodLevels", -1) == LEVELS);
    CHECK(number(root, "counts", 0) == COUNT && cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(root, "lodErrors")));
    CHECK(check_node(cJSON_GetObjectItemCaseSensitive(root, "tree"), low, high) == 3);
    cJSON_Delete(root);
}

static void the_same_again(void)
{
    char command[256];
    CHECK(mkdir(in_folder("again"), 0700) == 0);
    CHECK(write_scene(in_folder("again/lod-meta.json"), COUNT, COUNT, NULL) == 0);
    snprintf(command, sizeof command, "cd %s && for f in again/*.json again/*/*; do cmp $f ${f#again/} || exit 1; done",
             folder);
    CHECK(system(command) == 0);
}

static void small_scenes(void)
{
    static const int counts[] = {0, 1, 256, 257, 1000}, levels[] = {1, 1, 1, 2, 3};
    CHECK(mkdir(in_folder("small"), 0700) == 0);
    for (int i = 0; i < 5; i++) {
        CHECK(write_scene(in_folder("small/lod-meta.json"), counts[i], counts[i], NULL) == 0);
        CHECK(read_level(in_folder("small/lod-meta.json"), 0) == counts[i] && info.levels == levels[i]);
    }
}

static int stop(void *calls, double done)
{
    CHECK(done >= 0 && done <= 1);
    return ++*(int *)calls == 30;
}

static void faults(void)
{
    int calls = 0;
    CHECK(mkdir(in_folder("faulty"), 0700) == 0);
    CHECK(write_scene(in_folder("faulty/lod-meta.json"), 5, 6, NULL) == FXS_ERR_ARGUMENT);
    CHECK(write_scene(in_folder("faulty/lod-meta.json"), 6, 5, NULL) == FXS_ERR_ARGUMENT);
    CHECK(files_in(in_folder("faulty")) == 0);
    CHECK(write_scene(in_folder("faulty/lod-meta.json"), COUNT, COUNT,
                      &(fxs_progress){stop, &calls}) == FXS_ERR_STOPPED && calls == 30);
    CHECK(files_in(in_folder("faulty")) == 0);
    FILE *in_the_way = fopen(in_folder("faulty/1_0"), "wb");
    CHECK(in_the_way && !fclose(in_the_way));
    CHECK(write_scene(in_folder("faulty/lod-meta.json"), COUNT, COUNT, NULL) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "faulty/1_0: File exists"));
    CHECK(files_in(in_folder("faulty")) <= 1);
    CHECK(write_scene(in_folder("nowhere/lod-meta.json"), 5, 5, NULL) == FXS_ERR_FILE);
    CHECK(!fxs_scene_format_of("x.lod-meta.json", 1) && fxs_scene_format_of("x/lod-meta.json", 1) &&
          fxs_scene_format_of("lod-meta.json", 1));
}

int main(void)
{
    char command[64];
    if (!mkdtemp(folder))
        return 1;
    make();
    RUN(finest_level);
    RUN(coarser_levels);
    RUN(index_of_levels);
    RUN(the_same_again);
    RUN(small_scenes);
    RUN(faults);
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) != 0 || check_report();
}

#else

static void nothing(void)
{
    SKIP("built without libwebp, libzip or cJSON");
}

int main(void)
{
    RUN(nothing);
    return check_report();
}

#endif
