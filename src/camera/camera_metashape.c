/* Reads cameras that Agisoft Metashape exports as .xml. The formulas are in the appendix "Camera models" of its user
   manual. */
#include "camera_internal.h"

#ifdef FXS_WITH_EXPAT

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <expat.h>

#include "colmap_internal.h"
#include "src/base/fail_list.h"
#include "src/base/number.h"

enum { DEPTH_MOST = 64, NAME_ROOM = 24, TEXT_MOST = 2048, ID_ROOM = 24, ITEMS_MOST = 1000000 };

enum { F, CX, CY, B1, B2, K1, K2, K3, K4, P1, P2, P3, P4, NUMBERS };
static const char *const number_names[NUMBERS] = {"f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2",
                                                   "p3", "p4"};

/* The id must be the first field of a sensor, because find_item reads it there. */
typedef struct sensor {
    char id[ID_ROOM], type[ID_ROOM];
    double width, height, numbers[NUMBERS];
    int calibrated, adjusted;
} sensor;

/* Placement of a group of cameras: world position = scale * rotation * local position + translation. */
typedef struct placement {
    char id[ID_ROOM];
    double rotation[9], translation[3], scale;
    int given;
} placement;

#define ON_EARTH 65536.0           /* largest translation in scene units that is kept; a larger one is geographic, too
                                      far for floats */

typedef struct photographed {
    char *label;
    char sensor[ID_ROOM], component[ID_ROOM];
    double pose[16];
    int has_pose, disabled;
} photographed;

typedef struct items {
    void *data;
    size_t count, room;
} items;

typedef struct reader {
    fxs_view_list *list;
    XML_Parser parser;
    int error, chunks;
    char path[DEPTH_MOST][NAME_ROOM];
    int depth;
    char text[TEXT_MOST];
    size_t length;
    int calibration;
    placement chunk;
    double origin[3];
    items sensors, components, cameras;
} reader;

static void stop(reader *r, int error)
{
    r->error = error;
    XML_StopParser(r->parser, XML_FALSE);
}

static void fault(reader *r, const char *what, const char *of)
{
    stop(r, fxs_fail(r->list->message, "%s: line %lu: %s%.40s", r->list->path,
                     (unsigned long)XML_GetCurrentLineNumber(r->parser), what, of));
}

static void *add_item(reader *r, items *i, size_t size)
{
    if (i->count == i->room) {
        const size_t room = 2 * i->room + 16;
        void *data = i->count < ITEMS_MOST ? realloc(i->data, room * size) : NULL;
        if (!data) {
            stop(r, i->count < ITEMS_MOST ? fxs_fail_memory(r->list->message, r->list->path, room * size) :
                    fxs_fail(r->list->message, "%s: more than %d cameras", r->list->path, ITEMS_MOST));
            return NULL;
        }
        i->data = data;
        i->room = room;
    }
    return memset((char *)i->data + i->count++ * size, 0, size);
}

/* Returns 1 if the innermost open XML element and its parent have these names. */
static int is(const reader *r, const char *name, const char *parent)
{
    return r->depth > 1 && r->depth <= DEPTH_MOST && !strcmp(r->path[r->depth - 1], name) &&
           !strcmp(r->path[r->depth - 2], parent);
}

static const char *attribute(const char **attributes, const char *name)
{
    for (; *attributes; attributes += 2)
        if (!strcmp(*attributes, name))
            return attributes[1];
    return "";
}

static int take_id(reader *r, char id[ID_ROOM], const char **attributes, const char *name)
{
    const char *value = attribute(attributes, name);
    if (strlen(value) >= ID_ROOM) {
        fault(r, "too long: ", name);
        return 0;
    }
    strcpy(id, value);
    return 1;
}

static void take_size(reader *r, const char **attributes)
{
    sensor *s = (sensor *)r->sensors.data + r->sensors.count - 1;
    if (!fxs_read_number(attribute(attributes, "width"), &s->width) ||
        !fxs_read_number(attribute(attributes, "height"), &s->height))
        fault(r, "a resolution without width and height", "");
}

