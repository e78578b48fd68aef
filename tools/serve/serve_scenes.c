/* Packs and serves the scenes of `fixsplat view --web`. A request marks its scene as wanted, and scenes_work packs
   wanted scenes into temporary files. A changed file is packed again once it is stable. */
#include "serve_scenes.h"

#include <ctype.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "scene_picture.h"
#include "serve.h"

#define SECOND ((uint64_t)1000000000)
#define SETTLED (SECOND * 3 / 4)            /* a scene file is complete if unchanged for that many nanoseconds */
#define LOOKS (5 * SECOND)    /* a page is open if its last request is at most that many nanoseconds ago */
#define KEPT_MOST ((uint64_t)1 << 30)       /* most bytes of packed scenes that are kept although no page shows them */
enum { SMALL = 64 };                        /* a scene file with fewer bytes per Gaussian is sent unpacked */
enum { LISTED_WIDTH = 640, LISTED_HEIGHT = 360 };

/* Versions of a scene alternate between two web addresses, so that a page can finish reading the previous version. */
enum { VERSIONS = 2, FILES = SCENE_FILES };

/* Special values of a file descriptor. NONE: no file. AS_IT_LIES: opens the scene's file by name for each request. */
enum { NONE = -1, AS_IT_LIES = -2 };

enum scene_state { WAITS, PACKS, READY, FAILED, GONE };
static const char *const state_names[] = {"waits", "packs", "ready", "failed", "gone"};

typedef struct served_scene {
    served_scenes *all;
    const char *given;
    char *path;
    char *names[FILES];                     /* web addresses of the scene's versions, of its facts and of its picture */
    int number, is_twice;
    fxs_file_facts taken, seen;  /* size, time and inode of the file when it was served, and when it was last checked */
    uint64_t seen_at;

    /* The lock of the list of scenes guards the fields below. */
    enum scene_state state;
    int descriptors[VERSIONS];
    int picture;
    uint64_t kept;
    uint32_t version;                       /* number of the scene's version, from 1; 0: none yet */
    double done;
    uint64_t asked_at;                      /* time of the last request for the scene; 0: never */
    char words[256];
} served_scene;

struct served_scenes {
    const served_options *options;
    served_scene *scenes;
    int count;
    pthread_mutex_t lock;
    uint64_t listed_at;                     /* time of the last request for the list of scenes; 0: never */
};

static int slot_of(const served_scene *s)
{
    return (int)(s->version + VERSIONS - 1) % VERSIONS;
}

static int base_of(const char **base, const char *path)
{
    const char *end = path + strlen(path);
    while (end > path && end[-1] == '/')
        end--;
    for (*base = end; *base > path && (*base)[-1] != '/'; --*base)
        ;
    return (int)(end - *base);
}

static void write_facts(FILE *file, const served_scene *s)
{
    const int has = s->version && s->descriptors[slot_of(s)] != NONE;
    fputs("{\"name\": ", file);
    write_json_string(file, scenes_title(s->all, s->number));
    fprintf(file, ", \"state\": \"%s\", \"version\": %u, \"done\": %.3f, \"picture\": %s, \"address\": ",
            state_names[s->state], has ? (unsigned)s->version : 0, s->done, s->picture < 0 ? "false" : "true");
    write_json_string(file, s->names[slot_of(s)]);
    fputs(", \"words\": ", file);
    write_json_string(file, s->words);
    putc('}', file);
}

static int open_facts(void *self)
{
    served_scene *s = self;
    FILE *file = fxs_stream_temporary();
    pthread_mutex_lock(&s->all->lock);
    s->asked_at = fxs_clock(0);
    if (file)
        write_facts(file, s);
    pthread_mutex_unlock(&s->all->lock);
    return keep_written(file);
}

static int open_all_facts(void *self)
{
    served_scenes *all = self;
    FILE *file = fxs_stream_temporary();
    pthread_mutex_lock(&all->lock);
    all->listed_at = fxs_clock(0);
    for (int i = 0; file && i < all->count; i++) {
        fputs(i ? ",\n" : "[", file);
        write_facts(file, &all->scenes[i]);
    }
    pthread_mutex_unlock(&all->lock);
    if (file)
        putc(']', file);
    return keep_written(file);
}

static int open_again(const served_scene *s, int descriptor)
{
    return descriptor == NONE ? -1
         : descriptor == AS_IT_LIES ? fxs_descriptor_open(s->path) : fxs_descriptor_again(descriptor);
}

