/* Plays scenes that move: the time of the pictures, its keys, and the time bar at the lower edge of the window. */
#include <math.h>
#include <stdio.h>

#include <fixsplat/system.h>
#include "tools/command/frame_times.h"
#include "viewer.h"

/* BAR and BAR_REACH in points of the screen; STEP_RATE: frames a second of a scene whose motion is continuous. */
enum { BAR = 8, BAR_REACH = 14, STEP_RATE = 30 };

#define SPEED_MOST 8.0
#define SLOW_NS 50000000ull     /* frames of full size that take longer are drawn smaller while the scene plays */

static void show_moment(viewer *v, double seconds)
{
    playback *p = &v->play;
    const double end = p->time.duration;
    if (p->loops)
        p->at = seconds - floor(seconds / end) * end;
    else
        p->at = fmin(fmax(seconds, 0), end);
    v->options.render.time_q32 = seconds_q32(p->at);
    v->changed = v->exposed = 1;
}

void play_begin(viewer *v, int is_new)
{
    playback *p = &v->play;
    const double start = is_new ? 0 : ldexp((double)v->options.render.time_q32, -32);
    *p = (playback){.time = world_time(&v->world), .speed = 1, .clock = fxs_clock(0)};
    if (!(p->time.duration > 0))
        return;
    p->loops = p->time.loops;
    p->on = is_new || !is_given("time");
    show_moment(v, start);
}

int play_moves(const viewer *v)
{
    return v->path && v->play.time.duration > 0;
}

void play_toggle(viewer *v, int key)
{
    playback *p = &v->play;
    (void)key;
    p->on = !p->on;
    p->slow = 0;
    p->clock = fxs_clock(0);
    if (p->on && !p->loops && p->at >= p->time.duration)
        show_moment(v, 0);
    v->changed = 1;
}

void play_step_frame(viewer *v, int key)
{
    playback *p = &v->play;
    const double rate = p->time.rate > 0 ? p->time.rate : STEP_RATE;
    p->on = 0;
    show_moment(v, time_within(floor(p->at * rate + 0.5) + (key == ',' ? -1 : 1), rate));
}

void play_change_speed(viewer *v, int key)
{
    playback *p = &v->play;
    p->speed = fmin(fmax(p->speed * (key == '[' ? 0.5 : 2), 1 / SPEED_MOST), SPEED_MOST);
}

void play_toggle_loop(viewer *v, int key)
{
    (void)key;
    v->play.loops = !v->play.loops;
    snprintf(v->note, sizeof v->note, v->play.loops ? "again and again" : "once");
}

uint64_t play_due(const viewer *v)
{
    return v->play.on && !v->play.dragged && !v->request_count ? v->play.clock + PLAY_MS * 1000000ull : 0;
}

void play_advance(viewer *v, uint64_t now)
{
    playback *p = &v->play;
    const double passed = (double)(now - p->clock) * 1e-9 * p->speed;
    if (!p->on || now < p->clock + PLAY_MS * 1000000ull)
        return;
    p->clock = now;
    if (p->dragged)
        return;
    p->on = p->loops || p->at + passed < p->time.duration;
    show_moment(v, p->at + passed);
}

void play_take_time(viewer *v, uint64_t nanoseconds, int divisor)
{
    if (v->play.on && divisor == 1 && nanoseconds > SLOW_NS)
        v->play.slow = 1;
}

void play_words(const viewer *v, char *text, size_t size)
{
    const playback *p = &v->play;
    char speed[32] = "";
    if (p->speed < 1 || p->speed > 1)
        snprintf(speed, sizeof speed, ", %gx", p->speed);
    snprintf(text, size, "%.2f of %.2f s%s%s", p->at, p->time.duration, speed, p->on ? "" : ", paused");
}

void play_bar(const viewer *v, int bar[4])
{
    const int scale = (int)lround(fxs_window_scale(v->window));
    int width, height;
    fxs_window_size(v->window, &width, &height);
    bar[0] = 0;
    bar[1] = height - BAR * scale;
    bar[2] = width;
    bar[3] = BAR * scale;
}

static void seek(viewer *v, double x)
{
    int bar[4];
    play_bar(v, bar);
    const double part = fmin(fmax(x / bar[2], 0), 1 - 1e-9);
    show_moment(v, part * v->play.time.duration);
}

int play_press(viewer *v, double x, double y)
{
    int bar[4];
    play_bar(v, bar);
    v->play.dragged = play_moves(v) && y >= bar[1] - (BAR_REACH - BAR) * fxs_window_scale(v->window);
    if (v->play.dragged)
        seek(v, x);
    return v->play.dragged;
}

int play_drag(viewer *v, const fxs_window_event *event)
{
    v->play.dragged = v->play.dragged && event->left;
    if (v->play.dragged)
        seek(v, event->x);
    return v->play.dragged;
}

int play_release(viewer *v)
{
    const int dragged = v->play.dragged;
    v->play.dragged = 0;
    v->play.clock = fxs_clock(0);
    return dragged;
}

void play_undo_space(viewer *v)
{
    if (v->play.spaced)
        play_toggle(v, ' ');
    v->play.spaced = 0;
}
