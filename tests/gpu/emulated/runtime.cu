/* Implements the emulated CUDA of cuda_runtime.h: coroutines, streams and memory. */
#include <fenv.h>
#include <setjmp.h>
#include <ucontext.h>

#include <algorithm>
#include <deque>
#include <map>
#include <vector>

#include <cuda_runtime.h>

#include "ptx.h"

dim3 threadIdx, blockIdx, blockDim, gridDim;

namespace emulated {

unsigned char shared[SHARED_BYTES];

namespace {

enum { THREADS_MOST = 1024, BARRIERS = 16, STACK_BYTES = 128 << 10 };

[[noreturn]] void give_up(const char *why)
{
    fprintf(stderr, "emulated CUDA: %s\n", why);
    abort();
}

/* ---- Threads of a block ------------------------------------------------------------------------------------------ */

struct coroutine {
    ucontext_t first;
    jmp_buf at;
    bool has_begun, has_ended;
};

struct lanes_meeting {
    uint32_t here;
    uint64_t times, coming[32], all[32];
};

struct block_meeting {
    uint32_t here, sum, all;
    uint64_t times;
};

coroutine threads[THREADS_MOST];
jmp_buf scheduler;
uint32_t now, alive;
bool has_moved;                            /* true: some thread has made progress in the current round */
lanes_meeting warps[THREADS_MOST / 32];     /* state of the warp operation that the lanes of each warp wait for */
std::map<uint32_t, lanes_meeting> parts_of_warps[THREADS_MOST / 32];
block_meeting barriers[BARRIERS];
const std::function<void()> *body;

void pause_thread()
{
    if (!_setjmp(threads[now].at))
        _longjmp(scheduler, 1);
}

void end_meeting(block_meeting *m)
{
    m->all = m->sum;
    m->sum = m->here = 0;
    m->times++;
}

void run_threads()
{
    for (;;) {
        (*body)();
        threads[now].has_ended = has_moved = true;
        alive--;
        if (barriers[0].here && barriers[0].here == alive)
            end_meeting(&barriers[0]);
        pause_thread();
    }
}

void make_threads()
{
    unsigned char *stacks = (unsigned char *)malloc((size_t)THREADS_MOST * STACK_BYTES);
    if (!stacks)
        give_up("no memory");
    for (uint32_t i = 0; i < THREADS_MOST; i++) {
        ucontext_t *first = &threads[i].first;
        getcontext(first);
        first->uc_stack.ss_sp = stacks + (size_t)i * STACK_BYTES;
        first->uc_stack.ss_size = STACK_BYTES;
        makecontext(first, run_threads, 0);
    }
}

void take_turn(uint32_t thread)
{
    coroutine *t = &threads[thread];
    now = thread;
    threadIdx.x = thread;
    if (_setjmp(scheduler))
        return;
    if (t->has_begun)
        _longjmp(t->at, 1);
    t->has_begun = true;
    setcontext(&t->first);
}

void run_block(uint32_t count)
{
    alive = count;
    memset(shared, 0xa5, sizeof shared);
    memset(barriers, 0, sizeof barriers);
    for (uint32_t i = 0; i < count; i++)
        threads[i].has_ended = false;
    memset(warps, 0, sizeof warps);
    for (auto &parts : parts_of_warps)
        parts.clear();
    while (alive) {
        has_moved = false;
        for (uint32_t i = 0; i < count; i++)
            if (!threads[i].has_ended)
                take_turn(i);
        if (!has_moved)
            give_up("threads of a block wait for each other");
    }
}

}

const uint64_t *meet(uint32_t lanes, uint64_t own)
{
    const uint32_t me = lane();
    lanes_meeting *m = lanes == ~0u ? &warps[now / 32] : &parts_of_warps[now / 32][lanes];
    if (!(lanes >> me & 1) || m->here >> me & 1)
        give_up("a lane is where it should not be");
    m->coming[me] = own;
    m->here |= 1u << me;
    has_moved = true;
    if (m->here == lanes) {
        memcpy(m->all, m->coming, sizeof m->all);
        m->here = 0;
        m->times++;
    } else {
        for (const uint64_t before = m->times; m->times == before;)
            pause_thread();
        has_moved = true;
    }
    return m->all;
}

uint32_t meet_block(uint32_t barrier, uint32_t count, uint32_t own)
{
    block_meeting *m = &barriers[barrier];
    m->here++;
    m->sum += own;
    has_moved = true;
    if (m->here == (count ? count : alive))
        end_meeting(m);
    else
        for (const uint64_t before = m->times; m->times == before;)
            pause_thread();
    return m->all;
}

void run_grid(uint32_t blocks, uint32_t count, const std::function<void()> &thread)
{
    if (!threads[0].has_begun)
        make_threads();
    if (count > THREADS_MOST)
        give_up("a block with too many threads");
    body = &thread;
    gridDim.x = blocks;
    blockDim.x = count;
    for (uint32_t i = 0; i < blocks; i++) {
        blockIdx.x = i;
        run_block(count);
    }
}

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

struct event {
    uint64_t recorded, done, time;   /* number of records queued, number of records executed, time of the last record */
};

struct operation {
    std::function<void()> work;
    event *awaited;
    uint64_t record;
};

struct stream {
    std::deque<operation> operations;
};

namespace {

stream default_stream;
std::vector<stream *> streams = {&default_stream};
uint64_t chance = 1, steps;

/* Runs the next operation of a randomly chosen CUDA stream. Returns false if every stream is blocked. */
bool take_step()
{
    std::vector<stream *> ready;
    for (stream *s : streams)
        if (!s->operations.empty()) {
            const operation &next = s->operations.front();
            if (!next.awaited || next.awaited->done >= next.record)
                ready.push_back(s);
        }
    if (ready.empty())
        return false;
    chance = chance * 6364136223846793005u + 1442695040888963407u;
    stream *s = ready[(chance >> 33) % ready.size()];
    const operation next = s->operations.front();
    s->operations.pop_front();
    if (next.work)
        next.work();
    steps++;
    return true;
}

template <class Done>
void run_until(Done done)
{
    while (!done())
        if (!take_step())
            give_up("streams wait for each other");
}

void run_all()
{
    run_until([] {
        return std::all_of(streams.begin(), streams.end(), [](stream *s) { return s->operations.empty(); });
    });
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

struct memory_block {
    size_t bytes;
    int type;
};

std::map<uintptr_t, memory_block> memory_blocks;

int type_of(const void *memory)
{
    auto after = memory_blocks.upper_bound((uintptr_t)memory);
    if (after == memory_blocks.begin())
        return cudaMemoryTypeUnregistered;
    const auto &found = *--after;
    return (uintptr_t)memory < found.first + found.second.bytes ? found.second.type : (int)cudaMemoryTypeUnregistered;
}

cudaError_t make_memory(void **memory, size_t bytes, int type, int byte)
{
    if (posix_memalign(memory, 256, bytes ? bytes : 1))
        return cudaErrorMemoryAllocation;
    memset(*memory, byte, bytes);
    memory_blocks[(uintptr_t)*memory] = {bytes, type};
    return cudaSuccess;
}

int setting(const char *name, int otherwise)
{
    const char *text = getenv(name);
    return text ? atoi(text) : otherwise;
}

}

void enqueue(cudaStream_t to, std::function<void()> work)
{
    (to ? to : &default_stream)->operations.push_back({work, nullptr, 0});
}

}

using namespace emulated;

cudaError_t cudaMalloc(void **memory, size_t bytes)
{
    return make_memory(memory, bytes, cudaMemoryTypeDevice, 0xcd);
}

cudaError_t cudaHostAlloc(void **memory, size_t bytes, unsigned)
{
    return make_memory(memory, bytes, cudaMemoryTypeHost, 0);
}

cudaError_t cudaFree(void *memory)
{
    if (!memory)
        return cudaSuccess;
    run_all();
    memory_blocks.erase((uintptr_t)memory);
    free(memory);
    return cudaSuccess;
}

cudaError_t cudaFreeHost(void *memory)
{
    return cudaFree(memory);
}

cudaError_t cudaHostGetDevicePointer(void **there, void *here, unsigned)
{
    *there = here;
    return cudaSuccess;
}

cudaError_t cudaMemGetInfo(size_t *unused, size_t *all)
{
    *unused = *all = (size_t)16 << 30;
    return cudaSuccess;
}

cudaError_t cudaPointerGetAttributes(cudaPointerAttributes *attributes, const void *memory)
{
    attributes->type = type_of(memory);
    return cudaSuccess;
}

cudaError_t cudaMemcpy2DAsync(void *to, size_t to_pitch, const void *from, size_t from_pitch, size_t width,
                              size_t height, cudaMemcpyKind, cudaStream_t stream)
{
    std::vector<unsigned char> kept;
    const bool is_read_now = type_of(from) == cudaMemoryTypeUnregistered;
    for (size_t y = 0; y < height && is_read_now; y++) {
        const unsigned char *row = (const unsigned char *)from + y * from_pitch;
        kept.insert(kept.end(), row, row + width);
    }
    enqueue(stream, [=] {
        for (size_t y = 0; y < height; y++)
            memcpy((char *)to + y * to_pitch,
                   is_read_now ? (const void *)&kept[y * width] : (const char *)from + y * from_pitch, width);
    });
    return cudaSuccess;
}

cudaError_t cudaMemcpyAsync(void *to, const void *from, size_t bytes, cudaMemcpyKind kind, cudaStream_t stream)
{
    return bytes ? cudaMemcpy2DAsync(to, bytes, from, bytes, bytes, 1, kind, stream) : cudaSuccess;
}

cudaError_t cudaMemcpy2D(void *to, size_t to_pitch, const void *from, size_t from_pitch, size_t width, size_t height,
                         cudaMemcpyKind kind)
{
    cudaMemcpy2DAsync(to, to_pitch, from, from_pitch, width, height, kind, nullptr);
    return cudaStreamSynchronize(nullptr);
}

cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind kind)
{
    cudaMemcpyAsync(to, from, bytes, kind, nullptr);
    return cudaStreamSynchronize(nullptr);
}

