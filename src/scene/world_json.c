/* Reads a world, a list of placed scenes, from a JSON file. */
#include <fixsplat/world.h>

#include <stdlib.h>
#include <string.h>

#include "src/base/files_internal.h"
#include "src/base/source_internal.h"

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

typedef struct reader {
    fxs_world *world;
    const char *path;
    fxs_message *message;
} reader;

static int wrong(const reader *r, const char *what)
{
    fxs_fail(r->message, "%s: object %u: %s", r->path, r->world->count, what);
    return FXS_ERR_FILE;
}

static int take_file(const reader *r, const cJSON *item, fxs_placement *p)
{
    const char *name = cJSON_GetStringValue(item), *slash = strrchr(r->path, '/');
    if (!name || !*name)
        return wrong(r, "\"file\" is not a path");
    if (!fxs_name_stays(name))
        return wrong(r, "\"file\" leaves the folder of this file; --place takes scenes of any folder");
    const size_t folder = slash ? (size_t)(slash - r->path) + 1 : 0;
    char *path = malloc(folder + strlen(name) + 1);
    if (!path) {
        fxs_fail(r->message, "%s: out of memory", r->path);
        return FXS_ERR_MEMORY;
    }
    memcpy(path, r->path, folder);
    strcpy(path + folder, name);
    fxs_path_settle(path);
    int error = fxs_file_check_within(r->path, path, r->message);
    if (!error)
        error = fxs_world_add_file(r->world, path, &p->file, r->message);
    free(path);
    return error;
}

static int take_id(const reader *r, const cJSON *item, fxs_placement *p)
{
    const double id = cJSON_IsNumber(item) ? item->valuedouble : -1;
    if (!(id >= 0 && id <= FXS_NOTHING - 1.0) || (double)(uint32_t)id != id)
        return wrong(r, "\"id\" is not a whole number from 0 to 4294967294");
    p->id = (uint32_t)id;
    return 0;
}

static int take_visible(const reader *r, const cJSON *item, fxs_placement *p)
{
    if (!cJSON_IsBool(item))
        return wrong(r, "\"visible\" is not true or false");
    p->visible = cJSON_IsTrue(item);
    return 0;
}

static int take_crop(const reader *r, const cJSON *crop, fxs_world_crop *out)
{
    const cJSON *item;
    int low = 0, high = 0, keep = 0;
    cJSON_ArrayForEach(item, crop) {
        const char *text = cJSON_GetStringValue(item);
        if (!strcmp(item->string, "low"))
            low = fxs_json_numbers(item, out->low, 3);
        else if (!strcmp(item->string, "high"))
            high = fxs_json_numbers(item, out->high, 3);
        else if (!strcmp(item->string, "keep")) {
            out->outside = text && !strcmp(text, "outside");
            keep = out->outside || (text && !strcmp(text, "inside"));
        } else {
            return wrong(r, "a crop has \"low\", \"high\" and \"keep\" only");
        }
    }
    return low && high && keep ? 0 : wrong(r, "a crop needs \"low\" and \"high\", three numbers each, and \"keep\", "
                                              "which is \"inside\" or \"outside\"");
}

static int take_crops(const reader *r, const cJSON *list, fxs_placement *p)
{
    const cJSON *crop;
    int error = 0;
    if (!cJSON_IsArray(list))
        return wrong(r, "\"crops\" is not a list");
    p->crop_count = 0;
    cJSON_ArrayForEach(crop, list) {
        if (error)
            break;
        if (p->crop_count == FXS_MAX_CROPS)
            return wrong(r, "more than 8 crops");
        error = cJSON_IsObject(crop) ? take_crop(r, crop, &p->crops[p->crop_count++])
                                     : wrong(r, "a crop is not an object");
    }
    return error;
}

