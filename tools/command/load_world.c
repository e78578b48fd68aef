/* Loads the scenes of a subcommand and places them by the options --scene or --place. Merges several scenes into
   one. */
#include "load_world.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/internal/placements.h>

#include "command_line.h"

int take_scenes(world_options *o, const char *name, int count, char *const *scenes)
{
    o->scenes = scenes;
    o->scene_count = count;
    if (o->file && (count || o->place_count))
        return fail(EXIT_USAGE, "--scene lists the scenes and their places: leave out %s",
                    count ? "other scenes" : "--place");
    if (!o->file && !count)
        return fail(EXIT_USAGE, "%s takes a scene file, or several; see: fixsplat %s --help", name, name);
    return 0;
}

/* Compares a name with a scene's path. Returns 2 if they are equal, 1 if the name ends the path after a slash, else
   0. */
static int is_called(const char *scene, const char *name, size_t length)
{
    const size_t size = strlen(scene);
    if (size < length || strncmp(scene + size - length, name, length))
        return 0;
    return size == length ? 2 : scene[size - length - 1] == '/';
}

/* Returns the number of the scene that a value of option --place names before the colon. -1: not found or ambiguous. */
static int find_scene(const world_options *o, const char *place, size_t length)
{
    char name[16];
    uint64_t number;
    int ending = -1, endings = 0;
    for (int i = 0; i < o->scene_count; i++) {
        const int called = is_called(o->scenes[i], place, length);
        if (called == 2)
            return i;
        ending = called ? i : ending;
        endings += called;
    }
    if (endings)
        return endings == 1 ? ending : -1;
    if (!length || length >= sizeof name)
        return -1;
    memcpy(name, place, length);
    name[length] = 0;
    return parse_count(name, 0, (uint64_t)o->scene_count - 1, &number) ? (int)number : -1;
}

static int parse_placement(const char *text, fxs_placement *p)
{
    double numbers[8];
    int count = 1;
    for (const char *comma = text; (comma = strchr(comma, ',')) != 0; comma++)
        count++;
    if ((count != 3 && count != 7 && count != 8) || !parse_vector(text, count, numbers))
        return 0;
    memcpy(p->translation, numbers, sizeof p->translation);
    if (count > 3)
        memcpy(p->rotation, numbers + 3, sizeof p->rotation);
    if (count > 7)
        p->scale = numbers[7];
    return 1;
}

static int add_scene(fxs_world *placed, const world_options *o, int number)
{
    fxs_message message;
    fxs_placement p;
    fxs_object checked;
    uint32_t file;
    int times = 0, error = fxs_world_add_file(placed, o->scenes[number], &file, &message);
    for (int i = 0; i < o->place_count && !error; i++) {
        const char *place = o->places[i], *colon = strrchr(place, ':');
        if (find_scene(o, place, (size_t)(colon - place)) != number)
            continue;
        fxs_placement_init(&p, file, placed->count);
        if (!parse_placement(colon + 1, &p))
            return fail(EXIT_USAGE, "--place %s: expected 3, 7 or 8 numbers X,Y,Z[,QW,QX,QY,QZ[,S]]", place);
        if (fxs_object_place(&checked, 0, &p, 0, &message))
            return fail(EXIT_USAGE, "--place %s: %s", place, message.text);
        error = fxs_world_add(placed, &p, &message);
        times++;
    }
    if (!error && !times) {
        fxs_placement_init(&p, file, placed->count);
        error = fxs_world_add(placed, &p, &message);
    }
    return error ? fail(EXIT_FAILED, "%s: %s", o->scenes[number], message.text) : 0;
}

static int check_places(const world_options *o)
{
    for (int i = 0; i < o->place_count; i++) {
        const char *place = o->places[i];
        const size_t length = (size_t)(strrchr(place, ':') - place);
        if (find_scene(o, place, length) < 0)
            return fail(EXIT_USAGE, "--place %s: no scene, or more than one, is called %.*s", place, (int)length,
                        place);
    }
    return 0;
}

