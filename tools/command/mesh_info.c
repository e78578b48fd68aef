#include "mesh_info.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include <fixsplat/surface.h>
#include "command.h"

typedef struct sized_mesh {
    fxs_mesh *mesh;
    fxs_mesh_measures measures;
    fxs_mesh_route route;
    double off[2];                          /* distances of the route's ends from the given points */
} sized_mesh;

static int is_closed(const fxs_mesh_measures *m)
{
    return !m->open_edges && !m->turned_edges;
}

static void print_route_json(const sized_mesh *s)
{
    printf(", \"distance\": {\"from\": ");
    print_vector_json(s->route.from);
    printf(", \"to\": ");
    print_vector_json(s->route.to);
    printf(", \"off\": [%.9g, %.9g], \"straight\": %.9g, \"along\": %.9g, \"points\": %" PRIu32 "}", s->off[0],
           s->off[1], s->route.straight, s->route.along, s->route.count);
}

static void print_json(const sized_mesh *s, int has_distance)
{
    const fxs_mesh_measures *m = &s->measures;
    printf("{\"triangles\": %" PRIu32 ", \"vertices\": %" PRIu32 ", \"parts\": %" PRIu32 ", \"bounds\": ",
           s->mesh->triangle_count, s->mesh->vertex_count, m->parts);
    print_box_json(m->low, m->high);
    printf(", \"closed\": %s, \"open_edges\": %" PRIu64 ", \"turned_edges\": %" PRIu64 ", \"area\": %.9g, \"volume\": ",
           is_closed(m) ? "true" : "false", m->open_edges, m->turned_edges, m->area);
    if (is_closed(m))
        printf("%.9g", m->volume);
    else
        printf("null");
    if (has_distance)
        print_route_json(s);
    puts("}");
}

static void print_end(const char *name, const double at[3], double off)
{
    printf("%-13s", name);
    print_place(at);
    printf(", %.3g from the given point\n", off);
}

static void print_text(const sized_mesh *s, int has_distance)
{
    const fxs_mesh_measures *m = &s->measures;
    const fxs_mesh_route *r = &s->route;
    printf("triangles     %" PRIu32 "\nvertices      %" PRIu32 "\nparts         %" PRIu32 "\nbounds       ",
           s->mesh->triangle_count, s->mesh->vertex_count, m->parts);
    print_box(m->low, m->high);
    printf("area          %.7g\n", m->area);
    if (is_closed(m))
        printf("volume        %.7g%s\n", fabs(m->volume), m->volume < 0 ? ", the triangles face inwards" : "");
    else if (m->open_edges)
        printf("volume        none, open: %" PRIu64 " edges\n", m->open_edges);
    else
        printf("volume        none: at %" PRIu64 " edges, triangles face opposite ways\n", m->turned_edges);
    if (!has_distance)
        return;
    print_end("from", r->from, s->off[0]);
    print_end("to", r->to, s->off[1]);
    printf("straight      %.7g\nalong         %.7g\n", r->straight, r->along);
}

static double distance_of(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static int find_distance(sized_mesh *s, const char *path, const mesh_info_options *o, fxs_message *why)
{
    if (fxs_mesh_find_route(&s->route, s->mesh, o->ends, o->ends + 3, why))
        return fail(EXIT_FAILED, "%s: %s", path, why->text);
    s->off[0] = distance_of(s->route.from, o->ends);
    s->off[1] = distance_of(s->route.to, o->ends + 3);
    return o->output && fxs_mesh_route_write(o->output, &s->route, why) ? fail_for(why) : 0;
}

int print_mesh_info(const char *path, const mesh_info_options *o)
{
    sized_mesh s = {.mesh = 0};
    fxs_message why;
    int status = fxs_mesh_open(&s.mesh, path, o->max_memory, &why) || fxs_mesh_measure(&s.measures, s.mesh, &why)
                     ? fail_for(&why) : 0;
    if (!status && o->has_distance)
        status = find_distance(&s, path, o, &why);
    if (!status)
        (o->json ? print_json : print_text)(&s, o->has_distance);
    fxs_mesh_route_free(&s.route);
    fxs_mesh_free(s.mesh);
    return status;
}
