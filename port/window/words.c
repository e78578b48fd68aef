#include "words.h"

#include <stdlib.h>
#include <string.h>

#ifdef FXS_WITH_TTF
#include <SDL2/SDL_ttf.h>

#include "src/base/os_calls.h"

struct fxs_words {
    TTF_Font *font;
    int pixels;
};

int fxs_words_open(fxs_words **words, fxs_message *message)
{
    char font[4096];
    fxs_message why;
    *words = 0;
    if (fxs_font_find(font, sizeof font, &why))
        return fxs_fail(message, "no words in the window: %s", why.text);
    fxs_words *w = calloc(1, sizeof *w);
    if (!w)
        return fxs_fail(message, "no words in the window: out of memory");
    w->pixels = 14;
    if (!TTF_Init() && (w->font = TTF_OpenFont(font, w->pixels))) {
        *words = w;
        return 0;
    }
    fxs_fail(message, "no words in the window: %s: %s", font, TTF_GetError());
    fxs_words_close(w);
    return -1;
}

void fxs_words_close(fxs_words *words)
{
    if (!words)
        return;
    if (words->font)
        TTF_CloseFont(words->font);
    if (TTF_WasInit())
        TTF_Quit();
    free(words);
}

/* Changes the height of the font. Before SDL_ttf 2.0.18, a font has a fixed size. */
void fxs_words_resize(fxs_words *words, int pixels)
{
#if SDL_TTF_VERSION_ATLEAST(2, 0, 18)
    if (words && words->pixels != pixels && !TTF_SetFontSize(words->font, pixels))
        words->pixels = pixels;
#else
    (void)words, (void)pixels;
#endif
}

int fxs_words_line(const fxs_words *words)
{
    return words ? TTF_FontLineSkip(words->font) : 0;
}

int fxs_words_width(const fxs_words *words, const char *text)
{
    int width = 0;
    return words && *text && !TTF_SizeUTF8(words->font, text, &width, 0) ? width : 0;
}

/* Blends a colour over a picture, with opacities s, d and colours cs, cd of source and destination. The opacity becomes
   a = s + d (1 - s), the colour (s cs + d (1 - s) cd) / a. */
static void blend(uint8_t *below, const uint8_t colour[3], unsigned alpha)
{
    const unsigned rest = below[3] * (255 - alpha) / 255, sum = alpha + rest;
    for (int i = 0; i < 3 && sum; i++)
        below[i] = (uint8_t)((colour[i] * alpha + below[i] * rest) / sum);
    below[3] = (uint8_t)sum;
}

static void copy_words(const fxs_canvas *picture, int x, int y, const SDL_Surface *from, uint32_t colour)
{
    const uint8_t rgb[3] = {(uint8_t)(colour >> 24), (uint8_t)(colour >> 16), (uint8_t)(colour >> 8)};
    for (int row = y < 0 ? -y : 0; row < from->h && y + row < picture->height; row++)
        for (int column = x < 0 ? -x : 0; column < from->w && x + column < picture->width; column++) {
            const size_t pixel = (size_t)(y + row) * (size_t)picture->width + (size_t)(x + column);
            Uint32 argb;
            memcpy(&argb, (const Uint8 *)from->pixels + row * from->pitch + 4 * column, sizeof argb);
            blend(picture->rgba + 4 * pixel, rgb, (argb >> 24) * (colour & 255) / 255);
        }
}

void fxs_draw_words(fxs_words *words, const fxs_canvas *picture, int x, int y, const char *text, uint32_t colour)
{
    const SDL_Color white = {255, 255, 255, 255};
    SDL_Surface *surface = words && *text ? TTF_RenderUTF8_Blended(words->font, text, white) : 0;
    if (surface)
        copy_words(picture, x, y, surface, colour);
    SDL_FreeSurface(surface);
}
#else
int fxs_words_open(fxs_words **words, fxs_message *message)
{
    *words = 0;
    return fxs_fail(message, "no words in the window: built without SDL2_ttf");
}

void fxs_words_close(fxs_words *words) { (void)words; }

void fxs_words_resize(fxs_words *words, int pixels) { (void)words, (void)pixels; }

int fxs_words_line(const fxs_words *words) { return (void)words, 0; }

int fxs_words_width(const fxs_words *words, const char *text) { return (void)words, (void)text, 0; }

void fxs_draw_words(fxs_words *words, const fxs_canvas *picture, int x, int y, const char *text, uint32_t colour)
{
    (void)words, (void)picture, (void)x, (void)y, (void)text, (void)colour;
}
#endif
