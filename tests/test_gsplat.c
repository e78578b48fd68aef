/* Reads gsplat's folder of PNG images: the meaning of the bytes, and faulty folders. */
#include "every_format_bytes.h"

#ifdef WITH_GSPLAT

static char folder[] = "/tmp/fixsplat-test-XXXXXX";
static fxs_gaussian out[GAUSSIANS + 1];

static long read_folder(void)
{
    fxs_scene_file *file;
    write_made(folder);
    const int error = fxs_scene_file_open(folder, NULL, &file, &info, &message);
    const long count = error ? error : fxs_scene_file_read(file, out, GAUSSIANS + 1, &message);
    if (!error)
        fxs_scene_file_close(file);
    remove_made(folder);
    return count;
}

static double value_of(int image, int pixel, int channel)
{
    const double low = gsplat_bound(image, channel, 0), high = gsplat_bound(image, channel, 1);
    return low + (high - low) * gsplat_byte(image, pixel, channel) / 255;
}

static int is_value(float a, double b)
{
    return fabs((double)a - b) <= 1e-5 * (1 + fabs(b));
}

static void check_values(int has_sh)
{
    for (int i = 0; i < GAUSSIANS; i++) {
        for (int c = 0; c < 3; c++) {
            const double low = gsplat_bound(0, c, 0), high = gsplat_bound(0, c, 1);
            const double n = low + (high - low) * (gsplat_byte(0, i, c) + 256 * gsplat_byte(1, i, c)) / 65535;
            CHECK(is_value(out[i].position[c], n < 0 ? 1 - exp(-n) : exp(n) - 1));
            CHECK(is_value(out[i].scale[c], value_of(2, i, c)) && is_value(out[i].dc[c], value_of(5, i, c)));
        }
        for (int c = 0; c < 4; c++)
            CHECK(is_value(out[i].rotation[c], value_of(3, i, c)));
        CHECK(is_value(out[i].opacity, value_of(4, i, 0)));
        for (int k = 0; k < 9; k++)
            CHECK(is_value(out[i].sh[k], has_sh ? -2 + 5.0 * (i % GSPLAT_ENTRIES * 9 + k) / 63 : 0));
    }
}

static void values(void)
{
    size = 0;
    file_count = 0;
    add_gsplat(0, 0);
    if (CHECK(read_folder() == GAUSSIANS && info.sh_degree == 0 && !strcmp(info.format, "gsplat")))
        check_values(0);
#ifdef FXS_WITH_ZIP
    for (int is_by_column = 0; is_by_column < 2; is_by_column++) {
        file_count = 0;
        add_gsplat(1, is_by_column);
        if (CHECK(read_folder() == GAUSSIANS && info.sh_degree == 1))
            check_values(1);
    }
#endif
}

static void faults(void)
{
    static const struct { const char *old, *new, *words; } cases[] = {
        {"[3,3]", "[9,3]", "means_l.png: fewer pixels than Gaussians"},
        {"[3,3]", "[-1,3]", "meta.json: no valid \"shape\" of \"means\""},
        {"\"quats\"", "\"quaTs\"", "no valid \"mins\" and \"maxs\" of \"quats\""},
        {"\"opacities\":{\"shape\":[3,1],\"dtype\":\"float32\",\"mins\":[",
         "\"opacities\":{\"dtype\":\"float32\",\"mins\":[0,",
         "no valid \"mins\" and \"maxs\" of \"opacities\""},
        {"\"dtype\"", "\"dtype\"x", "meta.json: bad JSON"},
        {"\"quantization\":6", "\"quantization\":9", "no valid \"quantization\" of \"shN\""},
        {"[3,3,3]", "[3,4,3]", "no valid \"shape\" of \"shN\""},
        {"[3,3,3]", "[3,8,3]", "no valid \"centroids\" of 24 bytes each"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size = 0;
        file_count = 0;
        make_gsplat();
        struct made_file *meta = &files[0];
        meta->data[meta->size] = 0;
        const char *found = strstr((char *)meta->data, cases[i].old);
        if (!found && strstr(cases[i].words, "shN"))
            continue;
        if (!CHECK(found != NULL))
            continue;
        put("%.*s%s%s", (int)(found - (char *)meta->data), (char *)meta->data, cases[i].new,
            found + strlen(cases[i].old));
        memcpy(meta->data, bytes, meta->size = size);
        size = 0;
        if (!CHECK(read_folder() == FXS_ERR_FILE && strstr(message.text, cases[i].words)))
            printf("  said: %s\n  not:  %s\n", message.text, cases[i].words);
    }
    size = 0;
    file_count = 0;
    make_gsplat();
    files[3].size = 20;
    CHECK(read_folder() == FXS_ERR_FILE && strstr(message.text, "scales.png: "));
}

int main(void)
{
    if (!CHECK(mkdtemp(folder) != NULL))
        return check_report();
    RUN(values);
    RUN(faults);
    CHECK(rmdir(folder) == 0);
    return check_report();
}

#else

static void built_without(void)
{
    put("{\"opacities\":{\"dtype\":1}}");
    check_cut_fails(size, "built without libpng or cJSON");
}

int main(void)
{
    RUN(built_without);
    return check_report();
}

#endif
