/* Tests pictures that are rendered through lenses with distortion. Positions are compared with an independent
   inverse of the lens formula. */
#include "photo_folder.h"
#include "src/camera/lens_warp.h"
#include "src/fit/photos/photo_pixels.h"

enum { WIDE = 160, HIGH = 120 };

#define GOLDEN 0x6dbc72eeu

static const struct {
    fxs_lens lens;
    double fx, fy, cx, cy;
} lenses[] = {
    {{.k = {0}}, 140, 140, 80, 60},
    {{.k = {-0.15}}, 140, 140, 80, 60},
    {{.k = {0.2}}, 140, 145, 80, 60},
    {{.k = {-0.2, 0.05, -.01, .002}, .p = {0.01, -0.02}, .skew = 0.02}, 140, 150, 83, 58},
    {{.k = {0.1, -.05, .02}, .d = {.3, .04, .01}, .p = {.002, .001}}, 140, 140, 80, 60},
    {{.kind = FXS_LENS_FISHEYE, .k = {.05, -.01, .002, -.001}}, 100, 100, 80, 60},
    {{.kind = FXS_LENS_FISHEYE, .k = {.05, -.01}, .p = {.01, -.02}, .s = {.03, 0, -.04, 0}}, 100, 100, 80, 60},
    {{.kind = FXS_LENS_FISHEYE_AFTER, .k = {.05, -.01}, .p = {.01, -.02}, .s = {.01, .02, -.03, .004}}, 100, 100, 80,
     60},
    {{.kind = FXS_LENS_FOV, .k = {.9}}, 140, 140, 80, 60},
    {{.kind = FXS_LENS_DIVISION, .k = {-.2}}, 140, 150, 80, 60},
    {{.kind = FXS_LENS_EUCM, .k = {.6, 1.1}}, 140, 150, 80, 60},
    {{.kind = FXS_LENS_FISHEYE, .k = {0}}, 45, 45, 80, 60},
};
enum { LENSES = sizeof lenses / sizeof *lenses };

static void make(size_t number, fxs_lens_warp *warp)
{
    const fxs_view view = {.name = "a", .width = WIDE, .height = HIGH, .fx = lenses[number].fx,
                                .fy = lenses[number].fy, .cx = lenses[number].cx, .cy = lenses[number].cy};
    fxs_lens lens = lenses[number].lens;
    CHECK(fxs_lens_complete(&lens));
    fxs_lens_warp_make(warp, &lens, &view);
    CHECK(warp->cover.width >= 1 && warp->cover.width <= 4 * WIDE + 4 && warp->cover.height <= 4 * HIGH + 4);
}

static double scene(double x, double y, int c)
{
    return 128 + 50 * sin(2 * x + c) + 50 * cos(1.5 * y - x + 2 * c);
}

static uint8_t *pictures[2];       /* two pictures of a scene: [0] undistorted, [1] through the lens */

static void draw_cover(const fxs_view *v)
{
    for (int i = 0; i < v->width * v->height; i++)
        for (int c = 0; c < 4; c++)
            pictures[0][4 * i + c] = (uint8_t)(c == 3 ? 255 :
                scene((i % v->width + 0.5 - v->cx) / v->fx, (i / v->width + 0.5 - v->cy) / v->fy, c) + 0.5);
}

static void inverse(void)
{
    static fxs_lens_warp w;
    for (size_t i = 0; i < LENSES; i++) {
        int seen = 0;
        make(i, &w);
        for (int k = 0; k < 2000; k++) {
            const double angle = random_number() / 10430.0, r = random_number() / 65536.0 * 0.6;
            const double x = r * cos(angle), y = r * sin(angle);
            double bent[2], place[2];
            fxs_lens_bend(&w.lens, x, y, bent);
            if (!CHECK(fxs_lens_warp_straighten(&w, bent, place) && fabs(place[0] - x) < 1e-7 &&
                       fabs(place[1] - y) < 1e-7))
                printf("  lens %zu: %g, %g: %g, %g\n", i, x, y, place[0], place[1]);
        }
        for (int y = 0; y < HIGH; y++)
            for (int x = 0; x < WIDE; x++) {
                const double bent[2] = {(x + 0.5 - lenses[i].cx) / lenses[i].fx,
                                        (y + 0.5 - lenses[i].cy) / lenses[i].fy};
                double place[2], again[2];
                if (!fxs_lens_warp_straighten(&w, bent, place))
                    continue;
                fxs_lens_bend(&w.lens, place[0], place[1], again);
                seen += hypot(again[0] - bent[0], again[1] - bent[1]) < 1e-7;
                const double u = w.cover.fx * place[0] + w.cover.cx, v = w.cover.fy * place[1] + w.cover.cy;
                CHECK(u > 0.5 && v > 0.5 && u < w.cover.width - 0.5 && v < w.cover.height - 0.5);
            }
        if (!CHECK(i == LENSES - 1 ? seen > 10000 && seen < 11500 : seen == WIDE * HIGH))
            printf("  lens %zu: %d\n", i, seen);
    }
}

