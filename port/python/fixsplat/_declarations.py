"""What the library's headers declare, as far as this package needs it: constants and structs by their names in C.

tests/python/layout.py compares each of them with the C compiler.
"""
from __future__ import annotations

from ctypes import (CFUNCTYPE, POINTER, LittleEndianStructure, Structure, c_char, c_char_p, c_double, c_float, c_int,
                    c_int32, c_int64, c_long, c_size_t, c_ssize_t, c_uint, c_uint8, c_uint32, c_uint64, c_void_p)
from typing import Any

# ---- src/include/fixsplat/fixsplat.h, src/include/fixsplat/packed.h ------------------------------------------------------------------------------------

FXS_MAX_SIZE = 16384
FXS_MAX_COUNT = 1 << 30
FXS_MAX_OBJECTS = 65536
FXS_MAX_CROPS = 8
FXS_NOTHING = 0xffffffff
FXS_ERR_ARGUMENT = -1
FXS_ERR_DEVICE = -8
FXS_ERR_FILE = -11
FXS_PERSPECTIVE = 0
FXS_ORTHOGRAPHIC = 1
FXS_FORMAT_RGBA8 = 0
FXS_FORMAT_RGBA8_COVERAGE = 1
FXS_PROFILE_DEFAULT = 0
FXS_PROFILE_COMPACT = 1
FXS_PROFILE_SMALL = 2
FXS_CUTOFF_MAHALANOBIS = 0
FXS_CUTOFF_SQUARE = 1
FXS_PACKED_MAGIC = 0x31535846
FXS_PACKED_ANTIALIASED = 1


class fxs_message(Structure):
    _fields_ = [("text", c_char * 512), ("bytes_needed", c_uint64)]


class fxs_scene(Structure):
    _fields_ = [("chunks", c_void_p), ("rows", c_void_p), ("palette", c_void_p), ("profile", c_uint),
                ("count", c_uint32), ("chunk_count", c_uint32), ("chunk_bytes", c_uint32),
                ("palette_entries", c_uint32), ("palette_step_q19", c_uint32), ("sh_degree", c_int),
                ("antialiased", c_int)]


class fxs_packed_header(LittleEndianStructure):
    _fields_ = [("magic", c_uint32), ("version", c_uint32), ("count", c_uint32), ("chunk_count", c_uint32),
                ("chunk_bytes", c_uint32), ("sh_degree", c_uint32), ("flags", c_uint32), ("checksum", c_uint32),
                ("low_q32", c_int64 * 3), ("high_q32", c_int64 * 3), ("inner_low_q32", c_int64 * 3),
                ("inner_high_q32", c_int64 * 3), ("profile", c_uint32), ("palette_entries", c_uint32),
                ("palette_step_q19", c_uint32), ("palette_checksum", c_uint32), ("reserved", c_uint32 * 12)]


class fxs_crop(Structure):
    _fields_ = [("low_q32", c_int64 * 3), ("high_q32", c_int64 * 3), ("outside", c_int)]


class fxs_object(Structure):
    _fields_ = [("scene", POINTER(fxs_scene)), ("rotation_q30", c_int32 * 9), ("translation_q32", c_int64 * 3),
                ("scale_q32", c_int64), ("opacity_q16", c_uint32), ("tint_q13", c_uint32 * 3), ("visible", c_int),
                ("id", c_uint32), ("crops", POINTER(fxs_crop)), ("crop_count", c_uint32)]


class fxs_camera(Structure):
    _fields_ = [("width", c_int32), ("height", c_int32), ("fx_q12", c_int32), ("fy_q12", c_int32),
                ("cx_q12", c_int32), ("cy_q12", c_int32), ("rotation_q30", c_int32 * 9), ("position_q32", c_int64 * 3),
                ("near_q32", c_int64), ("projection", c_uint), ("whole_width", c_int32), ("whole_height", c_int32),
                ("whole_x", c_int32), ("whole_y", c_int32), ("hidden_x", c_int32), ("hidden_y", c_int32),
                ("hidden_width", c_int32), ("hidden_height", c_int32)]


fxs_stop_fn: Any = CFUNCTYPE(c_int, c_void_p)


class fxs_options(Structure):
    _fields_ = [("cutoff", c_uint), ("sh_degree", c_int), ("background", c_uint8 * 3), ("stop", fxs_stop_fn),
                ("stop_argument", c_void_p)]


class fxs_image(Structure):
    _fields_ = [("pixels", c_void_p), ("stride", c_ssize_t)]


class fxs_targets(Structure):
    _fields_ = [("colour", fxs_image), ("format", c_uint), ("coverage", fxs_image), ("mean_depth", fxs_image),
                ("median_depth", fxs_image), ("id", fxs_image), ("depth_bits", c_int), ("occluder", fxs_image),
                ("backdrop", fxs_image)]


