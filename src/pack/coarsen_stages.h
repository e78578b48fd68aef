/* Reduces a set of Gaussians by greedy merging: the pair with the smallest error is merged first. A merged Gaussian has
 * the mean and covariance of its pair, weighted by opacity times area. The error of a pair is the squared difference of
 * the pictures before and after the merge, averaged over the three coordinate planes. It needs inner products: for
 * Gaussians of peak 1 with covariances A and B at distance d, <Ga, Gb> = 2 pi sqrt(|A| |B| / |A + B|) exp(-d^T (A +
 * B)^-1 d / 2). The includer defines ISA and gather_rows, which transposes LANES rows. */
#include "merger.h"

#include <math.h>
#include <string.h>

static inline float larger(float x, float y)
{
    return x > y ? x : y;
}

static inline float smaller(float x, float y)
{
    return x < y ? x : y;
}

/* Returns e^-x for x >= 0 as 1 / (e^(x / 8))^8 with the series up to (x / 8)^5. Absolute error: 1e-6. */
static inline float falling(float x)
{
    const float y = x * 0.125f;
    const float e = 1 + y * (1 + y * (0.5f + y * (0.166666667f + y * (0.0416666667f + y * 0.00833333333f))));
    const float e2 = e * e, e4 = e2 * e2;
    return 1 / (e4 * e4);
}

static inline float minor(float u, float v, float uv)
{
    return larger(u * v - uv * uv, 1e-6f * u * v);
}

static inline void find_roots(group *of, int count)
{
    for (int p = 0; p < PLANES; p++)
        for (int i = 0; i < count; i++) {
            const float more = THINNEST * (of->f[XX][i] + of->f[YY][i] + of->f[ZZ][i]);
            const float u = of->f[first_square[p]][i] + more, v = of->f[second_square[p]][i] + more;
            of->f[ROOT + p][i] = sqrtf(larger(minor(u, v, of->f[mixed[p]][i]), LEAST));
        }
}

/* Computes the inner product <Ga, Gb> / pi of Gaussians in coordinate plane p. */
static inline void find_products(lanes product, const group *a, const group *b, int p, int count)
{
    const float *au = a->f[first_square[p]], *av = a->f[second_square[p]], *auv = a->f[mixed[p]];
    const float *bu = b->f[first_square[p]], *bv = b->f[second_square[p]], *buv = b->f[mixed[p]];
    const float *ax = a->f[first_axis[p]], *ay = a->f[second_axis[p]];
    const float *bx = b->f[first_axis[p]], *by = b->f[second_axis[p]];
    for (int i = 0; i < count; i++) {
        const float more = THINNEST * ((a->f[XX][i] + a->f[YY][i] + a->f[ZZ][i]) +
                                       (b->f[XX][i] + b->f[YY][i] + b->f[ZZ][i]));
        const float u = au[i] + bu[i] + more, v = av[i] + bv[i] + more, uv = auv[i] + buv[i];
        const float one_over = 1 / larger(u * v - uv * uv, LEAST), x = bx[i] - ax[i], y = by[i] - ay[i];
        const float square = larger((v * x * x - 2 * uv * x * y + u * y * y) * one_over, 0);
        product[i] = 2 * a->f[ROOT + p][i] * b->f[ROOT + p][i] * sqrtf(one_over) * falling(0.5f * square);
    }
}

/* Computes the masses of merged pairs, opacity times area. A mass is the sum of the two Gaussians' masses, reduced by
   OVERLAP times their mutual occlusion. */
static inline void find_masses(lanes mass, const group *a, const group *b, lanes products[PLANES], int count)
{
    for (int i = 0; i < count; i++) {
        const float x = a->f[OPACITY][i], y = b->f[OPACITY][i];
        const float both = x * (a->f[ROOT][i] + a->f[ROOT + 1][i] + a->f[ROOT + 2][i]) +
                           y * (b->f[ROOT][i] + b->f[ROOT + 1][i] + b->f[ROOT + 2][i]);
        const float hidden = 0.5f * x * y * (products[0][i] + products[1][i] + products[2][i]);
        mass[i] = (x * a->f[AREA][i] + y * b->f[AREA][i]) * (1 - OVERLAP * hidden / larger(both, LEAST));
    }
}

