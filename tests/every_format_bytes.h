/* Builds a small scene in every supported file format, as files in memory. */
#ifndef EVERY_FORMAT_BYTES_H
#define EVERY_FORMAT_BYTES_H

#include <sys/stat.h>

#include "rad_bytes.h"
#include "scene_bytes.h"
#include "spz_bytes.h"
#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_CJSON)
#define WITH_SOG
#include <webp/encode.h>
#endif
#ifdef FXS_WITH_ZIP
#include <zip.h>
#endif
#if defined(FXS_WITH_PNG) && defined(FXS_WITH_CJSON)
#define WITH_GSPLAT
#include <png.h>
#endif

enum { GAUSSIANS = 3, MAX_FILES = 24 };

static struct made_file { char name[32]; uint8_t data[1 << 14]; size_t size; } files[MAX_FILES];
static int file_count;

static inline void add_file(const char *name)
{
    struct made_file *f = &files[file_count++];
    snprintf(f->name, sizeof f->name, "%s", name);
    f->size = size < sizeof f->data ? size : sizeof f->data;
    memcpy(f->data, bytes, f->size);
    size = 0;
}

static inline void write_made(const char *folder)
{
    char full[160];
    for (int i = 0; i < file_count; i++) {
        snprintf(full, sizeof full, "%s/%.31s", folder, files[i].name);
        for (char *slash = full + strlen(folder) + 1; (slash = strchr(slash, '/')) != NULL; *slash++ = '/') {
            *slash = '\0';
            mkdir(full, 0700);
        }
        FILE *stream = fopen(full, "wb");
        if (!CHECK(stream != NULL))
            return;
        CHECK(fwrite(files[i].data, 1, files[i].size, stream) == files[i].size);
        fclose(stream);
    }
}

static inline void remove_made(const char *folder)
{
    char full[160];
    for (int i = file_count - 1; i >= 0; i--) {
        snprintf(full, sizeof full, "%s/%.31s", folder, files[i].name);
        unlink(full);
        for (char *slash; (slash = strrchr(full, '/')) != full + strlen(folder);) {
            *slash = '\0';
            rmdir(full);
        }
    }
}

static inline void put_floats(int count)
{
    for (int i = 1; i <= count; i++)
        put_float((float)i / 8);
}

static inline void put_ply_header(const char *encoding, const char *before)
{
    static const char *const names[] = {"x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",
                                        "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2"};
    put("ply\nformat %s 1.0\nelement vertex %d\n%s", encoding, GAUSSIANS, before);
    for (int i = 0; i < 14; i++)
        put("property float %s\n", names[i]);
}

static inline void make_ply(void)
{
    put_ply_header("binary_little_endian", "");
    put("end_header\n");
    put_floats(14 * GAUSSIANS);
    add_file("a.ply");
}

static inline void make_compressed_ply(void)
{
    put("ply\nformat binary_little_endian 1.0\nelement chunk 1\n");
    for (int i = 0; i < 12; i++)
        put("property float %s_%s%c\n", i % 6 < 3 ? "min" : "max", i < 6 ? "" : "scale_", "xyz"[i % 3]);
    put("element vertex %d\nproperty uint packed_position\nproperty uint packed_rotation\n", GAUSSIANS);
    put("property uint packed_scale\nproperty uint packed_color\nelement sh %d\n", GAUSSIANS);
    for (int i = 0; i < 9; i++)
        put("property uchar f_rest_%d\n", i);
    put("end_header\n");
    put_floats(12);
    for (uint32_t i = 0; i < 4 * GAUSSIANS; i++)
        put_u32(i * 2654435761u);
    for (int i = 0; i < 9 * GAUSSIANS; i++)
        put_u8(20 * i);
    add_file("a.compressed.ply");
}

static inline void make_splat(void)
{
    for (int i = 0; i < GAUSSIANS; i++) {
        put_floats(6);
        put_u32(0x80402010);
        put_u32(0x102030ff);
    }
    add_file("a.splat");
}

static inline void make_ksplat(void)
{
    memset(bytes, 0, 4096 + 1024);
    bytes[1] = 1;
    put_u32_at(4, 1);
    put_u32_at(4096, GAUSSIANS);
    put_u32_at(4096 + 4, GAUSSIANS);
    size = 4096 + 1024;
    put_floats(11 * GAUSSIANS);
    add_file("a.ksplat");
}

