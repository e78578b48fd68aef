/* Reads the cameras that RealityCapture and RealityScan export as "internal/external camera parameters": a text line
   per photograph. */
#include "camera_internal.h"
#include "colmap_internal.h"

#include <math.h>
#include <string.h>

#include "src/base/number.h"

enum { NAME, X, Y, ALT, HEADING, PITCH, ROLL, F, NEEDED, PX = NEEDED, PY, K1, K2, K3, K4, T1, T2, VALUES };
enum { COLUMNS_MOST = 64, SIZE = 800 };

static const char *const headings[VALUES] = {"#name", "x", "y", "alt", "heading", "pitch", "roll", "f", "px", "py",
                                             "k1", "k2", "k3", "k4", "t1", "t2"};

#define FILM 36.0                  /* width of 35 mm film in millimetres; the focal lengths in the file refer to it */
#define RADIANS 0.017453292519943295

typedef struct table {
    int columns[COLUMNS_MOST];
    int count;
    char separator;                /* character between fields: a comma, or a semicolon if decimals have commas */
} table;

static char *next_field(char **rest, char separator)
{
    const char separators[2] = {separator, 0};
    char *field = *rest;
    if (!field)
        return NULL;
    const int quoted = *field == '"';
    field += quoted;
    char *end = field + strcspn(field, quoted ? "\"" : separators);
    char *next = strchr(end, separator);
    *rest = next ? next + 1 : NULL;
    *end = 0;
    for (; end > field && strchr(" \t\r", end[-1]); end--)
        end[-1] = 0;
    return field + strspn(field, " \t");
}

static int read_headings(const fxs_view_list *list, char *line, table *t)
{
    int seen[VALUES] = {0};
    t->separator = line[strcspn(line, ",;")] == ';' ? ';' : ',';
    for (char *field; (field = next_field(&line, t->separator)); t->count++) {
        if (t->count == COLUMNS_MOST)
            return fxs_fail(list->message, "%s: more than %d columns", list->path, COLUMNS_MOST);
        t->columns[t->count] = -1;
        for (int i = 0; i < VALUES; i++)
            if (!strcmp(field, headings[i])) {
                t->columns[t->count] = i;
                seen[i] = 1;
            }
    }
    for (int i = 0; i < NEEDED; i++)
        if (!seen[i])
            return fxs_fail(list->message, "%s: no column %s; expected #name,x,y,alt,heading,pitch,roll,f and more",
                            list->path, headings[i]);
    return 0;
}

/* Computes sine and cosine of an angle from the tangent t of its half: 2 t / (1 + t^2), (1 - t^2) / (1 + t^2). */
static void turn(double degrees, double *sine, double *cosine)
{
    const double within = fmod(degrees, 360), sign = within < 0 ? -1 : 1;
    const double a = fabs(within) > 180 ? 360 - fabs(within) : fabs(within), flip = fabs(within) > 180 ? -sign : sign;
    const double t = fxs_tangent((a > 90 ? 180 - a : a) * RADIANS / 2), square = t * t;
    *sine = flip * 2 * t / (1 + square);
    *cosine = (a > 90 ? -1 : 1) * (1 - square) / (1 + square);
}

/* Computes the rotation from camera (x right, y up, z backwards) to world (x east, y north, z up): Rz(-heading)
   Rx(pitch) Ry(roll). */
static void set_pose(fxs_view *view, const double v[VALUES])
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

/* The file states the principal point relative to the picture's middle, as a fraction of the longer side. */
static int add_view(fxs_view_list *list, const char *name, const double v[VALUES])
{
    fxs_listed_view *listed;
    FXS_TRY(fxs_view_list_add(list, name, &listed));
    fxs_view *view = &listed->view;
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

static int read_line(fxs_view_list *list, char *line, const table *t)
{
    const char *name = "";
    double values[VALUES] = {0};
    for (int i = 0; i < t->count; i++) {
        const int column = t->columns[i];
        char *field = next_field(&line, t->separator), *comma;
        if (!field)
            return fxs_fail(list->message, "%s: camera %zu: %d values of %d", list->path, list->count, i, t->count);
        if (column > NAME && t->separator == ';' && (comma = strchr(field, ',')))
            *comma = '.';
        if (column == NAME)
            name = field;
        else if (column > NAME && !fxs_read_number(field, &values[column]))
            return fxs_fail(list->message, "%s: camera %zu: %s is not a finite number", list->path, list->count,
                            headings[column]);
    }
    if (!*name)
        return fxs_fail(list->message, "%s: camera %zu: no name", list->path, list->count);
    return add_view(list, fxs_without_drive(name), values);
}

int fxs_camera_csv_parse(fxs_view_list *list, const fxs_text *csv)
{
    char *rest = fxs_text_begin(csv), *line;
    table t = {.count = 0};
    if (strlen(csv->data) < csv->size)
        return fxs_fail(list->message, "%s: zero bytes in this text", list->path);
    while (!t.count && (line = fxs_colmap_line(&rest)))
        if (!strncmp(line, headings[NAME], strlen(headings[NAME])))
            FXS_TRY(read_headings(list, line, &t));
    if (!t.count)
        return fxs_fail(list->message, "%s: no line begins with #name", list->path);
    while ((line = fxs_colmap_entry(&rest)))
        FXS_TRY(read_line(list, line, &t));
    return 0;
}
