/* Draws text with SDL2_ttf and a font of the system. Without SDL2_ttf or a font, `words` is null and nothing is drawn.
 * Only one thread may call these functions. */
#ifndef FXS_WORDS_H
#define FXS_WORDS_H

#include <fixsplat/internal/message.h>
#include "overlay.h"

/* Opens a font of the system. Returns 0 and the font in *words, or -1, a null *words and a message. */
int fxs_words_open(fxs_words **words, fxs_message *message);
void fxs_words_close(fxs_words *words);

/* Sets the height of a line of text in pixels, without the gap between lines. */
void fxs_words_resize(fxs_words *words, int pixels);

int fxs_words_line(const fxs_words *words);
int fxs_words_width(const fxs_words *words, const char *text);

#endif
