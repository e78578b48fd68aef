/* Tests the errors of the CUDA back end without a visible device: with a driver, without a driver, and in builds
   without CUDA. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include "check.h"
#ifdef FXS_WITH_CUDA
#include <fixsplat/cuda.h>
#endif

#ifdef FXS_WITH_CUDA
static void no_device(void)
{
    fxs_cuda *cuda;
    fxs_message why = {.bytes_needed = 1};
    char name[32];
    CHECK(!setenv("CUDA_VISIBLE_DEVICES", "", 1));
    CHECK(fxs_cuda_create(&cuda, 0, 0, 1, &why) == FXS_ERR_DEVICE && !cuda);
    CHECK(!strncmp(why.text, "no NVIDIA ", 10) && strstr(why.text, "found") && !why.bytes_needed);
    why.text[0] = 0;
    CHECK(fxs_cuda_name(0, name, sizeof name, &why) == FXS_ERR_DEVICE && why.text[0]);
    CHECK(fxs_cuda_create(&cuda, 0, 0, 17, &why) == FXS_ERR_ARGUMENT && !cuda);
    CHECK(fxs_cuda_create(&cuda, 0, 0, 1, 0) == FXS_ERR_DEVICE);
    fxs_cuda_destroy(0);
}
#else
static void no_device(void)
{
    SKIP("built without nvcc");
}
#endif

static void table(void)
{
#ifdef FXS_WITH_CUDA
    const int expected = FXS_ERR_DEVICE;
#else
    const int expected = FXS_ERR_UNSUPPORTED;
#endif
    const fxs_backend *b = &fxs_backend_cuda;
    const fxs_backend_options options = {.size = sizeof(fxs_backend_options)};
    fxs_message why = {.bytes_needed = 1};
    char name[32];
    void *self = &why;
    CHECK(!strcmp(b->name, "cuda") && b->can & FXS_CAN_TRACE);
    CHECK(b->open(&self, &options, &why) == expected && !self && why.text[0] && !why.bytes_needed);
    why.text[0] = 0;
    CHECK(b->device(0, name, sizeof name, &why) == expected && why.text[0]);
    b->close(0);
}

int main(void)
{
    RUN(no_device);
    RUN(table);
    return check_report();
}
