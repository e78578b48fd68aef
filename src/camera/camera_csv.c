/* The "internal/external camera parameters" of RealityCapture and RealityScan: a line of text for each photograph. */
#include "camera_internal.h"
#include "colmap_internal.h"

#include <math.h>
#include <string.h>

#include "src/base/number.h"

enum { NAME, X, Y, ALT, HEADING, PITCH, ROLL, F, NEEDED, PX = NEEDED, PY, K1, K2, K3, K4, T1, T2, VALUES };
enum { COLUMNS_MOST = 64, SIZE = 800 };

static const char *const headings[VALUES] = {"#name", "x", "y", "alt", "heading", "pitch", "roll", "f", "px", "py",
                                             "k1", "k2", "k3", "k4", "t1", "t2"};

#define FILM 36.0                  /* mm: f is for a picture whose longer side is so long */
#define RADIANS 0.017453292519943295

/* Cuts the next field off a line; NULL behind the last. A field in quotes may have commas. */
static char *next_field(char **rest)
{
    char *field = *rest;
    if (!field)
        return NULL;
    const int quoted = *field == '"';
    field += quoted;
    char *end = field + strcspn(field, quoted ? "\"" : ",");
    char *comma = strchr(end, ',');
    *rest = comma ? comma + 1 : NULL;
    *end = 0;
    for (; end > field && strchr(" \t\r", end[-1]); end--)
        end[-1] = 0;
    return field + strspn(field, " \t");
}

/* Which value each column has, -1 for none. Returns how many columns, or an error and a message. */
static int read_headings(const fxs_view_list *list, char *line, int columns[COLUMNS_MOST])
{
    int count = 0, seen[VALUES] = {0};
    for (char *field; (field = next_field(&line)); count++) {
        if (count == COLUMNS_MOST)
            return fxs_fail(list->message, "%s: more than %d columns", list->path, COLUMNS_MOST);
        columns[count] = -1;
        for (int i = 0; i < VALUES; i++)
            if (!strcmp(field, headings[i])) {
                columns[count] = i;
                seen[i] = 1;
            }
    }
    for (int i = 0; i < NEEDED; i++)
        if (!seen[i])
            return fxs_fail(list->message, "%s: no column %s; expected #name,x,y,alt,heading,pitch,roll,f and more",
                            list->path, headings[i]);
    return count;
}

/* Sine and cosine of any angle in degrees, by the tangent t of half of it: 2 t / (1 + t^2), (1 - t^2) / (1 + t^2). */
static void turn(double degrees, double *sine, double *cosine)
{
    const double within = fmod(degrees, 360), sign = within < 0 ? -1 : 1;
    const double a = fabs(within) > 180 ? 360 - fabs(within) : fabs(within), flip = fabs(within) > 180 ? -sign : sign;
    const double t = fxs_tangent((a > 90 ? 180 - a : a) * RADIANS / 2), square = t * t;
    *sine = flip * 2 * t / (1 + square);
    *cosine = (a > 90 ? -1 : 1) * (1 - square) / (1 + square);
}

/* Camera to world, with x to the right, y up and z backwards: Rz(-heading) Rx(pitch) Ry(roll), where the world's x is
   east, y north and z up. */
static void set_pose(fxs_file_view *view, const double v[VALUES])
{
    double sh, ch, sp, cp, sr, cr;
    turn(-v[HEADING], &sh, &ch);
    turn(v[PITCH], &sp, &cp);
    turn(v[ROLL], &sr, &cr);
    const double right[3] = {ch * cr - sh * sp * sr, sh * cr + ch * sp * sr, -cp * sr};
    const double up[3] = {-sh * cp, ch * cp, sp};
    const double back[3] = {ch * sr + sh * sp * cr, sh * sr - ch * sp * cr, cp * cr};
    for (int i = 0; i < 3; i++) {
        view->rotation[i] = right[i];
        view->rotation[3 + i] = -up[i];
        view->rotation[6 + i] = -back[i];
        view->position[i] = v[X + i];
    }
}

/* The principal point is stated from the middle, in sides of the picture; the coefficients are OpenCV's. */
static int add_view(fxs_view_list *list, const char *name, const double v[VALUES])
{
    fxs_listed_view *listed;
    FXS_TRY(fxs_view_list_add(list, name, &listed));
    fxs_file_view *view = &listed->view;
    set_pose(view, v);
    view->fx = view->fy = v[F] / FILM * SIZE;
    view->cx = SIZE / 2.0 + v[PX] * SIZE;
    view->cy = SIZE / 2.0 + v[PY] * SIZE;
    listed->sizeless = FXS_SIZE_OF_LONGER;
    for (int i = 0; i < 4; i++)
        listed->lens.k[i] = v[K1 + i];
    listed->lens.p[0] = v[T1];
    listed->lens.p[1] = v[T2];
    view->bends = !fxs_lens_is_pinhole(&listed->lens);
    return fxs_view_list_finish(list, SIZE, SIZE);
}

static int read_line(fxs_view_list *list, char *line, const int *columns, int count)
{
    const char *name = "";
    double values[VALUES] = {0};
    for (int i = 0; i < count; i++) {
        const char *field = next_field(&line);
        if (!field)
            return fxs_fail(list->message, "%s: camera %zu: %d values of %d", list->path, list->count, i, count);
        if (columns[i] == NAME)
            name = field;
        else if (columns[i] > NAME && !fxs_read_number(field, &values[columns[i]]))
            return fxs_fail(list->message, "%s: camera %zu: %s is not a finite number", list->path, list->count,
                            headings[columns[i]]);
    }
    if (!*name)
        return fxs_fail(list->message, "%s: camera %zu: no name", list->path, list->count);
    return add_view(list, fxs_without_drive(name), values);
}

int fxs_camera_csv_parse(fxs_view_list *list, const fxs_text *csv)
{
    char *rest = csv->data, *line;
    int columns[COLUMNS_MOST], count = 0;
    if (strlen(csv->data) < csv->size)
        return fxs_fail(list->message, "%s: zero bytes in this text", list->path);
    if (!strncmp(rest, "\xef\xbb\xbf", 3))
        rest += 3;
    while (!count && (line = fxs_colmap_line(&rest)))
        if (!strncmp(line, headings[NAME], strlen(headings[NAME])))
            FXS_TRY((count = read_headings(list, line, columns)) < 0 ? count : 0);
    if (!count)
        return fxs_fail(list->message, "%s: no line begins with #name", list->path);
    while ((line = fxs_colmap_entry(&rest)))
        FXS_TRY(read_line(list, line, columns, count));
    return 0;
}