static inline void fill_spz(spz_bytes *s, int version)
{
    memset(s, 0, sizeof *s);
    s->version = version;
    s->count = GAUSSIANS;
    s->degree = 1;
    s->fractional_bits = 12;
    for (int i = 0; i < SPZ_ARRAYS; i++)
        for (int k = 0; k < 100; k++)
            s->arrays[i][k] = (uint8_t)(k * 37 + i);
}

static inline void make_plain_spz(void)
{
    static const uint8_t extension[] = {3, 0, 0xbe, 0xad, 4, 0, 0, 0, 6, 0, 0, 0};
    spz_bytes s;
    fill_spz(&s, 3);
    s.flags = 2;
    s.extensions = extension;
    s.extensions_size = sizeof extension;
    size = spz_plain(&s, bytes);
    add_file("a.spz");
}

#ifdef FXS_WITH_ZLIB
static inline void make_gzip_spz(void)
{
    static uint8_t plain[1 << 12];
    spz_bytes s;
    fill_spz(&s, 2);
    size = spz_gzip(plain, spz_plain(&s, plain), bytes, MAX_FILE);
    add_file("a.spz");
}
#endif

#ifdef FXS_WITH_ZSTD
static inline void make_zstd_spz(void)
{
    spz_bytes s;
    fill_spz(&s, 4);
    size = spz_zstd(&s, bytes, MAX_FILE);
    add_file("a.spz");
}
#endif

#ifdef FXS_WITH_CJSON

enum { GLTF_FLOATS = 14 * GAUSSIANS };

/* Writes glTF's JSON for two primitives. The first has floats in buffer 0. The second is an .spz of `spz` bytes at
   `offset` in the buffer with index `where`. */
static inline void put_gltf_json(const char *first_buffer, size_t first_size, int where, size_t offset, size_t spz)
{
    static const struct { const char *name, *type; int components; } attributes[] = {
        {"POSITION", "VEC3", 3}, {"KHR_gaussian_splatting:ROTATION", "VEC4", 4},
        {"KHR_gaussian_splatting:SCALE", "VEC3", 3}, {"KHR_gaussian_splatting:OPACITY", "SCALAR", 1},
        {"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "VEC3", 3}
    };
    put("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{"
        "\"primitives\":[{\"extensions\":{\"KHR_gaussian_splatting\":{}},\"attributes\":{");
    for (int i = 0; i < 5; i++)
        put("%s\"%s\":%d", i ? "," : "", attributes[i].name, i);
    put("}},{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":1}}}]}],\"accessors\":[");
    for (int i = 0, at = 0; i < 5; at += 4 * GAUSSIANS * attributes[i++].components)
        put("%s{\"bufferView\":0,\"byteOffset\":%d,\"componentType\":5126,\"count\":%d,\"type\":\"%s\"}", i ? "," : "",
            at, GAUSSIANS, attributes[i].type);
    put("],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d},{\"buffer\":%d,\"byteOffset\":%zu,\"byteLength\":%zu}],",
        4 * GLTF_FLOATS, where, offset, spz);
    put("\"buffers\":[{%s\"byteLength\":%zu}", first_buffer, first_size);
    put(where ? ",{\"uri\":\"b%%31.bin\",\"byteLength\":%zu}]}" : "]}", spz);
}

static inline void make_glb(void)
{
    static uint8_t spz[1 << 10];
    spz_bytes s;
    fill_spz(&s, 3);
    const size_t spz_size = spz_plain(&s, spz), bin_size = 4 * GLTF_FLOATS + spz_size;
    size = 20;
    put_gltf_json("", bin_size, 0, 4 * GLTF_FLOATS, spz_size);
    const uint32_t json_size = (uint32_t)size - 20;
    put_u32((uint32_t)bin_size);
    put_u32(0x004e4942);
    put_floats(GLTF_FLOATS);
    memcpy(bytes + size, spz, spz_size);
    size += spz_size;
    memcpy(bytes, "glTF\2\0\0", 8);
    put_u32_at(8, (uint32_t)size);
    put_u32_at(12, json_size);
    memcpy(bytes + 16, "JSON", 4);
    add_file("a.glb");
}

static inline void make_gltf(void)
{
    char uri[64 + GLTF_FLOATS / 3 * 16] = "\"uri\":\"data:application/octet-stream;base64,";
    spz_bytes s;
    fill_spz(&s, 3);
    for (int i = 0; i < GLTF_FLOATS / 3; i++)
        strcat(uri, "AACAPwAAgD8AAIA/");
    strcat(uri, "\",");
    size_t spz_size = spz_plain(&s, bytes);
    put_gltf_json(uri, 4 * GLTF_FLOATS, 1, 0, spz_size);
    add_file("a.gltf");
    size = spz_plain(&s, bytes);
    add_file("b1.bin");
}

