"""Loads scenes from files and bytes, converts them and saves them."""
from __future__ import annotations

import os
import weakref
from contextlib import contextmanager
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Sequence, Tuple, Type, Union

import numpy as np

from ._camera import Camera, numbers, number
from ._library import (NULL, PROFILES, Calls, Error, PathLike, Struct, call, choose, ffi, file_name, lib, new, pool,
                       string, whole)

if TYPE_CHECKING:
    from ._render import Picture

Box = Tuple[Tuple[float, float, float], Tuple[float, float, float]]
Progress = Optional[Callable[[float], object]]

AXES = {"file": lib.FXS_AXES_OF_FILE, "rub": lib.FXS_AXES_RUB, "rdf": lib.FXS_AXES_RDF}


def _box(header: bytes, *corners: str) -> Box:
    """Returns two corners of a box from the header of a packed scene, whose bytes are the same on every machine."""
    low, high = ((np.frombuffer(header, "<i8", 3, ffi.offsetof("fxs_packed_header", name)) * 2.0**-32).tolist()
                 for name in corners)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


class Memory:
    """The bytes of a packed scene. They are freed when no part of the program refers to this object any more."""

    def __init__(self, scene: Struct, data: Any, size: int, name: str, opened: Optional[Struct] = None,
                 source: Any = None):
        self.scene, self.data, self.size, self.name = scene, data, size, name
        self._opened, self._source = opened, source
        header = bytes(ffi.buffer(data, ffi.sizeof("fxs_packed_header")))
        self.box, self.inner_box = _box(header, "low_q32", "high_q32"), _box(header, "inner_low_q32", "inner_high_q32")

    @classmethod
    def opened(cls, opened: Struct, name: str, source: Any = None) -> "Memory":
        """Makes the Memory of a scene that fxs_open has opened. `source` keeps the bytes of the scene alive."""
        memory = cls(opened.scene, opened.data, opened.bytes, name, opened, source)
        weakref.finalize(memory, lib.fxs_close, opened).atexit = False
        return memory

    @classmethod
    def packed(cls, packed: Struct, name: str) -> "Memory":
        """Makes the Memory of a scene that fxs_fit_pack has packed."""
        scene = new("fxs_scene")
        lib.fxs_scene_open(scene, packed.data, packed.bytes)
        memory = cls(scene, packed.data, packed.bytes, name)
        weakref.finalize(memory, lib.fxs_packed_scene_free, packed).atexit = False
        return memory

    def check(self) -> None:
        """Raises an Error if the mapped file of the scene has been written to."""
        if self._opened is not None:
            call("fxs_opened_check", self._opened)


class Scene:
    """A packed scene, the form that the renderer draws. `load` and `fit` make scenes.

    Its memory or its mapped file is released by `close`, at the end of a `with`, or when the scene is no longer used.
    Any number of threads may use a scene at the same time. A thread that renders a scene while another thread closes it
    completes its picture.

    left_out: the number of Gaussians of the file that cannot be drawn, because they have a number that is not finite or
    a zero quaternion.
    brought_in: the number of Gaussians farther than 2^27 units away, which are drawn as they look from the origin.
    Both numbers are 0 for an .fxs file.
    """

    def __init__(self, memory: Memory, left_out: int = 0, brought_in: int = 0):
        self._memory: Optional[Memory] = memory
        self.left_out = left_out
        self.brought_in = brought_in

    @property
    def memory(self) -> Memory:
        if self._memory is None:
            raise ValueError("the scene is closed")
        return self._memory

    @property
    def count(self) -> int:
        """The number of Gaussians."""
        return int(self.memory.scene.count)

    def __len__(self) -> int:
        return self.count

    @property
    def sh_degree(self) -> int:
        """The degree of the SH of the scene, 0 to 3."""
        return int(self.memory.scene.sh_degree)

    @property
    def antialiased(self) -> bool:
        """Whether the opacities of the scene were fitted with compensation for the dilation of splats."""
        return bool(self.memory.scene.antialiased)

    @property
    def profile(self) -> str:
        """The profile, which says how the scene is packed: "default", "compact" or "small"."""
        return list(PROFILES)[int(self.memory.scene.profile)]

    @property
    def nbytes(self) -> int:
        """The size of the packed scene in bytes, in memory and as an .fxs file."""
        return self.memory.size

    @property
    def box(self) -> Box:
        """The least x, y, z and the greatest x, y, z of the centres of all Gaussians, in scene units."""
        return self.memory.box

    @property
    def inner_box(self) -> Box:
        """The least x, y, z and the greatest x, y, z of the visible part of the scene, without stray Gaussians, in
        scene units. It is the box for a camera that shows the whole scene."""
        return self.memory.inner_box

    def frame(self, width: int, height: int, *, fov: float = 50, up: Sequence[float] = (0, -1, 0)) -> Camera:
        """Makes a camera that shows the whole scene from the front and slightly above. width, height: the size of the
        picture in pixels. fov: the vertical field of view, 1 to 170 degrees. up: the direction that is up."""
        view = new("fxs_file_view")
        low, high = self.inner_box
        call("fxs_view_frame_box", view, low, high, list(numbers("up", up, (3,))), number("fov", fov, 1, 170),
             whole("width", width, 1, lib.FXS_MAX_SIZE), whole("height", height, 1, lib.FXS_MAX_SIZE))
        return Camera._of(view)

    def render(self, K: Any, world_to_camera: Any = None, width: Optional[int] = None, height: Optional[int] = None,
               **options: Any) -> "Picture":
        """Draws the scene by itself, at the origin. It calls `fixsplat.render` with this scene as the only object, and
        takes the same arguments and options."""
        from ._render import Object, render
        return render([Object(self)], K, world_to_camera, width, height, **options)

    def save(self, path: PathLike) -> None:
        """Writes the scene to an .fxs file, which can be opened without packing. An existing file of this name is
        replaced when the new file is complete. Raises a ValueError where the name does not end in .fxs."""
        name = file_name(path)
        if not name.endswith(b".fxs"):
            raise ValueError(f"{os.fsdecode(name)}: expected a name ending in .fxs")
        memory = self.memory
        call("fxs_file_write", name, memory.data, memory.size)

    def close(self) -> None:
        """Releases the memory of the scene, also on the back ends of this thread. It may be called again."""
        from ._render import forget_closed
        self._memory = None
        forget_closed()

    def __enter__(self) -> "Scene":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def __repr__(self) -> str:
        if self._memory is None:
            return "<fixsplat.Scene, closed>"
        return f"<fixsplat.Scene {self._memory.name!r}, {self.count} Gaussians, SH degree {self.sh_degree}>"


