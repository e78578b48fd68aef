/* Tests the double-precision reference renderer against closed formulas. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "reference.h"

#define PI 3.14159265358979323846
#define SIZE 48   /* width and height of the rendered pictures in pixels */

static int near(double value, double expected, double tolerance)
{
    if (fabs(value - expected) <= tolerance)
        return 1;
    printf("  %.15g instead of %.15g\n", value, expected);
    return 0;
}

static const struct reference_options black = { REFERENCE_MAHALANOBIS, 3, 0, { 0, 0, 0 } };
static const struct reference_options black_square = { REFERENCE_SQUARE, 3, 0, { 0, 0, 0 } };

/* A camera at the origin that looks along +z, with an off-centre principal point. */
static const fxs_view front = {
    "front", 64, 40, 50, 60, 30.25, 22.5, { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, { 0, 0, 0 }, 0,
    FXS_PERSPECTIVE, 0
};

/* Makes a round, half opaque, grey Gaussian with a sigma of 1 scene unit. */
static fxs_gaussian gaussian_at(float x, float y, float z)
{
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    g.position[0] = x, g.position[1] = y, g.position[2] = z;
    g.rotation[0] = 1;
    return g;
}

static struct reference_splat round_splat(double centre, double variance, double opacity, double red)
{
    struct reference_splat s = { centre, centre, variance, 0, variance, opacity, { red, 0, 0 }, 1, 8 };
    return s;
}

static double image[3 * SIZE * SIZE];

static double red_at(int column, int row)
{
    return image[3 * (row * SIZE + column)];
}

static void render(const struct reference_splat *splats, size_t count, const struct reference_options *options)
{
    CHECK(reference_render_splats(splats, count, SIZE, SIZE, options, image) == 0);
}

static void test_projected_centre_and_peak(void)
{
    /* Projected centre of a Gaussian: x = 50 * 0.4 / 4 + 30.25 = 35.25, y = 60 * -0.6 / 4 + 22.5 = 13.5. x is
       0.25 off the pixel centre. */
    fxs_gaussian g = gaussian_at(0.4f, -0.6f, 4);
    double rgb[64 * 40 * 3];
    for (int i = 0; i < 3; i++)
        g.scale[i] = -2;
    struct reference_splat s;
    CHECK(reference_project(&g, &front, &black, &s) == 1);
    CHECK(near(s.x, 35.25, 1e-6) && near(s.y, 13.5, 1e-6) && near(s.depth, 4, 0));
    CHECK(near(s.opacity, 0.5, 1e-15) && near(s.colour[1], 0.5, 1e-15));

    /* Covariance [[a, b], [b, c]] of a projected sphere of sigma s: a = s^2 fx^2 / z^2 (1 + (x/z)^2) + 0.3, b =
       s^2 fx fy / z^2 (x/z) (y/z), c like a. */
    double variance = exp(-4);
    CHECK(near(s.a, variance * 156.25 * 1.01 + 0.3, 1e-6));
    CHECK(near(s.b, variance * 187.5 * 0.1 * -0.15, 1e-6));
    CHECK(near(s.c, variance * 225 * 1.0225 + 0.3, 1e-6));

    double d2 = 0.0625 * s.c / (s.a * s.c - s.b * s.b);
    CHECK(reference_render(&g, 1, &front, &black, rgb) == 0);
    CHECK(near(rgb[3 * (13 * 64 + 35)], 0.5 * 0.5 * exp(-d2 / 2), 1e-6));
    CHECK(near(rgb[0], 0, 0));
}

static void test_slope_is_clamped(void)
{
    /* The projection clamps slopes. x/z = 5 is clamped to (64 - 30.25) / 50 + 0.3 * 64 / 100. y/z = -6 is
       clamped to -22.5 / 60 - 0.3 * 40 / 120. */
    fxs_gaussian g = gaussian_at(10, -12, 2);
    double u = 33.75 / 50 + 0.192, v = -0.375 - 0.1, variance = exp(6);
    for (int i = 0; i < 3; i++)
        g.scale[i] = 3;
    struct reference_splat s;
    CHECK(reference_project(&g, &front, &black, &s) == 1);
    CHECK(near(s.x, 280.25, 1e-9) && near(s.y, -337.5, 1e-9));
    CHECK(near(s.a, variance * 625 * (1 + u * u) + 0.3, 1e-6));
    CHECK(near(s.b, variance * 750 * u * v, 1e-6));
    CHECK(near(s.c, variance * 900 * (1 + v * v) + 0.3, 1e-6));
}

static void test_compensation(void)
{
    /* Dilation changes the variance from v to v + 0.3 on both axes. To compensate, the opacity is multiplied by
       v / (v + 0.3). */
    fxs_view view = front;
    fxs_gaussian g = gaussian_at(0, 0, 5);
    struct reference_options options = black;
    struct reference_splat s;
    view.fy = 50;
    options.antialiased = 1;
    for (int i = 0; i < 3; i++)
        g.scale[i] = -3;
    double v = exp(-6) * 100;
    CHECK(reference_project(&g, &view, &options, &s) == 1);
    CHECK(near(s.opacity, 0.5 * v / (v + 0.3), 1e-12));
}

static void test_mahalanobis_cutoff(void)
{
    /* With variance 4, the pixel at distance 6 is at Mahalanobis distance 3. Its alpha is 0.9 exp(-4.5) > 1/255. */
    struct reference_splat s = round_splat(20.5, 4, 0.9, 1);
    render(&s, 1, &black);
    CHECK(near(red_at(20, 20), 0.9, 1e-15));
    CHECK(near(red_at(26, 20), 0.9 * exp(-4.5), 1e-15) && near(red_at(20, 14), 0.9 * exp(-4.5), 1e-15));
    CHECK(near(red_at(26, 21), 0, 0) && near(red_at(27, 20), 0, 0));

    s.a = s.c = 4 - 1e-9;
    render(&s, 1, &black);
    CHECK(near(red_at(26, 20), 0, 0));
}

static void test_alpha_limits(void)
{
    /* Alpha limit of a splat with opacity 0.01: alpha 0.01 exp(-d2 / 2) is 1/255 at d2 = 2 ln 2.55 = 1.87. With
       variance 4 the distance is 2.7 pixels. */
    struct reference_splat s = round_splat(20.5, 4, 0.01, 1);
    render(&s, 1, &black);
    CHECK(near(red_at(22, 20), 0.01 * exp(-0.5), 1e-15) && near(red_at(23, 20), 0, 0));
    s.opacity = 0.00391;   /* the largest alpha is 0.997 / 255, below the limit 1/255 */
    render(&s, 1, &black);
    CHECK(near(red_at(20, 20), 0, 0));
    s.opacity = 0;
    render(&s, 1, &black);
    CHECK(near(red_at(20, 20), 0, 0));
    s.opacity = 1;
    render(&s, 1, &black);
    CHECK(near(red_at(20, 20), 0.99, 0));
}

static void test_square_cutoff(void)
{
    /* A splat at pixel 8 with radius 8 has tiles floor(0 / 16) to floor(31 / 16) - 1. Pixel 0 counts, with
       squared Mahalanobis distance 64 / 6.25. Pixel 16 does not count. */
    struct reference_splat s = round_splat(8.5, 6.25, 1, 1);
    render(&s, 1, &black_square);
    CHECK(near(red_at(0, 8), exp(-5.12), 1e-15) && near(red_at(8, 0), exp(-5.12), 1e-15));
    CHECK(near(red_at(16, 8), 0, 0) && near(red_at(8, 16), 0, 0));

    /* Moved by 3/4 pixel, the square around the splat ends at floor(31.75 / 16) = 1. Moved by a pixel, it
       touches the next tile. */
    s.x = 9.25;
    render(&s, 1, &black_square);
    CHECK(near(red_at(15, 8), exp(-3.125), 1e-15) && near(red_at(16, 8), 0, 0));
    s.x = 9.5;
    render(&s, 1, &black_square);
    CHECK(near(red_at(17, 8), exp(-5.12), 1e-15) && near(red_at(1, 8), exp(-5.12), 1e-15));

    render(&s, 1, &black);
    CHECK(near(red_at(1, 8), 0, 0));
}

static void test_square_radius(void)
{
    /* Radius of a splat with variance v on both axes: ceil(3 sqrt(v + sqrt(0.1))). Focal length 50 at depth 5
       makes v = 100 s^2 + 0.3 = 15.9. */
    fxs_view view = front;
    fxs_gaussian g = gaussian_at(0, 0, 5);
    struct reference_splat s;
    view.fy = 50;
    for (int i = 0; i < 3; i++)
        g.scale[i] = (float)(0.5 * log(0.156));
    CHECK(reference_project(&g, &view, &black_square, &s) == 1 && s.radius == 13);
    g.scale[0] = 0;   /* the longer axis decides the radius of the splat */
    CHECK(reference_project(&g, &view, &black_square, &s) == 1 && s.radius == 31);
}

static void test_layers_and_background(void)
{
    struct reference_options options = { REFERENCE_MAHALANOBIS, 3, 0, { 0.25, 0.5, 1 } };
    struct reference_splat s[2] = { round_splat(20.5, 4, 0.5, 0.1), round_splat(20.5, 4, 0.75, 0.8) };
    s[0].depth = 2;   /* the second splat (projected Gaussian) lies in front of the first */
    render(s, 2, &options);
    CHECK(near(red_at(20, 20), 0.75 * 0.8 + 0.25 * 0.5 * 0.1 + 0.125 * 0.25, 1e-15));
    CHECK(near(image[3 * (20 * SIZE + 20) + 2], 0.125, 1e-15));
    CHECK(near(red_at(0, 0), 0.25, 0));

    s[0].depth = 1;   /* of two splats at equal depth, the first is in front */
    render(s, 2, &options);
    CHECK(near(red_at(20, 20), 0.5 * 0.1 + 0.5 * 0.75 * 0.8 + 0.125 * 0.25, 1e-15));

    render(NULL, 0, &options);
    CHECK(near(red_at(47, 47), 0.25, 0));
}

static void test_early_stop(void)
{
    /* Four splats of one pixel. Alpha 0.99 leaves transmittance 0.01, alpha 0.95 leaves 0.0005. The third splat
       would leave 0.000025 and is not drawn. */
    struct reference_options options = { REFERENCE_MAHALANOBIS, 3, 0, { 1, 0, 0 } };
    struct reference_splat s[4];
    for (int i = 0; i < 4; i++)
        s[i] = round_splat(20.5, 4, i == 0 ? 0.99 : i == 3 ? 0.5 : 0.95, i + 2);
    render(s, 4, &options);
    CHECK(near(red_at(20, 20), 0.99 * 2 + 0.0095 * 3 + 0.0005, 1e-12));
}

/* Computes the associated Legendre polynomial P_l^m with the Condon-Shortley phase, by the usual recurrences. */
static double legendre(int l, int m, double z)
{
    double low = 0, value = 1;
    for (int i = 1; i <= m; i++)
        value *= -(2 * i - 1) * sqrt(1 - z * z);
    for (int i = m + 1; i <= l; i++) {
        double next = ((2 * i - 1) * z * value - (i + m - 1) * low) / (i - m);
        low = value;
        value = next;
    }
    return value;
}

/* Computes a real spherical harmonic of the direction d. It is sqrt(2) K P_l^|m| times sin(|m| phi) for m < 0 or
   cos(m phi) for m > 0, and K P_l for m = 0. */
static double harmonic(int l, int m, const double *d)
{
    int order = abs(m);
    double ratio = 1, phi = atan2(d[1], d[0]);
    for (int i = l - order + 1; i <= l + order; i++)
        ratio /= i;   /* the product becomes (l - |m|)! / (l + |m|)! */
    double value = sqrt((2 * l + 1) / (4 * PI) * ratio) * legendre(l, order, d[2]);
    return m == 0 ? value : sqrt(2) * value * (m < 0 ? sin(order * phi) : cos(order * phi));
}

/* Rotates the camera to look along the unit vector d, which is not along the scene's y axis. */
static void look_along(fxs_view *view, const double *d)
{
    double length = sqrt(d[0] * d[0] + d[2] * d[2]);
    double right[3] = { d[2] / length, 0, -d[0] / length };
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        view->rotation[i] = right[i];
        view->rotation[3 + i] = d[j] * right[k] - d[k] * right[j];
        view->rotation[6 + i] = d[i];
    }
}

