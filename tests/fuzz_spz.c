/* Fuzzes .spz files. If byte 0 is odd, the target gzips the data itself, so that the gzip checksum is valid. */
#include <stdlib.h>
#include <string.h>

#include "src/scene/read/spz_internal.h"
#include "spz_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_message(const fxs_message *message)
{
    if (strncmp(message->text, "fuzz: ", 6) != 0 || strchr(message->text, '\n'))
        abort();
}

static long read_all(fxs_spz *spz, fxs_gaussian *last)
{
    static fxs_gaussian gaussians[100];
    fxs_message message;
    long count, total = 0;
    while ((count = fxs_spz_read(spz, gaussians, 100, &message)) > 0) {
        total += count;
        *last = gaussians[count - 1];
    }
    if (count < 0)
        check_message(&message);
    return count < 0 ? -1 : total;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t gzip[1 << 16];
    fxs_spz *spz;
    fxs_scene_file_info info;
    fxs_message message;
    fxs_gaussian first, second;
    char path[] = "fuzz";
    if (size == 0)
        return 0;
    const int kind = *data++;
    size--;
#ifdef FXS_WITH_ZLIB
    if (kind & 1) {
        size = spz_gzip(data, size, gzip, sizeof gzip);
        data = gzip;
    }
#endif
    fxs_scene_source source = {.input = fxs_memory_input(data, size), .path = path};
    if (fxs_spz_open(&source, 0, size, kind >> 1 & 1 ? FXS_AXES_RDF : FXS_AXES_OF_FILE, &spz, &info, &message) != 0) {
        check_message(&message);
        return 0;
    }
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
    long total = read_all(spz, &first);
    fxs_spz_rewind(spz);
    if ((total >= 0 && (uint64_t)total != info.count) || read_all(spz, &second) != total ||
        memcmp(&first, &second, sizeof first) != 0)
        abort();
    fxs_spz_close(spz);
    return 0;
}
