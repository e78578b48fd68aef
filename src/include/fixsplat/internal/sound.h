/* Reads the sound of a moving scene from its file. */
#ifndef FXS_INTERNAL_SOUND_H
#define FXS_INTERNAL_SOUND_H

#include <fixsplat/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The sound of a moving scene: an audio file that begins at time 0 of the scene. */
typedef struct fxs_sound {
    const char *type;     /* media type, such as audio/mpeg; a static string */
    const char *ending;   /* usual ending of the names of such files, such as .mp3; a static string */
    double volume;        /* 0 to 1 */
    void *data;           /* the audio file */
    size_t bytes;
} fxs_sound;

/* Reads the sound of an open file of a moving scene. Returns 1; 0 if the file has none; or an error and a message. The
   sound stays valid until fxs_sound_free, before the file is closed. Errors: FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_scene_file_sound(fxs_scene_file *file, fxs_sound *sound, fxs_message *message);

FXS_EXPERIMENTAL void fxs_sound_free(fxs_scene_file *file, fxs_sound *sound);

/* Sets type and ending by a media type or, if it is null or another audio type than the known ones, by the ending of a
   file name. Returns 1, or 0 if the sound is of no known type: mp3, m4a, aac, ogg, opus, wav, flac or webm. */
FXS_EXPERIMENTAL int fxs_sound_kind(fxs_sound *sound, const char *name, const char *type);

#ifdef __cplusplus
}
#endif

#endif