int place_scenes(fxs_world *placed, const world_options *o)
{
    fxs_message message;
    memset(placed, 0, sizeof *placed);
    if (o->file)
        return fxs_world_read(placed, o->file, &message) ? fail_for(&message) : 0;
    int status = check_places(o);
    for (int i = 0; i < o->scene_count && !status; i++)
        status = add_scene(placed, o, i);
    if (status)
        fxs_world_free(placed);
    return status;
}

static int is_direction(const double up[3])
{
    return up[0] != 0 || up[1] != 0 || up[2] != 0;
}

int world_up(const world *w, double up[3])
{
    for (uint32_t i = 0; i < w->count; i++) {
        const fxs_placement *p = &w->placed.objects[i];
        fxs_start start = w->scenes[p->file].opened->info->start;
        if (!p->visible || !is_direction(start.up))
            continue;
        fxs_placement_start(p, &start);
        memcpy(up, start.up, sizeof start.up);
        return 1;
    }
    return 0;
}

int world_box(const world *w, uint32_t object, double low[3], double high[3])
{
    const fxs_placement *p = &w->placed.objects[object];
    const fxs_pack_report *report = w->scenes[p->file].opened->report;
    return fxs_placement_box(p, report->low, report->high, low, high);
}

static void add_box(double low[3], double high[3], const double l[3], const double h[3], int first)
{
    for (int i = 0; i < 3; i++) {
        low[i] = first || l[i] < low[i] ? l[i] : low[i];
        high[i] = first || h[i] > high[i] ? h[i] : high[i];
    }
}

static int find_bounds(world *w, int visible_only)
{
    int found = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        const fxs_placement *p = &w->placed.objects[i];
        const fxs_pack_report *report = w->scenes[p->file].opened->report;
        double low[3], high[3];
        if ((visible_only && !p->visible) || !world_box(w, i, low, high))
            continue;
        add_box(w->low, w->high, low, high, !found);
        if (!fxs_placement_box(p, report->inner_low, report->inner_high, low, high))
            world_box(w, i, low, high);
        add_box(w->inner_low, w->inner_high, low, high, !found);
        found = 1;
    }
    return found;
}

static int place_objects(world *w)
{
    fxs_message message;
    uint64_t slots = 0, gaussians = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        const fxs_placement *p = &w->placed.objects[i];
        const loaded_scene *scene = &w->scenes[p->file];
        if (fxs_object_place(&w->objects[i], scene->opened->scene, p, w->crops + i * FXS_MAX_CROPS, &message))
            return fail(EXIT_FAILED, "%s: %s", scene->path, message.text);
        slots += scene->opened->scene->count;
        gaussians += scene->opened->report->packed;
    }
    if (slots > FXS_MAX_COUNT)
        return fail(EXIT_FAILED, "%" PRIu64 " Gaussians in all objects: at most %u can be drawn", slots,
                    FXS_MAX_COUNT);
    w->gaussians = (uint32_t)gaussians;
    if (!find_bounds(w, 1))
        find_bounds(w, 0);
    return 0;
}

static int make_room(world *w)
{
    w->count = w->placed.count;
    w->scenes = calloc(w->placed.file_count, sizeof *w->scenes);
    w->objects = malloc(w->count * sizeof *w->objects);
    w->crops = malloc((size_t)w->count * FXS_MAX_CROPS * sizeof *w->crops);
    return w->scenes && w->objects && w->crops ? 0 : fail(EXIT_FAILED, "out of memory");
}

static int load_scenes(world *w, const load_options *load)
{
    int status = make_room(w);
    for (uint32_t i = 0; i < w->placed.file_count && !status; i++) {
        load_options own;
        status = options_of_file(&own, load, i, w->placed.file_count);
        if (!status)
            status = load_scene(&w->scenes[i], w->placed.files[i], &own);
        w->load_nanoseconds += w->scenes[i].load_nanoseconds;
    }
    return status ? status : place_objects(w);
}