# ---- Reading ---------------------------------------------------------------------------------------------------------

@contextmanager
def _about(name: str) -> "Iterator[None]":
    """Makes the message of an Error in the block begin with the name of the scene, if it does not do so already."""
    try:
        yield
    except Error as error:
        if str(error).startswith(name):
            raise
        raise Error(f"{name}: {error}", error.code, error.bytes_needed) from None


def _file_options(level: int, axes: str, max_gaussians: int, max_memory: int, calls: Calls) -> "dict[str, Any]":
    return {"level": whole("level", level, 0, 1000), "axes": choose("axes", axes, AXES), "progress": calls.progress,
            "max_gaussians": whole("max_gaussians", max_gaussians, 0, 2**64 - 1),
            "max_memory": whole("max_memory", max_memory, 0, 2**64 - 1)}


def _open_options(file: "dict[str, Any]", profile: str, threads: int, calls: Calls) -> Struct:
    return new("fxs_open_options", file=file, profile=choose("profile", profile, PROFILES),
               threads=whole("threads", threads, 0, 64), progress=calls.progress)


class _File:
    """An open scene file, from which Gaussians are read as floats."""

    def __init__(self, path: str, options: "dict[str, Any]", calls: Calls):
        self.info, self.calls, handle = new("fxs_scene_file_info"), calls, new("fxs_scene_file *")
        self._name = path
        call("fxs_scene_file_open", file_name(path), new("fxs_scene_file_options", **options), handle, self.info)
        self.handle = handle[0]

    def filter(self, how: Struct) -> Struct:
        report = new("fxs_scene_filter_report")
        with _about(self._name):
            call("fxs_scene_file_filter", self.handle, how, self.info, report, self.calls.progress, NULL)
        return report

    def decimate(self, target: int) -> None:
        with _about(self._name):
            call("fxs_scene_file_decimate", self.handle, target, self.info, self.calls.progress, NULL)

    def pack(self, profile: str, threads: int) -> Struct:
        options = _open_options({}, profile, threads, self.calls)
        handle, self.handle, opened = self.handle, NULL, new("fxs_opened *")
        with _about(self._name):
            call("fxs_open_gaussians", file_name(self._name), handle, self.info, options, opened)
        return opened[0]

    def __enter__(self) -> "_File":
        return self

    def __exit__(self, *_: object) -> None:
        lib.fxs_scene_file_close(self.handle)