# ---- src/include/fixsplat/backend.h ---------------------------------------------------------------------------------------------------

FXS_CAN_EXACT = 1
FXS_CAN_TRACE = 2
FXS_CAN_COMPOSE = 4
FXS_CAN_DEVICES = 16


class fxs_backend_options(Structure):
    _fields_ = [("device", c_int), ("max_memory", c_uint64), ("threads", c_uint32), ("without_cpu", c_uint)]


class fxs_request(Structure):
    _fields_ = [("objects", POINTER(fxs_object)), ("count", c_uint32), ("options", POINTER(fxs_options)),
                ("eyes", c_uint32), ("cameras", POINTER(fxs_camera)), ("targets", POINTER(fxs_targets)),
                ("exact", c_int)]


class fxs_backend(Structure):
    _fields_ = [("name", c_char_p), ("does", c_char_p), ("can", c_uint),
                ("device", CFUNCTYPE(c_int, c_int, c_char_p, c_size_t, POINTER(fxs_message))),
                ("open", CFUNCTYPE(c_int, POINTER(c_void_p), POINTER(fxs_backend_options), POINTER(fxs_message))),
                ("render", CFUNCTYPE(c_int, c_void_p, POINTER(fxs_request), c_void_p, POINTER(fxs_message))),
                ("forget", CFUNCTYPE(None, c_void_p, POINTER(fxs_scene))),
                ("version", c_void_p), ("nanoseconds", c_void_p), ("close", CFUNCTYPE(None, c_void_p)),
                ("pick", c_void_p)]


# ---- port/scene, port/import, port/posix -----------------------------------------------------------------------------

FXS_AXES_OF_FILE = 0
FXS_AXES_RUB = 1
FXS_AXES_RDF = 2

fxs_progress_fn: Any = CFUNCTYPE(c_int, c_void_p, c_double)


class fxs_gaussian(Structure):
    _fields_ = [("position", c_float * 3), ("scale", c_float * 3), ("rotation", c_float * 4), ("opacity", c_float),
                ("dc", c_float * 3), ("sh", c_float * 45)]


class fxs_grid(Structure):
    _fields_ = [("low", c_double), ("step", c_double)]


class fxs_scene_file_info(Structure):
    _fields_ = [("format", c_char_p), ("count", c_uint64), ("sh_degree", c_int), ("stored_sh_degree", c_int),
                ("antialiased", c_int), ("levels", c_int), ("colour", fxs_grid), ("sh", fxs_grid)]


class fxs_scene_file_options(Structure):
    _fields_ = [("level", c_int), ("axes", c_uint), ("allocator", c_void_p), ("progress", fxs_progress_fn),
                ("progress_argument", c_void_p), ("max_gaussians", c_uint64), ("max_memory", c_uint64)]


class fxs_pack_dropped(Structure):
    _fields_ = [("not_finite", c_uint64), ("rotation", c_uint64), ("weight", c_double), ("kept", c_double)]


class fxs_pack_error(Structure):
    _fields_ = [("position", c_double), ("scale", c_double), ("rotation", c_double), ("opacity", c_double),
                ("dc", c_double), ("sh", c_double)]


class fxs_pack_report(Structure):
    _fields_ = [("read", c_uint64), ("packed", c_uint64), ("dropped", fxs_pack_dropped), ("brought_in", c_uint64),
                ("largest", fxs_pack_error), ("rms", fxs_pack_error), ("low", c_double * 3), ("high", c_double * 3),
                ("inner_low", c_double * 3), ("inner_high", c_double * 3)]


class fxs_packed_scene(Structure):
    _fields_ = [("data", c_void_p), ("bytes", c_size_t), ("allocation", c_void_p), ("allocator", c_void_p)]


class fxs_pack_options(Structure):
    _fields_ = [("profile", c_uint), ("run", c_void_p), ("pool", c_void_p), ("threads", c_uint32),
                ("progress", fxs_progress_fn), ("argument", c_void_p), ("allocator", c_void_p)]


class fxs_scene_filter(Structure):
    _fields_ = [("low", c_double * 3), ("high", c_double * 3), ("middle", c_double * 3), ("radius", c_double),
                ("opacity", c_double), ("sh_degree", c_int), ("drawable", c_int), ("floaters", c_int)]


class fxs_scene_filter_report(Structure):
    _fields_ = [("read", c_uint64), ("kept", c_uint64), ("outside", c_uint64), ("faint", c_uint64),
                ("floaters", c_uint64), ("dropped", fxs_pack_dropped)]