static void patterns(void)
{
    static const uint8_t outside[4] = {9, 8, 7, 6};
    static fxs_lens_warp w;
    for (size_t i = 0; i < LENSES; i++) {
        double worst = 0;
        int beyond = 0;
        make(i, &w);
        draw_cover(&w.cover);
        fxs_lens_warp_rows(&w, pictures[0], outside, pictures[1], 0, HIGH);
        for (int k = 0; k < WIDE * HIGH; k++) {
            const double bent[2] = {(k % WIDE + 0.5 - lenses[i].cx) / lenses[i].fx,
                                    (k / WIDE + 0.5 - lenses[i].cy) / lenses[i].fy};
            double place[2];
            if (fxs_lens_warp_straighten(&w, bent, place))
                for (int c = 0; c < 3; c++)
                    worst = fmax(worst, fabs(pictures[1][4 * k + c] - scene(place[0], place[1], c)));
            else
                beyond += CHECK(!memcmp(pictures[1] + 4 * k, outside, 4));
        }
        if (!CHECK(worst < 1.6))
            printf("  lens %zu: %g\n", i, worst);
        CHECK((i == LENSES - 1) == (beyond > 0));
    }
}

static void round_trip(void)
{
    static const uint8_t outside[4] = {0, 0, 0, 0}, black[3] = {0, 0, 0};
    static fxs_lens_warp w;
    static uint8_t rgb[3 * WIDE * HIGH];
    for (size_t i = 0; i < LENSES; i++) {
        fxs_listed_view listed = {.image = NULL};
        fxs_photo_pixels photo;
        double worst = 0;
        make(i, &w);
        listed.view = w.photograph;
        listed.lens = w.lens;
        draw_cover(&w.cover);
        fxs_lens_warp_rows(&w, pictures[0], outside, pictures[1], 0, HIGH);
        for (int k = 0; k < WIDE * HIGH; k++)
            memcpy(rgb + 3 * k, pictures[1] + 4 * k, 3);
        put_ppm("a.ppm", WIDE, HIGH, rgb);
        if (!CHECK(
                !fxs_photo_read(in_folder("a.ppm"), &listed, 1600, black, &(fxs_photo_masking){0}, &photo, &message))) {
            printf("  lens %zu: %s\n", i, message.text);
            continue;
        }
        const fxs_view *v = &photo.view;
        for (int k = 0; k < WIDE * HIGH; k++)
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs(photo.pixels[3 * k + c] - scene((k % WIDE + 0.5 - v->cx) / v->fx,
                                                                        (k / WIDE + 0.5 - v->cy) / v->fy, c)));
        free(photo.pixels);
        if (!CHECK(worst < 3))
            printf("  lens %zu: %g\n", i, worst);
    }
}

static void same_bytes(void)
{
    static const uint8_t outside[4] = {1, 2, 3, 4};
    static fxs_lens_warp w;
    static uint8_t parts[4 * WIDE * HIGH];
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < LENSES; i++) {
        make(i, &w);
        for (int k = 0; k < 4 * w.cover.width * w.cover.height; k++)
            pictures[0][k] = (uint8_t)random_number();
        fxs_lens_warp_rows(&w, pictures[0], outside, pictures[1], 0, HIGH);
        for (int y = HIGH; y--;)
            fxs_lens_warp_rows(&w, pictures[0], outside, parts, y, y + 1);
        CHECK(!memcmp(parts, pictures[1], sizeof parts));
        hash = hash_on(hash, parts, sizeof parts);
        for (int y = 0; y < HIGH && i == 0; y++)
            CHECK(!memcmp(parts + 4 * WIDE * y, pictures[0] + 4 * ((y + 2) * w.cover.width + 2), 4 * WIDE));
    }
    if (!CHECK(hash == GOLDEN))
        printf("  0x%08xu\n", (unsigned)hash);
}

static void strange_lenses(void)
{
    static const double extremes[] = {0, 1e-300, 1e-9, 0.5, 3, 1e4, 1e150, 1e300};
    static fxs_lens_warp w;
    static uint8_t out[4 * 8 * 6];
    enum { EXTREMES = sizeof extremes / sizeof *extremes };
    for (int n = 0; n < 20000; n++) {
        fxs_lens lens = {.kind = (enum fxs_lens_kind)(random_number() % 6)};
        const char *letters = "012345abcpqstuv";
        for (int i = 0; letters[i]; i++)
            if (random_number() % 4 == 0)
                *fxs_lens_coefficient(&lens, letters[i]) = (random_number() % 2 ? 1 : -1) *
                                                           extremes[random_number() % EXTREMES];
        lens.skew = n % 3 ? 0 : extremes[random_number() % EXTREMES];
        if (!fxs_lens_complete(&lens))
            continue;
        const double focal = extremes[1 + random_number() % (EXTREMES - 1)];
        const fxs_view view = {.width = 8, .height = 6, .fx = focal, .fy = n % 5 ? focal : 2 * focal,
                                    .cx = n % 7 ? 4 : -1e5, .cy = 3};
        fxs_lens_warp_make(&w, &lens, &view);
        if (!CHECK(w.cover.width >= 4 && w.cover.height >= 4 && w.cover.width <= 4 * 8 + 4 &&
                   w.cover.height <= 4 * 6 + 4)) {
            printf("  kind %d, focal length %g: %d x %d\n", lens.kind, focal, w.cover.width, w.cover.height);
            return;
        }
        fxs_lens_warp_rows(&w, pictures[0], out, out, 0, 6);
    }
}

static void tests(void)
{
    pictures[0] = malloc(4 * (4 * WIDE + 4) * (4 * HIGH + 4));
    pictures[1] = malloc(4 * WIDE * HIGH);
    RUN(inverse);
    RUN(patterns);
    RUN(round_trip);
    RUN(same_bytes);
    RUN(strange_lenses);
    free(pictures[0]);
    free(pictures[1]);
}

int main(void)
{
    return in_a_folder(tests);
}
