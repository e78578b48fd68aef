/* Computes procedural scenes. A scene has several parts, such as terrain and trees. A part maps the index of a
   Gaussian to evenly spread numbers (u, v) and hashes, and computes the Gaussian from them. */
#include "procedural.h"

#include <math.h>
#include <string.h>
#include "src/base/sine.h"
#include "src/gaussian/attributes.h"

/* This pragma forbids fused a * b + c. gcc needs -std=c99 or -ffp-contract=off instead. */
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

#define PI 3.14159265358979324

typedef struct vec {
    double x, y, z;
} vec;

static vec v3(double x, double y, double z)
{
    vec v = { x, y, z };
    return v;
}

static vec add(vec a, vec b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static vec times(vec a, double s) { return v3(a.x * s, a.y * s, a.z * s); }
static vec sub(vec a, vec b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static vec tint(vec a, vec b) { return v3(a.x * b.x, a.y * b.y, a.z * b.z); }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static vec normalise(vec a) { return times(a, 1 / sqrt(dot(a, a))); }
static vec mirror(vec d, vec normal) { return sub(d, times(normal, 2 * dot(d, normal))); }
static double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }
static double blend(double a, double b, double t) { return a + (b - a) * t; }
static vec blend3(vec a, vec b, double t) { return add(a, times(sub(b, a), t)); }

static double smoothstep(double low, double high, double x)
{
    double t = clamp((x - low) / (high - low), 0, 1);
    return t * t * (3 - 2 * t);
}

static double whole(double x) { return fxs_floor(x); }
static double sine(double t) { return fxs_sine(t); }
static double cosine(double t) { return fxs_sine(t + 0.25); }

/* Computes the natural logarithm: ln x = e ln 2 + 2 (s + s^3/3 + s^5/5 + ...), with s = (m - 1)/(m + 1), x = m 2^e and
   sqrt(1/2) <= m < sqrt(2). */
static double logarithm(double x)
{
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2;
        e--;
    }
    static const double odd[] = { 1 / 15.0, 1 / 13.0, 1 / 11.0, 1 / 9.0, 1 / 7.0, 1 / 5.0, 1 / 3.0, 1 };
    double s = (m - 1) / (m + 1), sum = 0;
    for (int k = 0; k < 8; k++)
        sum = sum * (s * s) + odd[k];
    return e * 0.69314718055994531 + 2 * s * sum;
}

static double power_of_half(double t, double least, double most)
{
    double exponent = blend(least, most, t), halvings = whole(exponent);
    return ldexp(1 - 0.5 * (exponent - halvings), -(int)halvings);
}

