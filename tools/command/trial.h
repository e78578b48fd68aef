/* The trial by which --backend auto chooses: each back end draws the same frames of a small procedural scene, and the
   result is kept in a text file. */
#ifndef TRIAL_H
#define TRIAL_H

#include <fixsplat/backend.h>

enum { TRIAL_MOST = 8, TRIAL_TEXT = 128, TRIAL_KEY = 512 };

/* What a trial says of a back end. TRIAL_BEGUN is kept while a back end draws, so a driver that ends the process is not
   tried again. TRIAL_SLOW: far slower than the processor, so its large frame was left out. Only an exact back end is
   chosen. */
enum trial_state { TRIAL_ABSENT, TRIAL_BEGUN, TRIAL_FAILED, TRIAL_DIFFERS, TRIAL_SLOW, TRIAL_EXACT };

typedef struct trial_result {
    const fxs_backend *backend;
    enum trial_state state;
    uint32_t open_us, frame_us;    /* time to open the device, and median time of a frame as the host sees it,
                                      microseconds; of TRIAL_SLOW of a small frame */
    char text[TRIAL_TEXT];         /* name of the device, or why it is absent or failed */
} trial_result;

typedef struct trial {
    trial_result results[TRIAL_MOST];      /* the processor first */
    int count;
} trial;

/* Tries the back ends, of which the first is the processor. Calls `keep` before and after each of them; it may be
   null. */
void trial_run(trial *t, const fxs_backend *const *backends, int count, void (*keep)(void *argument, const trial *t),
               void *argument);

/* Returns the fastest exact back end with all features `can` (FXS_CAN_*), the first back end if there is none. */
const trial_result *trial_fastest(const trial *t, unsigned can);

/* Writes the file of a trial, with a key: one line that names the machine. Reads it: returns -1 for a missing or broken
   file, one with another key, or one of other back ends. */
int trial_write(const trial *t, const char *path, const char *key, fxs_message *why);
int trial_read(trial *t, const fxs_backend *const *backends, int count, const char *path, const char *key);

#endif
