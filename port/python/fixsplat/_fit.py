"""Scenes fitted to photographs, from files or from arrays."""
from __future__ import annotations

import os
import time
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np

from ._camera import Camera, numbers
from ._gaussians import floats
from ._library import (CUTOFFS, NULL, PROFILES, Calls, Error, PathLike, Struct, call, choose, colour, ffi, file_name,
                       lib, new, release, sized, whole, workers)
from ._scene import Memory, Scene

EXPOSURES = {"none": lib.FXS_FIT_EXPOSURE_NONE, "gain": lib.FXS_FIT_EXPOSURE_GAIN,
             "affine": lib.FXS_FIT_EXPOSURE_AFFINE}
RECIPES = {"reference": lib.FXS_FIT_REFERENCE, "mcmc": lib.FXS_FIT_MCMC, "fast": lib.FXS_FIT_FAST}


@dataclass(frozen=True)
class FitProgress:
    """The progress of a fit after a step.

    step: the number of steps that are done. steps: the number of steps of the whole fit.
    loss: 0.8 times the mean of |a - b| plus 0.2 times the mean of 1 - SSIM, over the photographs of this step.
    gaussians: the number of Gaussians of the scene.
    """
    step: int
    steps: int
    loss: float
    gaussians: int


def fit(photos: "Union[PathLike, Sequence[Any]]", K: Any = None, world_to_camera: Any = None, *, points: Any = None,
        colours: Any = None, recipe: str = "fast", steps: Optional[int] = None, resolution: Optional[int] = None,
        sh_degree: int = 3, max_gaussians: Optional[int] = None, seed: int = 0, batch: int = 0,
        background: "Sequence[int]" = (0, 0, 0), cutoff: str = "mahalanobis", profile: str = "default",
        exposure: str = "none", refine_poses: bool = False, antialiased: bool = False, sky: int = 0,
        surfaces: bool = False,
        hold_out: Optional[int] = None, skip_bad: bool = False,
        backend: str = "cpu", devices: "Sequence[int]" = (0,),
        max_memory: int = 0, threads: int = 0,
        progress: "Optional[Callable[[FitProgress], object]]" = None) -> Scene:
    """Fits a scene to photographs and returns it. The scene has the same bytes as the file that `fixsplat fit` writes.
    docs/fit.md describes the fit. Raises an Error where the photographs cannot be read or the fit cannot be made.

    photos: a COLMAP folder, a transforms.json of nerfstudio or Blender, Inria's cameras.json with the images beside it,
    or a folder that contains one of them. Or a sequence of N arrays of shape (H, W, 3), uint8: the rows from the top,
    red, green and blue. The order of the arrays is the one of the names of files.

    These are for arrays:
    K: the matrices of intrinsics, of shape (N, 3, 3), or (3, 3) for one matrix of all, in pixels. Or a sequence of N
    Cameras, which take the place of K and world_to_camera; with Cameras of `load_cameras`, the bytes are exactly those
    of the command.
    world_to_camera: the poses [R | t], of shape (N, 3, 4) or (N, 4, 4), for camera axes x right, y down, z forward.
    points: the positions at which the fit begins with a Gaussian, of shape (M, 3), in scene units. None stands for
    100,000 random ones in a cube around the cameras, three times as wide as their box.
    colours: the colours of the points, of shape (M, 3), uint8. None stands for grey.

    These are for files:
    resolution: the largest number of pixels on the longer side of a photograph. None stands for 1600.
    hold_out: every n-th photograph by name is left out of the fit. None stands for 8. With 0, all are fitted.
    skip_bad: True leaves out photographs that cannot be read, with a warning for each.

    These are for both:
    recipe: "fast", "mcmc" or "reference".
    steps: the number of steps. None stands for the number of the recipe: 8,000 for "fast", 30,000 for the others.
    sh_degree: the degree of SH of the scene, 0 to 3.
    max_gaussians: the largest number of Gaussians. None stands for the number of the recipe: 2^22 for "reference",
    1,000,000 for "mcmc", 250,000 for "fast".
    seed: the number from which all random numbers of the fit follow.
    batch: the number of photographs in a step, 1 to 8. 0 stands for one, or for one on each device.
    background: the colour behind the scene as red, green, blue, 0 to 255 each.
    cutoff: as for `render`. profile: as for `load`.
    exposure: "none", "gain": each photograph has a gain and a colour balance of its own, or "affine": each has an
        affine map of colours.
    refine_poses: True finds the poses of the photographs beside the scene.
    antialiased: True makes a scene for other distances and sizes than those of the photographs.
    surfaces: True fits flat Gaussians that lie along surfaces, for a mesh of the scene.
    sky: the number of directions around the cameras in which the fit begins with a Gaussian far away, where photographs
    look and no points lie, up to 1,000,000. 0 stands for no sky.
    backend: the engine that makes the steps, "cpu" or "cuda".
    devices: the numbers of the GPUs for "cuda", 1 to 8 of them.
    max_memory: the largest number of bytes of memory on each device. 0 stands for no limit.
    threads: the number of threads, 1 to 64. 0 stands for one thread on each processor.
    The scene does not depend on backend, devices, max_memory or threads.
    progress: a function that is called with a FitProgress after each step, or a few times a second with "cuda". An
    exception that it raises ends the fit.
    """
    is_path = isinstance(photos, (str, os.PathLike))
    if is_path and any(given is not None for given in (K, world_to_camera, points, colours)):
        raise TypeError("K, world_to_camera, points, colours: are for arrays, not for files")
    if colours is not None and points is None:
        raise TypeError("colours: are for points")
    if not is_path and (resolution, hold_out, skip_bad) != (None, None, False):
        raise TypeError("resolution, hold_out, skip_bad: are for files, not for arrays")
    options, reading = sized("fxs_fit_options"), sized("fxs_photos_options")
    _fill(options, recipe, steps, max_gaussians)
    options.sh_degree = whole("sh_degree", sh_degree, 0, 3)
    options.seed = reading.seed = whole("seed", seed, 0, 2**64 - 1)
    options.batch = whole("batch", batch, 0, 8)
    options.background = reading.background = colour("background", background)
    options.cutoff = choose("cutoff", cutoff, CUTOFFS)
    options.profile = choose("profile", profile, PROFILES)
    options.exposure = choose("exposure", exposure, EXPOSURES)
    options.refine_poses = bool(refine_poses)
    options.antialiased = bool(antialiased)
    options.surfaces = bool(surfaces)
    options.sky = whole("sky", sky, 0, lib.FXS_FIT_SKY_MOST)
    options.max_memory = whole("max_memory", max_memory, 0, 2**64 - 1)
    if choose("backend", backend, {"cpu": 0, "cuda": 1}):
        _choose_devices(options, devices)
    reading.resolution = 1600 if resolution is None else whole("resolution", resolution, 1, lib.FXS_MAX_SIZE)
    reading.hold_out = 8 if hold_out is None else whole("hold_out", hold_out, 0, 2**32 - 1)
    reading.skip_bad = bool(skip_bad)
    with workers(threads) as made:
        options.workers = reading.workers = made[0]
        if is_path:
            with read_photos(photos, reading) as taken:  # type: ignore[arg-type]
                return _fit(os.fsdecode(file_name(photos)), taken, options, progress)  # type: ignore[arg-type]
        pictures = [_pixels(i, picture) for i, picture in enumerate(photos)]  # type: ignore[arg-type]
        if not pictures:
            raise ValueError("photos: expected at least one")
        cameras = _cameras(pictures, K, world_to_camera)
        with _take(pictures, cameras, points, colours, options.seed) as taken:
            return _fit("photographs", taken, options, progress)