cudaError_t cudaMemsetAsync(void *to, int byte, size_t bytes, cudaStream_t stream)
{
    enqueue(stream, [=] { memset(to, byte, bytes); });
    return cudaSuccess;
}

cudaError_t cudaMemset(void *to, int byte, size_t bytes)
{
    cudaMemsetAsync(to, byte, bytes, nullptr);
    return cudaStreamSynchronize(nullptr);
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t *made, unsigned)
{
    *made = new stream;
    streams.push_back(*made);
    return cudaSuccess;
}

cudaError_t cudaStreamCreateWithPriority(cudaStream_t *made, unsigned flags, int)
{
    return cudaStreamCreateWithFlags(made, flags);
}

cudaError_t cudaDeviceGetStreamPriorityRange(int *least, int *most)
{
    *least = *most = 0;
    return cudaSuccess;
}

cudaError_t cudaStreamDestroy(cudaStream_t old)
{
    run_all();
    streams.erase(std::find(streams.begin(), streams.end(), old));
    delete old;
    return cudaSuccess;
}

cudaError_t cudaStreamSynchronize(cudaStream_t of)
{
    stream *s = of ? of : &default_stream;
    run_until([=] { return s->operations.empty(); });
    return cudaSuccess;
}

cudaError_t cudaStreamWaitEvent(cudaStream_t waits, cudaEvent_t for_event, unsigned)
{
    (waits ? waits : &default_stream)->operations.push_back({nullptr, for_event, for_event->recorded});
    return cudaSuccess;
}