static inline void make_tileset(void)
{
    put("{\"asset\":{\"version\":\"1.1\"},\"geometricError\":9,\"root\":{\"refine\":\"ADD\",\"content\":{\"uri\":"
        "\"a.glb\"},\"children\":[{\"content\":{\"uri\":\"t/more.json\"}}]}}");
    add_file("tileset.json");
    put("{\"asset\":{\"version\":\"1.0\"},\"geometricError\":9,\"root\":{\"refine\":\"REPLACE\",\"transform\":"
        "[0,2,0,0,-2,0,0,0,0,0,2,0,5,6,7,1],\"content\":{\"uri\":\"a%%2Egltf\"}}}");
    add_file("t/more.json");
    make_glb();
    const int first = file_count;
    make_gltf();
    for (int i = first; i < file_count; i++) {
        memmove(files[i].name + 2, files[i].name, sizeof files->name - 2);
        memcpy(files[i].name, "t/", 2);
    }
}

static inline void put_rad_columns(int count)
{
    static const struct { const char *name; int numbers; } columns[] = {
        {"center", 3}, {"alpha", 1}, {"rgb", 3}, {"scales", 3}, {"orientation", 3}, {"sh1", 9}
    };
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < columns[i].numbers * count; k++)
            put_float(i == 4 ? 0.125f : (float)(k + 1) / 8);
        rad_add_column(columns[i].name, "f32", "");
    }
}

static inline void make_rad(void)
{
    rad_begin(0);
    for (int base = 0; base < GAUSSIANS; base += 2) {
        const int count = GAUSSIANS - base < 2 ? GAUSSIANS - base : 2;
        put_rad_columns(count);
        rad_add_chunk(base, count);
    }
    rad_end(GAUSSIANS, 2, ",\"maxSh\":1");
    add_file("a.rad");
}

#ifdef FXS_WITH_ZLIB
static inline void make_rad_tree(void)
{
    rad_begin(1);
    put_rad_columns(GAUSSIANS + 1);
    for (int i = 0; i < GAUSSIANS + 1; i++)
        put_u16(i ? 0 : GAUSSIANS);
    rad_add_column("child_count", "u16", "");
    for (int i = 0; i < GAUSSIANS + 1; i++)
        put_u32(i ? 0 : 1);
    rad_add_column("child_start", "u32", "");
    rad_add_chunk(0, GAUSSIANS + 1);
    rad_end(GAUSSIANS + 1, 65536, ",\"maxSh\":1,\"lodTree\":true");
    add_file("a.rad");
}

static inline void make_rad_chunks(void)
{
    rad_begin(1);
    put("RAD0....{\"version\":1,\"type\":\"gsplat\",\"count\":%d,\"chunkSize\":1,\"chunks\":[", GAUSSIANS);
    const size_t begin = size;
    put("%*s]}", 64 * GAUSSIANS, "");
    put_u32_at(4, (uint32_t)size - 8);
    rad_pad();
    add_file("a.rad");
    for (int i = 0; i < GAUSSIANS; i++) {
        char name[16], line[64];
        put_rad_columns(1);
        rad_add_chunk(i, 1);
        memcpy(bytes, rad_body, size = rad_body_size);
        rad_body_size = 0;
        snprintf(name, sizeof name, "a-%d.radc", i);
        const int length = snprintf(line, sizeof line, "%s{\"offset\":0,\"bytes\":%zu,\"filename\":\"%s\"}",
                                    i ? "," : "", size, name);
        memcpy(files[0].data + begin + 64 * (size_t)i, line, (size_t)length);
        add_file(name);
    }
}
#endif

/* Writes an .lcc scene of two cells with a Gaussian each and a third Gaussian in the environment. */
static inline void make_lcc(void)
{
    put("{\"totalLevel\":1,\"attributes\":[{\"name\":\"scale\",\"min\":[1,2,3],\"max\":[4,5,6]},{\"name\":\"shcoef\",");
    put("\"min\":[-1,-2,-3],\"max\":[4,5,6]}]}");
    add_file("a.lcc");
    for (uint32_t cell = 0; cell < GAUSSIANS - 1; cell++) {
        const uint32_t unit[5] = {cell, 1, 32 * cell, 0, 32};
        for (int i = 0; i < 5; i++)
            put_u32(unit[i]);
    }
    add_file("index.bin");
    put_floats(8 + 16);
    add_file("environment.bin");
    put_floats(16 * (GAUSSIANS - 1));
    add_file("shcoef.bin");
    put_floats(8 * (GAUSSIANS - 1));
    add_file("data.bin");
}

