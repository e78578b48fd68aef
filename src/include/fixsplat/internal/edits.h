/* Edits by hand: selects Gaussians of a packed scene by shapes, deletes them or all others, and takes edits back. A
 * list of edits, read from a JSON file, deletes the same Gaussians on every machine: shapes are compared in IEEE
 * doubles in a fixed order, masks in integers, and depths are those of a frame. */
#ifndef FXS_EDITS_H
#define FXS_EDITS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_EDITS_MOST 65534u           /* largest number of edits of a scene, and of shapes in a file of edits */
#define FXS_EDIT_NUMBERS_MOST 196608u   /* largest number of coordinates of a lasso or a brush */
#define FXS_EDIT_PIXELS_MOST (1u << 26) /* largest picture of a lasso or a brush */
#define FXS_BRUSH_MOST 1024             /* largest radius of a brush, pixels */
#define FXS_EDIT_OUTSIDE (1 << 20)      /* largest distance of a lasso or a brush from the picture's corner, pixels */

enum fxs_edit_kind { FXS_EDIT_BOX, FXS_EDIT_SPHERE, FXS_EDIT_LASSO, FXS_EDIT_BRUSH, FXS_EDIT_OBJECT, FXS_EDIT_KINDS };

#define FXS_EDIT_HINT 5             /* coordinates of a hint of an object */

/* A shape that selects the Gaussians with centres in it, or the Gaussians of an object. */
typedef struct fxs_edit_shape {
    enum fxs_edit_kind kind;
    int subtract;               /* 1: takes the Gaussians out of the selection instead */
    int front;                  /* lasso, brush: 1: leaves out Gaussians behind the surface that the picture shows: more
                                   than 1/32 deeper than the median depth of their pixel */
    double numbers[6];          /* box: least x, y, z and greatest; sphere: middle and radius; scene units */
    fxs_camera camera;          /* lasso, brush, object: camera of the picture, not cropped */
    /* Coordinates in the picture, pixels. Lasso: x, y of each corner of a polygon (even-odd rule). Brush: x, y and
       radius of each disc. A Gaussian's centre selects it if the centre of its pixel is inside. Object: clicks and
       boxes (fxs_select_hint of select.h), x, y, right, bottom and 1 for the object or 0 for something else. */
    const int32_t *points;
    uint32_t point_numbers;     /* number of coordinates, up to FXS_EDIT_NUMBERS_MOST */
} fxs_edit_shape;

/* State of a slot of the scene. */
typedef struct fxs_edit_slot {
    uint16_t edit;              /* number of the edit that deletes the Gaussian, from 1; 0: none */
    uint8_t opacity;            /* the Gaussian's opacity code */
    uint8_t flags;
} fxs_edit_slot;

typedef struct fxs_editor {
    fxs_scene scene;            /* the edited scene, without its levels of detail */
    fxs_edit_slot *slots;
    uint32_t count;             /* slots of the scene */
    uint32_t last, done;        /* number of edits, and of those that are not taken back */
    uint32_t left, chosen;      /* Gaussians that are not deleted, and those of them that are selected */
} fxs_editor;

/* Checksum of a scene's Gaussians: CRC-32 of the checksums of its chunks, which an .fxs has (fxs_file_seal). */
FXS_EXPERIMENTAL uint32_t fxs_edit_checksum(const fxs_scene *scene);

/* Begins to edit a packed scene. The scene's bytes must be writable: a deleted Gaussian has opacity code 0 in them, so
   frames show edits at once (call fxs_renderer_forget after an edit). Levels of detail are not edited: draw
   editor->scene. Takes 4 bytes a slot, which fxs_editor_close frees. Returns 0, or FXS_ERR_MEMORY and a message. */
FXS_EXPERIMENTAL int fxs_editor_open(fxs_editor *editor, const fxs_scene *scene, fxs_message *message);
FXS_EXPERIMENTAL void fxs_editor_close(fxs_editor *editor);

