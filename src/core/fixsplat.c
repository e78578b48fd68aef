/* The table of the C kernels, and the functions of fixsplat.h that do not render: error texts, names, defaults,
 * setup. */
#include "sized.h"
#include <fixsplat/internal/stage.h>
#include <fixsplat/internal/declarations.h>

const fxs_kernels fxs_kernels_c = {
    {"c", "c", "c", "c", "c", "c"}, fxs_animate_c, fxs_project_c, fxs_shade_c, fxs_bin_c, fxs_spans_c, fxs_note_c,
    fxs_sort_c, fxs_list_c, fxs_blend_c, fxs_trace_c, fxs_resolve_c,
};

int fxs_version(void)
{
    return FXS_VERSION_NUMBER;
}

const char *fxs_strerror(int error)
{
    static const char *const words[] = {
        "success",
        "an argument is null or out of range",
        "not a packed scene, or one that is cut short, damaged or changed while it was rendered",
        "a packed scene of another version",
        "the camera's focal length is not above 0, its rotation is not a rotation, or its position is too far out",
        "a width or height is outside 1 to 16384, a part is outside its picture, or two eyes differ in size or "
        "projection",
        "too little memory: the working memory given (or it is not aligned to 64 bytes), or the device's",
        "not supported by this build or machine",
        "the back end's device is missing, failed or was lost",
        "an object's rotation, scale or another of its fields is out of range, or there are too many",
        "a target is missing or not aligned, its rows are longer than its stride, it overlaps another, or its format "
        "does not allow it",
        "a file is missing, cannot be read or written, or is not what it should be",
        "stopped by the caller",
        "the size of a struct is 0 or too large: its init function was not called",
    };
    int count = (int)(sizeof words / sizeof *words);
    return error <= 0 && error > -count ? words[-error] : "unknown error";
}

const char *fxs_stage_name(enum fxs_stage stage)
{
    static const char *const names[FXS_STAGES] = {"project", "shade", "sort", "bin", "blend", "resolve"};
    return (unsigned)stage < FXS_STAGES ? names[stage] : "unknown";
}

int fxs_stop_by_byte(void *byte)
{
    return *(const volatile unsigned char *)byte != 0;
}

int fxs_context_init(fxs_context *context, const fxs_config *config)
{
    if (!context)
        return FXS_ERR_ARGUMENT;
    memset(context, 0, sizeof *context);
    const int error = config ? fxs_sized_read(&context->config, sizeof context->config, config) : 0;
    if (!context->config.kernels)
        context->config.kernels = &fxs_kernels_c;
    return error ? error : context->config.workers.count > 64 ? FXS_ERR_ARGUMENT : 0;
}
