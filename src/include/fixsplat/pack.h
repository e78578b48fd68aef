/* Packs the Gaussians of a scene file into a packed scene (internal/packed.h).
 *
 * To pack Gaussians in memory, open them with fxs_scene_file_open_gaussians. Several threads may pack scenes at the
 * same time, each from its own file. */
#ifndef FXS_PACK_H
#define FXS_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Differences between the Gaussians of the file and those in the packed scene, by attribute. */
typedef struct fxs_pack_error {
    double position;          /* scene units */
    double scale;             /* ln(sigma) */
    double rotation;          /* degrees */
    double opacity;           /* 0..1 */
    double dc, sh;            /* error of the SH coefficients of degree 0 (dc) and above (sh); with an SH palette, `sh`
                                 is only exact to 1/254 of the Gaussian's largest coefficient */
} fxs_pack_error;

typedef struct fxs_pack_report {
    uint64_t read, packed;
    fxs_pack_dropped dropped;
    uint64_t brought_in;      /* number of Gaussians that fxs_pack moved in from beyond +-2^27 units */
    fxs_pack_error largest, rms;   /* largest errors, and errors as root mean square over all numbers of an attribute */
    double low[3], high[3];   /* bounds of the Gaussians' centres */
    double inner_low[3], inner_high[3];   /* bounds of the visible part of the scene, for framing a first view:
                                             docs/format.md */
    uint64_t limited;         /* number of moving Gaussians with a motion that was limited to the range of its codes */
} fxs_pack_report;

typedef struct fxs_packed_scene {
    void *data;               /* the packed scene for fxs_scene_open, aligned to 64 */
    size_t bytes;
    void *allocation;         /* the memory block that fxs_packed_scene_free releases */
    const fxs_allocator *allocator;
} fxs_packed_scene;

/* Options of fxs_pack. The defaults: default profile, one thread, no progress, malloc, no tree. */
typedef struct fxs_pack_options {
    uint32_t size;
    enum fxs_profile profile;
    fxs_workers workers;
    fxs_progress progress;    /* progress callback; it runs on the thread that called fxs_pack */
    const fxs_allocator *allocator;   /* allocator for all memory except the file reader's; null: malloc. Must outlive
                                         the scene */
    int tree;                 /* 1: adds a tree of levels of detail over the chunks, if the scene has two chunks or
                                 more. The packed scene becomes about twice as large. Building the tree takes 6 MB, 2 MB
                                 a thread and 120 bytes a chunk more */
    uint32_t unused;               /* 0: room for a field of a later version */
    uint32_t *slots;          /* receives the slot of each Gaussian of the file, as in fxs_id; FXS_NOTHING if it is
                                 dropped. Has room for info->count numbers; null: not wanted */
} fxs_pack_options;
FXS_INIT(fxs_pack_options)

/* Returns the size in bytes of a file's packed scene without a tree, if no Gaussian is dropped and all chunks (256
   Gaussians) are full. The size is known before the Gaussians are read. Isolated Gaussians far beyond the others need
   extra chunks, at most 8 each. Returns 0 if the file has too many Gaussians. */
FXS_API size_t fxs_pack_bytes(const fxs_scene_file_info *info, enum fxs_profile profile);

/* Packs an open scene file. It reads the file from its start three times; with an SH palette, once more for each
   further 2^24 Gaussians beyond the first 2^24. `info` was filled in when the file was opened, or updated by a filter.
   `options` may be null. One job reads the file, on any thread of the pool, while other jobs compute. Memory: 20 bytes
   a Gaussian before the packed scene is allocated; then 5 bytes a Gaussian and 3 MB besides the packed scene. An SH
   palette takes 64 bytes a Gaussian more, for at most 2^24 Gaussians (1.1 GB), and 6 MB.

   Every finite Gaussian is packed in a form that can be drawn. An axis thinner than e^-9 of the Gaussian's largest axis
   is widened to e^-9 of it; no camera shows the difference. ln(sigma) is clamped to +-20. A centre beyond +-2^27 units
   is moved to that distance, towards the origin, and the axes shrink in proportion, so that the Gaussian looks the same
   from near the origin.

   Returns 0 and a scene that fxs_packed_scene_free frees, or an error and a message, with a scene that is all 0.
   Errors: as fxs_scene_file_read; FXS_ERR_FILE if the file has no drawable Gaussian, more than FXS_MAX_COUNT, or
   different Gaussians from one pass to the next; FXS_ERR_STOPPED by `progress`; FXS_ERR_ARGUMENT (the profile, the SH
   degree); FXS_ERR_MEMORY. */
FXS_API int fxs_pack(fxs_scene_file *file, const fxs_scene_file_info *info, fxs_packed_scene *scene,
                     fxs_pack_report *report, const fxs_pack_options *options, fxs_message *message);

/* Returns 1 if fxs_pack keeps a Gaussian, with SH up to the given degree. Otherwise returns 0, counts the reason in
   `dropped` and adds the Gaussian's weight to dropped->weight. The caller adds the weights of kept Gaussians to
   dropped->kept. */
FXS_API int fxs_drawable(const fxs_gaussian *gaussian, int sh_degree, fxs_pack_dropped *dropped);

/* Frees a scene that fxs_pack made and sets it to 0. A scene that is all 0 is allowed. */
FXS_API void fxs_packed_scene_free(fxs_packed_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
