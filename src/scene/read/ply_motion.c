/* Reads the motion of Gaussians in a .ply. Sources of the layouts: oppo-us-research/SpacetimeGaussians at 427abfc
   (ourslite.py), SuperSplat 4D's ply_to_sog4d.py, and OpsiClear-4DGS/ftgs-player at 23abaf5 (FORMAT.md). */
#include "ply_motion.h"

#include "src/base/exponential.h"

enum { CENTRE, FADE, DRIFT, TURN = DRIFT + 9, SECOND_DRIFT = DRIFT + 3, FTGS_TIMES = DRIFT + 3 };

static const char *const spacetime_names[FXS_PLY_TIMES] = {
    "trbf_center", "trbf_scale", "motion_0", "motion_1", "motion_2", "motion_3", "motion_4", "motion_5", "motion_6",
    "motion_7", "motion_8", "omega_0", "omega_1", "omega_2", "omega_3"
};

static const char *const ftgs_names[FTGS_TIMES] = {
    "time", "log_duration", "velocity_0", "velocity_1", "velocity_2"
};

#define SQRT_2 1.4142135623730951
#define LEAST_SEEN (1 / 255.0)      /* smallest opacity that the renderer draws */

/* Reads a setting of a moving scene into *value, which keeps its number if the file has none. */
static int take(const fxs_ply_header *header, int setting, double low, double high, double *value, const char *path,
                fxs_message *message)
{
    if (!(header->given >> setting & 1))
        return 0;
    *value = header->settings[setting];
    if (*value >= low && *value <= high)
        return 0;
    return fxs_fail(message, "%s: no valid comment %s of a moving scene", path, fxs_ply_setting_names[setting]);
}

static int find_columns(fxs_ply_motion *m, const fxs_ply_header *header, const fxs_ply_element *element,
                        const char *const *names, int count)
{
    int found = 0;
    for (int i = 0; i < FXS_PLY_TIMES; i++) {
        m->columns[i] = i < count ? fxs_ply_find(header, element, names[i]) : -1;
        found += i < FTGS_TIMES && m->columns[i] >= 0;
    }
    return found == FTGS_TIMES;
}

/* In the lite model, f_dc is the colour itself, and times are 0 to 1. SuperSplat 4D writes SH and seconds. */
static int find_spacetime(fxs_ply_motion *m, const fxs_ply_header *header, const fxs_ply_element *element,
                          const char *path, fxs_message *message)
{
    const int in_seconds = header->given >> FXS_PLY_DURATION & 1;
    double frames = 0;
    if (fxs_ply_find(header, element, "f_t_0") >= 0)
        return fxs_fail(message, "%s: the full model of Spacetime Gaussians (f_t_*), whose colours need the network "
                        "beside it; the lite model is read", path);
    m->moves = 1;
    m->is_colour = !in_seconds && m->columns[TURN] >= 0 && fxs_ply_find(header, element, "f_rest_0") < 0;
    FXS_TRY(take(header, FXS_PLY_FPS, 1e-3, 1e6, &m->time.rate, path, message));
    FXS_TRY(take(header, FXS_PLY_N_FRAMES, 1, 1e9, &frames, path, message));
    m->unit = m->fade_unit = frames > 0 && m->time.rate > 0 && !in_seconds ? frames / m->time.rate : 1;
    m->time.duration = m->unit;
    FXS_TRY(take(header, FXS_PLY_DURATION, 1e-3, 1e6, &m->time.duration, path, message));
    FXS_TRY(take(header, FXS_PLY_START, -1e6, 1e6, &m->start, path, message));
    m->start = in_seconds ? m->start : 0;
    m->time.degree = m->columns[SECOND_DRIFT] >= 0 ? 3 : 1;
    m->time.turns = m->columns[TURN] >= 0;
    return 0;
}

/* FTGS raises opacities to a floor. A floor that is seen cannot be drawn. */
static int find_ftgs(fxs_ply_motion *m, const fxs_ply_header *header, const char *path, fxs_message *message)
{
    double version = 1, moves = 1, floor = 0, frames = 0;
    FXS_TRY(take(header, FXS_PLY_FTGS_VERSION, 1, 1, &version, path, message));
    FXS_TRY(take(header, FXS_PLY_USE_VELOCITY, 0, 1, &moves, path, message));
    FXS_TRY(take(header, FXS_PLY_OPACITY_FLOOR, 0, LEAST_SEEN, &floor, path, message));
    FXS_TRY(take(header, FXS_PLY_MIN_DURATION, 1e-9, 1e9, &m->least_fade, path, message));
    FXS_TRY(take(header, FXS_PLY_N_FRAMES, 1, 1e9, &frames, path, message));
    FXS_TRY(take(header, FXS_PLY_FPS, 1e-3, 1e6, &m->time.rate, path, message));
    m->moves = 1;
    m->unit = frames > 0 && m->time.rate > 0 ? fmax(frames - 1, 1) / m->time.rate : 1;
    m->time.duration = m->unit;
    m->fade_unit = SQRT_2 * m->unit;
    m->time.degree = moves > 0;
    return 0;
}

int fxs_ply_find_motion(fxs_ply_motion *m, const fxs_ply_header *header, const fxs_ply_element *element,
                        const char *path, fxs_message *message)
{
    m->time.loops = m->time.fades = 1;
    if (find_columns(m, header, element, spacetime_names, FXS_PLY_TIMES))
        return find_spacetime(m, header, element, path, message);
    if (!(header->given >> FXS_PLY_FTGS_VERSION & 1))
        return 0;
    if (find_columns(m, header, element, ftgs_names, FTGS_TIMES))
        return find_ftgs(m, header, path, message);
    for (int i = 0; i < FTGS_TIMES; i++)
        if (m->columns[i] < 0)
            return fxs_fail(message, "%s: an FTGS scene whose element vertex has no property %s", path, ftgs_names[i]);
    return 0;
}

void fxs_ply_motion_of(const fxs_ply_motion *m, const float numbers[FXS_PLY_TIMES], fxs_motion *out)
{
    double unit = 1;
    memset(out, 0, sizeof *out);
    for (int k = 0; k < m->time.degree; k++) {
        unit *= m->unit;
        for (int i = 0; i < 3; i++)
            out->drift[k][i] = (float)((double)numbers[DRIFT + 3 * k + i] / unit);
    }
    for (int i = 0; i < 4; i++)
        out->turn[i] = (float)((double)numbers[TURN + i] / m->unit);
    out->centre = (float)((double)numbers[CENTRE] * m->unit - m->start);
    const double fade = fxs_exp((double)numbers[FADE]);
    out->fade = (float)((fade < m->least_fade ? m->least_fade : fade) * m->fade_unit);
    out->from = -INFINITY;
    out->to = INFINITY;
}