static int take_numbers(const cJSON *item, fxs_placement *p, const char **fault)
{
    const struct {
        const char *name;
        double *out;
        int count;
        const char *fault;
    } items[] = {{"translation", p->translation, 3, "\"translation\" is not three numbers"},
                 {"rotation", p->rotation, 4, "\"rotation\" is not four numbers w, x, y, z"},
                 {"scale", &p->scale, 0, "\"scale\" is not a number"},
                 {"opacity", &p->opacity, 0, "\"opacity\" is not a number"},
                 {"tint", p->tint, 3, "\"tint\" is not three numbers"}};
    for (size_t i = 0; i < sizeof items / sizeof *items; i++) {
        if (strcmp(item->string, items[i].name))
            continue;
        if (items[i].count)
            *fault = fxs_json_numbers(item, items[i].out, items[i].count) ? 0 : items[i].fault;
        else if (cJSON_IsNumber(item))
            *items[i].out = item->valuedouble;
        else
            *fault = items[i].fault;
        return 1;
    }
    return 0;
}

static int take_item(const reader *r, const cJSON *item, fxs_placement *p)
{
    static const struct {
        const char *name;
        int (*take)(const reader *r, const cJSON *item, fxs_placement *p);
    } takers[] = {{"file", take_file}, {"visible", take_visible}, {"id", take_id}, {"crops", take_crops}};
    const char *fault = 0;
    if (take_numbers(item, p, &fault))
        return fault ? wrong(r, fault) : 0;
    for (size_t i = 0; i < sizeof takers / sizeof *takers; i++)
        if (!strcmp(item->string, takers[i].name))
            return takers[i].take(r, item, p);
    fxs_fail(r->message, "%s: object %u: \"%.64s\" is not known; there are file, translation, rotation, scale, "
             "opacity, tint, visible, id and crops", r->path, r->world->count, item->string);
    return FXS_ERR_FILE;
}

static int take_object(const reader *r, const cJSON *object)
{
    fxs_placement p;
    fxs_object checked;
    fxs_crop crops[FXS_MAX_CROPS];
    fxs_message why;
    const cJSON *item;
    fxs_placement_init(&p, FXS_NOTHING, r->world->count);
    if (!cJSON_IsObject(object))
        return wrong(r, "it is not an object");
    cJSON_ArrayForEach(item, object) {
        const int error = take_item(r, item, &p);
        if (error)
            return error;
    }
    if (p.file == FXS_NOTHING)
        return wrong(r, "it has no \"file\"");
    const int error = fxs_object_place(&checked, 0, &p, crops, &why);
    if (error) {
        wrong(r, why.text);
        return error;
    }
    return fxs_world_add(r->world, &p, r->message);
}

static int take_root(const reader *r, const cJSON *root)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "objects"), *object;
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(root) != 1) {
        fxs_fail(r->message, "%s: expected an object with a list \"objects\" and nothing else", r->path);
        return FXS_ERR_FILE;
    }
    cJSON_ArrayForEach(object, list) {
        const int error = take_object(r, object);
        if (error)
            return error;
    }
    if (r->world->count)
        return 0;
    fxs_fail(r->message, "%s: there are no objects in it", r->path);
    return FXS_ERR_FILE;
}

static int read_text(fxs_world *world, const fxs_text *text, fxs_message *message)
{
    const reader r = {world, text->path, message};
    cJSON *root;
    int error = fxs_json_parse(text, NULL, &root, message);
    if (error)
        return error;
    error = take_root(&r, root);
    cJSON_Delete(root);
    if (error)
        fxs_world_free(world);
    return error;
}

#else

static int read_text(fxs_world *world, const fxs_text *text, fxs_message *message)
{
    (void)world;
    fxs_fail(message, "%s: cannot be read: built without cJSON", text->path);
    return FXS_ERR_UNSUPPORTED;
}

#endif

int fxs_world_read(fxs_world *world, const char *path, fxs_message *message)
{
    fxs_text text;
    memset(world, 0, sizeof *world);
    if (fxs_text_load(path, &text, message))
        return FXS_ERR_FILE;
    const int error = read_text(world, &text, message);
    free(text.data);
    return error;
}