static void begin_calibration(reader *r, const char **attributes)
{
    sensor *s = (sensor *)r->sensors.data + r->sensors.count - 1;
    const int adjusted = !strcmp(attribute(attributes, "class"), "adjusted");
    r->calibration = !s->calibrated || (adjusted && !s->adjusted);
    if (!r->calibration)
        return;
    s->calibrated = 1;
    s->adjusted = adjusted;
    memset(s->numbers, 0, sizeof s->numbers);
}

static void begin_camera(reader *r, const char **attributes)
{
    photographed *c = add_item(r, &r->cameras, sizeof *c);
    const char *label = attribute(attributes, "label"), *enabled = attribute(attributes, "enabled");
    if (!c || !take_id(r, c->sensor, attributes, "sensor_id") || !take_id(r, c->component, attributes, "component_id"))
        return;
    c->disabled = !strcmp(enabled, "0") || !strcmp(enabled, "false");
    c->label = malloc(strlen(label) + 1);
    if (c->label)
        strcpy(c->label, label);
    else
        stop(r, fxs_fail_memory(r->list->message, r->list->path, strlen(label)));
}

static void begin_item(reader *r, const char **attributes)
{
    if (is(r, "sensor", "sensors")) {
        sensor *s = add_item(r, &r->sensors, sizeof *s);
        if (s && take_id(r, s->id, attributes, "id"))
            take_id(r, s->type, attributes, "type");
    } else if (is(r, "component", "components")) {
        placement *p = add_item(r, &r->components, sizeof *p);
        if (p)
            take_id(r, p->id, attributes, "id");
    } else if (is(r, "camera", "cameras") || is(r, "camera", "group")) {
        begin_camera(r, attributes);
    } else if (is(r, "resolution", "sensor") && r->sensors.count) {
        take_size(r, attributes);
    } else if (is(r, "calibration", "sensor") && r->sensors.count) {
        begin_calibration(r, attributes);
    } else if (is(r, "chunk", "document") && r->chunks++) {
        fault(r, "a second chunk: export one", "");
    }
}

static void begin(void *argument, const char *name, const char **attributes)
{
    reader *r = argument;
    r->length = 0;
    if (r->depth < DEPTH_MOST) {
        strncpy(r->path[r->depth], strlen(name) < NAME_ROOM ? name : "", NAME_ROOM - 1);
        r->path[r->depth][NAME_ROOM - 1] = 0;
    }
    r->depth++;
    if (!r->error)
        begin_item(r, attributes);
}

static void add_text(void *argument, const char *text, int length)
{
    reader *r = argument;
    const size_t room = TEXT_MOST - 1 - r->length, taken = (size_t)length < room ? (size_t)length : room;
    memcpy(r->text + r->length, text, taken);
    r->length += taken;
}

