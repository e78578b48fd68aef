"""Scenes fitted to photographs."""
from __future__ import annotations

import os
import time
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Optional, Sequence

from ._library import (CUTOFFS, NULL, PROFILES, Calls, PathLike, Struct, call, choose, colour, file_name, lib, new,
                       pool, whole)
from ._scene import Memory, Scene

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


def fit(photos: PathLike, *, recipe: str = "reference", steps: Optional[int] = None, resolution: int = 1600,
        sh_degree: int = 3, max_gaussians: Optional[int] = None, seed: int = 0, batch: int = 0,
        background: "Sequence[int]" = (0, 0, 0), cutoff: str = "mahalanobis", profile: str = "default",
        hold_out: int = 8, skip_bad: bool = False, backend: str = "cpu", devices: "Sequence[int]" = (0,),
        max_memory: int = 0, threads: int = 0,
        progress: "Optional[Callable[[FitProgress], object]]" = None) -> Scene:
    """Fits a scene to photographs and returns it. The scene has the same bytes as the file that `fixsplat fit` writes.
    docs/fit.md describes the fit. Raises an Error where the photographs cannot be read or the fit cannot be made.

    photos: a COLMAP folder, a transforms.json of nerfstudio or Blender, Inria's cameras.json with the images beside it,
    or a folder that contains one of them.
    recipe: "reference", "mcmc" or "fast".
    steps: the number of steps. None stands for the number of the recipe: 8,000 for "fast", 30,000 for the others.
    resolution: the largest number of pixels on the longer side of a photograph.
    sh_degree: the degree of SH of the scene, 0 to 3.
    max_gaussians: the largest number of Gaussians. None stands for the number of the recipe: 2^22 for "reference",
    1,000,000 for "mcmc", 250,000 for "fast".
    seed: the number from which all random numbers of the fit follow.
    batch: the number of photographs in a step, 1 to 8. 0 stands for one, or for one on each device.
    background: the colour behind the scene as red, green, blue, 0 to 255 each.
    cutoff: as for `render`. profile: as for `load`.
    hold_out: every n-th photograph by name is left out of the fit. With 0, all photographs are fitted.
    skip_bad: True leaves out photographs that cannot be read, with a warning for each.
    backend: the engine that makes the steps, "cpu" or "cuda".
    devices: the numbers of the GPUs for "cuda", 1 to 8 of them.
    max_memory: the largest number of bytes of memory on each device. 0 stands for no limit.
    threads: the number of threads, 1 to 64. 0 stands for one thread on each processor.
    The scene does not depend on backend, devices, max_memory or threads.
    progress: a function that is called with a FitProgress after each step, or a few times a second with "cuda". An
    exception that it raises ends the fit.
    """
    options, reading = new("fxs_fit_options"), new("fxs_photos_options")
    _fill(options, recipe, steps, max_gaussians)
    options.sh_degree = whole("sh_degree", sh_degree, 0, 3)
    options.seed = reading.seed = whole("seed", seed, 0, 2**64 - 1)
    options.batch = whole("batch", batch, 0, 8)
    options.background = reading.background = colour("background", background)
    options.cutoff = choose("cutoff", cutoff, CUTOFFS)
    options.profile = choose("profile", profile, PROFILES)
    options.max_memory = whole("max_memory", max_memory, 0, 2**64 - 1)
    if choose("backend", backend, {"cpu": 0, "cuda": 1}):
        _choose_devices(options, devices)
    reading.resolution = whole("resolution", resolution, 1, lib.FXS_MAX_SIZE)
    reading.hold_out = whole("hold_out", hold_out, 0, 2**32 - 1)
    reading.skip_bad = bool(skip_bad)
    with pool(threads) as (run, made, count):
        options.run = reading.run = run
        options.pool = reading.pool = made
        options.threads = count
        with _read(photos, reading) as taken:
            return _fit(os.fsdecode(file_name(photos)), taken, options, progress)


def _fill(options: Struct, recipe: str, steps: Optional[int], max_gaussians: Optional[int]) -> None:
    lib.fxs_fit_options_init(options)
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
def _read(path: PathLike, reading: Struct) -> "Iterator[Struct]":
    photos, name = new("fxs_photos"), file_name(path)
    with Calls(left_out=lambda why: warnings.warn(f"left out: {why}", stacklevel=2)) as calls:
        reading.progress, reading.left_out = calls.progress, calls.left_out
        call("fxs_photos_read", name, reading, photos)
    try:
        if photos.points_are_random:
            warnings.warn(f"{os.fsdecode(name)}: no points: begins with {photos.point_count} random ones", stacklevel=5)
        yield photos
    finally:
        lib.fxs_photos_free(photos)


def _fit(name: str, photos: Struct, options: Struct, progress: "Optional[Callable[[FitProgress], object]]") -> Scene:
    handle, packed, report = new("fxs_fit *"), new("fxs_packed_scene"), new("fxs_pack_report")
    call("fxs_fit_create", handle, photos.fit, photos.fit_count, photos.points, photos.point_count, options)
    try:
        _make_steps(handle[0], options, progress)
        call("fxs_fit_pack", handle[0], packed, report)
        return Scene(Memory.packed(packed, name), report.read - report.packed, report.brought_in)
    finally:
        lib.fxs_fit_free(handle[0])


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
