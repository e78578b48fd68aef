"""Gaussians as arrays of floats, and streams of them: from files, from packed scenes and from arrays."""
from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Tuple

import numpy as np
import numpy.typing as npt

from ._camera import number
from ._library import (NULL, PROFILES, Calls, Error, PathLike, Struct, call, choose, copy, ffi, file_name, lib, new,
                       sized, whole)

if TYPE_CHECKING:
    from ._convert import Conversion
    from ._scene import Memory, Scene

Floats = npt.NDArray[np.float32]
Progress = Optional[Callable[[float], object]]

AXES = {"file": lib.FXS_AXES_OF_FILE, "rub": lib.FXS_AXES_RUB, "rdf": lib.FXS_AXES_RDF}

# A Gaussian (fxs_gaussian of the C library) is a row of floats: first column of each field, and number of columns.
POSITION, SCALE, ROTATION, OPACITY, SH = (ffi.offsetof("fxs_gaussian", name) // 4
                                          for name in ("position", "scale", "rotation", "opacity", "dc"))
FLOATS = ffi.sizeof("fxs_gaussian") // 4


# ---- Arrays of Gaussians ---------------------------------------------------------------------------------------------

def floats(name: str, values: Any, *shape: Optional[int]) -> Floats:
    """Returns values as an array of float32, without a copy where they are one. A None in the shape stands for any
    length."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, not {array.dtype}")
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape)):
        wanted = ", ".join("N" if n is None else str(n) for n in shape)
        raise ValueError(f"{name}: expected the shape ({wanted}{',' * (len(shape) == 1)}), not {array.shape}")
    return array.astype(np.float32, copy=False)


@dataclass(frozen=True, eq=False)
class Gaussians:
    """N Gaussians as arrays of float32, before they are packed. The numbers are those of an Inria .ply, which are also
    those that gsplat and Inria's code optimise: logarithms of scales, and opacities before the sigmoid.

    positions: of shape (N, 3), in scene units.
    scales: of shape (N, 3): the natural logarithm of the standard deviation along each axis, in scene units.
    rotations: of shape (N, 4): quaternions w, x, y, z, of any length but 0.
    opacities: of shape (N,): the opacity is 1 / (1 + exp(-opacities)).
    sh: of shape (N, K, 3), with K of 1, 4, 9 or 16 for SH degree 0 to 3: the coefficients of red, green and blue. The
    colour is 0.5 + 0.28209479177387814 * sh[:, 0] + higher degrees.
    antialiased: True where the opacities were fitted with compensation for the dilation of splats.
    origin: X, Y, Z, to be added to the positions. It is not 0 for a scene so far out that its coordinates are finer
    than float32 there.

    Arrays of float32 are kept as they are, with any strides, and not copied; other real numbers are converted. The
    arrays of `load_gaussians` and `Scene.arrays` are views of one block of memory.
    """
    positions: Floats
    scales: Floats
    rotations: Floats
    opacities: Floats
    sh: Floats
    antialiased: bool = False
    origin: "Tuple[float, float, float]" = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        count = len(floats("positions", self.positions, None, 3))
        fields = {"positions": (3,), "scales": (3,), "rotations": (4,), "opacities": (), "sh": (None, 3)}
        for name, shape in fields.items():
            object.__setattr__(self, name, floats(name, getattr(self, name), count, *shape))
        if self.sh.shape[1] not in (1, 4, 9, 16):
            raise ValueError(f"sh: {self.sh.shape[1]} coefficients, expected 1, 4, 9 or 16")

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def sh_degree(self) -> int:
        """The degree of the SH, 0 to 3."""
        return (1, 4, 9, 16).index(self.sh.shape[1])

    def select(self, mask: Any) -> "Gaussians":
        """Returns some of the Gaussians. mask: an array of N bools, an array of numbers of Gaussians, or a slice. A
        slice gives views of the same memory."""
        chosen: Any = mask if isinstance(mask, slice) else np.asarray(mask)
        if not isinstance(chosen, slice) and (chosen.ndim != 1 or chosen.dtype.kind not in "biu" or
                                              (chosen.dtype.kind == "b" and len(chosen) != len(self))):
            raise ValueError(f"mask: expected {len(self)} bools, or numbers of Gaussians, not {chosen.dtype} of shape "
                             f"{chosen.shape}")
        return Gaussians(self.positions[chosen], self.scales[chosen], self.rotations[chosen], self.opacities[chosen],
                         self.sh[chosen], self.antialiased, self.origin)

    def pack(self, *, profile: str = "default", threads: int = 0, progress: Progress = None) -> "Scene":
        """Packs the Gaussians, and returns the scene. It has the same bytes as a scene that is loaded from a .ply with
        these Gaussians. profile, threads, progress: as for `load`."""
        from ._scene import Memory, Scene
        with Calls(progress) as calls, Stream.of_arrays(self, calls) as stream:
            opened = stream.pack(profile, threads)
            report = opened.report
            return Scene(Memory.opened(opened, "arrays"), report.read - report.packed, report.brought_in)

    def save(self, path: PathLike, **options: Any) -> "Conversion":
        """Writes the Gaussians to a scene file; the ending of its name chooses the format. options: as for `convert`.
        """
        from ._convert import convert
        return convert(self, path, **options)

    def __repr__(self) -> str:
        return f"<fixsplat.Gaussians, {len(self)}, SH degree {self.sh_degree}>"


# ---- Streams of Gaussians --------------------------------------------------------------------------------------------

@contextmanager
def _about(name: str) -> "Iterator[None]":
    """Makes the message of an Error in the block begin with the name of the scene, if it does not do so already."""
    try:
        yield
    except Error as error:
        if str(error).startswith(name):
            raise
        raise Error(f"{name}: {error}", error.code, error.bytes_needed) from None


def file_options(level: int, axes: str, max_gaussians: int, max_memory: int, calls: Calls) -> Struct:
    return sized("fxs_scene_file_options", level=whole("level", level, 0, 1000), axes=choose("axes", axes, AXES),
                 progress=calls.progress[0], max_gaussians=whole("max_gaussians", max_gaussians, 0, 2**64 - 1),
                 max_memory=whole("max_memory", max_memory, 0, 2**64 - 1))


def open_options(file: Struct, profile: str, threads: int, calls: Calls) -> Struct:
    """Returns options that point to `file`, the options of `file_options` or NULL. The caller keeps `file` alive."""
    return sized("fxs_open_options", file=file, profile=choose("profile", profile, PROFILES),
                 threads=whole("threads", threads, 0, 64), progress=calls.progress[0])


def _filler(gaussians: Gaussians) -> "Callable[[int, Any, int], None]":
    """Returns a function that copies n Gaussians, from number `first` on, to an array of C."""
    columns = ((POSITION, gaussians.positions), (SCALE, gaussians.scales), (ROTATION, gaussians.rotations),
               (OPACITY, gaussians.opacities), (SH, gaussians.sh))

    def fill(first: int, out: Any, n: int) -> None:
        rows = np.frombuffer(ffi.buffer(out, n * FLOATS * 4), np.float32).reshape(n, FLOATS)
        for column, array in columns:
            part = array[first:first + n].reshape(n, -1)
            rows[:, column:column + part.shape[1]] = part

    return fill


class Stream:
    """An open stream of Gaussians, which are read as floats. `kept` is what the stream reads from."""

    def __init__(self, name: str, calls: Calls, function: str, *arguments: Any, kept: Any = None):
        self.info, self.calls, self.name = new("fxs_scene_file_info"), calls, name
        handle = new("fxs_scene_file *")
        call(function, os.fsencode(name), *arguments, handle, self.info)
        self.handle, self._kept = handle[0], kept

    @classmethod
    def of_file(cls, path: PathLike, options: Struct, calls: Calls) -> "Stream":
        return cls(os.fsdecode(file_name(path)), calls, "fxs_scene_file_open", options)

    @classmethod
    def of_scene(cls, memory: "Memory", calls: Calls) -> "Stream":
        data = memory.sealed()
        return cls(memory.name, calls, "fxs_scene_file_open_memory", data, memory.size, NULL, kept=(memory, data))

    @classmethod
    def of_arrays(cls, gaussians: Gaussians, calls: Calls) -> "Stream":
        read = calls.source(_filler(gaussians))
        source = new("fxs_gaussian_source", count=len(gaussians), sh_degree=gaussians.sh_degree,
                     antialiased=bool(gaussians.antialiased), read=read, origin=list(gaussians.origin))
        return cls("arrays", calls, "fxs_scene_file_open_gaussians", source, NULL, kept=(source, read))

    def place(self, whole_scene: Struct, up: "Optional[list[float]]" = None) -> None:
        """Turns, scales and moves all Gaussians, and what is up there before."""
        world, placement, file = new("fxs_world"), new("fxs_placement"), ffi.new("uint32_t *")
        files, merged = ffi.new("fxs_scene_file *[]", [self.handle]), new("fxs_scene_file *")
        info = copy(self.info)
        try:
            call("fxs_world_add_file", world, os.fsencode(self.name), file)
            lib.fxs_placement_init(placement, 0, 0)
            call("fxs_world_add", world, placement)
            if up is not None:
                world.up = up
            lib.fxs_world_place(world, whole_scene)
            self.handle = NULL
            call("fxs_world_merge", world, files, info, merged, self.info)
            self.handle = merged[0]
        finally:
            lib.fxs_world_free(world)

    @property
    def moves(self) -> bool:
        return bool(self.info.time.duration > 0)

    def at(self, time: float) -> None:
        """Takes the Gaussians of a scene that moves as they are at a time, seconds."""
        if not self.moves:
            raise ValueError("time: the scene does not move")
        with _about(self.name):
            call("fxs_scene_file_at", self.handle, number("time", time, -1e6, 1e6), self.info)

    def between(self, start: float, end: float) -> None:
        """Takes a range of the time of a scene that moves, seconds."""
        if not self.moves:
            raise ValueError("times: the scene does not move")
        with _about(self.name):
            call("fxs_scene_file_between", self.handle, start, end, self.info)

    def filter(self, how: Struct) -> Struct:
        report = new("fxs_scene_filter_report")
        with _about(self.name):
            call("fxs_scene_file_filter", self.handle, how, self.info, report, self.calls.progress)
        return report

    def decimate(self, target: int) -> None:
        with _about(self.name):
            call("fxs_scene_file_decimate", self.handle, target, self.info, self.calls.progress)

    def pack(self, profile: str, threads: int) -> Struct:
        options = open_options(NULL, profile, threads, self.calls)
        handle, self.handle, opened = self.handle, NULL, new("fxs_opened *")
        with _about(self.name):
            call("fxs_open_gaussians", os.fsencode(self.name), handle, self.info, options, opened)
        return opened[0]

    def batches(self) -> "Iterator[Tuple[Any, int]]":
        """Yields the Gaussians, at most 4096 at a time, with their number."""
        batch = ffi.new("fxs_gaussian[4096]")
        while True:
            n = call("fxs_scene_file_read", self.handle, batch, len(batch))
            if n == 0:
                return
            self.calls.heard()
            yield batch, n

    def rewind(self) -> None:
        call("fxs_scene_file_rewind", self.handle)

    def arrays(self, progress: Progress) -> Gaussians:
        """Reads all Gaussians, straight into the memory of the arrays."""
        count, done = int(self.info.count), 0
        rows = np.empty((count, FLOATS), np.float32)
        out = ffi.cast("fxs_gaussian *", ffi.from_buffer(rows))
        while done < count:
            n = call("fxs_scene_file_read", self.handle, out + done, min(count - done, 65536))
            if n == 0:
                break
            self.calls.heard()
            done += n
            if progress is not None:
                progress(done / count)
        coefficients = (self.info.sh_degree + 1)**2
        return Gaussians(rows[:done, POSITION:POSITION + 3], rows[:done, SCALE:SCALE + 3],
                         rows[:done, ROTATION:ROTATION + 4], rows[:done, OPACITY],
                         rows[:done, SH:SH + 3 * coefficients].reshape(done, coefficients, 3),
                         bool(self.info.antialiased), tuple(self.info.origin))

    def __enter__(self) -> "Stream":
        return self

    def __exit__(self, *_: object) -> None:
        lib.fxs_scene_file_close(self.handle)


def load_gaussians(path: PathLike, *, level: int = 0, axes: str = "file", max_gaussians: int = 0, max_memory: int = 0,
                   time: Optional[float] = None, progress: Progress = None) -> Gaussians:
    """Reads the Gaussians of a scene file of any format as arrays of floats, in the order of the file. Of an .fxs file,
    they are the Gaussians that its codes stand for. Raises an Error where the file cannot be read.

    time: the moment at which Gaussians of a scene that moves are read, in seconds. None reads each Gaussian as it is in
    the middle of its own time.
    level, axes, max_gaussians, max_memory, progress: as for `load`.
    """
    with Calls(progress) as calls:
        with Stream.of_file(path, file_options(level, axes, max_gaussians, max_memory, calls), calls) as stream:
            if time is not None:
                stream.at(time)
            return stream.arrays(progress)