static int check_lod(const load_options *load, int has_lods)
{
    return load->lod && !load->lods && !has_lods
               ? fail(EXIT_FAILED, "--lod %d: none of these scenes has levels of detail to choose from", load->lod) : 0;
}

/* Refuses options that do nothing for these scenes. */
static int check_options(const world *w, const load_options *load)
{
    int has_levels = 0, has_lods = 0, is_all_packed = 1, moves = 0, is_numbered = 0;
    if (load->again)
        return 0;
    for (uint32_t i = 0; i < w->placed.file_count; i++) {
        has_levels |= w->scenes[i].opened->scene->nodes != NULL;
        has_lods |= w->scenes[i].opened->info->levels > 1;
        is_all_packed &= is_packed(&w->scenes[i]);
        moves |= w->scenes[i].opened->scene->motion != NULL;
        is_numbered |= !strcmp(w->scenes[i].opened->info->format, "numbered files");
    }
    if (is_given("rate") && !is_given("compare") && !is_numbered)
        return fail(EXIT_FAILED, "%s: --rate is for numbered files", w->placed.files[0]);
    if (is_given("time") && !moves)
        return fail(EXIT_FAILED, "%s: does not move: no --time", w->placed.files[0]);
    if ((is_given("budget") || is_given("detail")) && !has_levels)
        return fail(EXIT_FAILED, "%s: has no levels of detail for --budget and --detail; convert --levels makes "
                    "them", w->placed.files[0]);
    if (is_given("profile") && is_all_packed)
        return fail(EXIT_FAILED, "%s: is packed already; convert --profile packs it anew", w->placed.files[0]);
    if (load->lod && !load->lods && w->placed.file_count == 1 && is_all_packed)
        return fail(EXIT_FAILED, "%s: --lod is not for an .fxs: --detail and --budget choose its levels",
                    w->placed.files[0]);
    return check_lod(load, has_lods);
}

static int open_world(world *w, const world_options *options, const load_options *load, int is_checked)
{
    memset(w, 0, sizeof *w);
    int status = place_scenes(&w->placed, options);
    if (!status)
        status = load_scenes(w, load);
    if (!status && is_checked)
        status = check_options(w, load);
    if (status)
        world_close(w);
    return status;
}

int world_open(world *w, const world_options *options, const load_options *load)
{
    return open_world(w, options, load, 1);
}

int world_open_file(world *w, const char *path, const load_options *load)
{
    char *const scenes[] = {(char *)path};
    const world_options options = {.scenes = scenes, .scene_count = 1};
    return open_world(w, &options, load, 0);
}

static int merge(const fxs_world *placed, const char *name, const load_options *load, fxs_scene_file **files,
                 fxs_scene_file_info *infos, fxs_scene_file **file, fxs_scene_file_info *info)
{
    fxs_message message;
    int has_lods = 0;
    for (uint32_t i = 0; i < placed->file_count; i++) {
        load_options own;
        int status = options_of_file(&own, load, i, placed->file_count);
        if (!status)
            status = open_unfiltered(placed->files[i], &own, &files[i], &infos[i]);
        has_lods |= !status && infos[i].levels > 1;
        while (status && i > 0)
            fxs_scene_file_close(files[--i]);
        if (status)
            return status;
    }
    const int without = check_lod(load, has_lods);
    for (uint32_t i = 0; without && i < placed->file_count; i++)
        fxs_scene_file_close(files[i]);
    if (without)
        return without;
    if (fxs_world_merge(placed, files, infos, file, info, &message))
        return fail_for(&message);
    if (!load->again)
        note_coarse(name, info);
    return filter_scene(name, load, *file, info);
}

/* True if the world is one scene file, visible, uncropped and in its original place. */
static int is_plain(const fxs_world *placed)
{
    return placed->count == 1 && fxs_placement_is_plain(placed->objects) && placed->objects->visible &&
           !placed->objects->crop_count;
}