def _fill(options: Struct, recipe: str, steps: Optional[int], max_gaussians: Optional[int]) -> None:
    options.recipe = choose("recipe", recipe, RECIPES)
    options.steps = lib.fxs_fit_recipe_steps(options.recipe) if steps is None else whole("steps", steps, 1, 10**9)
    options.max_gaussians = (lib.fxs_fit_recipe_gaussians(options.recipe) if max_gaussians is None
                             else whole("max_gaussians", max_gaussians, 1, lib.FXS_MAX_COUNT))


def _choose_devices(options: Struct, devices: "Sequence[int]") -> None:
    if not 1 <= len(devices) <= 8:
        raise ValueError(f"devices: {len(devices)} of them, expected 1 to 8")
    options.device_count = len(devices)
    for i, device in enumerate(devices):
        options.devices[i] = whole("devices", device, 0, 2**31 - 1)


@contextmanager
def read_photos(path: PathLike, reading: Struct) -> "Iterator[Struct]":
    photos, name = new("fxs_photos"), file_name(path)
    with Calls(left_out=lambda why: warnings.warn(f"left out: {why}", stacklevel=2)) as calls:
        reading.progress, reading.left_out = calls.progress[0], calls.left_out
        call("fxs_photos_read", name, reading, photos)
    try:
        yield photos
    finally:
        lib.fxs_photos_free(photos)


def _pixels(number: int, picture: Any) -> Any:
    """Returns a picture as an array of C, without a copy where it is one."""
    array = np.asarray(picture)
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 3 or not array.size:
        raise ValueError(f"photos[{number}]: expected uint8 of the shape (H, W, 3), not {array.dtype} of {array.shape}")
    return np.ascontiguousarray(array)


