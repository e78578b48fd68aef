#include "views.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { VIEWS_MOST = 100000 };   /* in a list, where views may come again */

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* A number from 0 to count - 1. Returns what is behind it, or null where it is none. */
static const char *take_view(const char *text, long count, long *number)
{
    char *end;
    if (!isdigit((unsigned char)*text))
        return 0;
    *number = strtol(text, &end, 10);
    return *number < count ? end : 0;
}

/* A part of a list, as 8 or 8..40 or 40..8. */
static const char *take_part(const char *text, long count, long *first, long *last)
{
    text = take_view(text, count, first);
    *last = text ? *first : 0;
    return text && !strncmp(text, "..", 2) ? take_view(text + 2, count, last) : text;
}

/* Returns how many views, 0 where the text is no list, -1 without memory. */
static long take_list(const char *text, const fxs_file_view *views, long count, fxs_file_view **chosen)
{
    long found = 0, first, last;
    for (*chosen = 0;; text++) {
        text = take_part(text, count, &first, &last);
        if (!text || (*text && *text != ',') || found + labs(last - first) >= VIEWS_MOST)
            return 0;
        const long length = labs(last - first) + 1;
        fxs_file_view *larger = realloc(*chosen, (size_t)(found + length) * sizeof *larger);
        if (!larger)
            return -1;
        *chosen = larger;
        for (long i = 0; i < length; i++)
            larger[found++] = views[first < last ? first + i : first - i];
        if (!*text)
            return found;
    }
}

int names_several(const char *view)
{
    return view && (!strcmp(view, "all") || ((strchr(view, ',') || strstr(view, "..")) &&
                                             !view[strspn(view, "0123456789,.")]));
}

static long take_one(const frame_options *options, const fxs_file_view *views, long count, fxs_file_view **chosen)
{
    const long index = find_view(options, views, count);
    if (index < 0)
        return 0;
    *chosen = malloc(sizeof **chosen);
    if (!*chosen)
        return -1;
    **chosen = views[index];
    return 1;
}

long views_of_list(const frame_options *options, const fxs_file_view *views, long count, fxs_file_view **chosen)
{
    const int several = names_several(options->view);
    *chosen = 0;
    const long found = several ? take_list(options->view, views, count, chosen)
                               : take_one(options, views, count, chosen);
    if (found > 0)
        return found;
    free(*chosen);
    *chosen = 0;
    if (found < 0)
        fail(-1, "out of memory: the views of %s", options->cameras);
    else if (several)
        fail(-1, "%s: no views '%s': expected numbers from 0 to %ld as 8..40 or 0,8,40", options->cameras,
             options->view, count - 1);
    return -1;
}

/* ---- Films ------------------------------------------------------------------------------------------------------- */

static void turn(const frame_options *o, const world *w, const fxs_file_view *first, fxs_file_view *frames)
{
    double middle[3];
    for (int i = 0; i < 3; i++)
        middle[i] = (w->inner_low[i] + w->inner_high[i]) / 2;
    for (long i = 0; i < o->orbit; i++) {
        frames[i] = *first;
        if (i)
            fxs_view_orbit(&frames[i], middle, o->up.at, 6.283185307179586 * (double)i / (double)o->orbit);
    }
}

/* From the first view to the last; all of the first one's size. */
static void pass_through(const frame_options *o, fxs_file_view *keys, long count, fxs_file_view *frames)
{
    for (long i = 1; i < count; i++)
        if (keys[i].width != keys->width || keys[i].height != keys->height)
            fxs_view_resize(&keys[i], keys->width, keys->height);
    for (long i = 0; i < o->frames; i++)
        fxs_view_between(keys, count, (double)(i * (count - 1)) / (double)(o->frames - 1), &frames[i]);
}

long frames_of_film(const frame_options *options, const world *w, fxs_file_view **views, long count)
{
    const long frames = options->orbit ? options->orbit : options->frames;
    fxs_file_view *made = 0;
    if (options->orbit && count > 1)
        fail(-1, "--orbit begins at one view, --view %s are %ld", options->view, count);
    else if (options->frames && count < 2)
        fail(-1, "--frames needs several views, --view %s is one", options->view);
    else if (!(made = malloc((size_t)frames * sizeof *made)))
        fail(-1, "out of memory: %ld frames", frames);
    else if (options->orbit)
        turn(options, w, *views, made);
    else
        pass_through(options, *views, count, made);
    free(*views);
    *views = made;
    return made ? frames : -1;
}