class fxs_spz_clamped(Structure):
    _fields_ = [("position", c_uint32), ("scale", c_uint32), ("dc", c_uint32), ("sh", c_uint32), ("reach", c_double)]


class fxs_scene_write_options(Structure):
    _fields_ = [("count", c_uint64), ("sh_degree", c_int), ("antialiased", c_int), ("low", c_float * 3),
                ("high", c_float * 3), ("spz_version", c_int)]


class fxs_scene_write_report(Structure):
    _fields_ = [("lost_sh", c_int), ("lost_antialiased", c_int), ("clamped", fxs_spz_clamped)]


class fxs_mapping(Structure):
    _fields_ = [("data", c_void_p), ("bytes", c_size_t), ("descriptor", c_int), ("slot", c_int),
                ("modified", c_int64 * 2)]


# ---- port/camera, port/world -----------------------------------------------------------------------------------------

class fxs_file_view(Structure):
    _fields_ = [("name", c_char * 128), ("width", c_int), ("height", c_int), ("fx", c_double), ("fy", c_double),
                ("cx", c_double), ("cy", c_double), ("rotation", c_double * 9), ("position", c_double * 3),
                ("near", c_double), ("projection", c_uint)]


class fxs_world_crop(Structure):
    _fields_ = [("low", c_double * 3), ("high", c_double * 3), ("outside", c_int)]


class fxs_placement(Structure):
    _fields_ = [("file", c_uint32), ("translation", c_double * 3), ("rotation", c_double * 4), ("scale", c_double),
                ("opacity", c_double), ("tint", c_double * 3), ("visible", c_int), ("id", c_uint32),
                ("crop_count", c_uint32), ("crops", fxs_world_crop * FXS_MAX_CROPS)]


# ---- port/fit --------------------------------------------------------------------------------------------------------

FXS_FIT_REFERENCE = 0
FXS_FIT_MCMC = 1
FXS_FIT_FAST = 2

fxs_left_out_fn: Any = CFUNCTYPE(None, c_void_p, c_char_p)


class fxs_fit_options(Structure):
    _fields_ = [("recipe", c_uint), ("steps", c_uint32), ("sh_degree", c_int), ("max_gaussians", c_size_t),
                ("seed", c_uint64), ("batch", c_uint32), ("background", c_uint8 * 3), ("cutoff", c_uint),
                ("profile", c_uint), ("cpu", c_uint), ("run", c_void_p), ("pool", c_void_p), ("threads", c_uint32),
                ("clock", c_void_p), ("extent", c_float), ("block", c_uint32), ("blocks", c_uint32),
                ("device_count", c_uint32), ("devices", c_int * 8), ("max_memory", c_uint64)]


class fxs_fit_report(Structure):
    _fields_ = [("absolute", c_double), ("dissimilar", c_double), ("entries", c_uint64), ("visible", c_uint32),
                ("gaussians", c_size_t), ("nanoseconds", c_uint64 * 6)]


class fxs_photos_options(Structure):
    _fields_ = [("resolution", c_int), ("hold_out", c_uint32), ("background", c_uint8 * 3), ("skip_bad", c_int),
                ("left_out", fxs_left_out_fn), ("seed", c_uint64), ("run", c_void_p), ("pool", c_void_p),
                ("progress", fxs_progress_fn), ("argument", c_void_p)]


class fxs_photos(Structure):
    _fields_ = [("fit", c_void_p), ("held_out", c_void_p), ("fit_count", c_size_t), ("held_out_count", c_size_t),
                ("points", c_void_p), ("point_count", c_size_t), ("points_are_random", c_int), ("skipped", c_size_t)]


# ---- Functions: what they return, what they take ---------------------------------------------------------------------

_message = POINTER(fxs_message)
_file = c_void_p
_writer = c_void_p
_vector = c_double * 3