/* Merges each pair of Gaussians a, b. An opacity above the cap by a factor r is lowered to the cap, and the variances
   grow by sqrt(r). */
static inline void join(group *out, lanes share, const group *a, const group *b, lanes products[PLANES], int count)
{
    lanes mass;
    find_masses(mass, a, b, products, count);
    for (int i = 0; i < count; i++) {
        const float first = a->f[OPACITY][i] * a->f[AREA][i], second = b->f[OPACITY][i] * b->f[AREA][i];
        const float sum = first + second;
        const float v = sum > LEAST ? first / sum : 0.5f, w = 1 - v;
        const float x = b->f[X][i] - a->f[X][i], y = b->f[Y][i] - a->f[Y][i], z = b->f[Z][i] - a->f[Z][i];
        share[i] = v;
        out->f[X][i] = a->f[X][i] + w * x;
        out->f[Y][i] = a->f[Y][i] + w * y;
        out->f[Z][i] = a->f[Z][i] + w * z;
        out->f[XX][i] = v * a->f[XX][i] + w * b->f[XX][i] + v * w * (x * x);
        out->f[YY][i] = v * a->f[YY][i] + w * b->f[YY][i] + v * w * (y * y);
        out->f[ZZ][i] = v * a->f[ZZ][i] + w * b->f[ZZ][i] + v * w * (z * z);
        out->f[XY][i] = v * a->f[XY][i] + w * b->f[XY][i] + v * w * (x * y);
        out->f[XZ][i] = v * a->f[XZ][i] + w * b->f[XZ][i] + v * w * (x * z);
        out->f[YZ][i] = v * a->f[YZ][i] + w * b->f[YZ][i] + v * w * (y * z);
    }
    for (int i = 0; i < count; i++) {
        const float most = larger(OPACITY_MOST, larger(a->f[OPACITY][i], b->f[OPACITY][i]));
        const float minors = minor(out->f[XX][i], out->f[YY][i], out->f[XY][i]) +
                             minor(out->f[XX][i], out->f[ZZ][i], out->f[XZ][i]) +
                             minor(out->f[YY][i], out->f[ZZ][i], out->f[YZ][i]);
        const float area = sqrtf(larger(minors, LEAST)), opacity = mass[i] / area;
        const float over = larger(opacity / most, 1), more = sqrtf(over);
        out->f[OPACITY][i] = smaller(opacity, most);
        out->f[AREA][i] = area * more;
        for (int k = XX; k <= YZ; k++)
            out->f[k][i] *= more;
    }
    find_roots(out, count);
}

/* Merges the times of pairs as positions are merged. A width is at most that of the span. */
static inline void join_times(group *out, const group *a, const group *b, const lanes share, int count)
{
    for (int i = 0; i < count; i++) {
        const float v = share[i], w = 1 - v, apart = b->f[CENTRE][i] - a->f[CENTRE][i];
        out->f[CENTRE][i] = a->f[CENTRE][i] + w * apart;
        out->f[WIDTH][i] = smaller(v * a->f[WIDTH][i] + w * b->f[WIDTH][i] + 2 * v * w * (apart * apart), 1);
    }
}

/* Computes the inner products of opacities in time, for opacities of mean 1: sqrt(2 / (a + b)) e^-(d^2 / (a + b)), with
   the squared widths a, b and the distance d of the centres. */
