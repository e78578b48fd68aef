/* Import: a scene file -> a packed scene (src/packed.h). */
#ifndef FXS_PACK_H
#define FXS_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "../../src/fixsplat.h"
#include "../files/message.h"
#include "../scene/scene_file.h"

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
    fxs_progress_fn *progress;   /* may be null; called on the caller's thread */
    void *argument;           /* first argument of progress */
    const fxs_allocator *allocator;   /* for all memory but that of the file's reader; may be null, else outlives it */
} fxs_pack_options;

/* Bytes of the packed scene of a file where none of its Gaussians is left out, to be known before it is read. 0: more
   than can be packed. */
size_t fxs_pack_bytes(const fxs_scene_file_info *info, enum fxs_profile profile);

/* Reads an open scene file from its start, three times, and packs it: one job of a run reads while the others work.
   `options` may be null. Needs 20 bytes a Gaussian before the packed scene is allocated, 5 beside it, and 3 MB; where
   there is a palette, 69 beside it, and 6 MB. Returns 0, or -1 and a message; a scene without a drawable Gaussian is an
   error.

   What is finite is drawn. An axis thinner than e^-9 of the Gaussian's largest is packed as that, which a view does not
   tell from less; ln(sigma) is cut to +-20. A centre beyond +-2^27 units is brought to there, towards the origin, and
   the axes in proportion: from near the origin it looks the same. */
int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene, fxs_pack_report *report,
             const fxs_pack_options *options, fxs_message *message);

/* Opacity times area: the product of the two largest sigmas, each within e^-20 to e^20. */
double fxs_weight(const fxs_gaussian *gaussian);

/* Whether fxs_pack takes a Gaussian with SH of this degree; where not, the reason is counted and its weight added. The
   weight of those it takes is for the caller to add. */
int fxs_drawable(const fxs_gaussian *gaussian, int sh_degree, fxs_pack_dropped *dropped);

/* The share of the weight that was left out, 0 to 1. */
double fxs_dropped_share(const fxs_pack_dropped *dropped);

/* Frees what fxs_pack allocated. */
void fxs_packed_scene_free(fxs_packed_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
