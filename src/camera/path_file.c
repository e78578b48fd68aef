/* Reads the keys of camera paths: settings files of the web viewer (port/web/viewer/settings.js) and of
   supersplat-viewer, and texts with a key per line. */
#include "path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include "src/base/files_internal.h"
#include "src/base/foreign.h"
#include "src/base/text_internal.h"
#include "src/base/try_internal.h"

enum { KEYS_MOST = 10000, NUMBERS = 10, UP = 6, ANGLE = 9 };
#define SECONDS_MOST 86400

typedef struct reading {
    fxs_path *path;
    const char *name;
    const double *up;
    fxs_message *message;
    char where[160];                 /* what an error message names: a line, or a key of a track */
    size_t room;
} reading;

static int fault(const reading *r, const char *what)
{
    return fxs_fail(r->message, "%s: %s: %s", r->name, r->where, what);
}

/* Adds a key: eye, look-at point, up, and field of view in degrees. `time` is null for a key without a time. */
static int add_key(reading *r, const double values[NUMBERS], const double *time)
{
    fxs_path *path = r->path;
    fxs_message why;
    fxs_view view;
    if (path->count == KEYS_MOST)
        return fault(r, "more than 10000 keys");
    for (int i = 0; i < NUMBERS; i++)
        if (!(fabs(values[i]) <= 1e9))
            return fault(r, "a number is not from -1e9 to 1e9");
    if (fxs_view_look_at(&view, values, values + 3, values + UP, &(fxs_picture){values[ANGLE], 1, 1}, &why))
        return fault(r, why.text);
    if (path->count && path->timed != (time != NULL))
        return fault(r, "give all keys a time, or none");
    path->timed = time != NULL;
    if (time && !(*time >= 0 && *time <= SECONDS_MOST))
        return fault(r, "its time is not 0 to 86400 seconds");
    if (time && path->count && !(*time > path->keys[path->count - 1].at))
        return fault(r, "its time is not after that of the key before");
    if ((size_t)path->count + 5 > r->room) {     /* this key, and 4 for close_path */
        fxs_path_key *more = fxs_enlarge(NULL, path->keys, r->room, 2 * r->room + 64, sizeof *more);
        if (!more)
            return fxs_fail_memory(r->message, r->name, r->room * 2 * sizeof *more);
        path->keys = more;
        r->room = 2 * r->room + 64;
    }
    fxs_path_key *key = &path->keys[path->count++];
    memset(key, 0, sizeof *key);
    memcpy(key->values, values, NUMBERS * sizeof *values);
    key->at = time ? *time : 0;
    return 0;
}

/* Reads the numbers of a line, separated by blanks or commas. Returns -1 for another text. */
static int numbers_of(const char *line, double values[NUMBERS + 1])
{
    int count = 0;
    for (char *end; line += strspn(line, " \t\r,"), *line && *line != '#'; line = end) {
        if (count > NUMBERS)
            return -1;
        values[count++] = strtod(line, &end);
        if (end == line || !strchr(" \t\r,#", *end))
            return -1;
    }
    return count;
}

static int read_lines(reading *r, char *text)
{
    long number = 1;
    for (char *line = text, *next; line; line = next, number++) {
        double values[NUMBERS + 1] = {0};
        next = strchr(line, '\n');
        if (next)
            *next++ = 0;
        const int count = numbers_of(line, values);
        snprintf(r->where, sizeof r->where, "line %ld", number);
        if (count == 0)
            continue;
        if (count != 6 && count < 9)
            return fault(r, "expected 6 numbers (eye, look), 9 (and up), 10 (and field of view) or 11 (and time)");
        if (count < 9)
            memcpy(values + UP, r->up, 3 * sizeof *values);
        if (count < NUMBERS)
            values[ANGLE] = 50;
        FXS_TRY(add_key(r, values, count > NUMBERS ? &values[NUMBERS] : NULL));
    }
    r->path->smoothness = 1;
    r->path->end = r->path->count ? r->path->keys[r->path->count - 1].at : 0;
    return 0;
}

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