static inline void find_meetings(lanes meeting, const group *a, const group *b)
{
    for (int i = 0; i < LANES; i++) {
        const float sum = a->f[WIDTH][i] + b->f[WIDTH][i], apart = b->f[CENTRE][i] - a->f[CENTRE][i];
        meeting[i] = sqrtf(2 / larger(sum, LEAST)) * falling(apart * apart / larger(sum, LEAST));
    }
}

/* How far the second Gaussians of pairs move from the first until u = -sqrt(3 / 5) and u = sqrt(3 / 5). */
static inline void find_departures(lanes apart[2][3], const fxs_merger *m, const pair *pairs, uint32_t count)
{
    memset(apart, 0, 2 * sizeof *apart);
    for (uint32_t i = 0; i < count; i++)
        for (int side = 0; side < 2; side++)
            for (int axis = 0; axis < 3; axis++) {
                const float u = side ? 0.774596669f : -0.774596669f;
                const fxs_way *a = &m->ways[pairs[i].a], *b = &m->ways[pairs[i].b];
                float sum = 0;
                for (int k = 2; k >= 0; k--)
                    sum = u * (sum + (b->drift[k][axis] - a->drift[k][axis]));
                apart[side][axis][i] = sum;
            }
}

/* Replaces inner products at u = 0 by their means over the span: Gauss's rule, with the weights 5/18, 8/18, 5/18. The
   second Gaussians depart from the first by `share` times `apart`. */
static inline void average_products(lanes products[PLANES], const group *a, const group *b, lanes apart[2][3],
                                    const lanes share)
{
    group moved = *b;
    lanes there;
    for (int p = 0; p < PLANES; p++)
        for (int i = 0; i < LANES; i++)
            products[p][i] *= 8.0f / 18;
    for (int side = 0; side < 2; side++) {
        for (int axis = 0; axis < 3; axis++)
            for (int i = 0; i < LANES; i++)
                moved.f[X + axis][i] = b->f[X + axis][i] + share[i] * apart[side][axis][i];
        for (int p = 0; p < PLANES; p++) {
            find_products(there, a, &moved, p, LANES);
            for (int i = 0; i < LANES; i++)
                products[p][i] += 5.0f / 18 * there[i];
        }
    }
}

/* Inner products of the opacities in time of pairs a, b and their merged Gaussians m. */
typedef struct meetings {
    lanes aa, bb, ab, am, bm, mm;
} meetings;

static void meet(meetings *out, const fxs_merger *m, const pair *pairs, uint32_t count, const group *one,
                 const group *other, group *both, const lanes share, lanes ab[PLANES], lanes am[PLANES],
                 lanes bm[PLANES])
{
    lanes apart[2][3], whole, first, second;
    for (int i = 0; i < LANES; i++) {
        whole[i] = 1;
        first[i] = 1 - share[i];
        second[i] = -share[i];
    }
    join_times(both, one, other, share, LANES);
    find_departures(apart, m, pairs, count);
    average_products(ab, one, other, apart, whole);
    average_products(am, one, both, apart, first);
    average_products(bm, other, both, apart, second);
    find_meetings(out->aa, one, one);
    find_meetings(out->bb, other, other);
    find_meetings(out->ab, one, other);
    find_meetings(out->am, one, both);
    find_meetings(out->bm, other, both);
    find_meetings(out->mm, both, both);
}

/* Returns the weight of a pair's merge error. The weight grows with each earlier merge of the two Gaussians. Otherwise
   some Gaussians would absorb all their neighbours. */
static float grown(const pair *p)
{
    return (float)(1 + p->a_age + p->b_age);
}

static void gather(const fxs_merger *m, group *to, const uint16_t *of, uint32_t count)
{
    const float *rows[LANES];
    for (uint32_t i = 0; i < LANES; i++)
        rows[i] = m->fields[of[i < count ? i : 0]];
    gather_rows(to, rows);
}

