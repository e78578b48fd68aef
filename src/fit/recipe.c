/* The recipes of a fit, which set learning rates and densification: reference (Kerbl et al. 2023 and its code of 2025),
 * mcmc (Kheradmand et al. 2024), and fast, which is mcmc with fewer steps. */
#include "recipe.h"

#include <math.h>
#include <string.h>

#include "src/fit/stages/fit_lanes.h"

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

float fxs_fit_extent(const fxs_fit_photo *photos, size_t count, const fxs_fit_point *points, size_t point_count)
{
    double mean[3] = {0, 0, 0}, middle[3] = {0, 0, 0}, largest = 0, nearness = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            mean[k] += photos[i].view.position[k] / (double)count;
    for (size_t i = 0; i < count; i++) {
        const double away = distance(photos[i].view.position, mean);
        largest = away > largest ? away : largest;
    }
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < point_count; i++)
            middle[k] += (double)points[i].position[k] / (double)point_count;
        nearness += fabs(mean[k]) * 1e-6;
    }
    if (largest <= nearness)
        largest = distance(mean, middle);
    return (float)(1.1 * (largest > nearness ? largest : 1));
}

float fxs_fit_first_opacity(enum fxs_fit_recipe recipe)
{
    return recipe == FXS_FIT_REFERENCE ? 0.1f : 0.5f;
}

float fxs_fit_first_scale(enum fxs_fit_recipe recipe)
{
    return recipe == FXS_FIT_REFERENCE ? 1.0f : 0.1f;
}

/* Returns the learning rate of positions, which falls to 1/100: first * 100^-(step / steps). */
static float position_rate(float first, uint32_t step, uint32_t steps)
{
    const float part = step < steps ? (float)step / (float)steps : 1.0f;
    return first * exp_e(-4.60517019f * part);
}

static void set_rates(fxs_fit_plan *plan, float position, float opacity, float sh)
{
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
        plan->rate[i] = i < FXS_FIT_SCALE      ? position
                        : i < FXS_FIT_ROTATION ? 0.005f
                        : i < FXS_FIT_OPACITY  ? 0.001f
                        : i < FXS_FIT_COLOUR   ? opacity
                        : i < FXS_FIT_SH       ? 0.0025f
                                               : sh;
}

static int is_every(uint32_t step, uint32_t interval, uint32_t after, uint32_t before)
{
    return step > after && step < before && step % interval == 0;
}

static int is_white(const uint8_t background[3])
{
    return background[0] == 255 && background[1] == 255 && background[2] == 255;
}

/* Returns true if opacities are reset after this step. The reference recipe resets them every 3,000 steps before step
   15,000; with a white background also after step 500. */
static int is_reset(const fxs_fit_options *options, uint32_t step)
{
    return options->recipe == FXS_FIT_REFERENCE &&
           (is_every(step, 3000, 0, 15000) || (step == 500 && is_white(options->background)));
}

/* Sets the learning rates of exposures and of camera poses. The rate of affine exposures falls as 10^-(step / steps),
   the poses' rate as 100^-(step / steps). At the beginning and after each reset of opacities, pictures do not yet
   match; there both rates rise from 0 over 500 steps. */
static void set_photograph_rates(const fxs_fit_options *options, uint32_t step, uint32_t steps, fxs_fit_plan *plan)
{
    const float part = step < steps ? (float)step / (float)steps : 1.0f;
    uint32_t since = 1;
    if ((!options->exposure && !options->refine_poses) || options->blocks)
        return;
    while (since < 500 && since < step && !is_reset(options, step - since))
        since++;
    if (options->exposure)
        plan->gain_part = (float)since / 500.0f;
    if (options->exposure == FXS_FIT_EXPOSURE_AFFINE)
        plan->gain_part *= exp_e(-2.30258509f * part);
    if (options->refine_poses && step > 500 && options->steps > 500)
        plan->pose_way = position_rate(0.1f, step - 500, options->steps - 500) * ((float)since / 500.0f);
}

/* Sets the plan of a step by the reference recipe, which has 30,000 steps. A shorter fit makes the first of these
   steps; a longer one stretches only the falling learning rates. */
