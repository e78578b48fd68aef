/* Draws words by SDL2_ttf and a font of the system. Where either is missing, the words are null, which have no size and
   draw nothing. For one thread. */
#ifndef FXS_WORDS_H
#define FXS_WORDS_H

#include <fixsplat/message.h>
#include "overlay.h"

/* Returns 0 and words for fxs_words_close, or -1, null and a message. */
int fxs_words_open(fxs_words **words, fxs_message *message);
void fxs_words_close(fxs_words *words);

/* Sets the size of later words: height of a line without its gap, in pixels. */
void fxs_words_resize(fxs_words *words, int pixels);

/* The distance between lines, and the width of a text, in pixels. */
int fxs_words_line(const fxs_words *words);
int fxs_words_width(const fxs_words *words, const char *text);

#endif
