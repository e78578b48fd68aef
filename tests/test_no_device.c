/* What the CUDA back end answers where no device is to be seen, whether there is a driver or not. */
#include <stdlib.h>
#include <string.h>

#include "check.h"
#ifdef FXS_WITH_CUDA
#include "../kernels/cuda/cuda.h"

static void no_device(void)
{
    fxs_cuda *cuda = 0;
    fxs_cuda_failure failure = {0, 1};
    char name[32];
    CHECK(!setenv("CUDA_VISIBLE_DEVICES", "", 1));
    CHECK(fxs_cuda_devices() == 0);
    CHECK(fxs_cuda_create(&cuda, 0, 0, 1, &failure) == FXS_ERR_DEVICE && !cuda);
    CHECK(!strncmp(failure.text, "no NVIDIA ", 10) && strstr(failure.text, "found") && !failure.bytes_needed);
    failure.text = 0;
    CHECK(fxs_cuda_name(0, name, sizeof name, &failure) == FXS_ERR_DEVICE && failure.text);
    CHECK(fxs_cuda_create(&cuda, 0, 0, 17, &failure) == FXS_ERR_ARGUMENT);
}
#else
static void no_device(void)
{
    SKIP("built without nvcc");
}
#endif

int main(void)
{
    RUN(no_device);
    return check_report();
}