int open_merged(const fxs_world *placed, const char *name, const load_options *load, fxs_scene_file **file,
                fxs_scene_file_info *info)
{
    if (is_plain(placed)) {
        load_options own;
        int status = options_of_file(&own, load, 0, 1);
        if (!status)
            status = open_unfiltered(placed->files[0], &own, file, info);
        if (!status && is_direction(placed->up))
            memcpy(info->start.up, placed->up, sizeof placed->up);
        return status ? status : filter_scene(placed->files[0], &own, *file, info);
    }
    fxs_scene_file **files = calloc(placed->file_count, sizeof *files);
    fxs_scene_file_info *infos = calloc(placed->file_count, sizeof *infos);
    const int status = files && infos ? merge(placed, name, load, files, infos, file, info)
                                      : fail(EXIT_FAILED, "out of memory");
    free(files);
    free(infos);
    return status;
}

static int begin_plain(world *w, const char *name)
{
    fxs_message message;
    fxs_placement as_it_is;
    uint32_t number;
    memset(w, 0, sizeof *w);
    fxs_placement_init(&as_it_is, 0, 0);
    const int error = fxs_world_add_file(&w->placed, name, &number, &message) ||
                      fxs_world_add(&w->placed, &as_it_is, &message);
    return error ? fail_for(&message) : make_room(w);
}

int world_open_packed(world *w, const char *name, fxs_packed_scene *packed)
{
    fxs_message message;
    int status = begin_plain(w, name);
    if (!status) {
        loaded_scene *loaded = &w->scenes[0];
        loaded->path = w->placed.files[0];
        fxs_file_seal(packed->data, packed->bytes);
        const int error = fxs_open_memory(name, packed->data, packed->bytes, 0, &loaded->opened, &message);
        status = error ? fail_for(&message) : place_objects(w);
    }
    if (status)
        world_close(w);
    return status;
}

int world_open_merged(world *w, const fxs_world *placed, const char *name, const load_options *load)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    int status = begin_plain(w, name);
    if (!status)
        status = open_merged(placed, name, load, &file, &info);
    if (!status)
        status = load_stream(&w->scenes[0], w->placed.files[0], load, file, &info);
    if (!status)
        status = place_objects(w);
    if (status)
        world_close(w);
    return status;
}

int world_check(const world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (check_scene(&w->scenes[i]))
            return EXIT_FAILED;
    return 0;
}

static fxs_pager *pager_of(const world *w, uint32_t i)
{
    return w->scenes[i].opened->pager;
}

int world_is_paged(const world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (pager_of(w, i))
            return 1;
    return 0;
}

void world_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    const world *w = argument;
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (pager_of(w, i) && fxs_pager_scene(pager_of(w, i)) == scene)
            fxs_pager_want(pager_of(w, i), scene, chunk, there);
}

int world_turn(const world *w, fxs_pager_state *sum, fxs_message *message)
{
    int result = 0;
    memset(sum, 0, sizeof *sum);
    for (uint32_t i = 0; i < w->placed.file_count; i++) {
        fxs_pager_state state;
        const int error = pager_of(w, i) ? fxs_pager_turn(pager_of(w, i), &state, message) : 0;
        if (!pager_of(w, i))
            continue;
        result = error ? error : result;
        sum->chunks += state.chunks;
        sum->room += state.room;
        sum->there += state.there;
        sum->arrived += state.arrived;
        sum->coming += state.coming;
        sum->no_room += state.no_room;
        sum->lost += state.lost;
        sum->bytes_read += state.bytes_read;
        sum->memory += state.memory;
    }
    return result;
}

int world_wait(const world *w, uint64_t nanoseconds)
{
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (pager_of(w, i) && !fxs_pager_wait(pager_of(w, i), nanoseconds))
            return 0;
    return 1;
}

void world_close(world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count && w->scenes; i++)
        free_scene(&w->scenes[i]);
    fxs_world_free(&w->placed);
    free(w->scenes);
    free(w->objects);
    free(w->crops);
    memset(w, 0, sizeof *w);
}