#endif

#ifdef FXS_WITH_ZIP
static inline void zip_files(int first)
{
    char name[] = "/tmp/test_zip_XXXXXX";
    int descriptor = mkstemp(name), code;
    CHECK(descriptor >= 0 && !close(descriptor));
    zip_t *zip = zip_open(name, ZIP_TRUNCATE, &code);
    for (int i = first; i < file_count && zip; i++)
        zip_file_add(zip, files[i].name, zip_source_buffer(zip, files[i].data, files[i].size, 0), 0);
    CHECK(zip && zip_close(zip) == 0);
    FILE *stream = fopen(name, "rb");
    size = stream ? fread(bytes, 1, MAX_FILE, stream) : 0;
    if (stream)
        fclose(stream);
    unlink(name);
    file_count = first;
}
#endif

#ifdef WITH_SOG

static inline void add_image(const char *folder, const char *name, int width, int height)
{
    char full[32];
    uint8_t pixels[4 * 192], *webp;
    for (int i = 0; i < 4 * width * height; i++)
        pixels[i] = (uint8_t)(i % 4 == 3 ? 252 + i % 3 : name[0] == 'l' ? i & 1 : 40 * i + name[0]);
    size = WebPEncodeLosslessRGBA(pixels, width, height, 4 * width, &webp);
    memcpy(bytes, webp, size);
    WebPFree(webp);
    snprintf(full, sizeof full, "%s%s", folder, name);
    add_file(full);
}

static inline void add_sog(const char *folder)
{
    char full[32];
    put("{\"means\":{\"shape\":[%d,3],\"mins\":[0,1,2],\"maxs\":[1,2,3],\"files\":[\"m0\",\"m1\"]},", GAUSSIANS);
    put("\"scales\":{\"mins\":[-5,-4,-3],\"maxs\":[-1,0,1],\"files\":[\"s\"]},\"quats\":{\"files\":[\"q\"]},");
    put("\"sh0\":{\"mins\":[1,2,3,4],\"maxs\":[2,3,4,5],\"files\":[\"c\"]},");
    put("\"shN\":{\"mins\":0,\"maxs\":1,\"files\":[\"n\",\"l\"]}}");
    snprintf(full, sizeof full, "%smeta.json", folder);
    add_file(full);
    for (const char *names = "m0m1s q c n l "; *names; names += 2) {
        const char name[] = {names[0], names[1] == ' ' ? '\0' : names[1], '\0'};
        add_image(folder, name, name[0] == 'n' ? 192 : 2, name[0] == 'n' ? 1 : 2);
    }
}

static inline void make_sog_folder(void)
{
    add_sog("");
}

static inline void make_streamed_sog(void)
{
    put("{\"version\":1,\"lodLevels\":2,\"filenames\":[\"0/meta.json\"],\"environment\":\"sky/meta.json\",");
    put("\"tree\":{\"lods\":{\"0\":{\"file\":0,\"offset\":1,\"count\":2}}}}");
    add_file("lod-meta.json");
    add_sog("0/");
    add_sog("sky/");
}

#ifdef FXS_WITH_ZIP
static inline void make_sog_zip(void)
{
    add_sog("");
    zip_files(0);
    add_file("a.sog");
}
#endif

#endif

#ifdef WITH_GSPLAT

enum { GSPLAT_IMAGES = 6, GSPLAT_ENTRIES = 2 };

static const struct { const char *attribute, *file; int channels; } gsplat_images[GSPLAT_IMAGES] = {
    {"means", "means_l.png", 3}, {"means", "means_u.png", 3}, {"scales", "scales.png", 3}, {"quats", "quats.png", 4},
    {"opacities", "opacities.png", 1}, {"sh0", "sh0.png", 3}
};

static inline uint8_t gsplat_byte(int image, int pixel, int channel)
{
    return (uint8_t)(91 * pixel + 53 * image + 40 * channel + 7);
}

static inline double gsplat_bound(int image, int channel, int high)
{
    return high ? 1 + channel / 2.0 + image / 4.0 : -1 - channel / 8.0 - image / 4.0;
}