FUNCTIONS: "dict[str, tuple[Any, list[Any]]]" = {
    "fxs_version": (c_int, []),
    "fxs_strerror": (c_char_p, [c_int]),
    "fxs_scene_open": (c_int, [POINTER(fxs_scene), c_void_p, c_size_t]),
    "fxs_options_init": (None, [POINTER(fxs_options)]),
    "fxs_targets_init": (None, [POINTER(fxs_targets)]),
    "fxs_backend_at": (POINTER(fxs_backend), [c_int]),
    "fxs_backend_find": (POINTER(fxs_backend), [c_char_p]),
    "fxs_scene_file_open": (c_int, [c_char_p, POINTER(fxs_scene_file_options), POINTER(_file),
                                    POINTER(fxs_scene_file_info), _message]),
    "fxs_scene_file_open_memory": (c_int, [c_char_p, c_void_p, c_size_t, POINTER(fxs_scene_file_options),
                                           POINTER(_file), POINTER(fxs_scene_file_info), _message]),
    "fxs_scene_file_read": (c_long, [_file, POINTER(fxs_gaussian), c_size_t, _message]),
    "fxs_scene_file_close": (None, [_file]),
    "fxs_scene_filter_default": (None, [POINTER(fxs_scene_filter)]),
    "fxs_scene_file_filter": (c_int, [_file, POINTER(fxs_scene_filter), POINTER(fxs_scene_file_info),
                                      POINTER(fxs_scene_filter_report), fxs_progress_fn, c_void_p, _message]),
    "fxs_pack": (c_int, [_file, POINTER(fxs_scene_file_info), POINTER(fxs_packed_scene), POINTER(fxs_pack_report),
                         POINTER(fxs_pack_options), _message]),
    "fxs_packed_scene_free": (None, [POINTER(fxs_packed_scene)]),
    "fxs_file_write": (c_int, [c_char_p, c_void_p, c_size_t, _message]),
    "fxs_file_check": (c_int, [c_char_p, c_void_p, c_size_t, c_int, _message]),
    "fxs_scene_is_written": (c_int, [c_char_p]),
    "fxs_scene_writer_open": (c_int, [c_char_p, POINTER(fxs_scene_write_options), POINTER(_writer), _message]),
    "fxs_scene_writer_put": (c_int, [_writer, POINTER(fxs_gaussian), c_size_t, _message]),
    "fxs_scene_writer_close": (c_int, [_writer, POINTER(fxs_scene_write_report), fxs_progress_fn, c_void_p, _message]),
    "fxs_scene_file_rewind": (c_int, [_file, _message]),
    "fxs_scene_file_decimate": (c_int, [_file, c_uint64, POINTER(fxs_scene_file_info), fxs_progress_fn, c_void_p,
                                        _message]),
    "fxs_map": (c_int, [POINTER(fxs_mapping), c_char_p, _message]),
    "fxs_map_check": (c_int, [POINTER(fxs_mapping), c_char_p, _message]),
    "fxs_map_guard": (None, []),
    "fxs_unmap": (None, [POINTER(fxs_mapping)]),
    "fxs_pool_create": (c_void_p, [c_uint32]),
    "fxs_pool_run": (None, [c_void_p, c_void_p, c_void_p, c_uint32]),
    "fxs_pool_destroy": (None, [c_void_p]),
    "fxs_processors": (c_uint32, []),
    "fxs_view_look_at": (c_int, [POINTER(fxs_file_view), _vector, _vector, _vector, c_double, c_int, c_int, _message]),
    "fxs_view_frame_box": (c_int, [POINTER(fxs_file_view), _vector, _vector, _vector, c_double, c_int, c_int,
                                   _message]),
    "fxs_near_of_box": (c_double, [_vector, _vector]),
    "fxs_view_resize": (None, [POINTER(fxs_file_view), c_int, c_int]),
    "fxs_camera_from_view": (c_int, [POINTER(fxs_camera), POINTER(fxs_file_view), _message]),
    "fxs_camera_file_read": (c_long, [c_char_p, POINTER(POINTER(fxs_file_view)), _message]),
    "fxs_image_file_write": (c_int, [c_char_p, c_void_p, c_int, c_int, _message]),
    "fxs_placement_init": (None, [POINTER(fxs_placement), c_uint32, c_uint32]),
    "fxs_object_place": (c_int, [POINTER(fxs_object), POINTER(fxs_scene), POINTER(fxs_placement), POINTER(fxs_crop),
                                 _message]),
    "fxs_placement_box": (c_int, [POINTER(fxs_placement), _vector, _vector, _vector, _vector]),
    "fxs_photos_read": (c_int, [c_char_p, POINTER(fxs_photos_options), POINTER(fxs_photos), _message]),
    "fxs_photos_free": (None, [POINTER(fxs_photos)]),
    "fxs_fit_options_init": (None, [POINTER(fxs_fit_options)]),
    "fxs_fit_recipe_steps": (c_uint32, [c_uint]),
    "fxs_fit_recipe_gaussians": (c_size_t, [c_uint]),
    "fxs_fit_create": (c_int, [POINTER(c_void_p), c_void_p, c_size_t, c_void_p, c_size_t, POINTER(fxs_fit_options),
                               _message]),
    "fxs_fit_free": (None, [c_void_p]),
    "fxs_fit_step": (c_int, [c_void_p, POINTER(fxs_fit_report), _message]),
    "fxs_fit_pack": (c_int, [c_void_p, POINTER(fxs_packed_scene), POINTER(fxs_pack_report), _message]),
}