cudaError_t cudaEventCreate(cudaEvent_t *made)
{
    *made = new event();
    return cudaSuccess;
}

cudaError_t cudaEventCreateWithFlags(cudaEvent_t *made, unsigned)
{
    return cudaEventCreate(made);
}

cudaError_t cudaEventDestroy(cudaEvent_t old)
{
    run_all();
    delete old;
    return cudaSuccess;
}

cudaError_t cudaEventRecord(cudaEvent_t e, cudaStream_t stream)
{
    const uint64_t record = ++e->recorded;
    enqueue(stream, [=] {
        if (e->done > record)
            give_up("an event is recorded in two streams");
        e->done = record;
        e->time = steps;
    });
    return cudaSuccess;
}

cudaError_t cudaEventSynchronize(cudaEvent_t e)
{
    const uint64_t record = e->recorded;
    run_until([=] { return e->done >= record; });
    return cudaSuccess;
}

cudaError_t cudaEventQuery(cudaEvent_t e)
{
    return e->done >= e->recorded ? cudaSuccess : cudaErrorNotReady;
}

cudaError_t cudaEventElapsedTime(float *milliseconds, cudaEvent_t from, cudaEvent_t to)
{
    *milliseconds = (float)(to->time - from->time) * 1e-3f;
    return cudaSuccess;
}

cudaError_t cudaGetDevice(int *device)
{
    *device = 0;
    return cudaSuccess;
}

cudaError_t cudaSetDevice(int)
{
    return cudaSuccess;
}

cudaError_t cudaGetDeviceCount(int *count)
{
    *count = 1;
    return cudaSuccess;
}

cudaError_t cudaGetDeviceProperties(cudaDeviceProp *properties, int)
{
    strcpy(properties->name, "emulated");
    return cudaSuccess;
}

cudaError_t cudaDeviceGetAttribute(int *value, int attribute, int)
{
    *value = attribute == cudaDevAttrMultiProcessorCount ? setting("EMULATED_PROCESSORS", 3)
                                                          : setting("EMULATED_SHARED", 227) << 10;
    return cudaSuccess;
}

cudaError_t cudaDriverGetVersion(int *version)
{
    *version = 13000;
    return cudaSuccess;
}

cudaError_t cudaGetLastError()
{
    return cudaSuccess;
}

const char *cudaGetErrorString(cudaError_t)
{
    return "emulated error";
}

/* `result` is volatile, so that the compiler does not compute it before the rounding mode is set. */
template <class Operation>
static float rounded_down(Operation operation)
{
    const int usual = fegetround();
    fesetround(FE_DOWNWARD);
    const volatile float result = operation();
    fesetround(usual);
    return result;
}

float __fmaf_rd(float a, float b, float c)
{
    const volatile float x = a, y = b, z = c;
    return rounded_down([&] { return fmaf(x, y, z); });
}

float __fadd_rd(float a, float b)
{
    const volatile float x = a, y = b;
    return rounded_down([&] { return x + y; });
}