/* Mixes the bits of x as the finaliser of SplitMix64 does (Steele, Lea, Flood 2014). */
static uint64_t mix(uint64_t x)
{
    x = (x ^ (x >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

static double unit(uint64_t bits) { return (double)(int64_t)(bits >> 11) / 9007199254740992.0; }

/* Returns the k-th random number of a key, in [0, 1). */
static double draw(uint64_t key, unsigned k) { return unit(mix(key + (k + 1) * UINT64_C(0x9E3779B97F4A7C15))); }

static uint64_t key_of(uint32_t seed, uint64_t what) { return mix(mix(seed + UINT64_C(0x51ED270B)) + what); }

typedef struct place {
    uint64_t index, count;   /* index of the Gaussian in its part of the scene; number of Gaussians in the part */
    uint64_t total, key;
    uint32_t seed;
    double u, v;
} place;

/* Spreads points evenly, like the seeds of a sunflower. u grows with the index, and v advances by the golden ratio
   (0.64 fixed point). */
static void spread_evenly(place *p, uint64_t index, uint64_t count)
{
    p->u = ((double)index + 0.5) / (double)count;
    p->v = unit(key_of(p->seed, 0) + index * UINT64_C(0x9E3779B97F4A7C15));
}

/* Finds the part of the scene that Gaussian i belongs to. `ends` has the ends of all parts, in thousandths of
   `count`. */
static int part_of(uint64_t i, uint64_t count, uint32_t seed, const unsigned *ends, place *p)
{
    int part = 0;
    while (i >= count * ends[part] / 1000)
        part++;
    uint64_t start = part ? count * ends[part - 1] / 1000 : 0;
    p->index = i - start;
    p->count = count * ends[part] / 1000 - start;
    p->key = key_of(seed, i);
    p->seed = seed;
    p->total = count;
    spread_evenly(p, p->index, p->count);
    return part;
}

static double lattice(uint64_t corner)
{
    return (double)(int64_t)((corner ^ (corner >> 32)) * UINT64_C(0x94D049BB133111EB)) / 9223372036854775808.0;
}

/* Computes smooth noise in -1..1: random values on a grid with quintic interpolation (value noise). *dx and *dz get the
   noise's gradient. */
static double noise(double x, double z, uint64_t salt, double *dx, double *dz)
{
    const uint64_t right = UINT64_C(0xD1B54A32D192ED03), up = UINT64_C(0xABC98388FB8FAC03);
    double x0 = whole(x), z0 = whole(z), u = x - x0, w = z - z0;
    uint64_t corner = salt * UINT64_C(0x8CB92BA72F3D8DD7) + (uint64_t)(int64_t)x0 * right + (uint64_t)(int64_t)z0 * up;
    double a = lattice(corner), b = lattice(corner + right), c = lattice(corner + up), d = lattice(corner + right + up);
    double su = u * u * u * (u * (u * 6 - 15) + 10), sw = w * w * w * (w * (w * 6 - 15) + 10);
    double twist = a - b - c + d;
    *dx = 30 * u * u * (u - 1) * (u - 1) * (b - a + twist * sw);
    *dz = 30 * w * w * (w - 1) * (w - 1) * (c - a + twist * su);
    return a + (b - a) * su + (c - a) * sw + twist * su * sw;
}

static double plain_noise(double x, double z, uint64_t salt)
{
    double dx, dz;
    return noise(x, z, salt, &dx, &dz);
}

/* A Gaussian under construction. Its colour in the viewing direction d is the sum of sh[k] Y_k(d), with spherical
   harmonics Y_k. */
typedef struct splat {
    vec position, axis[3];   /* the three axes are orthonormal and right-handed */
    double sigma[3], opacity;
    vec sh[16];
} splat;

/* Computes the 16 real spherical harmonics of degrees 0 to 3 at the unit vector d, with the signs of
   KHR_gaussian_splatting. */
static void sh_basis(vec d, double y[16])
{
    double xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
    y[0] = FXS_SH_0;
    y[1] = -0.48860251190292 * d.y;
    y[2] = 0.48860251190292 * d.z;
    y[3] = -0.48860251190292 * d.x;
    y[4] = 1.09254843059208 * d.x * d.y;
    y[5] = -1.09254843059208 * d.y * d.z;
    y[6] = 0.31539156525252 * (2 * zz - xx - yy);
    y[7] = -1.09254843059208 * d.x * d.z;
    y[8] = 0.54627421529604 * (xx - yy);
    y[9] = -0.59004358992664 * d.y * (3 * xx - yy);
    y[10] = 2.89061144264055 * d.x * d.y * d.z;
    y[11] = -0.45704579946446 * d.y * (4 * zz - xx - yy);
    y[12] = 0.37317633259012 * d.z * (2 * zz - 3 * xx - 3 * yy);
    y[13] = -0.45704579946446 * d.x * (4 * zz - xx - yy);
    y[14] = 1.44530572132028 * d.z * (xx - yy);
    y[15] = -0.59004358992664 * d.x * (xx - 3 * yy);
}

static void add_constant(splat *s, vec colour) { s->sh[0] = add(s->sh[0], times(colour, 1 / FXS_SH_0)); }

/* Adds a colour that depends on the viewing direction d: colour f(d . axis), where f is the sum of p[l] P_l (Legendre
   polynomials). By the addition theorem, P_l(d . a) = 4 pi / (2 l + 1) sum over m of Y_lm(d) Y_lm(a). */
static void add_zonal(splat *s, vec axis, const double p[4], vec colour)
{
    static const double convolution[4] = { 4 * PI, 4 * PI / 3, 4 * PI / 5, 4 * PI / 7 };
    double y[16];
    sh_basis(axis, y);
    for (int l = 0, k = 0; l < 4; l++)
        for (double scale = p[l] * convolution[l]; k < (l + 1) * (l + 1); k++)
            s->sh[k] = add(s->sh[k], times(colour, scale * y[k]));
}

static const double highlight[4] = { 0.09, 0.26, 0.36, 0.29 };   /* Legendre coefficients of a bright spot */
static const double rim[4] = { 2 / 3.0, 0, -2 / 3.0, 0 };        /* Legendre coefficients of 1 - x^2 */

/* Makes a Gaussian that is a flat disc perpendicular to `normal`. Its first axis is as close to `along` as possible. */
static void lay_flat(splat *s, vec position, vec normal, vec along, double sigma, double opacity)
{
    memset(s, 0, sizeof *s);
    s->position = position;
    s->axis[2] = normal;
    s->axis[0] = normalise(sub(along, times(normal, dot(normal, along))));
    s->axis[1] = cross(normal, s->axis[0]);
    s->sigma[0] = s->sigma[1] = sigma;
    s->sigma[2] = sigma * 0.1;
    s->opacity = opacity;
}

static void lay_round(splat *s, vec position, double sigma, double opacity, vec colour)
{
    lay_flat(s, position, v3(0, 0, 1), v3(1, 0, 0), sigma, opacity);
    s->sigma[2] = sigma;
    add_constant(s, colour);
}

static void lay_surface(const place *p, vec (*surface)(double u, double v), double opacity, splat *s)
{
    const double step = 1.0 / 4096;
    vec along = times(sub(surface(p->u + step, p->v), surface(p->u - step, p->v)), 0.5 / step);
    vec around = times(sub(surface(p->u, p->v + step), surface(p->u, p->v - step)), 0.5 / step);
    vec area = cross(along, around);
    double sigma = 0.62 * sqrt(sqrt(dot(area, area)) / (double)p->count);
    lay_flat(s, surface(p->u, p->v), normalise(area), along, sigma, opacity);
}

static void turn(splat *s, uint64_t key, unsigned k)
{
    double z = 2 * draw(key, k) - 1, r = sqrt(1 - z * z), turn0 = draw(key, k + 1), turn1 = draw(key, k + 2);
    vec n = v3(r * cosine(turn0), r * sine(turn0), z);
    vec a = normalise(cross(n, n.x * n.x < 0.5 ? v3(1, 0, 0) : v3(0, 1, 0)));
    s->axis[0] = add(times(a, cosine(turn1)), times(cross(n, a), sine(turn1)));
    s->axis[1] = cross(n, s->axis[0]);
    s->axis[2] = n;
}

/* Converts a rotation with columns a, b, c to a unit quaternion w x y z. */
static void quaternion(vec a, vec b, vec c, double q[4])
{
    double w = 1 + a.x + b.y + c.z, x = 1 + a.x - b.y - c.z, y = 1 - a.x + b.y - c.z, z = 1 - a.x - b.y + c.z;
    double yz = b.z - c.y, zx = c.x - a.z, xy = a.y - b.x;
    if (w >= x && w >= y && w >= z)
        q[0] = w, q[1] = yz, q[2] = zx, q[3] = xy;
    else if (x >= y && x >= z)
        q[0] = yz, q[1] = x, q[2] = a.y + b.x, q[3] = c.x + a.z;
    else if (y >= z)
        q[0] = zx, q[1] = a.y + b.x, q[2] = y, q[3] = b.z + c.y;
    else
        q[0] = xy, q[1] = c.x + a.z, q[2] = b.z + c.y, q[3] = z;
    double scale = 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; k++)
        q[k] *= scale;
}

static void store(float out[3], vec v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void finish(const splat *s, fxs_gaussian *out)
{
    double q[4];
    quaternion(s->axis[0], s->axis[1], s->axis[2], q);
    for (int k = 0; k < 4; k++)
        out->rotation[k] = (float)q[k];
    for (int k = 0; k < 3; k++)
        out->scale[k] = (float)logarithm(s->sigma[k]);
    store(out->position, s->position);
    out->opacity = (float)logarithm(s->opacity / (1 - s->opacity));
    store(out->dc, sub(s->sh[0], times(v3(1, 1, 1), 0.5 / FXS_SH_0)));
    for (int k = 0; k < 15; k++)
        store(out->sh + 3 * k, s->sh[k + 1]);
}

#define KNOT_SIZE 0.80
#define KNOT_TUBE 0.50
#define TABLE_Y 2.13
#define TABLE_RADIUS 4.6
#define TABLE_DEPTH 0.30

static const vec key_light = { -0.53, -0.74, -0.42 }, cool_light = { 0.74, -0.29, 0.60 }, sky_light = { 0, -1, 0 };

static const struct marble {
    double x, z, radius;
    vec colour;
    double iridescence;
} marbles[] = {
    { -2.75, -1.25, 0.62, { 0.80, 0.16, 0.10 }, 0.0 },
    { 2.55, -1.55, 0.50, { 0.05, 0.36, 0.40 }, 0.1 },
    { 1.62, -2.35, 0.34, { 0.86, 0.56, 0.10 }, 0.0 },
    { -1.35, -2.60, 0.40, { 0.50, 0.50, 0.54 }, 0.30 },
    { 3.35, 0.35, 0.42, { 0.42, 0.09, 0.34 }, 0.1 },
    { -3.70, 0.95, 0.42, { 0.10, 0.22, 0.58 }, 0.1 },
    { 0.25, -3.15, 0.26, { 0.06, 0.42, 0.20 }, 0.0 },
    { -0.6, 2.6, 0.55, { 0.72, 0.66, 0.58 }, 0.2 },
};
#define MARBLES (sizeof marbles / sizeof marbles[0])

/* Returns a point of the trefoil curve (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t), from s = sin t and c = cos t. */
static vec trefoil(double s, double c)
{
    return times(v3(s + 4 * s * c, c - 2 * (c * c - s * s), -s * (3 - 4 * s * s)), KNOT_SIZE);
}

/* Returns a point of a rope along the trefoil curve. u runs along the rope, v around. */
static vec knot_surface(double u, double v)
{
    double s = sine(u), c = cosine(u);
    vec tangent = normalise(v3(c + 4 * (c * c - s * s), -s + 8 * s * c, -3 * c * (1 - 4 * s * s)));
    vec a = normalise(cross(tangent, v3(0, 0, 1))), b = cross(a, tangent);
    double radius = KNOT_TUBE * (1 + 0.06 * cosine(5 * v + 12 * u));
    return add(trefoil(s, c), add(times(a, radius * cosine(v)), times(b, radius * sine(v))));
}

/* Computes how a ball shades point p. Reduces *open (visible share of the sky) and *lit (visible share of the main
   light). */
static void occlude(vec p, vec normal, vec centre, double radius, double weight, double *open, double *lit)
{
    vec to = sub(centre, p);
    double square = dot(to, to), facing = dot(to, normal), along = dot(to, key_light);
    if (facing > 0)
        *open -= weight * radius * radius * facing / (square * sqrt(square));
    if (along > 0) {
        double across = sqrt(clamp(square - along * along, 0, square)), edge = 0.05 + 0.10 * along;
        double free = smoothstep(radius - edge, radius + edge, across);
        *lit = free < *lit ? free : *lit;
    }
}

static void occlude_all(vec p, vec normal, double *open, double *lit)
{
    enum { BALLS = 72 };
    const double step_c = 0.99619469809174554, step_s = 0.08715574274765817;   /* cosine and sine of a 72nd of a turn */
    double s = 0, c = 1;
    *open = *lit = 1;
    for (int k = 0; k < BALLS; k++) {
        occlude(p, normal, trefoil(s, c), KNOT_TUBE, 0.28, open, lit);
        double next = s * step_c + c * step_s;
        c = c * step_c - s * step_s;
        s = next;
    }
    for (size_t k = 0; k < MARBLES; k++) {
        vec centre = v3(marbles[k].x, TABLE_Y - marbles[k].radius, marbles[k].z), to = sub(centre, p);
        if (dot(to, to) > 1.01 * marbles[k].radius * marbles[k].radius)
            occlude(p, normal, centre, marbles[k].radius, 1, open, lit);
    }
    *open = clamp(*open, 0.12, 1);
}

/* Adds an iridescent colour: cos(k x + 2 pi phase), with k = 2.6 and x = d . normal for viewing direction d. The cosine
   is approximated by a Legendre series. */
static void add_iridescence(splat *s, vec normal, double phase, double strength)
{
    static const double even[4] = { 0.198, 0, -1.352, 0 }, odd[4] = { 0, 1.217, 0, -0.797 };
    vec c = v3(cosine(phase), cosine(phase + 0.33), cosine(phase + 0.67));
    vec d = v3(sine(phase), sine(phase + 0.33), sine(phase + 0.67));
    add_zonal(s, normal, even, times(c, strength));
    add_zonal(s, normal, odd, times(d, -strength));
}

static void add_gloss(splat *s, vec normal, vec colour, double phase, double iridescence)
{
    double open, lit, key = dot(normal, key_light), cool = dot(normal, cool_light);
    occlude_all(s->position, normal, &open, &lit);
    double diffuse = 0.50 * open * (1.2 - 0.6 * normal.y) + 0.75 * lit * clamp(key, 0, 1);
    add_constant(s, times(colour, diffuse));
    add_iridescence(s, normal, phase, iridescence * blend(open, diffuse, 0.6));
    vec warm = times(v3(0.72, 0.67, 0.59), lit * smoothstep(0, 0.5, key));
    vec cold = times(v3(0.245, 0.385, 0.595), open * smoothstep(0, 0.5, cool));
    vec above = times(v3(0.22, 0.25, 0.30), open * smoothstep(-0.2, 0.6, -normal.y));
    add_zonal(s, mirror(key_light, normal), highlight, warm);
    add_zonal(s, mirror(cool_light, normal), highlight, cold);
    add_zonal(s, mirror(sky_light, normal), highlight, above);
    add_zonal(s, normal, rim, times(v3(0.10, 0.13, 0.20), open));
}

static void knot_rope(place *p, splat *s)
{
    lay_surface(p, knot_surface, 0.96, s);
    add_gloss(s, s->axis[2], v3(0.42, 0.38, 0.46), p->u + 0.06 * sine(5 * p->v + 12 * p->u), 0.23);
}

static void knot_marble(place *p, splat *s)
{
    const struct marble *m = &marbles[p->index % MARBLES];
    spread_evenly(p, p->index / MARBLES, p->count / MARBLES + 1);
    double y = 2 * p->u - 1, r = sqrt(1 - y * y);
    vec normal = v3(r * cosine(p->v), y, r * sine(p->v));
    vec centre = v3(m->x, TABLE_Y - m->radius, m->z);
    double sigma = 0.72 * m->radius * sqrt(4 * PI * (double)MARBLES / (double)p->count);
    lay_flat(s, add(centre, times(normal, m->radius)), normal, v3(normal.z + 1e-9, 0, -normal.x), sigma, 0.96);
    add_gloss(s, normal, m->colour, 0.3 * normal.y, m->iridescence);
}

static vec table_colour(double x, double z, double r, uint64_t key)
{
    double grain = plain_noise(x * 1.3, z * 1.3, 5) + 0.5 * plain_noise(x * 3.7, z * 3.7, 6);
    vec stone = times(v3(0.80, 0.76, 0.70), 1 + 0.05 * grain + 0.06 * (draw(key, 0) - 0.5));
    vec slate = times(v3(0.16, 0.24, 0.30), 1 + 0.15 * grain);
    stone = blend3(stone, v3(0.78, 0.56, 0.26), smoothstep(0.38, 0.34, fabs(r - 3.97)));
    return blend3(stone, slate, smoothstep(0.28, 0.24, fabs(r - 3.97)));
}

static void knot_table(place *p, splat *s)
{
    const double side = 2 * TABLE_DEPTH / (2 * TABLE_DEPTH + TABLE_RADIUS);
    double c = cosine(p->v), z = sine(p->v), open, lit, r = TABLE_RADIUS * sqrt(clamp(p->u / (1 - side), 0, 1));
    double y = TABLE_Y + TABLE_DEPTH * clamp((p->u - 1 + side) / side, 0, 1);
    vec normal = p->u < 1 - side ? v3(0, -1, 0) : v3(c, 0, z);
    double sigma = 0.72 * sqrt(PI * TABLE_RADIUS * (TABLE_RADIUS + 2 * TABLE_DEPTH) / (double)p->count);
    lay_flat(s, v3(r * c, y, r * z), normal, v3(-z, 0, c), sigma, 0.96);
    occlude_all(s->position, normal, &open, &lit);
    double key = clamp(dot(normal, key_light), 0, 1) * lit * smoothstep(9, 2, r);
    vec light = add(times(v3(0.34, 0.37, 0.44), open), times(v3(0.98, 0.88, 0.74), key));
    add_constant(s, tint(table_colour(r * c, r * z, r, p->key), light));
    add_zonal(s, mirror(cool_light, normal), highlight, times(v3(0.04, 0.06, 0.10), open));
}

static void knot(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 480, 570, 1000 };
    static void (*const lay[])(place *, splat *) = { knot_rope, knot_marble, knot_table };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

#define LAND_RADIUS 64.0
#define LAND_OCTAVES 6
#define SNOW_LINE 4.6

static const vec sun = { -0.85, -0.42, -0.318 };
static const vec haze = { 0.66, 0.77, 0.88 };

/* Returns the height of the land above the lake. Octaves of noise are damped on steep slopes, which looks like erosion
   (after Quilez, "Elevated"). */
static double land_height(double x, double z, int octaves)
{
    double r = sqrt(x * x + z * z), ring = smoothstep(0, 42, r + 4 * plain_noise(x * 0.11, z * 0.11, 1));
    double px = x * 0.062 + 3.7, pz = z * 0.062 + 9.2, sx = 0, sz = 0, sum = 0, amplitude = 1;
    for (int k = 0; k < octaves; k++) {
        double dx, dz, value = noise(px, pz, (uint64_t)k + 100, &dx, &dz);
        sx += dx * 0.7;
        sz += dz * 0.7;
        sum += amplitude * (0.5 * value + 0.5) / (1 + sx * sx + sz * sz);
        amplitude *= 0.5;
        double turned = 1.6 * px - 1.2 * pz;
        pz = 1.2 * px + 1.6 * pz;
        px = turned;
    }
    return -0.24 + ring * (1.3 + 1.2 * sum) + ring * ring * 11 * sum;
}

static double sun_reach(vec p)
{
    double reach = 1;
    for (double t = 0.5; t < 20 && reach > 0; t *= 3) {
        double gap = -(p.y + sun.y * t) - land_height(p.x + sun.x * t, p.z + sun.z * t, 3);
        double free = 0.5 + 4 * gap / t;
        reach = free < reach ? free : reach;
    }
    return smoothstep(0, 1, reach);
}

/* Returns the density of the forest at a point. Trees grow where it exceeds 0.05. */
static double forest(double x, double z)
{
    return plain_noise(x * 0.21, z * 0.21, 31) + 0.5 * plain_noise(x * 0.6, z * 0.6, 32);
}

/* Lights a surface colour. Returns display values, which are the square root of linear light. */
static vec land_light(vec colour, double direct, double sky, double r)
{
    vec light = add(times(v3(1.65, 1.38, 1.05), direct), times(v3(0.20, 0.28, 0.42), sky));
    vec linear = tint(colour, light);
    double far = smoothstep(8, 75, r);
    return blend3(v3(sqrt(linear.x), sqrt(linear.y), sqrt(linear.z)), haze, 0.6 * far);
}

static vec ground_colour(vec p, vec normal, uint64_t key)
{
    double height = -p.y, rough = plain_noise(p.x * 0.9, p.z * 0.9, 41) + 0.5 * plain_noise(p.x * 2.7, p.z * 2.7, 42);
    double speckle = 0.8 + 0.4 * draw(key, 1);
    vec grass = blend3(v3(0.10, 0.19, 0.035), v3(0.30, 0.30, 0.07), clamp(0.5 + 0.45 * rough, 0, 1));
    grass = times(grass, 1 - 0.45 * smoothstep(0, 0.5, forest(p.x, p.z)));
    if (draw(key, 2) < 0.02 && rough > 0)
        grass = draw(key, 3) < 0.5 ? v3(0.75, 0.55, 0.08) : v3(0.70, 0.66, 0.70);
    double strata = 0.5 + 0.5 * plain_noise(height * 4 + rough, p.x * 0.1, 43);
    vec rock = blend3(v3(0.17, 0.145, 0.13), v3(0.30, 0.26, 0.23), strata);
    vec colour = blend3(v3(0.42, 0.36, 0.24), grass, smoothstep(0.03, 0.12, height + 0.03 * rough));
    colour = blend3(colour, rock, smoothstep(0.80, 0.66, -normal.y + 0.06 * rough));
    colour = blend3(colour, rock, smoothstep(2.8, 4.2, height + 0.5 * rough));
    colour = times(colour, speckle);
    double above = height - SNOW_LINE;
    double snow = smoothstep(-0.4, 0.6, above + 0.7 * rough) * smoothstep(0.40, 0.62, -normal.y + 0.02 * above);
    return blend3(colour, v3(0.60, 0.63, 0.68), snow);
}

static void lay_water(const place *p, double x, double z, double sigma, splat *s)
{
    double ripple = 0.03 * plain_noise(x * 2.2, z * 5.0, 51);
    vec normal = normalise(v3(ripple, -1, 0.03 * (draw(p->key, 1) - 0.5)));
    lay_flat(s, v3(x, 0, z), normal, v3(1, 0, 0), sigma, 0.07);
    add_constant(s, v3(0.03, 0.15, 0.19));
    add_zonal(s, v3(0, -1, 0), rim, times(sub(haze, v3(0.03, 0.15, 0.19)), 0.45));
    add_zonal(s, mirror(sun, normal), highlight, v3(0.22, 0.18, 0.10));
}

static void lay_ground(const place *p, double x, double z, double h, double sigma, splat *s)
{
    double step = sigma > 0.01 ? sigma : 0.01, r = sqrt(x * x + z * z);
    double dx = (land_height(x + step, z, LAND_OCTAVES) - h) / step;
    double dz = (land_height(x, z + step, LAND_OCTAVES) - h) / step;
    vec normal = normalise(v3(-dx, -1, -dz));
    lay_flat(s, v3(x, -h, z), normal, v3(dx + 1e-9, -dx * dx - dz * dz, dz), sigma, 0.97);
    s->sigma[0] = sigma * clamp(-1 / normal.y, 1, 1.8);
    double direct = clamp(dot(normal, sun), 0, 1);
    if (direct > 0)
        direct *= sun_reach(s->position);
    vec colour = ground_colour(s->position, normal, p->key);
    add_constant(s, land_light(colour, direct, 0.7 - 0.3 * normal.y, r));
    add_zonal(s, normal, rim, times(v3(0.03, 0.035, 0.03), 1 + direct));
    add_zonal(s, mirror(sun, normal), highlight, times(colour, 0.12 * direct));
}

/* Spreads points over a ring, sparser with distance from its middle. The radius is from + (to - from) (linear u +
   square u^2), where linear + square = 1. */
static void spread_over(const place *p, double from, double to, double linear, double square, double *x, double *z,
                        double *sigma)
{
    double r = from + (to - from) * p->u * (linear + square * p->u);
    double slope = (to - from) * (linear + 2 * square * p->u);
    *x = r * cosine(p->v);
    *z = r * sine(p->v);
    *sigma = clamp(0.72 * sqrt(2 * PI * (r + 0.05) * slope / (double)p->count), 0, 4);
}

static void spread(const place *p, double from, double *x, double *z, double *sigma)
{
    spread_over(p, from, LAND_RADIUS, 0.55, 0.45, x, z, sigma);
}

static void landscape_ground(place *p, splat *s)
{
    double x, z, sigma;
    spread(p, 0, &x, &z, &sigma);
    double h = land_height(x, z, LAND_OCTAVES);
    if (h < 0)
        lay_water(p, x, z, sigma, s);
    else
        lay_ground(p, x, z, h, sigma, s);
}

static void reflect_in_lake(splat *s)
{
    static const int odd_in_y[16] = { 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0 };
    s->position.y = -s->position.y;
    for (int k = 0; k < 3; k++)
        s->axis[k].y = -s->axis[k].y;
    s->axis[1] = times(s->axis[1], -1);
    for (int k = 0; k < 16; k++)
        s->sh[k] = times(s->sh[k], odd_in_y[k] ? -0.85 : 0.85);
}

static void lay_mist(const place *p, vec centre, double sigma, double opacity, vec colour, splat *s)
{
    lay_round(s, centre, sigma, opacity, colour);
    s->sigma[1] = 0.45 * sigma;
    add_zonal(s, sun, highlight, times(v3(0.12, 0.11, 0.09), 0.5 + draw(p->key, 9)));
}

static void landscape_reflected_ground(place *p, splat *s)
{
    double x, z, sigma;
    spread(p, 3, &x, &z, &sigma);
    double h = land_height(x, z, LAND_OCTAVES);
    if (h < 0.02) {
        vec centre = v3(x, -0.05 - 0.35 * draw(p->key, 1) * draw(p->key, 2), z);
        lay_mist(p, centre, 3 * sigma, 0.008 * smoothstep(2, 8, sqrt(x * x + z * z)) + 0.0001, v3(0.80, 0.86, 0.92), s);
        return;
    }
    lay_ground(p, x, z, h, sigma, s);
    reflect_in_lake(s);
}

static vec tree_foot(uint64_t key)
{
    vec foot = v3(0, 0, 0);
    for (unsigned k = 0; k < 100; k++) {
        double x = 56 * draw(key, 2 * k) - 28, z = 56 * draw(key, 2 * k + 1) - 28;
        if (forest(x, z) < 0.05)
            continue;
        foot = v3(x, -land_height(x, z, LAND_OCTAVES), z);
        if (foot.y < -0.08 && foot.y > -3.2)
            break;
    }
    return foot;
}

static void landscape_tree(place *p, splat *s)
{
    uint64_t trees = p->total / 400 + 1 < 3000 ? p->total / 400 + 1 : 3000;
    uint64_t key = key_of(p->seed, ~(p->index % trees) << 8);
    double twigs = (double)(p->count / trees + 1), height = 0.5 + 0.6 * draw(key, 20);
    vec foot = tree_foot(key);
    double up = 1 - sqrt(1 - draw(p->key, 1)), turns = draw(p->key, 2), tier = up * 9 - whole(up * 9);
    double reach = height * 0.24 * (1 - up) * (1.1 - 0.55 * tier) * (0.55 + 0.45 * sqrt(draw(p->key, 3)));
    vec out = v3(cosine(turns), 0.45, sine(turns));
    vec at = add(foot, v3(out.x * reach, -height * (0.10 + 0.90 * up), out.z * reach));
    vec normal = normalise(v3(out.x * 0.7, -1, out.z * 0.7));
    double sigma = height * 0.36 / sqrt(twigs), r = sqrt(at.x * at.x + at.z * at.z);
    lay_flat(s, at, normal, out, sigma, 0.93);
    s->sigma[0] = 1.7 * sigma;
    s->sigma[2] = 0.4 * sigma;
    vec green = blend3(v3(0.035, 0.085, 0.03), v3(0.10, 0.16, 0.04), draw(key, 21));
    vec colour = draw(key, 22) < 0.22 ? v3(0.50, 0.27, 0.04) : green;
    double depth = reach / (height * 0.26 * (1.02 - up)), shade = (0.25 + 0.9 * depth) * (0.6 + 0.8 * draw(p->key, 4));
    double direct = clamp(0.30 + 0.70 * dot(v3(out.x, -0.5, out.z), sun), 0.05, 1);
    add_constant(s, land_light(times(colour, shade), direct, 0.9, r));
    add_zonal(s, normal, rim, times(colour, 0.25));
    add_zonal(s, times(sun, -1), highlight, times(colour, 0.3 * direct));
}

static void landscape_reflected_tree(place *p, splat *s)
{
    landscape_tree(p, s);
    reflect_in_lake(s);
}

static void landscape_cloud(place *p, splat *s)
{
    enum { CLOUDS = 22 };
    uint64_t key = key_of(p->seed, ~(p->index % CLOUDS) << 16);
    double turns = draw(key, 1), r = 30 + 30 * draw(key, 2), size = 3 + 4 * draw(key, 3);
    vec centre = v3(r * cosine(turns), -9 - 7 * draw(key, 4), r * sine(turns));
    unsigned puff = (unsigned)(draw(p->key, 3) * 9);
    double px = 2 * draw(key, puff + 40) - 1, big = size * (1 - 0.7 * px * px) * (0.35 + 0.35 * draw(key, puff + 50));
    vec in = v3(0, 0, 0);
    for (unsigned k = 0; k < 9; k += 3)
        in = add(in, v3(draw(p->key, 10 + k) - 0.5, draw(p->key, 11 + k) - 0.5, draw(p->key, 12 + k) - 0.5));
    vec offset = add(times(in, big), v3(px * size, -0.2 * big, 0.6 * size * (draw(key, puff + 60) - 0.5)));
    offset.y *= offset.y > 0 ? 0.3 : 0.8;
    double shade = smoothstep(-1.2, 0.8, dot(in, sun) - 0.3 * in.y);
    double sigma = 3.0 * size / sqrt((double)p->count / CLOUDS + 1);
    vec along = v3(-centre.z, 0, centre.x), flat = v3(offset.x * along.x / r - offset.z * along.z / r, offset.y,
                                                        offset.x * along.z / r + offset.z * along.x / r);
    lay_mist(p, add(centre, flat), sigma, 0.06, blend3(v3(0.66, 0.73, 0.83), v3(1.0, 0.985, 0.96), shade), s);
}

static void landscape(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 560, 680, 900, 960, 1000 };
    static void (*const lay[])(place *, splat *) = {
        landscape_ground, landscape_reflected_ground, landscape_tree, landscape_reflected_tree, landscape_cloud,
    };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

#define MEADOW_RADIUS 74.0
#define TREE_HEIGHT 1.5
#define THIN 1e-9       /* sigma of flat discs across their plane */

static const vec noon = { -0.48, -0.80, -0.36 };

static double meadow_height(double x, double z)
{
    double r = sqrt(x * x + z * z), near = 0.30 * plain_noise(x * 0.15, z * 0.15, 61);
    double hill = 0.55 + 0.45 * plain_noise(x * 0.035, z * 0.035, 62);
    return near * smoothstep(1, 9, r) + 7 * hill * smoothstep(24, 66, r);
}

static double meadow_sun(double x, double z)
{
    double dx = x - 0.6, dz = z - 0.45;
    return blend(0.35, 1, smoothstep(0.5, 1.5, sqrt(dx * dx + dz * dz) + 0.2 * plain_noise(x * 3, z * 3, 63)));
}

static vec meadow_green(double x, double z, uint64_t key)
{
    double patch = plain_noise(x * 0.35, z * 0.35, 64) + 0.5 * plain_noise(x * 1.7, z * 1.7, 65);
    vec green = blend3(v3(0.24, 0.40, 0.12), v3(0.58, 0.62, 0.22), clamp(0.5 + 0.4 * patch, 0, 1));
    double r = sqrt(x * x + z * z);
    green = times(green, (0.75 + 0.4 * draw(key, 1)) * meadow_sun(x, z));
    return blend3(green, v3(0.62, 0.74, 0.80), 0.7 * smoothstep(15, 110, r));
}

/* Adds random errors to the spherical harmonics, as training does. Most of each error is common to the three colour
   channels. */
static void add_error(splat *s, uint64_t key, double rms)
{
    for (unsigned k = 1; k < 16; k++) {
        double all = draw(key, 100 + 5 * k) + draw(key, 101 + 5 * k) - 1;
        vec each = v3(draw(key, 102 + 5 * k) - 0.5, draw(key, 103 + 5 * k) - 0.5, draw(key, 104 + 5 * k) - 0.5);
        s->sh[k] = add(s->sh[k], times(add(v3(all, all, all), times(each, 0.6)), 2.25 * rms));
    }
}

static void meadow_ground(place *p, splat *s)
{
    double x, z, sigma;
    spread_over(p, 0, MEADOW_RADIUS, 0.06, 0.94, &x, &z, &sigma);
    double h = meadow_height(x, z), step = 0.05 + 0.1 * sigma;
    vec normal = normalise(v3((h - meadow_height(x + step, z)) / step, -1, (h - meadow_height(x, z + step)) / step));
    lay_flat(s, v3(x, -h, z), normal, v3(1, 0, 0), sigma, 0.96);
    s->sigma[0] *= 1 + draw(p->key, 2);
    if (draw(p->key, 3) < 0.5)
        s->sigma[2] = THIN;
    vec soil = times(v3(0.30, 0.25, 0.16), meadow_sun(x, z));
    double light = clamp(0.35 + 0.75 * dot(normal, noon), 0.3, 1.1);
    vec green = meadow_green(x, z, p->key);
    add_constant(s, times(blend3(soil, green, smoothstep(0, 10, sqrt(x * x + z * z)) * 0.5 + 0.4), light));
    add_error(s, p->key, 0.03);
}

static void meadow_grass(place *p, splat *s)
{
    double x, z, sigma;
    spread_over(p, 0, 14, 0.3, 0.7, &x, &z, &sigma);
    vec lean = normalise(v3(0.9 * draw(p->key, 4) - 0.3, -1, 0.8 * draw(p->key, 5) - 0.4));
    vec side = normalise(cross(lean, v3(draw(p->key, 6) - 0.5, 0, 1)));
    double length = clamp(2.6 * sigma, 0, 0.12) * (0.6 + 0.8 * draw(p->key, 7));
    double up = length + 0.12 * draw(p->key, 8) * draw(p->key, 8);
    vec at = add(v3(x, -meadow_height(x, z), z), times(lean, up));
    lay_flat(s, at, side, lean, 0.28 * sigma, 0.6 + 0.38 * draw(p->key, 9));
    s->sigma[0] = length;
    vec green = times(meadow_green(x, z, p->key), 0.55 + 4 * up);
    add_constant(s, green);
    add_zonal(s, times(noon, -1), highlight, times(green, 0.35));
    add_zonal(s, side, rim, times(green, 0.12));
    add_error(s, p->key, 0.035);
}

static void meadow_flower(place *p, splat *s)
{
    static const vec petals[] = {
        { 0.97, 0.96, 0.92 }, { 0.86, 0.14, 0.08 }, { 0.33, 0.38, 0.88 }, { 0.96, 0.80, 0.16 },
    };
    uint64_t key = key_of(p->seed, ~(p->index / 6) << 12);
    unsigned petal = (unsigned)(p->index % 6);
    double r = 0.5 + 9.5 * draw(key, 0) * (0.3 + 0.7 * draw(key, 0)), c = cosine(draw(key, 1)), z = sine(draw(key, 1));
    vec facing = normalise(v3(0.9 * draw(key, 2) - 0.6, -0.8, 0.9 * draw(key, 3) - 0.7));
    vec across = normalise(cross(facing, v3(1, 0, 0.2)));
    vec out = add(times(across, cosine(petal / 5.0)), times(cross(facing, across), sine(petal / 5.0)));
    double size = 0.024 * (0.7 + 0.6 * draw(key, 4)) * clamp(sqrt(12000 / (double)p->count), 0.2, 3);
    vec head = v3(r * c, -meadow_height(r * c, r * z) - 0.16 - 0.16 * draw(key, 5), r * z);
    double kind = 2 + 2 * plain_noise(r * c * 0.3, r * z * 0.3, 66) + 2 * (draw(key, 6) - 0.5);
    vec colour = times(petals[(int)clamp(kind, 0, 3.9)], 0.85 + 0.2 * draw(p->key, 1));
    if (petal == 5) {
        lay_flat(s, add(head, times(facing, 0.3 * size)), facing, out, 0.45 * size, 0.97);
        colour = v3(0.90, 0.66, 0.10);
    } else {
        lay_flat(s, add(head, times(out, size)), normalise(add(facing, times(out, -0.3))), out, 0.6 * size, 0.95);
        s->sigma[1] *= 0.6;
    }
    colour = times(colour, meadow_sun(r * c, r * z));
    add_constant(s, times(colour, 0.9));
    add_zonal(s, times(noon, -1), highlight, times(colour, 0.15));
    add_error(s, p->key, 0.03);
}

static vec tree_blob(unsigned k)
{
    uint64_t key = mix(k + 77);
    double turns = k * 0.381966, out = k ? 0.30 + 0.32 * draw(key, 0) : 0;
    double up = TREE_HEIGHT + (k ? 0.42 : 0.67) - 0.62 * (draw(key, 1) - 0.5);
    return v3(out * cosine(turns), -up, out * sine(turns));
}

enum { TREE_BLOBS = 13 };

static vec tree_trunk(double u, double v)
{
    double foot = (1 - u) * (1 - u) * (1 - u) * (1 - u);
    double radius = 0.115 * (1 - 0.45 * u) * (1 + 0.10 * cosine(5 * v + 0.3 * u)) + 0.13 * foot;
    return v3(0.10 * sine(0.55 * u) + radius * cosine(v), 0.05 - (TREE_HEIGHT + 0.05) * u,
              0.06 * sine(0.8 * u) - radius * sine(v));
}

static void tree_branch(const place *p, splat *s)
{
    vec from = v3(0.09, 0.25 - TREE_HEIGHT, -0.02), to = sub(tree_blob((unsigned)(p->index % TREE_BLOBS)), from);
    vec along = normalise(to), a = normalise(cross(along, v3(0.3, 0.1, 1))), b = cross(along, a);
    vec normal = add(times(a, cosine(p->v)), times(b, sine(p->v)));
    double radius = 0.055 * (1 - 0.75 * p->u);
    vec at = add(add(from, times(to, p->u)), add(times(normal, radius), v3(0, 0.12 * p->u * (1 - p->u), 0)));
    lay_flat(s, at, normal, along, 2.0 * radius / sqrt((double)(p->count / TREE_BLOBS / 12 + 1)), 0.95);
    s->sigma[0] *= 2;
}

static void meadow_trunk(place *p, splat *s)
{
    if (p->index % 4 == 0)
        tree_branch(p, s);
    else
        lay_surface(p, tree_trunk, 0.95, s);
    vec normal = s->axis[2];
    double bark = 0.75 + 0.35 * plain_noise(p->v * 40, p->u * 9, 67) + 0.2 * (draw(p->key, 1) - 0.5);
    vec colour = times(v3(0.43, 0.33, 0.26), bark * (0.45 + 0.7 * clamp(dot(normal, noon), 0, 1)));
    add_constant(s, colour);
    add_error(s, p->key, 0.04);
}

static void meadow_crown(place *p, splat *s)
{
    vec centre = tree_blob((unsigned)(p->index % TREE_BLOBS)), crown = v3(0, -TREE_HEIGHT - 0.35, 0);
    double y = 2 * draw(p->key, 1) - 1, r = sqrt(1 - y * y), radius = 0.34 * sqrt(0.45 + 0.55 * draw(p->key, 2));
    vec out = v3(r * cosine(p->v), y, r * sine(p->v)), at = add(centre, times(out, radius));
    double sigma = 0.95 / sqrt((double)p->count) * (1.2 + 0.8 * draw(p->key, 3));
    lay_flat(s, at, v3(0, 0, 1), v3(1, 0, 0), sigma, 0.75 + 0.24 * draw(p->key, 4));
    turn(s, p->key, 5);
    s->sigma[1] *= 0.7;
    vec up = normalise(sub(at, crown));
    double light = clamp(0.62 + 0.30 * dot(up, noon) + 0.22 * dot(out, noon), 0.2, 1.2);
    vec pink = blend3(v3(0.98, 0.70, 0.78), v3(1.0, 0.93, 0.95), draw(p->key, 8));
    vec colour = draw(p->key, 9) < 0.72 ? pink : v3(0.42, 0.60, 0.20);
    add_constant(s, times(colour, light));
    add_zonal(s, times(noon, -1), highlight, times(colour, 0.2 * light));
    add_error(s, p->key, 0.04);
}

static void meadow_woods(place *p, splat *s)
{
    enum { TREES = 90 };
    uint64_t key = key_of(p->seed, ~(p->index % TREES) << 10);
    double turns = draw(key, 0), far = 18 + 46 * draw(key, 1), x = far * cosine(turns), z = far * sine(turns);
    double y = 2 * draw(p->key, 1) - 1, r = sqrt(1 - y * y), size = 1.2 + 1.6 * draw(key, 2);
    vec out = v3(r * cosine(p->v), y, r * sine(p->v)), in = times(out, size * (0.6 + 0.4 * draw(p->key, 2)));
    vec at = v3(x + in.x, 1.3 * in.y - 1.1 * size - meadow_height(x, z), z + in.z);
    lay_flat(s, at, v3(0, 0, 1), v3(1, 0, 0), 3.0 * size / sqrt((double)p->count / TREES + 1), 0.93);
    turn(s, p->key, 4);
    vec green = blend3(v3(0.16, 0.30, 0.12), v3(0.40, 0.46, 0.16), draw(key, 3));
    double light = (0.55 + 0.55 * clamp(dot(out, noon), -0.6, 1)) * (0.75 + 0.5 * draw(p->key, 8));
    add_constant(s, blend3(times(green, light), v3(0.62, 0.74, 0.80), 0.75 * smoothstep(10, 100, far)));
    add_error(s, p->key, 0.03);
}

static vec sky_colour(vec d)
{
    double up = clamp(-d.y, 0, 1), flat = 1 / (0.12 + up);
    double x = d.x * flat, z = d.z * flat;
    double cloud = plain_noise(x * 0.9, z * 0.9, 68) + 0.5 * plain_noise(x * 2.3, z * 2.3, 69);
    vec blue = blend3(v3(0.78, 0.87, 0.94), v3(0.22, 0.46, 0.82), smoothstep(0, 0.7, up));
    return blend3(blue, v3(0.97, 0.97, 0.98), smoothstep(0.1, 0.8, cloud) * smoothstep(0, 0.15, up));
}

static void lay_sky(const place *p, double height, double nearest, double farthest, splat *s)
{
    double y = 0.06 - height * p->u, r = sqrt(1 - y * y), far = blend(nearest, farthest, draw(p->key, 1));
    double wide = draw(p->key, 2);
    vec d = v3(r * cosine(p->v), y, r * sine(p->v));
    double even = sqrt(2 * PI / (double)p->count);
    lay_flat(s, times(d, far), d, v3(draw(p->key, 3) - 0.5, 1e-3, draw(p->key, 4) - 0.5),
             far * clamp(even * (0.8 + 3.5 * wide * wide), 0, 0.18), 0.5 + 0.48 * draw(p->key, 5));
    s->sigma[1] *= 0.5 + 0.5 * draw(p->key, 6);
    if (draw(p->key, 7) < 0.7)
        s->sigma[2] = THIN;
    add_constant(s, sky_colour(d));
}

static void meadow_sky(place *p, splat *s)
{
    lay_sky(p, 0.4, 66, 77, s);
    add_error(s, p->key, 0.025);
}

enum { STRAYS = 256 };

/* Returns the distance of the outlier number `rank`. That many Gaussians are at least as far away, as in a captured
   scene. */
static double stray_distance(uint64_t rank)
{
    static const double ranks[] = { 1, 8, 32, 128, STRAYS }, units[] = { 24569, 763, 146, 87, 79.5 };
    int k = 1;
    while (ranks[k] < (double)rank)
        k++;
    double near = 1 / ranks[k], far = 1 / ranks[k - 1];
    return blend(units[k - 1], units[k], (far - 1 / (double)rank) / (far - near));
}

static void meadow_stray(const place *p, splat *s)
{
    double y = -0.2 - 0.6 * draw(p->key, 1), r = sqrt(1 - y * y), far = stray_distance(p->index + 1);
    vec d = v3(r * cosine(draw(p->key, 3)), y, r * sine(draw(p->key, 3)));
    vec normal = normalise(add(cross(d, v3(draw(p->key, 8) - 0.5, draw(p->key, 9) - 0.5, draw(p->key, 10) - 0.5)),
                               times(d, 0.1 * draw(p->key, 11) - 0.05)));
    lay_flat(s, times(d, far), normal, d, clamp(0.17 * far, 0, 68) * power_of_half(draw(p->key, 4), 0, 2),
             0.02 + 0.96 * draw(p->key, 5) * draw(p->key, 6) * draw(p->key, 7));
    s->sigma[1] *= 0.1 + 0.9 * draw(p->key, 12);
    s->sigma[2] = THIN;
    add_constant(s, times(v3(0.95, 0.93, 0.90), 0.5 + draw(p->key, 13)));
    add_error(s, p->key, 0.08);
}

static void meadow_outlier(place *p, splat *s)
{
    if (p->index < STRAYS) {
        meadow_stray(p, s);
        return;
    }
    double y = 2 * draw(p->key, 1) - 1, r = sqrt(1 - y * y), far = 60 * power_of_half(draw(p->key, 2), 0, 3.6);
    vec d = v3(r * cosine(draw(p->key, 3)), y, r * sine(draw(p->key, 3)));
    double sigma = far * 0.004 * power_of_half(draw(p->key, 4), 0, 4);
    vec colour = blend3(v3(0.55, 0.60, 0.58), v3(0.95, 0.96, 0.98), draw(p->key, 7));
    lay_round(s, times(d, far), sigma, 0.02 + 0.5 * draw(p->key, 5) * draw(p->key, 6), colour);
    s->sigma[1] *= 0.3;
    turn(s, p->key, 8);
    add_error(s, p->key, 0.08);
}

static void meadow(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 170, 560, 660, 700, 870, 950, 980, 1000 };
    static void (*const lay[])(place *, splat *) = {
        meadow_ground, meadow_grass, meadow_flower, meadow_trunk,
        meadow_crown, meadow_woods, meadow_sky, meadow_outlier,
    };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

#define FENCE_REACH 4.0
#define FENCE_DEPTH 2.8

/* Stretches a flat, round Gaussian to 5 to 40 times its width, at constant area. */
static void stretch(splat *s, uint64_t key)
{
    double longer = blend(5, 40, draw(key, 20)), width = s->sigma[0] / sqrt(longer);
    s->sigma[0] = longer * width;
    s->sigma[1] = width;
    s->sigma[2] = width * (0.1 + 0.5 * draw(key, 21));
}

static vec waver(vec d, uint64_t key)
{
    vec off = v3(draw(key, 22) - 0.5, draw(key, 23) - 0.5, draw(key, 24) - 0.5);
    return normalise(add(d, times(off, 0.08)));
}

static void add_day_light(splat *s, vec colour, uint64_t key)
{
    double light = 0.45 + 0.6 * clamp(fabs(dot(s->axis[2], noon)), 0, 1);
    add_constant(s, times(colour, light));
    add_zonal(s, times(noon, -1), highlight, times(colour, 0.3 * light));
    add_zonal(s, s->axis[1], rim, times(colour, 0.12));
    add_error(s, key, 0.03);
}

/* Lays Gaussians as fibres of a board that begins at `foot`, on both of its faces. u runs along the board, v across
   it. */
static void lay_board(const place *p, vec foot, vec along, vec across, double area, splat *s)
{
    vec face = normalise(cross(along, across));
    vec at = add(add(foot, times(along, p->u)), times(across, 2 * p->v - 1));
    double side = draw(p->key, 0) < 0.5 ? -0.012 : 0.012, sigma = 0.6 * sqrt(area / (double)p->count);
    lay_flat(s, add(at, times(face, side)), face, waver(normalise(along), p->key), sigma, 0.98 - 0.4 * draw(p->key, 1));
    stretch(s, p->key);
    add_day_light(s, times(v3(1.0, 0.96, 0.88), 0.25 + 0.95 * draw(p->key, 2)), p->key);
}

enum { PICKETS = 60, RAILS = 2 };

static void fence_picket(place *p, splat *s)
{
    uint64_t picket = p->index % PICKETS, key = key_of(p->seed, ~picket << 14);
    double x = FENCE_REACH * (2 * ((double)picket + 0.5) / PICKETS - 1), height = 0.95 + 0.1 * draw(key, 0);
    vec along = times(v3(0.08 * (draw(key, 1) - 0.5), -1, 0.06 * (draw(key, 2) - 0.5)), height);
    spread_evenly(p, p->index / PICKETS, p->count / PICKETS + 1);
    vec across = v3(0.04 * smoothstep(1.02, 0.86, p->u), 0, 0.012 * (draw(key, 3) - 0.5));
    lay_board(p, v3(x, 0, 0), along, across, 2 * PICKETS * 0.08, s);
}

static void fence_rail(place *p, splat *s)
{
    double y = p->index % RAILS ? -0.26 : -0.72;
    spread_evenly(p, p->index / RAILS, p->count / RAILS + 1);
    lay_board(p, v3(-FENCE_REACH, y, 0.03), v3(2 * FENCE_REACH, 0.05, 0), v3(0, 0.045, 0),
              2 * RAILS * 2 * FENCE_REACH * 0.09, s);
}

static void fence_grass(place *p, splat *s)
{
    double up = draw(p->key, 0), height = 0.22 + 0.5 * draw(p->key, 1), bend = 0.8 * up * draw(p->key, 2);
    double turns = draw(p->key, 3), x = FENCE_REACH * (2 * p->u - 1), z = FENCE_DEPTH * (2 * p->v - 1);
    height *= z > 0.3 ? 2.5 : 1;
    vec out = v3(cosine(turns), 0, sine(turns)), root = v3(x, 0, z);
    vec at = add(root, times(add(v3(0, -up, 0), times(out, 0.5 * bend * up)), height));
    vec along = waver(normalise(add(v3(0, -1, 0), times(out, bend + 0.2 * (draw(p->key, 4) - 0.5)))), p->key);
    vec face = normalise(cross(along, v3(-out.z, 0.1, out.x)));
    double sigma = 0.8 * sqrt(2 * FENCE_REACH * FENCE_DEPTH / (double)p->count);
    lay_flat(s, at, face, along, sigma, 0.98 - 0.4 * draw(p->key, 5));
    stretch(s, p->key);
    vec green = blend3(v3(0.05, 0.13, 0.03), v3(1.0, 0.98, 0.50), draw(p->key, 6));
    add_day_light(s, green, p->key);
}

static void fence_ground(place *p, splat *s)
{
    double x = 1.1 * FENCE_REACH * (2 * p->u - 1), z = 1.2 * FENCE_DEPTH * (2 * p->v - 1);
    double sigma = 0.9 * sqrt(5 * FENCE_REACH * FENCE_DEPTH / (double)p->count), patch = plain_noise(x, z, 76);
    lay_flat(s, v3(x, 0.02, z), v3(0, -1, 0), v3(draw(p->key, 0) - 0.5, 0, 1), sigma, 0.95);
    add_constant(s, blend3(v3(0.20, 0.17, 0.10), v3(0.25, 0.32, 0.12), 0.5 + 0.5 * patch));
    add_error(s, p->key, 0.03);
}

static void fence(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 350, 400, 900, 1000 };
    static void (*const lay[])(place *, splat *) = { fence_picket, fence_rail, fence_grass, fence_ground };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

#define BENCH_Y 1.2

static const double half_space[4] = { 0.5, 0.75, 0, -0.4375 };   /* Legendre coefficients of light from a half-space */

static const struct lobe {
    vec axis;
    const double *shape;
    vec colour;
} room[] = {
    { { 0, -1, 0 }, half_space, { 0.42, 0.46, 0.54 } },
    { { -0.60, -0.64, -0.48 }, highlight, { 1.05, 0.98, 0.86 } },
    { { 0.80, -0.36, -0.48 }, highlight, { 0.42, 0.60, 0.85 } },
    { { 0.36, -0.48, 0.80 }, highlight, { 0.80, 0.52, 0.30 } },
    { { -0.80, 0.36, 0.48 }, highlight, { 0.34, 0.16, 0.14 } },
};

/* Adds the lights of a room that metal reflects. The viewing direction d shows the light from mirror(d), so each light
   is added at its mirrored direction. */
static void add_room(splat *s, vec normal, vec metal)
{
    add_constant(s, tint(v3(0.20, 0.16, 0.13), metal));
    for (size_t k = 0; k < sizeof room / sizeof room[0]; k++)
        add_zonal(s, mirror(room[k].axis, normal), room[k].shape, tint(room[k].colour, metal));
}

static vec hammered(vec normal, vec at, double depth)
{
    double dx, dz, ex, ez;
    noise(6 * at.x + 2 * at.y, 6 * at.z + 4 * at.y, 71, &dx, &dz);
    noise(5 * at.y - 3 * at.x, 5 * at.x + 4 * at.z, 72, &ex, &ez);
    return normalise(add(normal, times(v3(dx - ez, ex, dz + ez), depth)));
}

static vec vase_surface(double u, double v)
{
    double body = smoothstep(0.02, 0.42, u) * (1 - smoothstep(0.42, 0.80, u));
    double radius = 0.34 + 0.62 * body + 0.24 * smoothstep(0.84, 1, u) - 0.06 * smoothstep(0.02, 0.12, u);
    radius *= 1 + 0.035 * cosine(9 * v + 2 * u) * body;
    return v3(radius * cosine(v), BENCH_Y - 2.6 * u, -radius * sine(v));
}

static void mirrors_vase(place *p, splat *s)
{
    lay_surface(p, vase_surface, 0.97, s);
    add_room(s, hammered(s->axis[2], s->position, 0.10), v3(1.00, 0.74, 0.30));
    add_error(s, p->key, 0.05);
}

static const struct ball {
    double x, z, radius;
    vec metal;
    double dents;
} balls[] = {
    { -1.75, -0.55, 0.55, { 0.92, 0.94, 0.97 }, 0 },
    { 1.55, -1.00, 0.42, { 0.95, 0.58, 0.42 }, 0.05 },
    { 0.45, -1.70, 0.27, { 0.92, 0.94, 0.97 }, 0 },
    { -0.75, -1.75, 0.22, { 1.00, 0.74, 0.30 }, 0.12 },
    { 1.30, 1.35, 0.60, { 0.70, 0.74, 0.80 }, 0.08 },
};
#define BALLS (sizeof balls / sizeof balls[0])

static void mirrors_ball(place *p, splat *s)
{
    const struct ball *b = &balls[p->index % BALLS];
    spread_evenly(p, p->index / BALLS, p->count / BALLS + 1);
    double y = 2 * p->u - 1, r = sqrt(1 - y * y);
    vec normal = v3(r * cosine(p->v), y, r * sine(p->v)), centre = v3(b->x, BENCH_Y - b->radius, b->z);
    vec at = add(centre, times(normal, b->radius));
    double sigma = 0.72 * b->radius * sqrt(4 * PI * (double)BALLS / (double)p->count);
    lay_flat(s, at, normal, v3(normal.z + 1e-9, 0, -normal.x), sigma, 0.97);
    add_room(s, hammered(normal, at, b->dents), b->metal);
    add_error(s, p->key, 0.04);
}

static vec ring_surface(double u, double v)
{
    double out = 1.05 + 0.17 * (1 + 0.08 * cosine(3 * v + 8 * u)) * cosine(v);
    double deep = 0.17 * sine(v) + 0.12 * sine(2 * u);
    return v3(-1.25 + out * cosine(u), BENCH_Y - 1.22 + out * sine(u), 1.15 + deep - 0.3 * out * cosine(u));
}

static void mirrors_ring(place *p, splat *s)
{
    lay_surface(p, ring_surface, 0.97, s);
    add_room(s, s->axis[2], v3(0.93, 0.60, 0.46));
    add_error(s, p->key, 0.05);
}

static void mirrors_bench(place *p, splat *s)
{
    double r = 3.2 * sqrt(p->u), x = r * cosine(p->v), z = r * sine(p->v);
    double across = x * 0.8 + z * 0.6, along = z * 0.8 - x * 0.6, square = whole(across * 1.6) + whole(along * 1.6);
    double grain = plain_noise(across * 2, along * 19, 73);
    int dark = square > 2 * whole(square / 2);
    vec wood = dark ? v3(0.16, 0.10, 0.075) : v3(0.50, 0.34, 0.20);
    lay_flat(s, v3(x, BENCH_Y, z), v3(0, -1, 0), v3(0.8, 0, 0.6), 0.72 * sqrt(PI * 3.2 * 3.2 / (double)p->count), 0.96);
    double shade = smoothstep(0.2, 1.3, sqrt(x * x + z * z));
    for (size_t k = 0; k < BALLS; k++) {
        double dx = x - balls[k].x, dz = z - balls[k].z;
        shade *= blend(0.4, 1, smoothstep(0.1, 1.2, sqrt(dx * dx + dz * dz) / balls[k].radius));
    }
    add_constant(s, times(wood, (0.85 + 0.2 * grain) * blend(0.35, 1, shade) * (1 - 0.5 * smoothstep(2.4, 3.3, r))));
    add_room(s, v3(0, -1, 0), times(v3(0.16, 0.16, 0.17), shade));
    add_error(s, p->key, 0.03);
}

static void mirrors(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 430, 590, 720, 1000 };
    static void (*const lay[])(place *, splat *) = { mirrors_vase, mirrors_ball, mirrors_ring, mirrors_bench };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

static void discs_ground(place *p, splat *s)
{
    double x, z, sigma;
    spread_over(p, 0, 60, 0.1, 0.9, &x, &z, &sigma);
    double r = sqrt(x * x + z * z), ring = r / 1.5 - whole(r / 1.5);
    vec flag = blend3(v3(0.58, 0.52, 0.47), v3(0.44, 0.45, 0.50), draw(p->key, 1));
    flag = times(flag, 1 + 0.25 * plain_noise(x * 0.5, z * 0.5, 74));
    flag = blend3(v3(0.22, 0.22, 0.25), flag, smoothstep(0, 0.25, ring < 0.5 ? ring : 1 - ring));
    vec normal = normalise(v3(0.03 * (draw(p->key, 2) - 0.5), -1, 0.03 * (draw(p->key, 3) - 0.5)));
    vec at = v3(x, TABLE_Y + TABLE_DEPTH + 0.07, z);
    lay_flat(s, at, normal, v3(x + 1e-9, 0, z), 1.1 * sigma, 0.6 + 0.38 * draw(p->key, 4));
    s->sigma[1] *= 0.5 + 0.5 * draw(p->key, 5);
    s->sigma[2] = THIN;
    flag = times(flag, blend(0.45, 1, smoothstep(3.5, 7, r)));
    add_constant(s, blend3(flag, v3(0.93, 0.72, 0.55), 0.8 * smoothstep(12, 65, r)));
}

static void discs_sky(place *p, splat *s)
{
    lay_sky(p, 1.06, 100, 400, s);
    s->sigma[2] = THIN;
    vec d = normalise(s->position);
    double dusk = smoothstep(0.5, 0, -d.y) * (0.6 + 0.4 * dot(d, v3(0, 0, 1)));
    s->sh[0] = blend3(s->sh[0], times(v3(1.0, 0.66, 0.42), 1 / FXS_SH_0), clamp(dusk, 0, 1));
}

static void discs(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 130, 170, 1000 };
    place p;
    splat s;
    int part = part_of(i, count, seed, ends, &p);
    if (part == 2) {
        knot(p.index, p.count, seed, out);
        return;
    }
    (part ? discs_sky : discs_ground)(&p, &s);
    finish(&s, out);
}

typedef struct house {
    vec at;
    double c, s;
    double width, depth, wall, roof;
    vec paint, tiles;
} house;

static vec turned(const house *h, vec v) { return v3(h->c * v.x + h->s * v.z, v.y, h->c * v.z - h->s * v.x); }

static vec lay_on_house(const house *h, double face, double u, double v, double sigma, splat *s)
{
    double side = face < 0.5 ? -1 : 1, part = 2 * (face < 0.5 ? face : face - 0.5), w = h->width / 2, d = h->depth / 2;
    vec at, normal, along = v3(0, 0, 1), colour = h->paint;
    if (part < 0.5) {
        at = v3(1.1 * side * w * (1 - v), -(h->wall + h->roof * (1.1 * v - 0.1)), 1.1 * d * (2 * u - 1));
        normal = v3(side * h->roof, -w, 0);
        colour = times(h->tiles, 0.85 + 0.3 * (8 * v - whole(8 * v)));
    } else if (part < 0.75) {
        at = v3(side * w, -h->wall * v, d * (2 * u - 1));
        normal = v3(side, 0, 0);
    } else {
        at = v3(w * (2 * u - 1), -v * (h->wall + h->roof * (1 - fabs(2 * u - 1))), side * d);
        normal = v3(0, 0, side);
        along = v3(1, 0, 0);
    }
    double pane = 3 * u - whole(3 * u);
    if (part >= 0.5 && pane > 0.33 && pane < 0.67 && v > 0.35 && v < 0.70)
        colour = v3(0.13, 0.15, 0.19);
    lay_flat(s, add(h->at, turned(h, at)), turned(h, normalise(normal)), turned(h, along), sigma, 0.96);
    return colour;
}

/* The scene below tests rounding losses: its opacities are a few steps of 1/255, and hundreds of Gaussians overlap. */
#define SHORE_Y 1.6

static const vec lamp = { 0, -3.05, 0 };

static double shore_height(double x, double z)
{
    return 0.5 * smoothstep(6, 0.5, sqrt(x * x + z * z)) + 0.16 * plain_noise(x * 0.8, z * 0.8, 81) +
        0.07 * plain_noise(x * 2.9, z * 2.9, 82);
}

static vec lighthouse(double u, double v)
{
    static const double outline[][2] = {
        { 0.74, 0.0 }, { 0.60, 1.2 }, { 0.50, 2.5 }, { 0.46, 3.6 }, { 0.66, 3.72 },
        { 0.66, 3.86 }, { 0.33, 3.87 }, { 0.33, 4.45 }, { 0.44, 4.47 }, { 0.02, 5.0 },
    };
    double at = 9 * clamp(u, 0, 0.9999), t = at - whole(at);
    const double *a = outline[(int)at], *b = outline[(int)at + 1], radius = blend(a[0], b[0], t);
    return v3(radius * cosine(v), SHORE_Y - 0.45 - blend(a[1], b[1], t), -radius * sine(v));
}

static vec lighthouse_colour(double u, double v, uint64_t key)
{
    double at = 9 * u, band = whole(3 * at), turns = 9 * v - whole(9 * v);
    vec paint = band - 2 * whole(band / 2) > 0.5 ? v3(0.72, 0.16, 0.13) : v3(0.88, 0.86, 0.82);
    if (at > 6 && at < 7)
        return turns < 0.15 ? v3(0.12, 0.12, 0.13) : v3(1.25, 1.0, 0.62);
    if (at > 3)
        paint = at < 6 ? v3(0.30, 0.31, 0.33) : v3(0.35, 0.12, 0.11);
    else if (fabs(3 * at - band - 0.5) < 0.22 && fabs(v - whole(v) - 0.75) < 0.025 && band > 0 && band < 8)
        paint = v3(1.0, 0.78, 0.42);
    return times(paint, 0.88 + 0.2 * draw(key, 1) + 0.06 * plain_noise(v * 30, u * 60, 83));
}

static void haze_tower(place *p, splat *s)
{
    lay_surface(p, lighthouse, 0.97, s);
    vec n = s->axis[2];
    double lit = 9 * p->u > 6 && 9 * p->u < 7 ? 1 : 0.62 + 0.25 * clamp(-n.x, -1, 1) - 0.15 * n.y;
    add_constant(s, times(lighthouse_colour(p->u, p->v, p->key), lit));
    add_zonal(s, n, rim, v3(0.05, 0.06, 0.07));
}

static void haze_house(place *p, splat *s)
{
    static const house keeper = {
        { 1.75, SHORE_Y - 0.33, -0.25 }, 0.8, 0.6, 1.1, 1.5, 0.62, 0.5, { 0.82, 0.79, 0.72 }, { 0.42, 0.22, 0.18 },
    };
    vec colour = lay_on_house(&keeper, draw(p->key, 1), p->u, p->v, 3.2 / sqrt((double)p->count), s);
    vec n = s->axis[2];
    if (colour.z < 0.2 && colour.x < 0.2)
        colour = v3(1.1, 0.8, 0.4);
    add_constant(s, times(colour, 0.62 + 0.25 * clamp(-n.x, -1, 1) - 0.15 * n.y));
    add_zonal(s, n, rim, v3(0.05, 0.06, 0.07));
}

static void haze_shore(place *p, splat *s)
{
    double x, z, sigma;
    spread_over(p, 0, 11, 0.4, 0.6, &x, &z, &sigma);
    double h = shore_height(x, z), step = 0.03;
    vec normal = normalise(v3((h - shore_height(x + step, z)) / step, -1, (h - shore_height(x, z + step)) / step));
    double rough = plain_noise(x * 1.3, z * 1.3, 84) + 0.5 * plain_noise(x * 5, z * 5, 85);
    vec rock = blend3(v3(0.33, 0.31, 0.29), v3(0.46, 0.44, 0.40), draw(p->key, 1));
    vec colour = blend3(rock, v3(0.26, 0.34, 0.16), smoothstep(-0.2, 0.5, rough));
    lay_flat(s, v3(x, SHORE_Y - h, z), normal, v3(1, 0, 0), sigma, 0.96);
    add_constant(s, times(colour, 0.65 - 0.3 * normal.y + 0.5 * clamp(-normal.x, 0, 1)));
    add_zonal(s, normal, rim, v3(0.04, 0.04, 0.05));
}

static void haze_veil(place *p, splat *s)
{
    double r = 9.5 * sqrt(draw(p->key, 1)), turns = draw(p->key, 2), up = draw(p->key, 3), size = draw(p->key, 4);
    vec at = v3(r * cosine(turns), SHORE_Y - 8.5 * up * (0.4 + 0.6 * up), r * sine(turns)), to = sub(lamp, at);
    double sigma = (0.16 + 0.32 * size * size) * clamp(sqrt(24000 / (double)p->count), 0, 3);
    vec grey = blend3(v3(0.62, 0.68, 0.74), v3(0.80, 0.83, 0.86), up);
    vec colour = blend3(grey, v3(1.15, 0.92, 0.60), 0.9 / (1 + 1.1 * dot(to, to)));
    lay_round(s, at, sigma, 0.05 * power_of_half(draw(p->key, 5), 0, 3.64), colour);
    s->sigma[0] *= 1.7;
    s->sigma[1] *= 0.6;
    turn(s, p->key, 6);
    add_zonal(s, v3(0.8, 0.36, 0.48), highlight, v3(0.10, 0.09, 0.07));
}

static void lighthouse_haze(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 300, 380, 600, 1000 };
    static void (*const lay[])(place *, splat *) = { haze_tower, haze_house, haze_shore, haze_veil };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

#define SITE_X 400.0
#define SITE_Z 300.0
#define BLOCK_X 80.0
#define BLOCK_Z 75.0

enum block { HOUSES, PARK, FIELD, WORKS };

/* Returns what stands on a block of the town. *dx and *dz get the distances from the nearest roads. */
static enum block site_block(double x, double z, double *dx, double *dz)
{
    double bx = whole((x + SITE_X / 2) / BLOCK_X), bz = whole((z + SITE_Z / 2) / BLOCK_Z);
    double pick = lattice(mix((uint64_t)(bx * 16 + bz + 501)));
    double ox = x + SITE_X / 2 - bx * BLOCK_X, oz = z + SITE_Z / 2 - bz * BLOCK_Z;
    *dx = ox < BLOCK_X / 2 ? ox : BLOCK_X - ox;
    *dz = oz < BLOCK_Z / 2 ? oz : BLOCK_Z - oz;
    return pick < 0.1 ? HOUSES : pick < 0.45 ? PARK : pick < 0.8 ? FIELD : WORKS;
}

static double site_river(double x, double z)
{
    return fabs(z - 0.25 * x - 28 * sine(x / 310) - 14);
}

static double site_height(double x, double z)
{
    return 0.9 * plain_noise(x * 0.011, z * 0.011, 91) - 1.6 * smoothstep(13, 7, site_river(x, z));
}

static vec site_colour(double x, double z, uint64_t key)
{
    double dx, dz, rough = plain_noise(x * 0.09, z * 0.09, 92) + 0.5 * plain_noise(x * 0.4, z * 0.4, 93);
    enum block kind = site_block(x, z, &dx, &dz);
    double river = site_river(x, z), road = dx < dz ? dx : dz, along = dx < dz ? z : x;
    vec grass = blend3(v3(0.28, 0.38, 0.16), v3(0.50, 0.50, 0.25), clamp(0.5 + 0.5 * rough, 0, 1)), ground = grass;
    if (kind == FIELD) {
        double furrow = sine(0.16 * (x * 0.9 + z * 0.35));
        ground = blend3(v3(0.66, 0.58, 0.30), v3(0.50, 0.50, 0.22), 0.5 + 0.5 * furrow);
    } else if (kind == WORKS) {
        ground = times(v3(0.43, 0.42, 0.41), 1 + 0.1 * rough);
    }
    if (road < 5.5)
        ground = road < 3.6 ? v3(0.31, 0.31, 0.33) : v3(0.62, 0.60, 0.57);
    if (road < 0.35 && along / 6 - whole(along / 6) < 0.5)
        ground = v3(0.92, 0.91, 0.86);
    if (river < 11 && road > 4.5)
        ground = river < 9 ? v3(0.20, 0.33, 0.38) : v3(0.60, 0.55, 0.42);
    return times(ground, 0.88 + 0.22 * draw(key, 1));
}

static void add_site_light(splat *s, vec colour, uint64_t key)
{
    vec n = s->axis[2];
    add_constant(s, times(colour, 0.42 + 0.68 * clamp(dot(n, noon), 0, 1)));
    add_zonal(s, mirror(noon, n), highlight, times(colour, 0.08));
    add_error(s, key, 0.02);
}

static void site_ground(place *p, splat *s)
{
    double x = SITE_X * (p->u - 0.5), z = SITE_Z * (p->v - 0.5);
    double sigma = clamp(0.66 * sqrt(SITE_X * SITE_Z / (double)p->count), 0, 20);
    double h = site_height(x, z);
    vec normal = normalise(v3(h - site_height(x + 1, z), -1, h - site_height(x, z + 1)));
    lay_flat(s, v3(x, -h, z), normal, v3(1, 0, 0), sigma, 0.97);
    add_site_light(s, site_colour(x, z, p->key), p->key);
}

static int site_house(uint64_t lot, uint64_t key, house *h)
{
    static const vec tiles[] = {
        { 0.62, 0.28, 0.20 }, { 0.50, 0.24, 0.20 }, { 0.36, 0.36, 0.39 }, { 0.56, 0.42, 0.30 },
    };
    double x = BLOCK_X / 4 * ((double)(lot / 16) + 0.5) - SITE_X / 2, dx, dz;
    double z = BLOCK_Z / 4 * ((double)(lot % 16) + 0.5) - SITE_Z / 2;
    enum block kind = site_block(x, z, &dx, &dz);
    x += (dx < BLOCK_X / 4 ? 1.5 : 0) + 2 * draw(key, 1) - 1;
    h->at = v3(x, -site_height(x, z), z);
    h->c = draw(key, 2) < 0.5;
    h->s = 1 - h->c;
    h->width = 8 + 2.5 * draw(key, 3);
    h->depth = 8 + 4 * draw(key, 4);
    h->wall = 2.6 + 1.2 * draw(key, 5);
    h->roof = 1.8 + 1.4 * draw(key, 6);
    h->paint = blend3(v3(0.85, 0.80, 0.70), v3(0.78, 0.66, 0.56), draw(key, 7));
    h->tiles = tiles[(unsigned)(4 * draw(key, 8))];
    if (kind == WORKS) {
        h->width = 13;
        h->depth = 10;
        h->roof = 1;
        h->wall = 4.5;
        h->tiles = blend3(v3(0.34, 0.40, 0.47), v3(0.68, 0.66, 0.62), draw(key, 9));
    }
    return (kind == HOUSES || kind == WORKS) && site_river(x, z) > 22;
}

static void site_roof(place *p, splat *s)
{
    enum { LOTS = 320 };
    uint64_t lot = p->index % LOTS;
    house h;
    while (!site_house(lot, key_of(p->seed, ~lot << 14), &h))
        lot = (lot + 1) % LOTS;
    double sigma = 0.62 * sqrt((h.width + 3 * h.wall) * h.depth * 2 * LOTS / (double)p->count);
    vec colour = lay_on_house(&h, draw(p->key, 1), draw(p->key, 2), draw(p->key, 3), clamp(sigma, 0, 3), s);
    add_site_light(s, times(colour, 0.92 + 0.16 * draw(p->key, 4)), p->key);
}

static vec site_tree_foot(uint64_t key)
{
    double x = 0, z = 0, dx, dz;
    for (unsigned k = 0; k < 40; k++) {
        x = SITE_X * (draw(key, 2 * k) - 0.5);
        z = SITE_Z * (draw(key, 2 * k + 1) - 0.5);
        enum block kind = site_block(x, z, &dx, &dz);
        int fence = fabs(dx - BLOCK_X / 4) < 2 || (dx > 7 && dx < 9);
        if (dx > 7 && dz > 7 && site_river(x, z) > 13 && (kind == PARK || (kind == HOUSES && fence)))
            break;
    }
    return v3(x, -site_height(x, z), z);
}

static void site_tree(place *p, splat *s)
{
    uint64_t trees = p->count / 40 + 1 < 800 ? p->count / 40 + 1 : 800;
    uint64_t key = key_of(p->seed, ~(p->index % trees) << 18);
    double size = 2.0 + 1.6 * draw(key, 90), y = 2 * draw(p->key, 1) - 1, r = sqrt(1 - y * y);
    vec out = v3(r * cosine(p->v), y, r * sine(p->v)), in = times(out, size * (0.65 + 0.35 * draw(p->key, 2)));
    vec at = add(site_tree_foot(key), v3(in.x, 0.75 * in.y - 0.95 * size, in.z));
    lay_flat(s, at, out, v3(0.6, 0.1, 0.8), 1.9 * size / sqrt((double)(p->count / trees + 1)), 0.92);
    s->sigma[2] = 0.4 * s->sigma[0];
    vec green = blend3(v3(0.15, 0.28, 0.10), v3(0.38, 0.42, 0.14), draw(key, 91));
    add_site_light(s, times(green, 0.7 + 0.6 * draw(p->key, 3)), p->key);
}

static void site(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 480, 780, 1000 };
    static void (*const lay[])(place *, splat *) = { site_ground, site_roof, site_tree };
    place p;
    splat s;
    lay[part_of(i, count, seed, ends, &p)](&p, &s);
    finish(&s, out);
}

static uint64_t lattice_side(uint64_t count, int power)
{
    uint64_t side = 1;
    while ((power == 3 ? side * side * side : side * side) < count)
        side++;
    return side;
}

static vec rainbow(double t)
{
    return v3(0.5 + 0.45 * cosine(t), 0.5 + 0.45 * cosine(t - 0.33), 0.5 + 0.45 * cosine(t - 0.67));
}

static void needles(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    uint64_t key = key_of(seed, i);
    vec at = v3(10 * draw(key, 0) - 5, 10 * draw(key, 1) - 5, 10 * draw(key, 2) - 5);
    double size = power_of_half(draw(key, 3), 0, 7) * clamp(141 / sqrt((double)count), 0, 1);
    double thin = power_of_half(draw(key, 4), 1, 9.966);
    static const double degree1[4] = { 0, 0.25, 0, 0 };
    splat s;
    lay_round(&s, at, size, 0.3 + 0.69 * draw(key, 5), rainbow(draw(key, 6)));
    s.sigma[1] = draw(key, 7) < 0.3 ? size : size * thin;
    s.sigma[2] = size * thin;
    turn(&s, key, 8);
    add_zonal(&s, s.axis[2], degree1, rainbow(draw(key, 11)));
    finish(&s, out);
}

static void fog(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    static const unsigned ends[] = { 1000 };
    static const double degree2[4] = { 0.1, 0.35, 0.55, 0 };
    place p;
    splat s;
    part_of(i, count, seed, ends, &p);
    vec at = v3(12 * draw(p.key, 0) - 6, 7 * draw(p.key, 1) - 3.5, 12 * draw(p.key, 6) - 6);
    double sigma = (0.25 + 0.55 * draw(p.key, 7)) * clamp(70.7 / sqrt((double)count), 0, 4);
    double glow = smoothstep(4.5, 0.5, sqrt(dot(at, at)));
    vec colour = blend3(v3(0.16, 0.20, 0.34), v3(1.0, 0.62, 0.25), glow);
    colour = blend3(colour, rainbow(0.08 * at.x + 0.25 * draw(p.key, 8)), 0.45);
    lay_round(&s, at, sigma, 0.01 + 0.09 * draw(p.key, 2), colour);
    s.sigma[0] *= 1.6;
    s.sigma[2] *= 0.6;
    turn(&s, p.key, 3);
    add_zonal(&s, normalise(v3(0.4, 0.2, -0.9)), degree2, times(v3(0.30, 0.34, 0.40), 1 - glow));
    finish(&s, out);
}

/* Makes a scene of ten flat cards, with Gaussians of equal depths on each card. Every position occurs at least
   twice. */
static void layers(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    enum { CARDS = 10 };
    uint64_t card = i % CARDS, twin = i / CARDS % 2, j = i / CARDS / 2;
    uint64_t side = lattice_side((count + 2 * CARDS - 1) / (2 * CARDS), 2);
    double spacing = 4.0 / (double)side, x = (double)(j % side) * spacing, y = (double)(j / side % side) * spacing;
    double shift = 0.5 * (double)card;
    vec at = v3(x + shift - 4.25, y + 0.5 * shift - 3.125, 0.25 * (double)card);
    vec colour = rainbow(0.1 * (double)card + (twin ? 0.5 : 0) + 0.03 * draw(key_of(seed, i), 0));
    splat s;
    lay_round(&s, at, 0.6 * spacing, twin ? 0.6 : 0.999, colour);
    s.sigma[2] *= 0.01;
    finish(&s, out);
}

static void cubes(uint64_t i, uint64_t count, uint32_t seed, fxs_gaussian *out)
{
    uint64_t side = lattice_side(count, 3), key = key_of(seed, i);
    double spacing = 9.0 / (double)side, centre = 0.5 * (double)(side - 1);
    double x = (double)(i % side), y = (double)(i / side % side), z = (double)(i / side / side);
    double wide = draw(key, 0) < 0.01 ? 4 : 0.4, last = side > 1 ? (double)(side - 1) : 1;
    vec at = times(sub(v3(x, y, z), v3(centre, centre, centre)), spacing);
    splat s;
    lay_round(&s, at, wide * spacing * power_of_half(draw(key, 1), 0, 9), wide > 1 ? 0.1 : 0.4 + 0.55 * draw(key, 2),
              v3(0.1 + 0.85 * x / last, 0.1 + 0.85 * y / last, 0.1 + 0.85 * z / last));
    finish(&s, out);
}

static const fxs_procedural_scene scenes[] = {
    { "knot", "an iridescent knot and glossy marbles on a stone disc", 3, 100000, knot },
    { "landscape", "a lake, woods and snow mountains under clouds", 3, 1000000, landscape },
    { "needles", "needles and discs, up to a thousand times as long as thick", 1, 20000, needles },
    { "fog", "large Gaussians, nearly transparent, hundreds over every pixel", 2, 5000, fog },
    { "layers", "opaque cards full of equal depths and positions", 0, 10000, layers },
    { "cubes", "a lattice of balls, from far below a pixel to huge", 0, 4096, cubes },
    { "meadow", "a tree among flowers, hills and a sky of discs, with strays to 24,569 units", 3, 120000, meadow },
    { "mirrors", "gold, chrome and copper: colours that turn with the view", 3, 100000, mirrors },
    { "discs", "the knot under a sky and on a ground of discs without thickness", 3, 100000, discs },
    { "haze", "a lighthouse behind thousands of Gaussians of opacity 0.004 to 0.05", 3, 60000, lighthouse_haze },
    { "fence", "pickets and grass of needles, 5 to 40 times as long as wide", 3, 50000, fence },
    { "site", "a town from the air, 400 x 300 units and 8 high", 3, 150000, site },
};

const fxs_procedural_scene *fxs_procedural_list(size_t *count)
{
    *count = sizeof scenes / sizeof scenes[0];
    return scenes;
}

const fxs_procedural_scene *fxs_procedural_find(const char *name)
{
    for (size_t k = 0; k < sizeof scenes / sizeof scenes[0]; k++)
        if (strcmp(name, scenes[k].name) == 0)
            return &scenes[k];
    return NULL;
}