def load(source: "Union[PathLike, bytes, bytearray, memoryview]", *, profile: str = "default", level: int = 0,
         axes: str = "file", max_gaussians: int = 0, max_memory: int = 0, threads: int = 0,
         progress: Progress = None) -> Scene:
    """Opens a scene of any format that the library reads, and returns it. Raises an Error where it cannot be opened.

    source: the path of a scene file, or the bytes of one file. An .fxs file is mapped into memory and rendered from
    there; a file of another format is packed in memory.
    profile: how a file of another format is packed. At SH degree 3, a Gaussian takes 63.5 bytes with "default", 39.6
    with "compact" and 19.6 with "small".
    level: the level of detail of an .lcc or a streamed .sog file. 0 is the finest level.
    axes: the axes of an .spz file: "file" (as the file states), "rub" (right, up, back) or "rdf" (right, down, front).
    max_gaussians: the largest number of Gaussians; a scene with more is an Error. 0 stands for the library's limit.
    max_memory: the largest number of bytes that reading may take; to need more is an Error. 0 stands for the library's
    limit.
    threads: the number of threads, 1 to 64. 0 stands for one thread on each processor. The packed scene does not depend
    on the number of threads.
    progress: a function that is called now and then with a number from 0 to 1, which may start again from 0. An
    exception in it ends the call.
    """
    opened = new("fxs_opened *")
    with Calls(progress) as calls:
        options = _open_options(_file_options(level, axes, max_gaussians, max_memory, calls), profile, threads, calls)
        if isinstance(source, (bytes, bytearray, memoryview)):
            data = bytes(source)
            name, held, options.check_all = "bytes", ffi.from_buffer(data), 1
            call("fxs_open_memory", name.encode(), held, len(data), options, opened)
        elif isinstance(source, (str, os.PathLike)):
            lib.fxs_map_guard()
            name, held = os.fsdecode(file_name(source)), None
            call("fxs_open", file_name(source), options, opened)
        else:
            raise TypeError(f"source: expected a path or bytes, not {type(source).__name__}")
        memory, report = Memory.opened(opened[0], name, held), opened[0].report
    return Scene(memory, report.read - report.packed, report.brought_in)


# ---- Converting ------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Conversion:
    """The numbers of Gaussians that a conversion read, wrote and left out.

    read: the number of Gaussians in the source.
    written: the number of Gaussians in the new file. With `decimate` it is smaller than the number that was kept.
    outside: Gaussians left out by `crop` and `sphere`. faint: Gaussians left out by `prune`. floaters: Gaussians left
    out by `drop_floaters`.
    left_out: Gaussians that cannot be drawn.
    brought_in: Gaussians farther than 2^27 units away, which were packed nearer.
    clamped: for .spz, the largest of the numbers of Gaussians with a position, a scale or a colour that the format
    cannot hold.
    lost_sh: the degree of SH that the format cannot hold, or 0.
    lost_antialiased: True where the scene is anti-aliased and the format cannot say so.
    """
    read: int
    written: int
    outside: int
    faint: int
    floaters: int
    left_out: int
    brought_in: int = 0
    clamped: int = 0
    lost_sh: int = 0
    lost_antialiased: bool = False


def convert(src: PathLike, dst: PathLike, *, crop: Any = None, sphere: Any = None, prune: float = 0,
            drop_floaters: bool = False, sh_degree: int = 3, decimate: Optional[int] = None,
            profile: Optional[str] = None, spz_version: Optional[int] = None, level: int = 0, axes: str = "file",
            max_gaussians: int = 0, max_memory: int = 0, threads: int = 0, progress: Progress = None) -> Conversion:
    """Converts the scene file src into the scene file dst. The ending of dst chooses the format, and
    `fixsplat help formats` lists the formats that can be written. The new file has the same bytes as the file that
    `fixsplat convert` writes. An existing file of this name is replaced when the new file is complete. Raises an Error
    where a file cannot be read or written, and a ValueError for an argument that is not valid.

    crop: the corners (low, high) of a box, of shape (2, 3), in scene units. Gaussians with a centre in it are kept.
    sphere: x, y, z and the radius of a sphere, of shape (4,), in scene units. Gaussians with a centre in it are kept.
    prune: Gaussians of at least this opacity are kept, 0 to 1.
    drop_floaters: True leaves out Gaussians with almost nothing around them.
    sh_degree: SH are kept up to this degree, 0 to 3.
    decimate: neighbours are merged until this number of Gaussians is left. None merges no Gaussians.
    profile: the profile of an .fxs file: "default", "compact" or "small". None stands for "default".
    spz_version: the version of an .spz file: 3 (gzip) or 4 (zstd). None stands for 4.
    level, axes, max_gaussians, max_memory, threads, progress: as for `load`.
    """
    source, out = os.fsdecode(file_name(src)), os.fsdecode(file_name(dst))
    packed = out.endswith(".fxs")
    if not packed and not lib.fxs_scene_format_of(file_name(dst), 1):
        endings = ffi.new("char[]", 1 + lib.fxs_scene_format_endings(NULL, 0, 1))
        lib.fxs_scene_format_endings(endings, len(endings), 1)
        raise ValueError(f"{out}: expected a name ending in one of {string(endings)}")
    if profile is not None and not packed:
        raise ValueError("profile: is for .fxs")
    if spz_version is not None and not out.endswith(".spz"):
        raise ValueError("spz_version: is for .spz")
    version = whole("spz_version", 4 if spz_version is None else spz_version, 3, 4)
    target = None if decimate is None else whole("decimate", decimate, 1, 2**64 - 1)
    how = _filter(crop, sphere, prune, drop_floaters, sh_degree)
    how.drawable = not packed or target is not None
    _check_names(source, out)
    options = (level, axes, max_gaussians, max_memory)
    with Calls(progress) as calls, _File(source, _file_options(*options, calls), calls) as file:
        kept = file.filter(how)
        if target is not None:
            file.decimate(target)
        if packed:
            return _pack_into(file, out, profile or "default", threads, kept)
        written = _write_into(file, out, version, progress)
        clamped = max(getattr(written.clamped, name) for name in ("position", "scale", "dc", "sh"))
        return _conversion(kept, file.info.count, 0, 0, clamped, written.lost_sh, bool(written.lost_antialiased))