static void find_errors(const fxs_merger *m, pair *pairs, uint32_t count)
{
    group one, other, both;
    lanes share, ab[PLANES], am[PLANES], bm[PLANES], dots = {0}, sums;
    meetings in_time;
    uint16_t a[LANES], b[LANES];
    for (uint32_t i = 0; i < count; i++) {
        a[i] = pairs[i].a;
        b[i] = pairs[i].b;
        dots[i] = dot_of_sh(m->compared[a[i]], m->compared[b[i]]) + ALPHA_WEIGHT;
    }
    gather(m, &one, a, count);
    gather(m, &other, b, count);
    for (int p = 0; p < PLANES; p++)
        find_products(ab[p], &one, &other, p, LANES);
    join(&both, share, &one, &other, ab, LANES);
    for (int p = 0; p < PLANES; p++) {
        find_products(am[p], &one, &both, p, LANES);
        find_products(bm[p], &other, &both, p, LANES);
    }
    if (m->moves)
        meet(&in_time, m, pairs, count, &one, &other, &both, share, ab, am, bm);
    for (int i = 0; i < LANES; i++) {
        const float v = share[i], w = 1 - v, x = one.f[OPACITY][i], y = other.f[OPACITY][i], z = both.f[OPACITY][i];
        float aa = one.f[SQUARE][i] + ALPHA_WEIGHT, bb = other.f[SQUARE][i] + ALPHA_WEIGHT, mixed_ab = dots[i], sum = 0;
        for (int k = 0; k < 3; k++) {
            const float behind = 0.5f * (one.f[LOCAL + k][i] + other.f[LOCAL + k][i]);
            const float a_colour = one.f[COLOUR + k][i] - behind, b_colour = other.f[COLOUR + k][i] - behind;
            aa += a_colour * a_colour;
            bb += b_colour * b_colour;
            mixed_ab += a_colour * b_colour;
        }
        float with_a = v * aa + w * mixed_ab, with_b = v * mixed_ab + w * bb, mm = v * with_a + w * with_b;
        if (m->moves) {
            aa *= in_time.aa[i];
            bb *= in_time.bb[i];
            mixed_ab *= in_time.ab[i];
            with_a *= in_time.am[i];
            with_b *= in_time.bm[i];
            mm *= in_time.mm[i];
        }
        for (int p = 0; p < PLANES; p++)
            sum += x * x * aa * one.f[ROOT + p][i] + y * y * bb * other.f[ROOT + p][i] +
                   z * z * mm * both.f[ROOT + p][i] +
                   2 * (x * y * mixed_ab * ab[p][i] - x * z * with_a * am[p][i] - y * z * with_b * bm[p][i]);
        sums[i] = larger(sum, 0) * (PI / PLANES);
    }
    for (uint32_t i = 0; i < count; i++)
        pairs[i].error = sums[i] * grown(&pairs[i]);
}

static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 16) & 0x30000ff;
    x = (x | x << 8) & 0x300f00f;
    x = (x | x << 4) & 0x30c30c3;
    return (x | x << 2) & 0x9249249;
}

static void sort_by_keys(uint16_t order[MOST], const uint32_t keys[MOST], uint32_t count)
{
    uint16_t other[MOST], *from = order, *to = other;
    for (uint32_t i = 0; i < count; i++)
        order[i] = (uint16_t)i;
    for (int shift = 0; shift < 30; shift += 10) {
        uint16_t starts[1025] = {0};
        for (uint32_t i = 0; i < count; i++)
            starts[(keys[i] >> shift & 1023) + 1]++;
        for (int k = 1; k < 1024; k++)
            starts[k] = (uint16_t)(starts[k] + starts[k - 1]);
        for (uint32_t i = 0; i < count; i++)
            to[starts[keys[from[i]] >> shift & 1023]++] = from[i];
        uint16_t *const sorted = to;
        to = from;
        from = sorted;
    }
    memcpy(order, other, count * sizeof *order);
}

