/* Draws words with SDL2_ttf and a font of the system. If either is missing, `words` is null, which has size 0 and draws
   nothing. For one thread. */
#ifndef FXS_WORDS_H
#define FXS_WORDS_H

#include <fixsplat/internal/message.h>
#include "overlay.h"

/* Returns 0 and words to close with fxs_words_close, or -1, null and a message. */
int fxs_words_open(fxs_words **words, fxs_message *message);
void fxs_words_close(fxs_words *words);

/* Sets the size for later words: line height without the gap, pixels. */
void fxs_words_resize(fxs_words *words, int pixels);

/* The line spacing, and the width of a text, pixels. */
int fxs_words_line(const fxs_words *words);
int fxs_words_width(const fxs_words *words, const char *text);

#endif
