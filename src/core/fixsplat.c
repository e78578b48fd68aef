/* Functions of fixsplat.h that do not render: error texts, names and defaults. */
#include "memory.h"
#include <fixsplat/stage.h>

const fxs_kernels fxs_kernels_c = {
    {"c", "c", "c", "c", "c", "c"}, fxs_project_c, fxs_shade_c, fxs_bin_c, fxs_spans_c, fxs_note_c,
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

void fxs_options_init(fxs_options *options)
{
    memset(options, 0, sizeof *options);
    options->sh_degree = 3;
}

int fxs_init(fxs_context *context, const fxs_config *config)
{
    if (!context || (config && config->threads > 64))
        return FXS_ERR_ARGUMENT;
    memset(context, 0, sizeof *context);
    if (config)
        context->config = *config;
    context->kernels = fxs_kernels_c;
    return 0;
}

void fxs_request_init(fxs_request *request, const fxs_object *objects, uint32_t count)
{
    memset(request, 0, sizeof *request);
    request->objects = objects;
    request->count = count;
    request->eyes = 1;
    fxs_options_init(&request->options);
    fxs_targets_init(&request->targets[0]);
    fxs_targets_init(&request->targets[1]);
}