/* Orders the Gaussians along a Morton curve in a cube twice as wide as their extent. The cube begins `shift` times
   its width before the extent. */
static void find_order(fxs_merger *m, float shift)
{
    float low[3], width = LEAST;
    uint32_t keys[MOST];
    for (int k = 0; k < 3; k++) {
        float high = low[k] = m->fields[0][X + k];
        for (uint32_t i = 1; i < m->count; i++) {
            low[k] = smaller(low[k], m->fields[i][X + k]);
            high = larger(high, m->fields[i][X + k]);
        }
        width = larger(width, high - low[k]);
    }
    for (uint32_t i = 0; i < m->count; i++) {
        uint32_t code = 0;
        for (int k = 0; k < 3; k++)
            code |= spread_bits((uint32_t)(int32_t)((m->fields[i][X + k] - low[k]) / width * 511 + shift * 1023)) << k;
        keys[i] = code;
    }
    sort_by_keys(m->order, keys, m->count);
    for (uint32_t i = 0; i < m->count; i++)
        for (int k = 0; k < 3; k++)
            m->places[k][WINDOW + i] = m->fields[m->order[i]][X + k];
    for (uint32_t i = 0; i < WINDOW; i++)
        for (int k = 0; k < 3; k++)
            m->places[k][i] = m->places[k][WINDOW + m->count + i] = INFINITY;
}

typedef struct candidates {
    float distances[NEAREST];
    uint16_t which[NEAREST];
    uint32_t count;
} candidates;

static inline void take(candidates *c, uint16_t other, float distance, int again)
{
    uint32_t at = c->count < NEAREST ? c->count : NEAREST - 1;
    if (c->count == NEAREST && !(distance < c->distances[at]))
        return;
    for (uint32_t k = 0; k < c->count && again; k++)
        if (c->which[k] == other)
            return;
    c->count = at + 1;
    for (; at > 0 && distance < c->distances[at - 1]; at--) {
        c->distances[at] = c->distances[at - 1];
        c->which[at] = c->which[at - 1];
    }
    c->distances[at] = distance;
    c->which[at] = other;
}

static inline void find_distances(float distances[WINDOW], const fxs_merger *m, uint32_t first, uint32_t from)
{
    for (uint32_t k = 0; k < WINDOW; k++) {
        const float x = m->places[0][first + k] - m->places[0][from], y = m->places[1][first + k] - m->places[1][from],
                    z = m->places[2][first + k] - m->places[2][from];
        distances[k] = x * x + y * y + z * z;
    }
}

static void look_along(fxs_merger *m, int again)
{
    for (uint32_t i = 0; i < m->count; i++) {
        const uint32_t of = m->order[i], after = m->count - 1 - i < WINDOW ? m->count - 1 - i : WINDOW;
        candidates c;
        float distances[WINDOW];
        memcpy(c.distances, m->distances[of], sizeof c.distances);
        memcpy(c.which, m->nearest[of], sizeof c.which);
        c.count = m->nearest_count[of];
        find_distances(distances, m, i, WINDOW + i);
        for (uint32_t k = i < WINDOW ? WINDOW - i : 0; k < WINDOW; k++)
            take(&c, m->order[i + k - WINDOW], distances[k], again);
        find_distances(distances, m, WINDOW + i + 1, WINDOW + i);
        for (uint32_t k = 0; k < after; k++)
            take(&c, m->order[i + 1 + k], distances[k], again);
        memcpy(m->distances[of], c.distances, sizeof c.distances);
        memcpy(m->nearest[of], c.which, sizeof c.which);
        m->nearest_count[of] = (uint8_t)c.count;
    }
}

/* Finds the nearest neighbours of each Gaussian. Searches along two Morton curves, because near Gaussians can be far
   apart on a single curve. */
static void find_nearest(fxs_merger *m)
{
    memset(m->nearest_count, 0, sizeof m->nearest_count);
    for (int curve = 0; curve < CURVES; curve++) {
        find_order(m, 0.3f * (float)curve);
        look_along(m, curve > 0);
    }
}