/* Opens a version of a scene, or the current version if the wanted one is gone. If a scene has no version yet, marks it
   as wanted. */
static int open_version(served_scene *s, int slot)
{
    pthread_mutex_lock(&s->all->lock);
    const int has = s->descriptors[slot] != NONE;
    const int descriptor = open_again(s, s->descriptors[has ? slot : slot_of(s)]);
    if (descriptor < 0)
        s->asked_at = fxs_clock(0);
    pthread_mutex_unlock(&s->all->lock);
    return descriptor;
}

static int open_first(void *self)
{
    return open_version(self, 0);
}

static int open_next(void *self)
{
    return open_version(self, 1);
}

static int open_picture(void *self)
{
    served_scene *s = self;
    pthread_mutex_lock(&s->all->lock);
    const int descriptor = open_again(s, s->picture);
    pthread_mutex_unlock(&s->all->lock);
    return descriptor;
}

int scenes_file_count(const served_scenes *all)
{
    return all->count * FILES + 1;
}

void scenes_files(served_scenes *all, fxs_http_file *files)
{
    static int (*const opens[FILES])(void *) = {open_first, open_next, open_facts, open_picture};
    for (int i = 0; i < all->count; i++)
        for (int j = 0; j < FILES; j++)
            *files++ = (fxs_http_file){.name = all->scenes[i].names[j], .open = opens[j], .self = &all->scenes[i]};
    *files = (fxs_http_file){.name = "/scenes.json", .open = open_all_facts, .self = all};
}

/* Returns -1 if the path cannot be a scene, because it is missing, a link or a FIFO. */
static int look_at_file(const char *path, fxs_file_facts *facts)
{
    const enum fxs_file_kind kind = fxs_file_look_at_name(path, facts);
    if (kind == FXS_FILE_REGULAR || kind == FXS_FILE_FOLDER)
        return 0;
    memset(facts, 0, sizeof *facts);
    return -1;
}

static int is_same(const fxs_file_facts *a, const fxs_file_facts *b)
{
    return a->device == b->device && a->inode == b->inode && a->size == b->size && a->modified == b->modified;
}

static int is_one_file(const char *path)
{
    if (fxs_file_kind(path) != FXS_FILE_REGULAR)
        return 0;
    FILE *file = fxs_stream_open(path, "r");
    int c = ' ';
    while (file && isspace(c))
        c = getc(file);
    if (file)
        fclose(file);
    return c != '{';
}

typedef struct first_look {
    int is_fxs, is_sent;
} first_look;

static int look_first(const char *path, const load_options *o, first_look *look)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_file_facts state;
    if (open_scene(path, o, &file, &info))
        return EXIT_FAILED;
    fxs_scene_file_close(file);
    look->is_fxs = !strcmp(info.format, "fxs");
    const int is_asked = o->lod || o->lods || o->axes || o->profile || o->tree || o->max_gaussians || o->import_memory;
    look->is_sent = look->is_fxs || (!is_asked && is_one_file(path) && !look_at_file(path, &state) &&
                                     state.size / SMALL <= info.count);
    return 0;
}

static int tell_progress(void *scene, double done)
{
    served_scene *s = scene;
    char label[64];
    const char *base;
    const int length = base_of(&base, s->given);
    pthread_mutex_lock(&s->all->lock);
    s->done = done;
    pthread_mutex_unlock(&s->all->lock);
    snprintf(label, sizeof label, "packing %.*s", length < 40 ? length : 40, base);
    progress_bar(label, done);
    if (fxs_end_wait(0)) {
        progress_end();
        exit(EXIT_OK);
    }
    return 0;
}

static int picture_of(const served_scene *s, const loaded_scene *scene)
{
    const served_options *o = s->all->options;
    fxs_encoded encoded;
    fxs_message why;
    const int error = scene_picture(scene->opened, LISTED_WIDTH, LISTED_HEIGHT, o->background, o->load.threads,
                                    &encoded, &why);
    const int descriptor = error ? -1 : keep(encoded.bytes, encoded.size);
    fxs_encoded_free(&encoded);
    return descriptor;
}

/* Closes a file descriptor and replaces it by another. Call with the lock held if the descriptor belongs to a scene. */
static void replace(int *descriptor, int by)
{
    if (*descriptor >= 0)
        fxs_descriptor_close(*descriptor);
    *descriptor = by;
}

typedef struct taken {
    int descriptor, picture;
    uint64_t kept;
} taken;

