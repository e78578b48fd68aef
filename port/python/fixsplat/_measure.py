"""Metrics of pictures, and of scenes against photographs."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Callable, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._camera import Camera
from ._fit import read_photos
from ._library import (NULL, Error, PathLike, call, colour, copy, ffi, file_name, lib, new, release, sized, whole,
                       workers)
from ._render import Picture
from ._scene import Scene, load

Pixels = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class Metrics:
    """How similar two pictures are, over red, green and blue. docs/fit.md explains the words.

    psnr: dB; infinity for equal pictures. ssim: Wang et al. 2004, 1 for equal pictures; NaN where a mask leaves no
    window of 11x11 pixels whole. largest: the largest difference of a channel, 0 to 255.
    affine_psnr: dB, after the affine map of the first picture's colours that fits the second picture best.
    name: the name of the photograph, where there is one.
    """
    psnr: float
    ssim: float
    largest: int
    affine_psnr: float
    name: str = ""


@dataclass(frozen=True)
class Measurement:
    """A scene measured against photographs.

    views: the metrics of each photograph, by name. held_out: True where the photographs were held out of the fit.
    psnr, affine_psnr: the means of the finite PSNRs, or infinity. ssim: the mean of the SSIMs that are not NaN, or NaN.
    """
    views: Tuple[Metrics, ...]
    held_out: bool

    @property
    def psnr(self) -> float:
        return _mean([m.psnr for m in self.views], math.inf)

    @property
    def affine_psnr(self) -> float:
        return _mean([m.affine_psnr for m in self.views], math.inf)

    @property
    def ssim(self) -> float:
        return _mean([m.ssim for m in self.views], math.nan)


def _mean(values: "list[float]", none: float) -> float:
    finite = [value for value in values if math.isfinite(value)]
    return sum(finite) / len(finite) if finite else none


def _rgba(name: str, picture: Any) -> Pixels:
    if isinstance(picture, (str, os.PathLike)):
        pixels, size = new("uint8_t *"), ffi.new("int[2]")
        call("fxs_image_file_read", file_name(picture), pixels, size, size + 1)
        try:
            return np.frombuffer(bytes(ffi.buffer(pixels[0], 4 * size[0] * size[1])), np.uint8).reshape(size[1], -1, 4)
        finally:
            release(pixels[0])
    array = np.asarray(picture.colour if isinstance(picture, Picture) else picture)
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] not in (3, 4) or not array.size:
        raise ValueError(f"{name}: expected a file or uint8 of the shape (H, W, 3 or 4), not {array.dtype} of "
                         f"{array.shape}")
    return np.ascontiguousarray(np.pad(array, ((0, 0), (0, 0), (0, 4 - array.shape[2]))))


def compare(a: Any, b: Any, *, mask: Any = None, name: str = "") -> Metrics:
    """Compares two pictures of one size, with the figures of `fixsplat compare`. Transparency is ignored.

    a, b: each the path of a picture, an array of shape (H, W, 3) or (H, W, 4), uint8, or a Picture with colours.
    mask: an array of shape (H, W); its pixels that are 0 or False are ignored. name: for `Metrics.name`.
    """
    drawn, photograph = _rgba("a", a), _rgba("b", b)
    if drawn.shape != photograph.shape:
        raise ValueError(f"a is {drawn.shape[1]} x {drawn.shape[0]} pixels, b is {photograph.shape[1]} x "
                         f"{photograph.shape[0]}")
    counts = None if mask is None else np.ascontiguousarray(np.asarray(mask) != 0)
    if counts is not None and counts.shape != drawn.shape[:2]:
        raise ValueError(f"mask: expected the shape {drawn.shape[:2]}, not {counts.shape}")
    found = new("struct fxs_metrics")
    arguments = (ffi.from_buffer("uint8_t[]", drawn), ffi.from_buffer("uint8_t[]", photograph),
                 NULL if counts is None else ffi.from_buffer("uint8_t[]", counts), drawn.shape[1], drawn.shape[0])
    if lib.fxs_metrics_compare_masked(*arguments, found):
        raise Error("out of memory", lib.FXS_ERR_MEMORY)
    return Metrics(found.psnr, found.ssim, found.largest, lib.fxs_metrics_affine_psnr(*arguments), name)


def measure(scene: "Union[Scene, PathLike]", photos: PathLike, *, resolution: Optional[int] = None,
            hold_out: Optional[int] = None, skip_bad: bool = False, threads: int = 0,
            each: "Optional[Callable[[Metrics, Pixels, Pixels], object]]" = None, **options: Any) -> Measurement:
    """Renders a scene from the cameras of held-out photographs, and compares both, with the figures of `fixsplat fit
    PHOTOS --measure SCENE`. Where no photograph is held out, all are measured.

    scene: a Scene, or the path of a scene file. photos, resolution, hold_out, skip_bad: as for `fit` with files.
    each: a function that is called for each photograph with its metrics, the picture and the photograph, for example to
    compute metrics of other packages. The arrays have the shapes (H, W, 4) and (H, W, 3) and are valid during the call.
    options: those of `render`. `background` is also the colour behind transparent photographs.
    """
    reading = sized("fxs_photos_options", held_out_alone=1, skip_bad=bool(skip_bad))
    reading.resolution = 1600 if resolution is None else whole("resolution", resolution, 1, lib.FXS_MAX_SIZE)
    reading.hold_out = 8 if hold_out is None else whole("hold_out", hold_out, 0, 2**32 - 1)
    reading.background = colour("background", options.get("background", (0, 0, 0)))
    if not isinstance(scene, Scene):
        with load(scene, threads=threads) as opened:
            return measure(opened, photos, resolution=resolution, hold_out=hold_out, skip_bad=skip_bad,
                           threads=threads, each=each, **options)
    with workers(threads) as made:
        reading.workers = made[0]
        with read_photos(photos, reading) as taken:
            held_out = taken.held_out_count > 0
            chosen, count = ((taken.held_out, taken.held_out_count) if held_out else (taken.fit, taken.fit_count))
            return Measurement(tuple(_measure(scene, chosen[i], each, {"threads": threads, **options})
                                     for i in range(count)), held_out)


def _measure(scene: Scene, photo: Any, each: Any, options: Any) -> Metrics:
    camera = Camera._of(copy(ffi.addressof(photo.view)))
    height, width = camera.height, camera.width
    pixels = np.frombuffer(ffi.buffer(photo.pixels, 3 * width * height), np.uint8).reshape(height, width, 3)
    mask = (np.frombuffer(ffi.buffer(photo.mask, width * height), np.uint8).reshape(height, width) if photo.mask
            else None)
    drawn = scene.render(camera, **options).colour
    metrics = compare(drawn, pixels, mask=mask, name=camera.name)
    if each is not None:
        each(metrics, drawn, pixels)
    return metrics