static void take_numbers(reader *r, double *out, int count)
{
    char *rest = r->text;
    if (r->length == TEXT_MOST - 1)
        r->text[0] = 0;
    for (char *c = r->text; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
    if (!fxs_colmap_numbers(&rest, out, count) || *fxs_colmap_word(&rest))
        fault(r, "not finite numbers, or not so many as there should be: ", r->path[r->depth - 1]);
}

static void take_calibration(reader *r)
{
    sensor *s = (sensor *)r->sensors.data + r->sensors.count - 1;
    for (int i = 0; i < NUMBERS; i++)
        if (!strcmp(r->path[r->depth - 1], number_names[i]))
            take_numbers(r, &s->numbers[i], 1);
}

static void take_placement(reader *r)
{
    const char *owner = r->depth > 2 ? r->path[r->depth - 3] : "";
    placement *p = !strcmp(owner, "chunk") ? &r->chunk :
                   !strcmp(owner, "component") && r->components.count ?
                       (placement *)r->components.data + r->components.count - 1 : NULL;
    if (!p)
        return;
    if (!p->given)
        p->rotation[0] = p->rotation[4] = p->rotation[8] = p->scale = p->given = 1;
    if (is(r, "rotation", "transform"))
        take_numbers(r, p->rotation, 9);
    else if (is(r, "translation", "transform"))
        take_numbers(r, p->translation, 3);
    else if (is(r, "scale", "transform"))
        take_numbers(r, &p->scale, 1);
}

static void end(void *argument, const char *name)
{
    reader *r = argument;
    (void)name;
    r->text[r->length] = 0;
    if (r->depth > 1 && r->depth <= DEPTH_MOST && !r->error) {
        if (is(r, "transform", "camera") && r->cameras.count) {
            photographed *c = (photographed *)r->cameras.data + r->cameras.count - 1;
            c->has_pose = 1;
            take_numbers(r, c->pose, 16);
        } else if (!strcmp(r->path[r->depth - 2], "transform")) {
            take_placement(r);
        } else if (!strcmp(r->path[r->depth - 2], "calibration") && r->calibration) {
            take_calibration(r);
        }
        if (is(r, "calibration", "sensor"))
            r->calibration = 0;
    }
    r->depth--;
    r->length = 0;
}

/* Refuses an XML file with a document type, because entities that it declares could expand without limit. */
static void begin_declarations(void *argument, const char *name, const char *system, const char *public, int internal)
{
    (void)system, (void)public, (void)internal;
    fault(argument, "a document type is declared: ", name);
}

static int compare_ids(const void *a, const void *b)
{
    return strcmp(a, b);
}

static void sort_items(items *i, size_t size)
{
    if (i->count)
        qsort(i->data, i->count, size, compare_ids);
}

static const void *find_item(const items *i, const char *id, size_t size)
{
    return i->count ? bsearch(id, i->data, i->count, size, compare_ids) : NULL;
}

static const placement *find_placement(const reader *r, const char *id)
{
    const placement *of = find_item(&r->components, id, sizeof *of);
    return of && of->given ? of : r->chunk.given ? &r->chunk : NULL;
}

/* Returns 1 if a camera has a pose and is not disabled. Metashape gives no pose to a camera that it did not align. */
static int is_view(const photographed *c)
{
    return c->has_pose && !c->disabled;
}

/* Sets the origin of all cameras to the first geographic translation, in whole units, which doubles subtract
   exactly. */
static void find_origin(reader *r)
{
    const photographed *cameras = r->cameras.data;
    for (size_t i = 0; i < r->cameras.count && !r->list->moved; i++) {
        const placement *p = is_view(&cameras[i]) ? find_placement(r, cameras[i].component) : NULL;
        const double *t = p ? p->translation : r->origin;
        r->list->moved = fmax(fabs(t[0]), fmax(fabs(t[1]), fabs(t[2]))) > ON_EARTH;
        for (int k = 0; k < 3 && r->list->moved; k++)
            r->origin[k] = floor(t[k] + 0.5);
    }
}

/* Places a camera in the world. The columns of `pose` are the camera's axes x, y (down), z (forward), and its
   centre. */
static int place(fxs_view_list *list, fxs_view *view, const double pose[16], const placement *p,
                 const double origin[3])
{
    static const placement none = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1};
    if (pose[12] != 0 || pose[13] != 0 || pose[14] != 0 || pose[15] != 1)
        return fxs_view_list_fault(list, "the last row of its transform is not 0 0 0 1");
    p = p ? p : &none;
    if (!(p->scale > 0))
        return fxs_view_list_fault(list, "the scale of its chunk or component is not above 0");
    for (int i = 0; i < 3; i++) {
        const double *r = p->rotation + 3 * i;
        for (int axis = 0; axis < 3; axis++)
            view->rotation[3 * axis + i] = r[0] * pose[axis] + r[1] * pose[4 + axis] + r[2] * pose[8 + axis];
        view->position[i] = p->scale * (r[0] * pose[3] + r[1] * pose[7] + r[2] * pose[11]) +
                            (p->translation[i] - origin[i]);
    }
    return 0;
}

/* Converts Metashape's lens coefficients. It projects to pixels by u = w / 2 + cx + x' f + x' B1 + y' B2, v = h / 2 +
   cy + y' f, where x' includes P1 (r^2 + 2 x^2) + 2 P2 x y. */
