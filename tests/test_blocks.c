/* Tests the division of a large fit into blocks. Blocks must cover every place exactly once and have nearly equal
   numbers of points. */
#include <math.h>
#include <stdlib.h>

#include "src/fit/blocks.h"
#include "check.h"

enum { POINTS = 5000 };

static fxs_fit_point points[POINTS];
static fxs_fit_photo views[2];
static fxs_photos whole = {.fit = views, .fit_count = 1, .points = points, .point_count = POINTS};

static float random_place(float size)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return ((float)(state >> 8) / 8388608.0f - 1) * size;
}

/* Makes points that fill a box of 20 x 2 x 10 units, and two cameras. One camera at z = -30 sees all points; the
   other faces away. */
static void set_up(void)
{
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++)
            points[i].position[k] = random_place(k == 0 ? 10 : k == 1 ? 1 : 5);
    for (int v = 0; v < 2; v++) {
        fxs_view *view = &views[v].view;
        for (int k = 0; k < 3; k++)
            view->rotation[4 * k] = v && k != 1 ? -1 : 1;
        view->position[2] = -30;
        view->fx = view->fy = 100;
        view->cx = view->cy = 50;
        view->width = view->height = 100;
    }
    whole.fit_count = 1;
    whole.point_count = POINTS;
}

static int is_in(const fxs_fit_block *b, const float at[3])
{
    for (int k = 0; k < 3; k++)
        if ((double)at[k] < b->low[k] || (double)at[k] >= b->high[k])
            return 0;
    return 1;
}

static void tiled(void)
{
    static const uint32_t counts[] = {1, 2, 3, 7, 16};
    fxs_message message;
    fxs_fit_block b[16];
    set_up();
    for (int c = 0; c < 5; c++) {
        const uint32_t n = counts[c];
        for (uint32_t i = 0; i < n; i++) {
            int inside = 0;
            CHECK(!fxs_fit_block_choose(&whole, i + 1, n, &b[i], &message));
            for (int p = 0; p < POINTS; p++)
                inside += is_in(&b[i], points[p].position);
            CHECK(abs(inside - (int)(POINTS / n)) <= 3);
        }
        for (int p = 0; p < 2000; p++) {
            const float *edge = points[p % POINTS].position;
            const float far[3] = {p % 2 ? random_place(1e9f) : edge[0], random_place(20), p % 3 ? edge[2] : 1e12f};
            int found = 0;
            for (uint32_t i = 0; i < n; i++)
                found += is_in(&b[i], far);
            CHECK(found == 1);
        }
        for (uint32_t i = 0; i < n; i++)
            fxs_fit_block_free(&b[i]);
    }
}

static void order_does_not_matter(void)
{
    fxs_message message;
    fxs_fit_block a, b;
    set_up();
    for (uint32_t i = 1; i <= 5; i++) {
        CHECK(!fxs_fit_block_choose(&whole, i, 5, &a, &message));
        for (int p = 0; p < POINTS / 2; p++) {
            const fxs_fit_point swap = points[p];
            points[p] = points[POINTS - 1 - p];
            points[POINTS - 1 - p] = swap;
        }
        CHECK(!fxs_fit_block_choose(&whole, i, 5, &b, &message));
        for (int k = 0; k < 3; k++)
            CHECK(!(a.low[k] < b.low[k] || a.low[k] > b.low[k] || a.high[k] < b.high[k] || a.high[k] > b.high[k]));
        CHECK(a.photos.point_count == b.photos.point_count);
        fxs_fit_block_free(&a);
        fxs_fit_block_free(&b);
    }
}

static void chosen(void)
{
    fxs_message message;
    fxs_fit_block b;
    set_up();
    whole.fit_count = 2;
    CHECK(!fxs_fit_block_choose(&whole, 1, 2, &b, &message));
    CHECK(isinf(b.low[0]) && fabs(b.high[0]) < 0.5 && isinf(b.high[2]));
    CHECK(b.photos.fit_count == 1 && b.photos.point_count == POINTS && b.extent > 0);
    fxs_fit_block_free(&b);
    views[0] = views[1];
    CHECK(fxs_fit_block_choose(&whole, 2, 2, &b, &message) == FXS_ERR_FILE);
    CHECK(!b.photos.fit && !b.photos.points);
}

static void bad_input(void)
{
    fxs_message message;
    fxs_fit_block b;
    set_up();
    CHECK(fxs_fit_block_choose(&whole, 0, 2, &b, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_fit_block_choose(&whole, 3, 2, &b, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_fit_block_choose(&whole, 1, 4097, &b, &message) == FXS_ERR_ARGUMENT);
    for (int i = 1; i < POINTS; i++)
        points[i] = points[0];
    CHECK(fxs_fit_block_choose(&whole, 1, 2, &b, &message) == FXS_ERR_FILE);
    CHECK(!fxs_fit_block_choose(&whole, 2, 2, &b, &message));
    fxs_fit_block_free(&b);
}

int main(void)
{
    RUN(tiled);
    RUN(order_does_not_matter);
    RUN(chosen);
    RUN(bad_input);
    return check_report();
}