static void check_harmonics(const fxs_view *view, fxs_gaussian g, const double *direction)
{
    struct reference_splat s;
    for (int l = 1; l <= 3; l++)
        for (int m = -l; m <= l; m++) {
            int k = l * l - 1 + l + m, channel = k % 3;
            struct reference_options options = black;
            g.sh[3 * k + channel] = 1;
            CHECK(reference_project(&g, view, &options, &s) == 1);
            CHECK(near(s.colour[channel], 1 + harmonic(l, m, direction), 1e-7));
            CHECK(near(s.colour[(channel + 1) % 3], 1, 1e-7));
            options.sh_degree = l - 1;
            CHECK(reference_project(&g, view, &options, &s) == 1 && near(s.colour[channel], 1, 1e-7));
            g.sh[3 * k + channel] = 0;
        }
}

static void test_spherical_harmonics(void)
{
    fxs_view view = front;
    for (int i = 0; i < 8; i++) {
        double height = -0.9 + 0.25 * i, ring = sqrt(1 - height * height), angle = 0.3 + 2.4 * i;
        double d[3] = { ring * cos(angle), height, ring * sin(angle) };
        for (int j = 0; j < 3; j++)
            view.position[j] = 0.5 * j - 1;
        fxs_gaussian g = gaussian_at((float)(3 * d[0] - 1), (float)(3 * d[1] - 0.5), (float)(3 * d[2]));
        for (int j = 0; j < 3; j++)
            g.dc[j] = (float)(0.5 / 0.28209479177387814);
        look_along(&view, d);
        check_harmonics(&view, g, d);
    }

    fxs_gaussian dark = gaussian_at(0, 0, 3);
    struct reference_splat s;
    dark.dc[0] = -4;
    CHECK(reference_project(&dark, &front, &black, &s) == 1 && near(s.colour[0], 0, 0));
}

