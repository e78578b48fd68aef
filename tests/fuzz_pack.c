/* Fuzzes the packer. Gaussians with arbitrary floats must pack to a scene that opens. Byte 0 gives the profile, the
   SH degree and whether levels of detail are built. Records of a .ply follow. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/scene.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MOST = 1 << 17 };

static size_t make_ply(char *ply, int sh_degree, const uint8_t *records, size_t size)
{
    static const char *const properties[] = {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                                             "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
    const int rest = 3 * ((sh_degree + 1) * (sh_degree + 1) - 1);
    const size_t record = 4 * (14 + (size_t)rest), count = size / record;
    char *to = ply + sprintf(ply, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", count);
    for (int i = 0; i < 14; i++)
        to += sprintf(to, "property float %s\n", properties[i]);
    for (int i = 0; i < rest; i++)
        to += sprintf(to, "property float f_rest_%d\n", i);
    to += sprintf(to, "end_header\n");
    memcpy(to, records, count * record);
    return (size_t)(to - ply) + count * record;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char ply[MOST + 4096];
    fxs_message message;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_scene scene;
    if (size < 1 || size > MOST)
        return 0;
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = (enum fxs_profile)(data[0] % 3),
                                      .tree = data[0] / 12 % 2};
    size = make_ply(ply, data[0] / 3 % 4, data + 1, size - 1);
    if (fxs_scene_file_open_memory("fuzz", ply, size, NULL, &file, &info, &message))
        return 0;
    if (fxs_pack(file, &info, &packed, &report, &options, &message) == 0) {
        if (fxs_scene_open(&scene, packed.data, packed.bytes) || scene.count != report.packed ||
            packed.bytes > 16 * fxs_pack_bytes(&info, options.profile))
            abort();
        fxs_packed_scene_free(&packed);
    } else if (strchr(message.text, '\n')) {
        abort();
    }
    fxs_scene_file_close(file);
    return 0;
}
