/* Every format must give the same Gaussians from a file, from memory and by read functions. A failed allocation or
   read must be an error without a leak. */
#include <fixsplat/internal/allocator.h>

#include "every_format_bytes.h"

enum { MOST = 64 };

/* fails_at: index of the allocation that fails; -1: none */
static struct { long calls, live, fails_at; size_t largest; } memory;

static void *allocate(void *argument, size_t length)
{
    CHECK(argument == &memory && length > 0);
    if (memory.calls++ == memory.fails_at)
        return NULL;
    memory.live++;
    memory.largest = length > memory.largest ? length : memory.largest;
    return malloc(length);
}

static void release(void *argument, void *block)
{
    CHECK(argument == &memory && block != NULL);
    memory.live--;
    free(block);
}

static const fxs_allocator counting = {allocate, release, &memory};

static void count_from_0(long fails_at)
{
    memory.calls = memory.live = 0;
    memory.largest = 0;
    memory.fails_at = fails_at;
}

/* fails_from: index of the first read that fails; -1: none */
static struct { long reads, open, fails_from; } input_calls;

static int read_made(void *argument, uint64_t offset, void *out, size_t length)
{
    const struct made_file *f = argument;
    if (!CHECK(length > 0 && offset <= f->size && length <= f->size - offset))
        return -1;
    if (input_calls.fails_from >= 0 && input_calls.reads >= input_calls.fails_from)
        return -1;
    input_calls.reads++;
    memcpy(out, f->data + offset, length);
    return 0;
}

static void close_made(void *argument)
{
    CHECK(argument != NULL);
    input_calls.open--;
}

static int open_beside(void *argument, const char *name, fxs_scene_input *input)
{
    CHECK(argument == &files[0]);
    for (int i = 0; i < file_count; i++)
        if (strcmp(files[i].name, name) == 0) {
            *input = (fxs_scene_input){files[i].size, read_made, NULL, close_made, &files[i]};
            input_calls.open++;
            return 0;
        }
    return -1;
}

static void forget_calls(long fails_from)
{
    input_calls.reads = input_calls.open = 0;
    input_calls.fails_from = fails_from;
}

typedef enum way { BY_PATH, BY_MEMORY, BY_INPUT } way;

static char folder[96] = "/tmp/test_input_XXXXXX";

static int open_made(way by, const fxs_scene_file_options *options, fxs_scene_file **file)
{
    fxs_scene_input input = {files[0].size, read_made, open_beside, close_made, &files[0]};
    char full[128];
    if (by == BY_MEMORY)
        return fxs_scene_file_open_memory("folder/made", files[0].data, files[0].size, options, file, &info, &message);
    if (by == BY_INPUT) {
        input_calls.open++;
        return fxs_scene_file_open_input("folder/made", &input, options, file, &info, &message);
    }
    snprintf(full, sizeof full, "%s/%.31s", folder, files[0].name);
    return fxs_scene_file_open(full, options, file, &info, &message);
}

static long read_made_scene(way by, const fxs_scene_file_options *options, fxs_gaussian *gaussians)
{
    fxs_scene_file *file;
    const int error = open_made(by, options, &file);
    if (error) {
        CHECK(file == NULL);
        return error;
    }
    long count = fxs_scene_file_read(file, gaussians, 1, &message);
    if (count >= 0 && fxs_scene_file_rewind(file, &message) == 0)
        count = fxs_scene_file_read(file, gaussians, MOST, &message);
    fxs_scene_file_close(file);
    return count;
}

static void same_from_everywhere(void)
{
    static fxs_gaussian out[3][MOST];
    for (int i = 0; i < FORMATS; i++) {
        const struct made_format *f = make_format(i);
        write_made(folder);
        forget_calls(-1);
        long count = read_made_scene(BY_PATH, NULL, out[0]);
        if (!CHECK(count >= 2 && strcmp(info.format, f->name) == 0 && (uint64_t)count == info.count))
            printf("  %s\n", message.text);
        CHECK(read_made_scene(BY_INPUT, NULL, out[2]) == count && input_calls.reads > 0 && input_calls.open == 0);
        CHECK(memcmp(out[0], out[2], (size_t)(count < 0 ? 0 : count) * sizeof **out) == 0);
        if (!f->is_several) {
            CHECK(read_made_scene(BY_MEMORY, NULL, out[1]) == count);
            CHECK(memcmp(out[0], out[1], (size_t)(count < 0 ? 0 : count) * sizeof **out) == 0);
        } else {
            CHECK(read_made_scene(BY_MEMORY, NULL, out[1]) == FXS_ERR_FILE);
            CHECK(strncmp(message.text, "folder/made: needs the file ", 28) == 0);
        }
        remove_made(folder);
    }
}