def _check_names(source: str, out: str) -> None:
    if os.path.exists(source) and os.path.exists(out) and os.path.samefile(source, out):
        raise Error(f"{out}: is read and cannot be written too; give it another name", lib.FXS_ERR_FILE)


def _filter(crop: Any, sphere: Any, prune: float, drop_floaters: bool, sh_degree: int) -> Struct:
    how = new("fxs_scene_filter")
    lib.fxs_scene_filter_default(how)
    if crop is not None:
        low, high = numbers("crop", crop, (2, 3))
        if (low > high).any():
            raise ValueError("crop: its low is above its high")
        how.low, how.high = list(low), list(high)
    if sphere is not None:
        x, y, z, radius = numbers("sphere", sphere, (4,))
        if radius < 0:
            raise ValueError("sphere: its radius is below 0")
        how.middle, how.radius = (x, y, z), radius
    how.opacity = number("prune", prune, 0, 1)
    how.sh_degree = whole("sh_degree", sh_degree, 0, 3)
    how.floaters = bool(drop_floaters)
    return how


def _conversion(kept: Struct, written: int, dropped: int, *rest: Any) -> Conversion:
    left_out = kept.dropped.not_finite + kept.dropped.rotation + dropped
    return Conversion(kept.read, written, kept.outside, kept.faint, kept.floaters, left_out, *rest)


def _pack_into(file: _File, out: str, profile: str, threads: int, kept: Struct) -> Conversion:
    opened = file.pack(profile, threads)
    report = opened.report
    with Scene(Memory.opened(opened, out)) as scene:
        scene.save(out)
        return _conversion(kept, report.packed, report.read - report.packed, report.brought_in)


def _batches(file: _File) -> "Iterator[Tuple[Any, int]]":
    """Yields the Gaussians of a file, at most 4096 at a time, with their number."""
    batch = ffi.new("fxs_gaussian[4096]")
    while True:
        n = call("fxs_scene_file_read", file.handle, batch, len(batch))
        if n == 0:
            return
        file.calls.heard()
        yield batch, n


def _find_bounds(file: _File, options: Struct) -> None:
    """Reads the whole file to find the bounds of the centres of its Gaussians, and returns to the beginning of the
    file."""
    low, high = np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32)
    for batch, n in _batches(file):
        centres = np.frombuffer(ffi.buffer(batch), np.float32).reshape(len(batch), -1)[:n, :3]
        low, high = np.minimum(low, centres.min(0)), np.maximum(high, centres.max(0))
    options.low, options.high = list(low), list(high)
    call("fxs_scene_file_rewind", file.handle)


def _write_into(file: _File, out: str, spz_version: int, progress: Progress) -> Struct:
    info, writer, report, done = file.info, new("fxs_scene_writer *"), new("fxs_scene_write_report"), 0
    options = new("fxs_scene_write_options", count=info.count, sh_degree=info.sh_degree, antialiased=info.antialiased,
                  spz_version=spz_version)
    if out.endswith(".glb"):
        _find_bounds(file, options)
    call("fxs_scene_writer_open", file_name(out), options, writer)
    try:
        for batch, n in _batches(file):
            if progress is not None:
                progress(done / info.count)
            call("fxs_scene_writer_put", writer[0], batch, n)
            done += n
    except BaseException:
        # With Gaussians missing, it removes what it has written.
        lib.fxs_scene_writer_close(writer[0], report, NULL, NULL, new("fxs_message"))
        raise
    call("fxs_scene_writer_close", writer[0], report, file.calls.progress, NULL)
    return report