static const cJSON *item_of(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static double number_of(const cJSON *object, const char *name, double absent)
{
    const cJSON *item = item_of(object, name);
    return !item || cJSON_IsNull(item) ? absent : cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

/* Takes `count` numbers from an item of an array and those after it. Missing numbers become NAN. */
static const cJSON *take(const cJSON *item, double *out, int count)
{
    for (int i = 0; i < count; i++) {
        out[i] = cJSON_IsNumber(item) ? item->valuedouble : NAN;
        item = item ? item->next : NULL;
    }
    return item;
}

static const cJSON *first_of(const cJSON *array)
{
    return cJSON_IsArray(array) ? array->child : NULL;
}

static int read_our_key(reading *r, const cJSON *key)
{
    double values[NUMBERS] = {0}, time = number_of(key, "time", NAN);
    const cJSON *up = item_of(key, "up");
    memcpy(values + UP, r->up, 3 * sizeof *values);
    values[ANGLE] = number_of(key, "fov", NAN);
    if (!fxs_json_numbers(item_of(key, "eye"), values, 3) || !fxs_json_numbers(item_of(key, "look"), values + 3, 3) ||
        (up && !fxs_json_numbers(up, values + UP, 3)))
        return fault(r, "its eye, look or up is not three numbers");
    return add_key(r, values, &time);
}

/* The numbers of a track of supersplat-viewer, in arrays. */
typedef struct their_keys {
    const cJSON *position, *target, *angle;
    double rate, usual_angle;        /* frames a second of the times; angle for a track without angles */
} their_keys;

static their_keys their_keys_of(const cJSON *root, const cJSON *track)
{
    const cJSON *of = item_of(item_of(track, "keyframes"), "values");
    const double rate = number_of(track, "frameRate", 1);     /* early files: times in seconds */
    return (their_keys){first_of(item_of(of, "position")), first_of(item_of(of, "target")),
                        first_of(item_of(of, "fov")), rate > 0 ? rate : 1,
                        item_of(of, "fov") ? NAN : number_of(item_of(root, "camera"), "fov", 85)};
}

/* Reads the next key of supersplat-viewer, which turns scenes by half a turn about z. */
static int read_their_key(reading *r, their_keys *keys, const cJSON *key)
{
    double values[NUMBERS] = {[UP + 1] = -1}, time;
    take(key, &time, 1);
    time /= keys->rate;
    keys->position = take(keys->position, values, 3);
    keys->target = take(keys->target, values + 3, 3);
    for (int i = 0; i < 6; i++)
        values[i] *= i % 3 < 2 ? -1 : 1;
    values[ANGLE] = keys->usual_angle;
    if (isnan(keys->usual_angle))
        keys->angle = take(keys->angle, values + ANGLE, 1);
    return add_key(r, values, &time);
}

/* Puts two more keys before and two behind a repeated track, which close the path. If the track does not end
   after its last key, the next round begins a second after that key. */
static void close_path(fxs_path *path)
{
    const long n = path->count;
    const double last = path->keys[n - 1].at, length = path->end > last ? path->end : last + 1;
    memmove(path->keys + 2, path->keys, (size_t)n * sizeof *path->keys);
    for (int i = 0; i < 2; i++) {
        path->keys[i] = path->keys[n + i];
        path->keys[i].at -= length;
        path->keys[n + 2 + i] = path->keys[2 + i];
        path->keys[n + 2 + i].at += length;
    }
    path->count += 4;
    path->closed = 1;
}

static int read_track(reading *r, const cJSON *root, const cJSON *track, int is_ours, const char *called)
{
    fxs_path *path = r->path;
    const cJSON *keys = is_ours ? item_of(track, "keys") : item_of(item_of(track, "keyframes"), "times"), *key;
    const char *loop = fxs_json_string(track, is_ours ? "loop" : "loopMode");
    const char *steps = fxs_json_string(track, "interpolation");
    their_keys theirs = their_keys_of(root, track);
    int i = 0;
    cJSON_ArrayForEach(key, keys) {
        snprintf(r->where, sizeof r->where, "%s, key %d", called, i);
        FXS_TRY(is_ours ? read_our_key(r, key) : read_their_key(r, &theirs, key));
        i++;
    }
    snprintf(r->where, sizeof r->where, "%s", called);
    path->smoothness = number_of(track, "smoothness", is_ours);
    path->is_wide = !is_ours || cJSON_IsTrue(item_of(track, "longer"));
    path->steps = is_ours ? cJSON_IsTrue(item_of(track, "step")) : steps && !strcmp(steps, "step");
    path->end = number_of(track, "duration", path->count ? path->keys[path->count - 1].at : 1);
    path->returns = loop && !strcmp(loop, "pingpong");
    if (!(path->smoothness >= 0 && path->smoothness <= 1))
        return fault(r, "its smoothness is not 0 to 1");
    if (!(path->end > 0 && path->end <= SECONDS_MOST))
        return fault(r, "its duration is not above 0 and at most 86400 seconds");
    if (loop && !strcmp(loop, "repeat") && path->count > 1)
        close_path(path);
    return 0;
}

/* Finds a track by its number from 0, or its name. */
static const cJSON *find_track(const cJSON *tracks, const char *wanted, int *number)
{
    const cJSON *track;
    char digits[16];
    *number = 0;
    cJSON_ArrayForEach(track, tracks) {
        const char *name = fxs_json_string(track, "name");
        snprintf(digits, sizeof digits, "%d", *number);
        if (!wanted || !strcmp(wanted, digits) || (name && !strcmp(wanted, name)))
            return track;
        ++*number;
    }
    return NULL;
}

/* Returns 1, or 0 for a file of cameras. */
static int read_settings(reading *r, const cJSON *root, const char *wanted)
{
    const int is_ours = item_of(root, "fixsplat") != NULL;
    const cJSON *tracks = item_of(root, is_ours ? "tracks" : "animTracks");
    char called[32];
    int number;
    if (!cJSON_IsObject(root) || cJSON_IsArray(item_of(root, "frames")))
        return 0;
    const cJSON *track = find_track(tracks, wanted, &number);
    if (!track && wanted && number)
        return fxs_fail(r->message, "%s: no track '%.80s': there are %d, from 0 on", r->name, wanted, number);
    if (!track)
        return fxs_fail(r->message, "%s: no track of a camera in it; the page's settings panel adds keys of a track",
                        r->name);
    snprintf(called, sizeof called, "track %d", number);
    FXS_TRY(read_track(r, root, track, is_ours, called));
    return 1;
}

static int read_json(reading *r, const fxs_text *text, const char *wanted)
{
    cJSON *root;
    FXS_TRY(fxs_json_parse(text, NULL, &root, r->message));
    const int status = read_settings(r, root, wanted);
    cJSON_Delete(root);
    return status;
}

#else

static int read_json(reading *r, const fxs_text *text, const char *wanted)
{
    (void)text, (void)wanted;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, r->message, "%s: cannot read JSON: built without cJSON", r->name);
}

#endif

/* Returns 1 for the name of a text of keys: NAME.txt, except for COLMAP's files. */
static int is_lines(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    return fxs_ends_in(name, ".txt") && strcmp(name, "images.txt") && strcmp(name, "cameras.txt");
}

int fxs_path_read(fxs_path *path, const char *name, const char *track, const double up[3], fxs_message *message)
{
    reading r = {.path = path, .name = name, .up = up, .message = message};
    const int lines = is_lines(name);
    fxs_text text;
    *path = (fxs_path){.count = 0};
    if (fxs_file_kind(name) == FXS_FILE_FOLDER || (!lines && !fxs_ends_in(name, ".json")))
        return 0;
    if (lines && track)
        return fxs_fail(message, "%s: a text of keys has no tracks", name);
    FXS_TRY(fxs_text_load(name, &text, message));
    int status = lines ? read_lines(&r, fxs_text_begin(&text)) : read_json(&r, &text, track);
    free(text.data);
    status = lines && !status ? 1 : status;
    if (status > 0 && path->count < 2)
        status = fxs_fail(message, "%s: %ld keys: a path needs two or more", name, path->count);
    if (status <= 0)
        fxs_path_free(path);
    return status;
}