static void file_that_is_not_there(void)
{
    static fxs_gaussian out[MOST];
    for (int i = 0; i < FORMATS; i++) {
        if (!make_format(i)->is_several)
            continue;
        file_count--;
        forget_calls(-1);
        CHECK(read_made_scene(BY_INPUT, NULL, out) == FXS_ERR_FILE && input_calls.open == 0);
        if (!CHECK(strncmp(message.text, "folder/", 7) == 0 && strstr(message.text, ": cannot be opened")))
            printf("  %s\n", message.text);
    }
}

static void move_and_link(const char *from, const char *to)
{
    CHECK(rename(from, to) == 0 && symlink(to, from) == 0);
}

static void move_back(const char *from, const char *to)
{
    CHECK(unlink(from) == 0 && rename(to, from) == 0);
}

static void links_stay_in_the_folder(void)
{
    static fxs_gaussian out[MOST];
    char outside[128], inside[128], linked[128];
    snprintf(outside, sizeof outside, "%s.outside", folder);
    snprintf(inside, sizeof inside, "%s/inside", folder);
    for (int i = 0; i < FORMATS; i++) {
        if (!make_format(i)->is_several)
            continue;
        write_made(folder);
        snprintf(linked, sizeof linked, "%s/%.31s", folder, files[file_count - 1].name);
        CHECK(read_made_scene(BY_PATH, NULL, out) > 0);
        while (strlen(linked) > strlen(folder)) {   /* replaces the file by a link, then each folder above it */
            move_and_link(linked, outside);
            if (!CHECK(read_made_scene(BY_PATH, NULL, out) == FXS_ERR_FILE &&
                       strstr(message.text, ": leaves the folder of ")))
                printf("  %s\n", message.text);
            move_back(linked, outside);
            move_and_link(linked, inside);
            if (!CHECK(read_made_scene(BY_PATH, NULL, out) > 0))
                printf("  %s\n", message.text);
            move_back(linked, inside);
            *strrchr(linked, '/') = '\0';
        }
        remove_made(folder);
    }
}

static void linked_scene(void)
{
    static fxs_gaussian out[MOST];
    char outside[128], full[128];
    snprintf(outside, sizeof outside, "%s.outside", folder);
    for (int i = 0; i < FORMATS; i++) {
        make_format(i);
        write_made(folder);
        snprintf(full, sizeof full, "%s/%.31s", folder, files[0].name);
        move_and_link(full, outside);
        CHECK(read_made_scene(BY_PATH, NULL, out) > 0);
        move_back(full, outside);
        remove_made(folder);
    }
}

static void only_regular_files(void)
{
    static fxs_gaussian out[MOST];
    static const char *const others[] = {"pipe", "folder"};
    for (int i = 0; i < FORMATS; i++) {
        make_format(i);
        for (int which = 0; which < 2 * file_count; which++) {
            char full[128];
            write_made(folder);
            snprintf(full, sizeof full, "%s/%.31s", folder, files[which / 2].name);
            CHECK(unlink(full) == 0 && (which % 2 ? mkdir(full, 0700) : mkfifo(full, 0600)) == 0);
            alarm(10);
            if (!CHECK(read_made_scene(BY_PATH, NULL, out) == FXS_ERR_FILE &&
                       (strstr(message.text, ": not a regular file") ||
                                                                     strstr(message.text, "meta.json: No such file"))))
                printf("  %s for %s: %s\n", others[which % 2], files[which / 2].name, message.text);
            alarm(0);
            if (which % 2)
                rmdir(full);
            remove_made(folder);
        }
    }
}

