/* Tests the trial of back ends: which is taken, what is kept, and that no file breaks it. The back ends of the test are
   the processor's with faults. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/backends.h>
#include <fixsplat/internal/message.h>
#include "tools/command/trial.h"
#include "check.h"

static fxs_message why;

/* Wait of each frame of the processor, nanoseconds: other back ends of the test are faster. */
enum { WAIT = 30000000 };

static int slow_render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *message)
{
    const uint64_t start = fxs_clock(NULL);
    const int error = fxs_backend_cpu.render(self, request, stats, message);
    while (fxs_clock(NULL) - start < WAIT)
        ;
    return error;
}

/* Changes one bit of one pixel. */
static int wrong_render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *message)
{
    const int error = fxs_backend_cpu.render(self, request, stats, message);
    const fxs_image *colour = &request->targets[0].colour;
    ((uint8_t *)colour->pixels)[100 * colour->stride + 400] ^= 1;
    return error;
}

static int failing_render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *message)
{
    (void)self, (void)request, (void)stats;
    return fxs_fail_as(FXS_ERR_DEVICE, message, "lost\nthe device");
}

static int failing_open(void **self, const fxs_backend_options *options, fxs_message *message)
{
    (void)options;
    *self = NULL;
    return fxs_fail_as(FXS_ERR_DEVICE, message, "no memory");
}

static int no_device(int device, char *name, size_t size, fxs_message *message)
{
    (void)device, (void)name, (void)size;
    return fxs_fail_as(FXS_ERR_DEVICE, message, "no driver");
}

static fxs_backend like_cpu(const char *name)
{
    fxs_backend b = fxs_backend_cpu;
    b.name = name;
    return b;
}

enum { CPU, ABSENT, CLOSED, FAILING, WRONG, SLOW, FAST, COUNT };
static fxs_backend table[COUNT];
static const fxs_backend *all[COUNT];

static void make_table(void)
{
    static const char *const names[] = {"cpu", "absent", "closed", "failing", "wrong", "slow", "fast"};
    for (int i = 0; i < COUNT; i++) {
        table[i] = like_cpu(names[i]);
        all[i] = &table[i];
    }
    table[CPU].render = table[SLOW].render = slow_render;
    table[ABSENT].device = no_device;
    table[CLOSED].open = failing_open;
    table[FAILING].render = failing_render;
    table[WRONG].render = wrong_render;
    table[FAST].can = FXS_CAN_TRACE;
}

/* Sees that a back end is marked as begun while it draws, and as done after it. */
static void see_begun(void *seen, const trial *t)
{
    int *calls = seen, begun = 0;
    for (int i = 0; i < t->count; i++)
        begun += t->results[i].state == TRIAL_BEGUN;
    CHECK(begun == (*calls < COUNT - 1));
    CHECK(*calls == COUNT - 1 || t->results[*calls + 1].state == TRIAL_BEGUN);
    ++*calls;
}

static trial made;

static void chosen(void)
{
    static const enum trial_state states[COUNT] = {TRIAL_EXACT, TRIAL_ABSENT, TRIAL_FAILED, TRIAL_FAILED, TRIAL_DIFFERS,
                                                   TRIAL_EXACT, TRIAL_EXACT};
    int calls = 0;
    trial_run(&made, all, COUNT, see_begun, &calls);
    CHECK(calls == COUNT && made.count == COUNT);
    for (int i = 0; i < COUNT; i++)
        CHECK(made.results[i].state == states[i] && made.results[i].backend == all[i]);
    CHECK(made.results[CPU].frame_us >= WAIT / 1000 && made.results[FAST].frame_us);
    CHECK(!strcmp(made.results[ABSENT].text, "no driver") && !strcmp(made.results[CLOSED].text, "no memory"));
    CHECK(!strncmp(made.results[FAILING].text, "lost", 4) && !strchr(made.results[FAILING].text, '\n'));
    made.results[FAST].frame_us = made.results[SLOW].frame_us - 1;
    made.results[CPU].frame_us = made.results[SLOW].frame_us;
    made.results[WRONG].frame_us = 1;
    CHECK(trial_fastest(&made, 0) == &made.results[FAST]);
    CHECK(trial_fastest(&made, FXS_CAN_RATES) == &made.results[CPU]);
    made.results[CPU].frame_us = 1;
    CHECK(trial_fastest(&made, 0) == &made.results[CPU]);
}

static int same(const trial *a, const trial *b)
{
    int is_same = a->count == b->count;
    for (int i = 0; i < a->count && is_same; i++) {
        const trial_result *x = &a->results[i], *y = &b->results[i];
        is_same = x->backend == y->backend && x->state == y->state && x->frame_us == y->frame_us &&
                  x->open_us == y->open_us && !strcmp(x->text, y->text);
    }
    return is_same;
}

static int write_bytes(const char *path, const char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    const size_t written = file ? fwrite(bytes, 1, size, file) : 0;
    return file && !fclose(file) && written == size;
}

/* Reads the kept file with each of its bytes changed in turn, and cut at each length. A file that is read must have
   only known states and texts of one line. */
static void broken(const char *path, const char *bytes, size_t size)
{
    char changed[4096];
    trial t;
    for (size_t i = 0; i < size; i++) {
        memcpy(changed, bytes, size);
        changed[i] = (char)(i % 3 == 0 ? 0 : i % 3 == 1 ? '\n' : changed[i] ^ 0x55);
        CHECK(write_bytes(path, changed, size));
        if (trial_read(&t, all, COUNT, path, "key 1"))
            continue;
        for (int k = 0; k < COUNT; k++)
            CHECK(t.results[k].state <= TRIAL_EXACT && !strpbrk(t.results[k].text, "\n\033"));
    }
    for (size_t i = 0; i + 20 < size; i++)
        CHECK(write_bytes(path, bytes, i) && trial_read(&t, all, COUNT, path, "key 1"));
}

static void kept(void)
{
    char path[] = "/tmp/fixsplat-trial-XXXXXX", bytes[4096];
    const int descriptor = mkstemp(path);
    trial t;
    CHECK(descriptor >= 0);
    close(descriptor);
    CHECK(trial_read(&t, all, COUNT, path, "key 1"));
    CHECK(!trial_write(&made, path, "key 1", &why) && !trial_read(&t, all, COUNT, path, "key 1") && same(&t, &made));
    CHECK(trial_read(&t, all, COUNT, path, "key 2") && trial_read(&t, all, COUNT, path, "key"));
    CHECK(trial_read(&t, all, COUNT - 1, path, "key 1") == 0 && trial_read(&t, all + 1, COUNT - 1, path, "key 1"));
    CHECK(trial_read(&t, all, COUNT, "/tmp", "key 1") && trial_read(&t, all, COUNT, "/dev/zero", "key 1"));
    FILE *file = fopen(path, "rb");
    const size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    CHECK(file && size > 100 && size < sizeof bytes);
    if (file)
        fclose(file);
    broken(path, bytes, size);
    memset(bytes, 'x', sizeof bytes);
    CHECK(write_bytes(path, bytes, sizeof bytes) && trial_read(&t, all, COUNT, path, "key 1"));
    unlink(path);
    CHECK(trial_read(&t, all, COUNT, path, "key 1") && trial_write(&made, "/none/trial", "key 1", &why) && why.text[0]);
}

int main(void)
{
    make_table();
    RUN(chosen);
    RUN(kept);
    return check_report();
}