def _cameras(pictures: "list[Any]", K: Any, world_to_camera: Any) -> "list[Camera]":
    """Returns a camera for each picture, of its size."""
    count = len(pictures)
    if isinstance(K, (list, tuple)) and all(isinstance(camera, Camera) for camera in K):
        if world_to_camera is not None:
            raise TypeError("a Camera has its own world_to_camera")
        cameras = list(K)
    elif K is None or world_to_camera is None:
        raise TypeError("expected Cameras, or K and world_to_camera")
    else:
        ks = np.broadcast_to(numbers("K", K, (3, 3), (count, 3, 3)), (count, 3, 3))
        given = numbers("world_to_camera", world_to_camera, (count, 3, 4), (count, 4, 4))
        poses = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
        poses[:, :given.shape[1]] = given
        cameras = [Camera(k, pose, picture.shape[1], picture.shape[0])
                   for k, pose, picture in zip(ks, poses, pictures)]
    if len(cameras) != count:
        raise ValueError(f"{len(cameras)} cameras for {count} photographs")
    for i, (camera, picture) in enumerate(zip(cameras, pictures)):
        if (camera.height, camera.width) != picture.shape[:2]:
            raise ValueError(f"photos[{i}]: has {picture.shape[1]} x {picture.shape[0]} pixels, its camera has "
                             f"{camera.width} x {camera.height}")
    return cameras


def _points(points: Any, colours: Any) -> "tuple[Any, int]":
    """Returns the points as an array of C, with their number."""
    positions = floats("points", points, None, 3)
    if not len(positions):
        raise ValueError("points: expected at least one")
    if not (np.abs(positions) < 2.0**27).all():
        raise ValueError("points: expected finite numbers within 2^27 units")
    shades = np.full(positions.shape, 128, np.uint8) if colours is None else np.asarray(colours)
    if shades.dtype != np.uint8 or shades.shape != positions.shape:
        raise ValueError(f"colours: expected uint8 of the shape {positions.shape}, not {shades.dtype} of "
                         f"{shades.shape}")
    made = ffi.new("fxs_fit_point[]", len(positions))
    table = np.frombuffer(ffi.buffer(made), np.dtype({"names": ["position", "colour"], "formats": ["3f4", "3u1"],
                                                      "itemsize": ffi.sizeof("fxs_fit_point")}))
    table["position"], table["colour"] = positions, shades
    return made, len(positions)


@contextmanager
def _take(pictures: "list[Any]", cameras: "list[Camera]", points: Any, colours: Any, seed: int) -> "Iterator[Struct]":
    """Makes the photographs of a fit from pictures in memory."""
    photos, found = new("fxs_photos", fit_count=len(pictures)), NULL
    kept = ffi.new("fxs_fit_photo[]", [{"view": camera._view[0], "pixels": ffi.from_buffer("uint8_t[]", picture)}
                                       for camera, picture in zip(cameras, pictures)])
    photos.fit = kept
    try:
        if points is None:
            chosen, count = new("fxs_fit_point *"), ffi.new("size_t *")
            call("fxs_photos_random_points", kept, len(pictures), seed, chosen, count)
            photos.points, photos.point_count, found = chosen[0], count[0], chosen[0]
        else:
            made, photos.point_count = _points(points, colours)
            photos.points = made
        yield photos
    finally:
        release(found)


def _fit(name: str, photos: Struct, options: Struct, progress: "Optional[Callable[[FitProgress], object]]") -> Scene:
    handle, packed, report = new("fxs_fit *"), new("fxs_packed_scene"), new("fxs_pack_report")
    if photos.points_are_random:
        warnings.warn(f"{name}: no points: begins with {photos.point_count} random ones", stacklevel=3)
    call("fxs_fit_create", handle, photos.fit, photos.fit_count, photos.points, photos.point_count, options)
    try:
        _make_steps(handle[0], options, progress)
        call("fxs_fit_pack", handle[0], packed, report)
        try:
            call("fxs_fit_start_view", photos.fit, photos.fit_count, packed.data)
            call("fxs_start_choose", packed.data, packed.bytes)
        except Error as why:
            warnings.warn(f"no start view: {why}", stacklevel=4)
        return Scene(Memory.packed(packed, name), report.read - report.packed, report.brought_in)
    finally:
        lib.fxs_fit_destroy(handle[0])


def _make_steps(handle: Any, options: Struct, progress: "Optional[Callable[[FitProgress], object]]") -> None:
    """Makes all steps of a fit. To ask a device for a report makes it wait, so a device is asked only a few times a
    second, and after the last step."""
    report = new("fxs_fit_report")
    last = time.monotonic()
    for step in range(1, options.steps + 1):
        asked = not options.device_count or step == options.steps or time.monotonic() - last > 0.2
        call("fxs_fit_step", handle, report if asked else NULL)
        if asked and progress is not None:
            last = time.monotonic()
            progress(FitProgress(step, options.steps, 0.8 * report.absolute + 0.2 * report.dissimilar,
                                 report.gaussians))