static int is_one_line(void)
{
    return strncmp(message.text, "folder/", 7) == 0 && !strpbrk(message.text, "\r\n");
}

static void every_allocation_fails(void)
{
    static fxs_gaussian out[MOST];
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .allocator = &counting};
    for (int i = 0; i < FORMATS; i++) {
        const struct made_format *f = make_format(i);
        const way by = f->is_several ? BY_INPUT : BY_MEMORY;
        long count, n = 0;
        forget_calls(-1);
        do {
            count_from_0(n++);
            count = read_made_scene(by, &options, out);
            CHECK(memory.live == 0 && input_calls.open == 0);
            if (memory.calls >= n && !CHECK(count == FXS_ERR_MEMORY && is_one_line() &&
                                            strstr(message.text, "out of memory")))
                printf("  %s, allocation %ld: %s\n", f->name, n, message.text);
        } while (memory.calls >= n && n < 1000);
        CHECK(n >= 4 && n < 1000 && count >= 2);
    }
}

static void every_read_fails(void)
{
    static fxs_gaussian out[MOST];
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .allocator = &counting};
    for (int i = 0; i < FORMATS; i++) {
        const struct made_format *f = make_format(i);
        long count, n = 0;
        do {
            count_from_0(-1);
            forget_calls(n++);
            count = read_made_scene(BY_INPUT, &options, out);
            CHECK(memory.live == 0 && input_calls.open == 0);
            CHECK(count >= 0 || (count == FXS_ERR_FILE && is_one_line() && message.bytes_needed == 0));
        } while (count < 0 && n < 1000);
        if (!CHECK(n >= 3 && n < 1000 && input_calls.reads == n - 1))
            printf("  %s: %ld reads, succeeds with %ld\n", f->name, input_calls.reads, n - 1);
    }
}

#ifdef FXS_WITH_ZLIB

enum { MANY = 50000, MANY_BYTES = 20 * MANY };

static void make_large_spz(void)
{
    static uint8_t plain[16 + MANY_BYTES];
    spz_bytes s;
    memset(&s, 0, sizeof s);
    s.version = 3;
    s.count = MANY;
    spz_put_header(&s, plain);
    for (uint32_t i = 0, state = 1; i < MANY_BYTES; i++, state = state * 1664525 + 1013904223)
        plain[16 + i] = (uint8_t)(state >> 30);
    size = spz_gzip(plain, sizeof plain, bytes, MAX_FILE);
}

static void count_comes_first(void)
{
    static fxs_gaussian one;
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .allocator = &counting};
    fxs_scene_file *file;
    make_large_spz();
    count_from_0(-1);
    if (!CHECK(fxs_scene_file_open_memory(path, bytes, size, &options, &file, &info, &message) == 0))
        return;
    CHECK(info.count == MANY && info.sh_degree == 0 && memory.largest < 100000);
    memory.fails_at = memory.calls + 1;   /* fails the allocation that follows the gzip buffer's */
    CHECK(fxs_scene_file_read(file, &one, 1, &message) == FXS_ERR_MEMORY && strstr(message.text, "out of memory"));
    memory.fails_at = -1;
    CHECK(fxs_scene_file_read(file, &one, 1, &message) == 1 && memory.largest >= MANY_BYTES);
    fxs_scene_file_close(file);
    CHECK(memory.live == 0);
}

#else

static void count_comes_first(void)
{
    SKIP("built without zlib");
}

#endif

/* stops_at: index of the progress callback that stops the import; -1: none */
static struct { int calls, stops_at; double done; } progress;

static int note_progress(void *argument, double done)
{
    CHECK(argument == &progress && done >= progress.done && done <= 1);
    progress.done = done;
    return progress.calls++ == progress.stops_at;
}

#if defined(FXS_WITH_ZLIB) && defined(WITH_SOG)

static const fxs_scene_file_options watched = {.size = sizeof(fxs_scene_file_options), 
    .allocator = &counting, .progress.call = note_progress, .progress.argument = &progress
};