static void plan_reference(const fxs_fit_options *options, float extent, uint32_t step, fxs_fit_plan *plan)
{
    const uint32_t steps = options->steps > 30000 ? options->steps : 30000;
    set_rates(plan, position_rate(1.6e-4f * extent, step, steps), 0.025f, 0.000125f);
    plan->sh_degree = (int)(step / 1000);
    plan->densify = is_every(step, 100, 500, 15000);
    plan->large = step > 3000 ? 0.1f * extent : INFINITY;
    plan->reset = is_reset(options, step);
    set_photograph_rates(options, step, steps, plan);
    plan->order = plan->densify && step % 1000 == 0;
}

static uint32_t from_1_to(uint32_t most, uint32_t x)
{
    return x < 1 ? 1 : x < most ? x : most;
}

static uint32_t relocation_interval(const fxs_fit_options *options)
{
    return from_1_to(100, options->steps / 80);
}

static int is_relocated(const fxs_fit_options *options, uint32_t step)
{
    const uint32_t interval = relocation_interval(options);
    return is_every(step, interval, 3 * interval, options->steps / 5 * 4);
}

/* Lets all learning rates but those of positions fall to 1/20 in the last tenth of the steps: first 20^-part. */
static void lower_rates(uint32_t step, uint32_t steps, fxs_fit_plan *plan)
{
    const uint32_t last = steps / 10, first = steps - last;
    const float part = step > first ? (float)(step - first) / (float)last : 0.0f, share = exp_e(-2.99573227f * part);
    for (int i = FXS_FIT_SCALE; i < FXS_FIT_PARAMETERS; i++)
        plan->rate[i] *= share;
}

static void plan_mcmc(const fxs_fit_options *options, float extent, uint32_t step, int least_side, fxs_fit_plan *plan)
{
    const uint32_t steps = options->steps;
    set_rates(plan, position_rate(1.6e-4f * extent, step, steps), 0.05f, 0.00025f);
    lower_rates(step, steps, plan);
    plan->sh_degree = (int)(step / from_1_to(1000, steps / 16));
    plan->divisor = step <= steps / 10 ? 4 : step <= steps / 10 * 3 ? 2 : 1;
    while (plan->divisor > 1 && least_side / plan->divisor < 50)
        plan->divisor /= 2;
    plan->by_opacity = plan->by_scale = 0.01f;
    plan->noise = 5e5f * plan->rate[FXS_FIT_POSITION];
    plan->relocate = is_relocated(options, step);
    set_photograph_rates(options, step, steps, plan);
    plan->order = plan->relocate && step % (5 * relocation_interval(options)) == 0;
}

double fxs_fit_growth(const fxs_fit_options *options, uint32_t step)
{
    const uint32_t interval = relocation_interval(options);
    double factor = 1;
    for (uint32_t at = interval; at <= step && options->recipe != FXS_FIT_REFERENCE; at += interval)
        factor *= is_relocated(options, at) ? 1.05 : 1;
    return factor;
}

/* Returns true if scales are raised to their lower limit in this step. That happens in step 1, as Gaussians smaller
   than a pixel would start too faint, and every 100 steps. It also happens before the last tenth, which quantises
   scales, and at the end. */
static int is_smoothed(const fxs_fit_options *options, uint32_t step)
{
    const uint32_t steps = options->steps;
    return options->antialiased && (step == 1 || step % 100 == 0 || step == steps - steps / 10 || step == steps);
}

/* Sets how a step fits surfaces (fit_surface.h), after 7/30 of the steps as in Huang et al. 2024. Every 4 steps, either
   normals or positions are compared with the depths, in turn. */
static void plan_surfaces(const fxs_fit_options *options, uint32_t step, fxs_fit_plan *plan)
{
    if (!options->surfaces || step <= (uint64_t)options->steps * 7 / 30)
        return;
    plan->by_flat = 0.1f;
    plan->is_depth = step / 4 % 2;
    plan->by_surface = step % 4 ? 0 : plan->is_depth ? 0.4f : 0.3f;
}

void fxs_fit_plan_step(const fxs_fit_options *options, float extent, uint32_t step, int least_side,
                       fxs_fit_plan *plan)
{
    memset(plan, 0, sizeof *plan);
    plan->divisor = 1;
    plan->large = INFINITY;
    if (options->recipe == FXS_FIT_REFERENCE)
        plan_reference(options, extent, step, plan);
    else
        plan_mcmc(options, extent, step, least_side, plan);
    plan_surfaces(options, step, plan);
    plan->smooths = is_smoothed(options, step) ? plan->divisor : 0;
    plan->sh_degree = plan->sh_degree < options->sh_degree ? plan->sh_degree : options->sh_degree;
}