/* Computes the pixel coordinates of a point in the scene. */
static void project_point(const fxs_view *view, const double *point, double pixel[2])
{
    double c[3] = { 0, 0, 0 };
    for (int i = 0; i < 9; i++)
        c[i / 3] += view->rotation[i] * (point[i % 3] - view->position[i % 3]);
    pixel[0] = view->fx * c[0] / c[2] + view->cx;
    pixel[1] = view->fy * c[1] / c[2] + view->cy;
}

/* Rotates the vector v by the unit quaternion (w, q): v + 2 w (q x v) + 2 q x (q x v). */
static void rotate(const double *quaternion, double v[3])
{
    const double *q = quaternion + 1;
    double once[3], twice[3];
    for (int i = 0; i < 3; i++)
        once[i] = q[(i + 1) % 3] * v[(i + 2) % 3] - q[(i + 2) % 3] * v[(i + 1) % 3];
    for (int i = 0; i < 3; i++)
        twice[i] = q[(i + 1) % 3] * once[(i + 2) % 3] - q[(i + 2) % 3] * once[(i + 1) % 3];
    for (int i = 0; i < 3; i++)
        v[i] += 2 * quaternion[0] * once[i] + 2 * twice[i];
}

static void test_covariance_against_differences(void)
{
    /* Computes the covariance of a projected Gaussian. Each principal axis is projected by central differences.
       The outer products of the projected axes add up. */
    fxs_view view = front;
    fxs_gaussian g = gaussian_at(2, -1, 4);
    const double direction[3] = { 0.48, -0.36, 0.8 }, quaternion[4] = { 0.5, -0.1, 0.7, 0.5 };
    double covariance[3] = { 0.3, 0, 0.3 }, mean[3] = { 2, -1, 4 };
    look_along(&view, direction);
    view.position[0] = 0.1;
    for (int i = 0; i < 4; i++)
        g.rotation[i] = (float)(3 * quaternion[i]);
    for (int axis = 0; axis < 3; axis++) {
        double step = 1e-5, offset[3] = { 0, 0, 0 }, ahead[3], behind[3], p[2], q[2];
        g.scale[axis] = (float)axis - 2;
        offset[axis] = step * exp(axis - 2);
        rotate(quaternion, offset);
        for (int i = 0; i < 3; i++) {
            ahead[i] = mean[i] + offset[i];
            behind[i] = mean[i] - offset[i];
        }
        project_point(&view, ahead, p);
        project_point(&view, behind, q);
        double dx = (p[0] - q[0]) / (2 * step), dy = (p[1] - q[1]) / (2 * step);
        covariance[0] += dx * dx, covariance[1] += dx * dy, covariance[2] += dy * dy;
    }
    struct reference_splat s;
    CHECK(reference_project(&g, &view, &black, &s) == 1);
    CHECK(near(s.a, covariance[0], 1e-4) && near(s.b, covariance[1], 1e-4) && near(s.c, covariance[2], 1e-4));
}

