/* Writes cameras.json, the format that camera_json.c reads. */
#include <fixsplat/camera.h>
#include "src/base/output_internal.h"
#include "view_print.h"

void fxs_view_print(FILE *to, const fxs_view *v)
{
    const double *r = v->rotation;
    fprintf(to, "{\"img_name\": \"");
    for (const char *c = v->name; *c; c++)
        fprintf(to, (unsigned char)*c < ' ' ? "\\u%04x" : *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    fprintf(to, "\", \"width\": %d, \"height\": %d, \"fx\": %.17g, \"fy\": %.17g, \"cx\": %.17g, \"cy\": %.17g, "
            "%s\"position\": [%.17g, %.17g, %.17g], \"rotation\": [", v->width, v->height, v->fx, v->fy, v->cx, v->cy,
            v->projection == FXS_ORTHOGRAPHIC ? "\"orthographic\": true, " : "",
            v->position[0], v->position[1], v->position[2]);
    for (int i = 0; i < 3; i++)
        fprintf(to, "%s[%.17g, %.17g, %.17g]", i ? ", " : "", r[i], r[3 + i], r[6 + i]);
    fputs("]}", to);
}

int fxs_camera_file_write(const char *path, const fxs_view *views, size_t count, fxs_message *message)
{
    fxs_output output;
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    for (size_t i = 0; i < count; i++) {
        fputs(i ? ",\n" : "[", output.file);
        fxs_view_print(output.file, &views[i]);
    }
    fputs(count ? "]\n" : "[]\n", output.file);
    return fxs_output_close(&output, message);
}