static int set_intrinsics(fxs_view_list *list, fxs_listed_view *listed, const sensor *s)
{
    const double *n = s->numbers;
    fxs_view *view = &listed->view;
    const int fisheye = !strcmp(s->type, "fisheye");
    if (!fisheye && strcmp(s->type, "frame") && *s->type)
        return fxs_view_list_fault(list, "its sensor is neither a frame nor an (equidistant) fisheye");
    if (n[P3] != 0 || n[P4] != 0)
        return fxs_view_list_fault(list, "its sensor has p3 or p4, which are not known here");
    view->fx = n[F] + n[B1];
    view->fy = n[F];
    view->cx = s->width / 2 + n[CX];
    view->cy = s->height / 2 + n[CY];
    listed->lens.kind = fisheye ? FXS_LENS_FISHEYE : FXS_LENS_BROWN;
    for (int i = 0; i < 4; i++)
        listed->lens.k[i] = n[K1 + i];
    listed->lens.p[0] = n[P2];
    listed->lens.p[1] = n[P1];
    listed->lens.skew = n[B2] == 0 ? 0 : n[B2] / view->fx;
    view->bends = !fxs_lens_is_pinhole(&listed->lens);
    return fxs_lens_complete(&listed->lens) ? 0 : fxs_view_list_fault(list, "its sensor has no finite lens");
}

static int add_view(reader *r, const photographed *c)
{
    fxs_view_list *list = r->list;
    fxs_listed_view *listed;
    const sensor *s = find_item(&r->sensors, c->sensor, sizeof *s);
    if (!is_view(c))
        return 0;
    FXS_TRY(fxs_view_list_add(list, *c->label ? fxs_without_drive(c->label) : NULL, &listed));
    if (!s)
        return fxs_view_list_fault(list, "its sensor is not in the file");
    if (!s->calibrated)
        return fxs_view_list_fault(list, "its sensor has no calibration");
    FXS_TRY(place(list, &listed->view, c->pose, find_placement(r, c->component), r->origin));
    FXS_TRY(set_intrinsics(list, listed, s));
    return fxs_view_list_finish(list, s->width, s->height);
}

static int parse(reader *r, const fxs_text *xml)
{
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, begin, end);
    XML_SetCharacterDataHandler(r->parser, add_text);
    XML_SetStartDoctypeDeclHandler(r->parser, begin_declarations);
    errno = 0;
    if (XML_Parse(r->parser, xml->data, (int)xml->size, 1) != XML_STATUS_OK && !r->error)
        return fxs_fail_library(r->list->message, r->list->path, "%s: line %lu: %s", r->list->path,
                                (unsigned long)XML_GetCurrentLineNumber(r->parser),
                                XML_ErrorString(XML_GetErrorCode(r->parser)));
    FXS_TRY(r->error);
    if (!r->chunks)
        return fxs_fail(r->list->message, "%s: no cameras of Metashape", r->list->path);
    sort_items(&r->sensors, sizeof(sensor));
    sort_items(&r->components, sizeof(placement));
    find_origin(r);
    const photographed *cameras = r->cameras.data;
    for (size_t i = 0; i < r->cameras.count; i++)
        FXS_TRY(add_view(r, &cameras[i]));
    return 0;
}

int fxs_camera_metashape_parse(fxs_view_list *list, const fxs_text *xml)
{
    reader *r = calloc(1, sizeof *r);
    int error = r && (r->parser = XML_ParserCreate(NULL)) ? 0 : fxs_fail_memory(list->message, list->path, sizeof *r);
    if (!error) {
        r->list = list;
        error = parse(r, xml);
        XML_ParserFree(r->parser);
        photographed *cameras = r->cameras.data;
        for (size_t i = 0; i < r->cameras.count; i++)
            free(cameras[i].label);
        free(r->cameras.data);
        free(r->sensors.data);
        free(r->components.data);
    }
    free(r);
    return error;
}

#else

int fxs_camera_metashape_parse(fxs_view_list *list, const fxs_text *xml)
{
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, list->message, "%s: cannot read XML cameras: built without expat",
                       xml->path);
}

#endif
