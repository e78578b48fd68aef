/* Reads the JSON of an earlier benchmark and checks that it measured the same scene in the same way. Lists the allowed
   differences. */
#include "bench_earlier.h"

#ifndef FXS_WITH_CJSON

int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count)
{
    (void)earlier;
    (void)facts;
    (void)count;
    return fail(EXIT_FAILED, "--compare %s: built without cJSON", path);
}

#else

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"

#define FILE_MOST 65536

static int load(const char *path, char text[FILE_MOST + 1])
{
    FILE *file = fxs_stream_open(path, "rb");
    if (!file)
        return fail(EXIT_FAILED, "%s: %s", path, strerror(errno));
    errno = 0;
    const size_t size = fread(text, 1, FILE_MOST + 1, file);
    const int error = ferror(file) ? errno : 0;
    fclose(file);
    text[size < FILE_MOST ? size : FILE_MOST] = 0;
    return error ? fail(EXIT_FAILED, "%s: %s", path, strerror(error))
           : size > FILE_MOST ? fail(EXIT_FAILED, "%s: too long for the output of bench --json", path) : 0;
}

static const char *words_of(const cJSON *item, char room[32])
{
    if (cJSON_IsNumber(item))
        snprintf(room, 32, "%.15g", item->valuedouble);
    return cJSON_IsNumber(item) ? room : cJSON_GetStringValue(item);
}

static int check_fact(bench_earlier *e, const char *path, const cJSON *root, const bench_fact *fact)
{
    char rooms[2][32];
    const char *there = words_of(cJSON_GetObjectItemCaseSensitive(root, fact->name), rooms[0]), *here = fact->text;
    const size_t used = strlen(e->marks);
    if (!here) {
        snprintf(rooms[1], sizeof rooms[1], "%.15g", fact->number);
        here = rooms[1];
    }
    if (!there)
        return fail(EXIT_FAILED, "%s: no %s: expected the output of this version's bench --json", path, fact->name);
    if (fact->kind == FACT_ASIDE || !strcmp(here, there))
        return 0;
    if (fact->kind == FACT_SAME)
        return fail(EXIT_FAILED, "%s cannot be compared: %s: %.200s there, %.200s here", path, fact->name, there,
                    here);
    snprintf(e->marks + used, sizeof e->marks - used, "%s%s is %.100s there and %.100s here", used ? "; " : "",
             fact->name, there, here);
    return 0;
}

static int take_time(double *out, const char *path, const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    *out = cJSON_IsNumber(item) ? item->valuedouble : -1;
    return *out >= 0 ? 0 : fail(EXIT_FAILED, "%s: no time of %s: expected the output of bench --json", path, name);
}

static int take(bench_earlier *e, const char *path, const cJSON *root, const bench_fact *facts, int count)
{
    const cJSON *stages = cJSON_GetObjectItemCaseSensitive(root, "stages");
    int status = 0;
    memset(e, 0, sizeof *e);
    for (int i = 0; i < count && !status; i++)
        status = check_fact(e, path, root, &facts[i]);
    for (int s = 0; s < FXS_STAGES && !status; s++)
        status = take_time(&e->stages[s], path, stages, fxs_stage_name((enum fxs_stage)s));
    return status ? status : take_time(&e->frame, path, root, "frame_ms");
}

int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count)
{
    static char text[FILE_MOST + 1];
    int status = load(path, text);
    if (status)
        return status;
    cJSON *root = cJSON_ParseWithOpts(text, 0, 1);
    status = cJSON_IsObject(root) ? take(earlier, path, root, facts, count)
                                  : fail(EXIT_FAILED, "%s: not the JSON object of bench --json", path);
    cJSON_Delete(root);
    return status;
}

#endif