static uint64_t key_of(const fxs_merger *m, uint32_t number)
{
    uint32_t bits;
    memcpy(&bits, &m->pairs[number].error, sizeof bits);
    return (uint64_t)bits << 32 | number;
}

static void sift_down(uint64_t *heap, uint32_t count, uint32_t at)
{
    const uint64_t moved = heap[at];
    for (uint32_t child; (child = 2 * at + 1) < count; at = child) {
        child += child + 1 < count && heap[child + 1] < heap[child];
        if (moved <= heap[child])
            break;
        heap[at] = heap[child];
    }
    heap[at] = moved;
}

static void push(fxs_merger *m, uint64_t key)
{
    uint32_t at = m->heap_count++;
    for (; at > 0 && key < m->heap[(at - 1) / 2]; at = (at - 1) / 2)
        m->heap[at] = m->heap[(at - 1) / 2];
    m->heap[at] = key;
}

static pair pair_of(const fxs_merger *m, uint32_t i, uint32_t k)
{
    const uint32_t a = i < k ? i : k, b = i < k ? k : i;
    return (pair){0, (uint16_t)a, (uint16_t)b, m->age[a], m->age[b]};
}

static int is_candidate(const fxs_merger *m, uint32_t of, uint32_t which)
{
    for (uint32_t k = 0; k < m->nearest_count[of]; k++)
        if (m->nearest[of][k] == which)
            return 1;
    return 0;
}

static void find_pairs(fxs_merger *m)
{
    m->pair_count = 0;
    for (uint32_t i = 0; i < m->count; i++)
        for (uint32_t k = 0; k < m->nearest_count[i]; k++) {
            const uint32_t other = m->nearest[i][k];
            if (other > i || !is_candidate(m, other, i))
                m->pairs[m->pair_count++] = pair_of(m, i, other);
        }
    for (uint32_t i = 0; i < m->pair_count; i += LANES)
        find_errors(m, m->pairs + i, m->pair_count - i < LANES ? m->pair_count - i : LANES);
    for (uint32_t i = 0; i < m->pair_count; i++)
        m->heap[i] = key_of(m, i);
    m->heap_count = m->pair_count;
    for (uint32_t i = m->heap_count / 2; i-- > 0;)
        sift_down(m->heap, m->heap_count, i);
}

static void join_candidates(fxs_merger *m, uint32_t a, uint32_t b)
{
    uint16_t both[2 * NEAREST];
    uint32_t count = 0;
    for (uint32_t k = 0; k < 2u * NEAREST; k++) {
        const uint32_t from = k % 2 ? b : a, place = k / 2;
        if (place >= m->nearest_count[from])
            continue;
        const uint16_t other = (uint16_t)now(m, m->nearest[from][place]);
        uint32_t at = 0;
        while (at < count && both[at] != other)
            at++;
        if (other != a && at == count)
            both[count++] = other;
    }
    count = count < JOINED ? count : JOINED;
    m->nearest_count[a] = (uint8_t)(count < NEAREST ? count : NEAREST);
    memcpy(m->nearest[a], both, m->nearest_count[a] * sizeof *both);
    for (uint32_t i = 0; i < count; i++)
        m->pairs[m->pair_count + i] = pair_of(m, a, both[i]);
    for (uint32_t i = 0; i < count; i += LANES)
        find_errors(m, m->pairs + m->pair_count + i, count - i < LANES ? count - i : LANES);
    for (; count > 0; count--, m->pair_count++)
        push(m, key_of(m, m->pair_count));
}