static int take_loaded(served_scene *s, const first_look *look, loaded_scene *scene, taken *t)
{
    if (s->all->options->has_list)
        t->picture = picture_of(s, scene);
    if (look->is_sent)
        return 0;
    fxs_file_seal((void *)(uintptr_t)scene->opened->data, scene->opened->bytes);
    t->kept = scene->opened->bytes;
    t->descriptor = keep(scene->opened->data, scene->opened->bytes);
    return t->descriptor < 0 ? fail(EXIT_FAILED, "%s: a temporary file: %s", s->given, strerror(errno)) : 0;
}

/* Loads a scene for the server. A scene that is sent unpacked is loaded too, to find errors. */
static int take_file(served_scene *s, taken *t)
{
    load_options o;
    first_look look;
    loaded_scene scene;
    int status = options_of_file(&o, &s->all->options->load, 0, 1);
    o.progress = (fxs_progress){tell_progress, s};
    if (!status)
        status = look_first(s->path, &o, &look);
    if (!status && look.is_sent && (t->descriptor = fxs_descriptor_open(s->path)) < 0)
        status = fail(EXIT_FAILED, "%s: %s", s->given, strerror(errno));
    if (!status && look.is_sent && !FXS_OPEN_MAY_BE_REPLACED)
        replace(&t->descriptor, AS_IT_LIES);
    if (status || (look.is_sent && !look.is_fxs && !s->all->options->has_list))
        return status;
    status = load_scene(&scene, s->path, &o);
    if (status)
        return status;
    status = take_loaded(s, &look, &scene, t);
    free_scene(&scene);
    return status;
}

static void set_state(served_scene *s, enum scene_state state, const char *words)
{
    pthread_mutex_lock(&s->all->lock);
    s->state = state;
    s->done = 0;
    snprintf(s->words, sizeof s->words, "%s", words);
    pthread_mutex_unlock(&s->all->lock);
}

/* Frees the versions of a scene. Call with the lock held. */
static void drop(served_scene *s)
{
    for (int i = 0; i < VERSIONS; i++)
        replace(&s->descriptors[i], NONE);
    s->kept = 0;
    s->state = WAITS;
}

/* Frees packed scenes that no page shows, the least recently requested first, until at most KEPT_MOST bytes are
   left. */
static void make_room(served_scenes *all)
{
    const uint64_t now = fxs_clock(0);
    served_scene *oldest;
    pthread_mutex_lock(&all->lock);
    do {
        uint64_t kept = 0;
        oldest = 0;
        for (int i = 0; i < all->count; i++) {
            served_scene *s = &all->scenes[i];
            kept += s->kept;
            if (s->kept && now - s->asked_at > LOOKS && (!oldest || s->asked_at < oldest->asked_at))
                oldest = s;
        }
        if (kept <= KEPT_MOST)
            oldest = 0;
        if (oldest)
            drop(oldest);
    } while (oldest);
    pthread_mutex_unlock(&all->lock);
}

/* Removes the scene's path from a message, because pages on other machines may see it. */
static const char *without_path(const served_scene *s, const char *words)
{
    const size_t length = strlen(s->path);
    return strncmp(words, s->path, length) || strncmp(words + length, ": ", 2) ? words : words + length + 2;
}

static int take(served_scene *s, const fxs_file_facts *now)
{
    taken t = {NONE, NONE, 0};
    make_room(s->all);
    set_state(s, PACKS, "");
    s->taken = s->seen = *now;
    const int status = take_file(s, &t);
    progress_end();
    if (status) {
        replace(&t.descriptor, NONE);
        replace(&t.picture, NONE);
        set_state(s, FAILED, without_path(s, last_failure()));
        return status;
    }
    pthread_mutex_lock(&s->all->lock);
    s->version++;
    replace(&s->descriptors[slot_of(s)], t.descriptor);
    replace(&s->picture, t.picture);
    s->kept = t.kept;
    pthread_mutex_unlock(&s->all->lock);
    set_state(s, READY, "");
    return 0;
}

static void follow(served_scene *s)
{
    const uint64_t time = fxs_clock(0);
    fxs_file_facts now;
    if (look_at_file(s->path, &now)) {
        set_state(s, GONE, "the file is not there any more");
        s->taken = s->seen = now;
        return;
    }
    if (!is_same(&now, &s->seen)) {
        s->seen = now;
        s->seen_at = time;
    }
    if (!is_same(&now, &s->taken) && time - s->seen_at >= SETTLED)
        take(s, &now);
}