/* Adds the Gaussians in a shape to the selection, or takes them out of it. A shape with `front` renders a frame with
   `context`; an object takes the steps of select.h. After an error, the selection is as before. Errors:
   FXS_ERR_ARGUMENT (size of the picture or of a brush), and as fxs_render, fxs_select_mark and fxs_select. */
FXS_EXPERIMENTAL int fxs_editor_select(fxs_editor *editor, const fxs_context *context, const fxs_edit_shape *shape,
                                       fxs_message *message);

/* The same, but first takes back what the last shape did to the selection. */
FXS_EXPERIMENTAL int fxs_editor_replace(fxs_editor *editor, const fxs_context *context, const fxs_edit_shape *shape,
                                        fxs_message *message);
FXS_EXPERIMENTAL void fxs_editor_clear(fxs_editor *editor);

/* Deletes the selected Gaussians, or with `keep` all others, and clears the selection. Drops the edits that were taken
   back. Returns the number of deleted Gaussians, or FXS_ERR_ARGUMENT and a message if none or all would be deleted. */
FXS_EXPERIMENTAL int fxs_editor_act(fxs_editor *editor, int keep, fxs_message *message);

/* Takes edits back or does them again, until the first `done` edits are done. Clears the selection. */
FXS_EXPERIMENTAL void fxs_editor_go(fxs_editor *editor, uint32_t done);

FXS_EXPERIMENTAL int fxs_editor_deleted(const fxs_editor *editor, uint32_t slot);

/* Sets 2x2 pixels, RGBA8, of a picture at the centre of each selected Gaussian to `colour`. */
FXS_EXPERIMENTAL void fxs_editor_mark(const fxs_editor *editor, const fxs_camera *camera, uint32_t *pixels,
                                      uint32_t colour);

/* Size in bytes of the edited scene as an .fxs without levels of detail, and the scene itself, written to `out`
   (aligned to 64). `data` is the packed scene that was edited. The Gaussians that are left keep their codes. */
FXS_EXPERIMENTAL size_t fxs_editor_bytes(const fxs_editor *editor);
FXS_EXPERIMENTAL void fxs_editor_write(const fxs_editor *editor, const void *data, void *out);

/* A list of edits. Edit i acts on the selection by the shapes from edits[i].first to before edits[i].end. */
typedef struct fxs_edits {
    uint32_t gaussians, checksum;       /* the scene that the edits are for: its Gaussians and fxs_edit_checksum */
    struct {
        int keep;
        uint32_t first, end;
    } *edits;
    fxs_edit_shape *shapes;
    uint32_t count, shape_count;
} fxs_edits;

/* Reads a file of edits (docs/convert.md). fxs_edits_free frees the list, which is empty after an error. Errors:
   FXS_ERR_FILE, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED if fixsplat was built without cJSON. */
FXS_EXPERIMENTAL int fxs_edits_read(fxs_edits *edits, const char *path, fxs_message *message);
FXS_EXPERIMENTAL void fxs_edits_free(fxs_edits *edits);

/* Make a list: add a shape to the selection after the last edit, which is copied; drop shapes; or replace all edits
   after the first `done` by an edit of the selection. fxs_edits_write writes the first `done` edits of a list. */
FXS_EXPERIMENTAL int fxs_edits_add_shape(fxs_edits *edits, const fxs_edit_shape *shape, fxs_message *message);
FXS_EXPERIMENTAL void fxs_edits_drop_shapes(fxs_edits *edits, uint32_t first, uint32_t end);
FXS_EXPERIMENTAL int fxs_edits_add(fxs_edits *edits, uint32_t done, int keep, fxs_message *message);
FXS_EXPERIMENTAL int fxs_edits_write(const fxs_edits *edits, uint32_t done, const char *path, fxs_message *message);

/* Does all edits of a list. Errors: FXS_ERR_ARGUMENT for another scene, and as the functions above. */
FXS_EXPERIMENTAL int fxs_edits_do(const fxs_edits *edits, fxs_editor *editor, const fxs_context *context,
                                  fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