static void find_surroundings(fxs_merger *m, uint32_t of)
{
    float sum = LEAST, colours[3] = {0};
    for (uint32_t k = 0; k <= m->nearest_count[of]; k++) {
        const float *f = m->fields[k ? m->nearest[of][k - 1] : of], weight = f[OPACITY] * f[AREA];
        sum += weight;
        for (int c = 0; c < 3; c++)
            colours[c] += weight * f[COLOUR + c];
    }
    for (int c = 0; c < 3; c++)
        m->fields[of][LOCAL + c] = colours[c] / sum;
}

static void find_all_roots(fxs_merger *m)
{
    for (uint32_t first = 0; first < m->count; first += LANES) {
        group several;
        uint16_t of[LANES];
        const uint32_t count = m->count - first < LANES ? m->count - first : LANES;
        for (uint32_t i = 0; i < count; i++)
            of[i] = (uint16_t)(first + i);
        gather(m, &several, of, count);
        find_roots(&several, LANES);
        for (int p = 0; p < PLANES; p++)
            for (uint32_t i = 0; i < count; i++)
                m->fields[first + i][ROOT + p] = several.f[ROOT + p][i];
    }
}

static void merge_ways(fxs_merger *m, uint32_t a, uint32_t b, group *both, const group *one, const group *other,
                       const lanes share)
{
    const float v = share[0], w = 1 - v;
    fxs_way *to = &m->ways[a];
    const fxs_way *from = &m->ways[b];
    join_times(both, one, other, share, 1);
    m->fields[a][CENTRE] = both->f[CENTRE][0];
    m->fields[a][WIDTH] = both->f[WIDTH][0];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            to->drift[k][i] = v * to->drift[k][i] + w * from->drift[k][i];
    for (int i = 0; i < 4; i++)
        to->turn[i] = v * to->turn[i] + w * from->turn[i];
}

static void merge(fxs_merger *m, uint32_t a, uint32_t b, double error, fxs_merge_error *sums)
{
    group one, other, both;
    lanes share, products[PLANES];
    for (int k = 0; k < FIELDS; k++) {
        one.f[k][0] = m->fields[a][k];
        other.f[k][0] = m->fields[b][k];
    }
    for (int p = 0; p < PLANES; p++)
        find_products(products[p], &one, &other, p, 1);
    join(&both, share, &one, &other, products, 1);
    if (m->moves)
        merge_ways(m, a, b, &both, &one, &other, share);
    for (int k = 0; k < COLOUR; k++)
        m->fields[a][k] = both.f[k][0];
    for (int k = COLOUR; k < SQUARE; k++)
        m->fields[a][k] = share[0] * m->fields[a][k] + (1 - share[0]) * m->fields[b][k];
    for (uint32_t k = 0; k < m->sh_count; k++)
        m->sh[a][k] = share[0] * m->sh[a][k] + (1 - share[0]) * m->sh[b][k];
    compare_sh(m, a);
    sums->error += error;
    sums->size += error * both.f[AREA][0];
    m->into[b] = (uint16_t)a;
    m->age[a]++;
    m->age[b]++;
    m->left--;
    join_candidates(m, a, b);
}

static pair take_best(fxs_merger *m)
{
    while (m->heap_count > 0) {
        const pair best = m->pairs[(uint32_t)m->heap[0]];
        m->heap[0] = m->heap[--m->heap_count];
        if (m->heap_count)
            sift_down(m->heap, m->heap_count, 0);
        if (best.a_age == m->age[best.a] && best.b_age == m->age[best.b])
            return best;
    }
    uint32_t a = 0, b;
    while (m->into[a] != a)
        a++;
    for (b = a + 1; m->into[b] != b; b++)
        ;
    return pair_of(m, a, b);
}

FXS_COARSEN(ISA)
{
    find_all_roots(m);
    find_nearest(m);
    for (uint32_t i = 0; i < m->count; i++)
        find_surroundings(m, i);
    find_pairs(m);
    for (m->left = m->count; m->left > most;) {
        const pair best = take_best(m);
        merge(m, best.a, best.b, best.error / grown(&best), sums);
    }
}