static int take_first(served_scene *s)
{
    fxs_file_facts now;
    if (!look_at_file(s->path, &now))
        return take(s, &now);
    set_state(s, GONE, "there is no such file");
    return fail(EXIT_FAILED, "%s: there is no such file", s->given);
}

/* What open pages want of a scene: nothing, a small picture for the list of scenes, or the scene itself. */
enum interest { NOBODY, LISTED, SHOWN };

static enum interest interest_in(served_scene *s, enum scene_state *state)
{
    const served_scenes *all = s->all;
    const uint64_t now = fxs_clock(0);
    pthread_mutex_lock(&s->all->lock);
    const int is_shown = !all->options->has_list || (s->asked_at && now - s->asked_at < LOOKS);
    const int is_listed = all->listed_at && now - all->listed_at < LOOKS && s->picture < 0;
    *state = s->state;
    pthread_mutex_unlock(&s->all->lock);
    return is_shown ? SHOWN : is_listed ? LISTED : NOBODY;
}

int scenes_work(served_scenes *all)
{
    served_scene *next = 0;
    enum interest most = NOBODY;
    for (int i = 0; i < all->count; i++) {
        enum scene_state state;
        const enum interest interest = interest_in(&all->scenes[i], &state);
        if (interest == SHOWN && state != WAITS)
            follow(&all->scenes[i]);
        if (state == WAITS && interest > most) {
            next = &all->scenes[i];
            most = interest;
        }
    }
    if (!next)
        return 0;
    return take_first(next) && !all->options->has_list ? -1 : 1;
}

served_scenes *scenes_new(const served_options *options, int most)
{
    served_scenes *all = calloc(1, sizeof *all);
    if (!all || !(all->scenes = calloc((size_t)most, sizeof *all->scenes))) {
        free(all);
        return 0;
    }
    all->options = options;
    pthread_mutex_init(&all->lock, 0);
    return all;
}

static int name_scene(served_scene *s, int is_sent)
{
    const char *base, *ending = is_sent ? "" : ".fxs";
    const int length = base_of(&base, s->given);
    s->names[0] = text_of("/scenes/%d/%.*s%s", s->number, length, base, ending);
    s->names[1] = text_of("/scenes/%d/next/%.*s%s", s->number, length, base, ending);
    s->names[2] = text_of("/scenes/%d.json", s->number);
    s->names[3] = text_of("/scenes/%d.jpg", s->number);
    for (int i = 0; i < FILES; i++)
        if (!s->names[i])
            return fail(EXIT_FAILED, "out of memory");
    return 0;
}

static void find_twins(served_scenes *all, served_scene *s)
{
    const char *base, *other;
    const int length = base_of(&base, s->given);
    for (int i = 0; i < s->number; i++) {
        served_scene *before = &all->scenes[i];
        if (base_of(&other, before->given) == length && !strncmp(base, other, (size_t)length))
            s->is_twice = before->is_twice = 1;
    }
}

int scenes_add(served_scenes *all, const char *path, int is_sure)
{
    served_scene *s = &all->scenes[all->count];
    first_look look = {.is_sent = ends_with(path, ".fxs")};
    s->all = all;
    s->number = all->count++;
    s->given = path;
    s->picture = s->descriptors[0] = s->descriptors[1] = NONE;
    if (is_sure && look_first(path, &all->options->load, &look))
        return EXIT_FAILED;
    s->path = fxs_path_whole(path);
    if (!s->path && !(is_sure ? 0 : (s->path = strdup(path))))
        return fail(EXIT_FAILED, "%s: %s", path, strerror(errno));
    find_twins(all, s);
    if (name_scene(s, look.is_sent))
        return EXIT_FAILED;
    return is_sure && look.is_sent && !all->options->has_list ? take_first(s) : 0;
}

const char *scenes_address(const served_scenes *all, int scene)
{
    return all->scenes[scene].names[0];
}

const char *scenes_title(const served_scenes *all, int scene)
{
    const served_scene *s = &all->scenes[scene];
    const char *base;
    base_of(&base, s->given);
    return s->is_twice ? s->given : base;
}

void scenes_free(served_scenes *all)
{
    for (int i = 0; all && i < all->count; i++) {
        served_scene *s = &all->scenes[i];
        for (int j = 0; j < FILES; j++)
            free(s->names[j]);
        for (int j = 0; j < VERSIONS; j++)
            replace(&s->descriptors[j], NONE);
        replace(&s->picture, NONE);
        free(s->path);
    }
    if (all)
        free(all->scenes);
    free(all);
}