static void progress_is_told(void)
{
    static fxs_gaussian out[MOST];
    fxs_scene_file *file;
    int calls;
    forget_calls(-1);
    progress.stops_at = -1;
    make_large_spz();
    count_from_0(-1);
    CHECK(fxs_scene_file_open_memory(path, bytes, size, &watched, &file, &info, &message) == 0);
    progress.done = 0;
    progress.calls = 0;
    CHECK(fxs_scene_file_read(file, out, 1, &message) == 1);
    CHECK(progress.calls >= 3 && progress.done > 0.5);
    fxs_scene_file_close(file);
    progress.done = 0;
    progress.calls = 0;
    for (int i = 0; i < FORMATS && formats[i].make != make_streamed_sog; i++)
        make_format(i + 1);
    CHECK(read_made_scene(BY_INPUT, &watched, out) == 5 && progress.calls == 2);
    calls = progress.calls;
    for (progress.stops_at = 0; progress.stops_at < calls; progress.stops_at++) {
        progress.done = 0;
        progress.calls = 0;
        CHECK(read_made_scene(BY_INPUT, &watched, out) == FXS_ERR_STOPPED &&
              strcmp(message.text, "folder/made: stopped") == 0);
        CHECK(progress.calls == progress.stops_at + 1 && memory.live == 0 && input_calls.open == 0);
    }
}

static void every_progress_stops(void)
{
    fxs_scene_file *file;
    fxs_gaussian one;
    make_large_spz();
    for (int n = 0; n < 3; n++) {
        count_from_0(-1);
        progress.calls = 0;
        progress.done = 0;
        progress.stops_at = n;
        if (fxs_scene_file_open_memory(path, bytes, size, &watched, &file, &info, &message) == 0) {
            progress.done = 0;
            CHECK(fxs_scene_file_read(file, &one, 1, &message) == FXS_ERR_STOPPED);
            fxs_scene_file_close(file);
        }
        CHECK(progress.calls == n + 1 && strstr(message.text, ": stopped") && memory.live == 0);
    }
}

#else

static void progress_is_told(void)
{
    (void)note_progress;
    SKIP("built without zlib, libwebp or cJSON");
}

static void every_progress_stops(void)
{
    SKIP("built without zlib, libwebp or cJSON");
}

#endif

static void allocator_helpers(void)
{
    const fxs_allocator *both[] = {NULL, &counting};
    count_from_0(-1);
    for (int i = 0; i < 2; i++) {
        const fxs_allocator *a = both[i];
        CHECK(fxs_allocate(a, SIZE_MAX / 2, 3) == NULL && fxs_allocate_zeroed(a, SIZE_MAX / 2, 3) == NULL);
        CHECK(fxs_enlarge(a, NULL, 0, SIZE_MAX / 2, 3) == NULL && memory.calls == 0);
        void *empty = fxs_allocate(a, 0, 8), *also = fxs_allocate_zeroed(a, 8, 0);
        CHECK(empty && also);
        fxs_release(a, empty);
        fxs_release(a, also);
        fxs_release(a, NULL);
        uint8_t *block = fxs_allocate_zeroed(a, 10, 10);
        if (!CHECK(block != NULL))
            return;
        for (int k = 0; k < 100; k++)
            CHECK(block[k] == 0);
        memset(block, 7, 100);
        uint8_t *larger = fxs_enlarge(a, block, 10, 30, 10);
        CHECK(larger && larger[0] == 7 && larger[99] == 7);
        fxs_release(a, larger);
        CHECK(memory.live == 0);
        count_from_0(-1);
    }
}

static int write_all(const char *parent)
{
    for (int i = 0; i < FORMATS; i++) {
        make_format(i);
        snprintf(folder, sizeof folder, "%s/%d", parent, i);
        mkdir(folder, 0700);
        write_made(folder);
        printf("%d/%s\n", i, files[0].name);
    }
    return check_faults != 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_all(argv[2]);
    if (!mkdtemp(folder))
        return 1;
    RUN(same_from_everywhere);
    RUN(file_that_is_not_there);
    RUN(links_stay_in_the_folder);
    RUN(linked_scene);
    RUN(only_regular_files);
    RUN(every_allocation_fails);
    RUN(every_read_fails);
    RUN(count_comes_first);
    RUN(progress_is_told);
    RUN(every_progress_stops);
    RUN(allocator_helpers);
    rmdir(folder);
    return check_report();
}
