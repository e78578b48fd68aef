#include "output_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void free_names(fxs_output *output)
{
    free(output->path);
    free(output->temporary);
}

/* A new file in the folder of output->path, so that it can be renamed to that. */
static FILE *create_beside(fxs_output *output)
{
    const char *slash = strrchr(output->path, '/');
    int folder = slash ? (int)(slash + 1 - output->path) : 0, descriptor = -1;
    size_t room = (size_t)folder + 64;
    output->temporary = malloc(room);
    if (!output->temporary)
        return NULL;
    for (int i = 0; i < 100 && descriptor < 0; i++) {
        snprintf(output->temporary, room, "%.*s.fixsplat-%ld-%d.tmp", folder, output->path, (long)getpid(), i);
        descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (descriptor < 0 && errno != EEXIST)
            break;
    }
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (!file && descriptor >= 0) {
        close(descriptor);
        remove(output->temporary);
    }
    return file;
}

static int fail(const fxs_output *output, fxs_message *message)
{
    return fxs_fail(message, "%s: cannot be written: %s", output->path, strerror(output->error));
}

int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message)
{
    memset(output, 0, sizeof *output);
    output->left = count;
    output->path = strdup(path);
    output->file = output->path ? create_beside(output) : NULL;
    if (output->file)
        return 0;
    fxs_fail(message, "%s: cannot be written: %s", path, strerror(errno));
    free_names(output);
    return -1;
}

int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message)
{
    if (n <= output->left) {
        output->left -= n;
        return 0;
    }
    output->error = EINVAL;
    return fxs_fail(message, "%s: more Gaussians than announced", output->path);
}

int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message)
{
    errno = 0;
    if (fwrite(bytes, 1, size, output->file) == size)
        return 0;
    if (!output->error)
        output->error = errno ? errno : EIO;
    return fail(output, message);
}

int fxs_output_close(fxs_output *output, fxs_message *message)
{
    int result = 0;
    if (ferror(output->file) && !output->error)
        output->error = errno ? errno : EIO;
    if (fclose(output->file) && !output->error)
        output->error = errno;
    if (!output->error && output->left)
        result = fxs_fail(message, "%s: %" PRIu64 " Gaussians fewer than announced", output->path, output->left);
    else if (output->error || rename(output->temporary, output->path)) {
        output->error = output->error ? output->error : errno;
        result = fail(output, message);
    }
    if (result)
        remove(output->temporary);
    free_names(output);
    return result;
}