static inline void put_gsplat_meta(int has_sh)
{
    for (int i = 0; i < GSPLAT_IMAGES; i++) {
        if (i == 1)
            continue;
        put("%s\"%s\":{\"shape\":[%d,%d],\"dtype\":\"float32\"", i ? "," : "{", gsplat_images[i].attribute, GAUSSIANS,
            gsplat_images[i].channels);
        for (int high = 0; high < 2; high++)
            for (int c = 0; c < gsplat_images[i].channels; c++)
                put("%s%.17g%s", c ? "," : high ? ",\"maxs\":[" : ",\"mins\":[", gsplat_bound(i, c, high),
                    c + 1 < gsplat_images[i].channels ? "" : "]");
        put("}");
    }
    put(has_sh ? ",\"shN\":{\"shape\":[%d,3,3],\"dtype\":\"float32\",\"mins\":-2,\"maxs\":3,\"quantization\":6}}" : "}",
        GAUSSIANS);
    add_file("meta.json");
}

/* Writes the header of a .npy array, padded to a multiple of 64 bytes. */
static inline void put_npy(const char *type, const char *order, const char *shape)
{
    put("%cNUMPY", 0x93);
    put_u16(1);
    put_u16(118);
    put("{'descr': '%s', 'fortran_order': %s, 'shape': (%s), }", type, order, shape);
    put("%*s\n", (int)(127 - size), "");
}

/* Adds the .npy files of an SH palette. is_by_column: 1 stores the palette in Fortran order, as numpy writes a
   transposed array. */
static inline void add_gsplat_sh(int is_by_column)
{
    const int first = file_count;
    put_npy("|u1", is_by_column ? "True" : "False", "2, 9");
    for (int i = 0; i < 9 * GSPLAT_ENTRIES; i++)
        put_u8(is_by_column ? i % GSPLAT_ENTRIES * 9 + i / GSPLAT_ENTRIES : i);
    add_file("centroids.npy");
    put_npy("<u2", "False", "3,");
    for (int i = 0; i < GAUSSIANS; i++)
        put_u16(i % GSPLAT_ENTRIES);
    add_file("labels.npy");
#ifdef FXS_WITH_ZIP
    zip_files(first);
    add_file("shN.npz");
#else
    file_count = first;
#endif
}

static inline void add_gsplat(int has_sh, int is_by_column)
{
    put_gsplat_meta(has_sh);
    for (int i = 0; i < GSPLAT_IMAGES; i++) {
        uint8_t pixels[4 * 4];
        const int channels = gsplat_images[i].channels;
        png_image png = {.version = PNG_IMAGE_VERSION, .width = 2, .height = 2, .format =
                         channels == 1 ? PNG_FORMAT_GRAY : channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA};
        for (int k = 0; k < 4 * channels; k++)
            pixels[k] = gsplat_byte(i, k / channels, k % channels);
        png_alloc_size_t room = MAX_FILE;
        CHECK(png_image_write_to_memory(&png, bytes, &room, 0, pixels, 0, NULL));
        size = room;
        add_file(gsplat_images[i].file);
    }
    if (has_sh)
        add_gsplat_sh(is_by_column);
}

static inline void make_gsplat(void)
{
#ifdef FXS_WITH_ZIP
    add_gsplat(1, 1);
#else
    add_gsplat(0, 0);
#endif
}

#endif

static const struct made_format { const char *name; void (*make)(void); int is_several; } formats[] = {
    {"ply", make_ply, 0}, {"compressed ply", make_compressed_ply, 0}, {"splat", make_splat, 0},
    {"ksplat", make_ksplat, 0}, {"spz", make_plain_spz, 0},
#ifdef FXS_WITH_ZLIB
    {"spz", make_gzip_spz, 0},
#endif
#ifdef FXS_WITH_ZSTD
    {"spz", make_zstd_spz, 0},
#endif
#ifdef FXS_WITH_CJSON
    {"gltf", make_glb, 0}, {"gltf", make_gltf, 1}, {"tileset", make_tileset, 1},
    {"lcc", make_lcc, 1}, {"rad", make_rad, 0},
#ifdef FXS_WITH_ZLIB
    {"rad", make_rad_tree, 0}, {"rad", make_rad_chunks, 1},
#endif
#endif
#ifdef WITH_SOG
    {"sog", make_sog_folder, 1}, {"sog", make_streamed_sog, 1},
#ifdef FXS_WITH_ZIP
    {"sog", make_sog_zip, 0},
#endif
#endif
#ifdef WITH_GSPLAT
    {"gsplat", make_gsplat, 1},
#endif
};

enum { FORMATS = sizeof formats / sizeof *formats };

static inline const struct made_format *make_format(int i)
{
    size = 0;
    file_count = 0;
    formats[i].make();
    return &formats[i];
}

#endif
