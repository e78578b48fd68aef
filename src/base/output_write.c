/* Parts of output files that are the same on every operating system. */
#include "output_internal.h"

#include <errno.h>
#include <string.h>

#include <fixsplat/internal/message.h>

#include "os_calls.h"

int fxs_output_fail(const char *path, int error, fxs_message *message)
{
    if (error == ECANCELED)
        return fxs_fail_as(FXS_ERR_STOPPED, message, "%s: stopped", path);
    return fxs_fail_as(error == ENOMEM ? FXS_ERR_MEMORY : FXS_ERR_FILE, message, "%s: cannot be written: %s", path,
                       error == EBUSY ? "another program has it open" : strerror(error));
}

int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message)
{
    if (n <= output->left) {
        output->left -= n;
        return 0;
    }
    output->error = EINVAL;
    return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: more Gaussians than announced", output->path);
}

int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message)
{
    errno = 0;
    if (fwrite(bytes, 1, size, output->file) == size)
        return 0;
    if (!output->error)
        output->error = fxs_stream_fault(output->file);
    return fxs_output_fail(output->path, output->error, message);
}
