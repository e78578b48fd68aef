/* Loads libheif at run time, on first use, because it depends on a dozen libraries. */
#ifndef FXS_HEIF_LIBRARY_H
#define FXS_HEIF_LIBRARY_H

#include <libheif/heif.h>

#define FXS_HEIF_FUNCTIONS(use) \
    use(heif_init) \
    use(heif_context_alloc) \
    use(heif_context_free) \
    use(heif_context_set_maximum_image_size_limit) \
    use(heif_context_set_max_decoding_threads) \
    use(heif_context_read_from_memory_without_copy) \
    use(heif_context_get_primary_image_handle) \
    use(heif_image_handle_release) \
    use(heif_image_handle_get_width) \
    use(heif_image_handle_get_height) \
    use(heif_image_handle_get_list_of_metadata_block_IDs) \
    use(heif_image_handle_get_metadata_size) \
    use(heif_image_handle_get_metadata) \
    use(heif_image_handle_get_nclx_color_profile) \
    use(heif_decoding_options_alloc) \
    use(heif_decoding_options_free) \
    use(heif_decode_image) \
    use(heif_image_get_width) \
    use(heif_image_get_height) \
    use(heif_image_get_bits_per_pixel_range) \
    use(heif_image_get_plane_readonly) \
    use(heif_image_get_nclx_color_profile) \
    use(heif_nclx_color_profile_free) \
    use(heif_image_is_premultiplied_alpha) \
    use(heif_image_release)

typedef struct fxs_heif_library {
#define FXS_HEIF_FIELD(name) __typeof__(&(name)) name;
    FXS_HEIF_FUNCTIONS(FXS_HEIF_FIELD)
#undef FXS_HEIF_FIELD
} fxs_heif_library;

/* Returns libheif's functions, or NULL if libheif is not installed. */
const fxs_heif_library *fxs_heif_library_open(void);

#endif
