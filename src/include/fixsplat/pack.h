/* Import: a scene file -> a packed scene (src/include/fixsplat/packed.h).
 *
 * A program that has Gaussians of its own opens them with fxs_scene_file_open_gaussians. Scenes may be packed at the
 * same time by several threads, each from a file of its own. */
#ifndef FXS_PACK_H
#define FXS_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "allocator.h"
#include "gaussian.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Gaussians that no rule can draw and that were left out, by reason; what they and the others weigh. */
typedef struct fxs_pack_dropped {
    uint64_t not_finite;      /* a value is NaN or infinite; but ln(sigma) may be minus infinity */
    uint64_t rotation;        /* the quaternion is zero */
    double weight, kept;      /* sums of fxs_weight: of those left out, and of the others */
} fxs_pack_dropped;

/* Differences between what was read and what the packed scene says. */
typedef struct fxs_pack_error {
    double position;          /* scene units */
    double scale;             /* ln(sigma) */
    double rotation;          /* degrees */
    double opacity;           /* 0..1 */
    double dc, sh;            /* coefficients; sh with a palette: within half a 127th of a Gaussian's largest */
} fxs_pack_error;

typedef struct fxs_pack_report {
    uint64_t read, packed;
    fxs_pack_dropped dropped;
    uint64_t brought_in;      /* packed from beyond +-2^27 units: see fxs_pack */
    fxs_pack_error largest, rms;   /* rms: root mean square, of all numbers of an attribute */
    double low[3], high[3];   /* bounds of the centres */
    double inner_low[3], inner_high[3];   /* of what is seen, to frame a scene: see docs/format.md */
} fxs_pack_report;

typedef struct fxs_packed_scene {
    void *data;               /* aligned to 64, for fxs_scene_open */
    size_t bytes;
    void *allocation;         /* what fxs_packed_scene_free frees */
    const fxs_allocator *allocator;
} fxs_packed_scene;

/* All 0: profile default, one thread, no progress, malloc. */
typedef struct fxs_pack_options {
    enum fxs_profile profile;
    fxs_run_fn *run;          /* null: one thread, the caller's */
    void *pool;               /* first argument of run */
    uint32_t threads;         /* threads that run uses, 1 to 64; 0: 1. The packed scene does not depend on it */
    fxs_progress_fn *progress;   /* may be null; called on the thread that called fxs_pack */
    void *argument;           /* first argument of progress */
    const fxs_allocator *allocator;   /* for all memory but that of the file's reader; may be null, else outlives it */
} fxs_pack_options;

/* The bytes of a file's packed scene where none of its Gaussians is left out. It is known before they are read. 0:
   there are more than can be packed. */
size_t fxs_pack_bytes(const fxs_scene_file_info *info, enum fxs_profile profile);

/* Reads an open scene file from its start, three times, and packs it. `info` is what was filled in when the file was
   opened, or what a filter made of it. `options` may be null. One job reads, on any of the pool's threads, while the
   others work. Before the packed scene is allocated this takes 20 bytes a Gaussian, and beside it 5 bytes a Gaussian
   and 3 MB; where there is a palette, 69 bytes a Gaussian and 6 MB.

   What is finite is packed so that it can be drawn. An axis thinner than e^-9 of the Gaussian's largest becomes that,
   which no camera tells from less, and ln(sigma) is cut to +-20. A centre beyond +-2^27 units is brought to there,
   towards the origin, and the axes in proportion: from near the origin it looks the same.

   Returns 0 and a scene that fxs_packed_scene_free frees, or an error and a message, with a scene that is all 0.
   Errors: those of fxs_scene_file_read; FXS_ERR_FILE where the file has no Gaussian that can be drawn or more than
   FXS_MAX_COUNT, or where it changed from one reading to the next; FXS_ERR_STOPPED by `progress`; FXS_ERR_ARGUMENT
   (the profile, the SH degree); FXS_ERR_MEMORY. */
int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene, fxs_pack_report *report,
             const fxs_pack_options *options, fxs_message *message);

/* Opacity times area: the product of the two largest sigmas, each within e^-20 to e^20. */
double fxs_weight(const fxs_gaussian *gaussian);

/* Whether fxs_pack takes a Gaussian with SH of this degree; where not, the reason is counted and its weight added. The
   weight of those it takes is for the caller to add. */
int fxs_drawable(const fxs_gaussian *gaussian, int sh_degree, fxs_pack_dropped *dropped);

/* The share of the weight that was left out, 0 to 1. */
double fxs_dropped_share(const fxs_pack_dropped *dropped);

/* Frees what fxs_pack allocated, and sets the scene to 0. A scene that is all 0 is allowed. */
void fxs_packed_scene_free(fxs_packed_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
