/* The sound of a moving scene's file. Reading it is up to the reader of the format. */
#include <fixsplat/internal/sound.h>

#include <string.h>

#include "src/base/os_calls.h"
#include "src/gaussian/stream_internal.h"

/* The first row of a media type has its usual ending. Source: OpsiClear-4DGS, "TSOG Playback Profile 1", section 9. */
static const char *const kinds[][2] = {
    {"audio/mpeg", ".mp3"}, {"audio/mp4", ".m4a"}, {"audio/aac", ".aac"}, {"audio/ogg", ".ogg"}, {"audio/ogg", ".oga"},
    {"audio/ogg", ".opus"}, {"audio/wav", ".wav"}, {"audio/flac", ".flac"}, {"audio/webm", ".webm"}
};

int fxs_sound_kind(fxs_sound *sound, const char *name, const char *type)
{
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (type ? !strcasecmp(type, kinds[i][0]) : fxs_ends_in(name, kinds[i][1])) {
            sound->type = kinds[i][0];
            sound->ending = kinds[i][1];
            return 1;
        }
    return type && !strncasecmp(type, "audio/", 6) && fxs_sound_kind(sound, name, NULL);
}

int fxs_scene_file_sound(fxs_scene_file *file, fxs_sound *sound, fxs_message *message)
{
    fxs_text text;
    *sound = (fxs_sound){.volume = 1};
    const int found = file->import.sound ? file->import.sound(file->import.reader, sound, &text, message) : 0;
    if (found <= 0)
        return found;
    sound->data = text.data;
    sound->bytes = text.size;
    if (sound->bytes)
        return 1;
    fxs_sound_free(file, sound);
    return fxs_fail(message, "%s: an empty sound", file->source.path);
}

void fxs_sound_free(fxs_scene_file *file, fxs_sound *sound)
{
    fxs_text_let_go(&file->source, &(fxs_text){NULL, sound->data, sound->bytes});
    sound->data = NULL;
}