static int is_visible(fxs_gaussian g)
{
    struct reference_splat s;
    return reference_project(&g, &front, &black, &s);
}

static void test_culling(void)
{
    CHECK(is_visible(gaussian_at(0, 0, 0.201f)));
    CHECK(!is_visible(gaussian_at(0, 0, 0.199f)) && !is_visible(gaussian_at(0, 0, -3)));
    CHECK(!is_visible(gaussian_at(500, 0, 5)));

    fxs_gaussian g = gaussian_at(0, 0, 5);
    CHECK(is_visible(g));
    g.opacity = -6;   /* opacity 1 / (1 + e^6), which is below 1/255 */
    CHECK(!is_visible(g));
}

static void test_bad_values_are_dropped(void)
{
    const float bad[3] = { NAN, INFINITY, -INFINITY };
    const fxs_gaussian good = gaussian_at(0, 0, 5);
    for (int i = 0; i < 3; i++) {
        fxs_gaussian g = good;
        float *const fields[] = { g.position, g.rotation + 2, &g.opacity, g.dc + 2, g.sh + 44, g.scale + 1 };
        /* the scale is bad only if NaN or +infinity, since sigma e^-infinity = 0 is valid */
        for (size_t field = 0; field < 5 + (size_t)(bad[i] > 0 || isnan(bad[i])); field++) {
            *fields[field] = bad[i];
            CHECK(!is_visible(g));
            g = good;
        }
    }
    fxs_gaussian g = good;
    g.rotation[0] = 0;
    CHECK(!is_visible(g));
    g = good;
    g.scale[0] = 3e38f;   /* sigma, the exponential of this scale, overflows */
    CHECK(!is_visible(g));
    g = good;
    g.position[0] = -3e38f;
    CHECK(!is_visible(g));
}

static void test_rgba8(void)
{
    const double rgb[6] = { -1, 0.5, 7, 0.4999 / 255, 0.5001 / 255, NAN };
    const uint8_t expected[8] = { 0, 128, 255, 255, 0, 1, 0, 255 };
    uint8_t rgba[8];
    reference_to_rgba8(rgb, 2, 1, rgba);
    CHECK(memcmp(rgba, expected, sizeof rgba) == 0);
}

int main(void)
{
    RUN(test_projected_centre_and_peak);
    RUN(test_slope_is_clamped);
    RUN(test_compensation);
    RUN(test_mahalanobis_cutoff);
    RUN(test_alpha_limits);
    RUN(test_square_cutoff);
    RUN(test_square_radius);
    RUN(test_layers_and_background);
    RUN(test_early_stop);
    RUN(test_spherical_harmonics);
    RUN(test_covariance_against_differences);
    RUN(test_culling);
    RUN(test_bad_values_are_dropped);
    RUN(test_rgba8);
    return check_report();
}
