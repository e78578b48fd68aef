"""Converts and edits scenes: files, packed scenes and arrays."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Optional, Tuple, Union

import numpy as np

from ._camera import number, numbers
from ._gaussians import Gaussians, Progress, Stream, file_options
from ._library import NULL, Calls, Error, PathLike, Struct, call, ffi, file_name, lib, new, sized, string, whole
from ._scene import Memory, Scene

Source = Union[PathLike, Gaussians, Scene]


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
    outside: int = 0
    faint: int = 0
    floaters: int = 0
    left_out: int = 0
    brought_in: int = 0
    clamped: int = 0
    lost_sh: int = 0
    lost_antialiased: bool = False


def convert(src: Source, dst: PathLike, *, up: Any = None, rotate: Any = None, scale: float = 1, translate: Any = None,
            crop: Any = None, sphere: Any = None, prune: float = 0, drop_floaters: bool = False, sh_degree: int = 3,
            decimate: Optional[float] = None, time: Optional[float] = None, times: Any = None,
            profile: Optional[str] = None, spz_version: Optional[int] = None, spz_fine: bool = False, level: int = 0, axes: str = "file",
            max_gaussians: int = 0, max_memory: int = 0, threads: int = 0, progress: Progress = None) -> Conversion:
    """Converts the scene src into the scene file dst. src is the path of a scene file, Gaussians, or a Scene. The
    ending of dst chooses the format, and `fixsplat help formats` lists the formats that can be written. The new file
    has the same bytes as the file that `fixsplat convert` writes with the options of the same names. An existing file
    of this name is replaced when the new file is complete. Raises an Error where a file cannot be read or written, and
    a ValueError for an argument that is not valid.

    The scene is first turned, scaled and moved, in this order, with its SH, in the axes of a .ply (x right, y down, z
    to the front). Then Gaussians are left out, by where they are now; neighbours are merged last.

    up: a direction of shape (3,), which is turned to up, (0, -1, 0), by the shortest way. An .fxs then says that this
    is up (`Scene.up`). An .fxs that is converted to an .fxs keeps what it says of that, and its start view unless it
    is cropped.
    rotate: degrees of shape (3,): a turn about the x axis, then about the y axis, then about the z axis.
    scale: the factor of the size, about the origin, 2^-16 to 2^16.
    translate: the movement, of shape (3,), in scene units.
    crop: the corners (low, high) of a box, of shape (2, 3), in scene units. Gaussians with a centre in it are kept.
    sphere: x, y, z and the radius of a sphere, of shape (4,), in scene units. Gaussians with a centre in it are kept.
    prune: Gaussians of at least this opacity are kept, 0 to 1.
    drop_floaters: True leaves out Gaussians with almost nothing around them.
    sh_degree: SH are kept up to this degree, 0 to 3.
    decimate: neighbours are merged until this number of Gaussians is left, or, for a float above 0 and up to 1.0, this
    share of them. None merges no Gaussians.
    time: the moment at which a scene that moves is converted, in seconds. None keeps the motion, which only an .fxs or
    a .splat4d can hold, without drop_floaters and decimate.
    times: the range (start, end) of a scene that moves, in seconds, which begins at 0 in dst. None keeps all of it.
    profile: the profile of an .fxs file: "default", "compact" or "small". None stands for "default".
    spz_version: the version of an .spz file: 3 (gzip) or 4 (zstd). None stands for 4.
    spz_fine: True gives an .spz file all 8 bits of SH and all 24 of positions.
    level, axes, max_gaussians, max_memory, threads, progress: as for `load`. The first four are for files.
    """
    out = os.fsdecode(file_name(dst))
    packed = out.endswith(".fxs")
    if not packed and not lib.fxs_scene_format_of(file_name(dst), 1):
        endings = ffi.new("char[]", 1 + lib.fxs_scene_format_endings(NULL, 0, 1))
        lib.fxs_scene_format_endings(endings, len(endings), 1)
        raise ValueError(f"{out}: expected a name ending in one of {string(endings)}")
    if profile is not None and not packed:
        raise ValueError("profile: is for .fxs")
    if spz_version is not None and not out.endswith(".spz"):
        raise ValueError("spz_version: is for .spz")
    if spz_fine and not out.endswith(".spz"):
        raise ValueError("spz_fine: is for .spz")
    version = whole("spz_version", 4 if spz_version is None else spz_version, 3, 4)
    share = number("decimate", decimate, math.ulp(0), 1) if isinstance(decimate, float) else 0
    target = 0 if share or decimate is None else whole("decimate", decimate, 1, 2**64 - 1)
    how = _filter(crop, sphere, prune, drop_floaters, sh_degree)
    how.drawable = not packed or decimate is not None
    placement = _placement(up, rotate, scale, translate)
    known = None if up is None else list(numbers("up", up, (3,)))
    with Calls(progress) as calls, _open(src, out, (level, axes, max_gaussians, max_memory), calls) as stream:
        if times is not None:
            stream.between(*numbers("times", times, (2,)))
        if time is not None:
            stream.at(time)
        if not lib.fxs_placement_is_plain(placement):
            stream.place(placement, known)
        elif known is not None:
            stream.info.start.up = known
        if stream.moves and not lib.fxs_scene_format_of(file_name(dst), 1).moves:
            raise ValueError(f"{out}: holds no motion: give time")
        kept = stream.filter(how)
        if decimate is not None:
            stream.decimate(target or math.ceil(share * stream.info.count))
        if packed:
            return _pack_into(stream, out, profile or "default", threads, kept, crop is not None or sphere is not None)
        written = _write_into(stream, out, version, spz_fine, progress)
        clamped = max(getattr(written.clamped, name) for name in ("position", "scale", "dc", "sh"))
        return _conversion(kept, stream.info.count, 0, 0, clamped, written.lost_sh, bool(written.lost_antialiased))


def _open(src: Source, out: str, options: "Tuple[int, str, int, int]", calls: Calls) -> Stream:
    if isinstance(src, (str, os.PathLike)):
        if os.path.exists(src) and os.path.exists(out) and os.path.samefile(src, out):
            raise Error(f"{out}: is read and cannot be written too; give it another name", lib.FXS_ERR_FILE)
        return Stream.of_file(src, file_options(*options, calls), calls)
    if options != (0, "file", 0, 0):
        raise ValueError("level, axes, max_gaussians, max_memory: are for files")
    if isinstance(src, Scene):
        return Stream.of_scene(src.memory, calls)
    if isinstance(src, Gaussians):
        return Stream.of_arrays(src, calls)
    raise TypeError(f"src: expected a path, Gaussians or a Scene, not {type(src).__name__}")


def _placement(up: Any, rotate: Any, scale: float, translate: Any) -> Struct:
    placement = new("fxs_placement")
    lib.fxs_placement_init(placement, 0, 0)
    if up is not None:
        direction = numbers("up", up, (3,))
        if not direction.any():
            raise ValueError("up: expected a direction, not 0, 0, 0")
        lib.fxs_placement_turn_up(placement, list(direction))
    if rotate is not None:
        for axis, degrees in enumerate(numbers("rotate", rotate, (3,))):
            if degrees:
                lib.fxs_placement_turn(placement, axis, degrees)
    placement.scale = number("scale", scale, 2.0**-16, 2.0**16)
    if translate is not None:
        placement.translation = list(numbers("translate", translate, (3,)))
    call("fxs_object_place", new("fxs_object"), NULL, placement, NULL)
    return placement


def _filter(crop: Any, sphere: Any, prune: float, drop_floaters: bool, sh_degree: int) -> Struct:
    how = sized("fxs_scene_filter")
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
    left_out = kept.dropped.not_finite + kept.dropped.rotation + kept.dropped.transparent + dropped
    return Conversion(kept.read, written, kept.outside, kept.faint, kept.floaters, left_out, *rest)


def _pack_into(stream: Stream, out: str, profile: str, threads: int, kept: Struct, is_part: bool) -> Conversion:
    opened = stream.pack(profile, threads)
    report = opened.report
    if is_part and not opened.info.start.tangent:
        call("fxs_start_choose", ffi.cast("void *", opened.data), opened.bytes)
    with Scene(Memory.opened(opened, out)) as scene:
        scene.save(out)
        return _conversion(kept, report.packed, report.read - report.packed, report.brought_in)


def _find_bounds(stream: Stream, options: Struct) -> None:
    """Reads the whole file to find the bounds of the centres of its Gaussians, and returns to the beginning of the
    file."""
    low, high = np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32)
    for batch, n in stream.batches():
        centres = np.frombuffer(ffi.buffer(batch), np.float32).reshape(len(batch), -1)[:n, :3]
        low, high = np.minimum(low, centres.min(0)), np.maximum(high, centres.max(0))
    options.low, options.high = list(low), list(high)
    stream.rewind()


def _write_into(stream: Stream, out: str, spz_version: int, spz_fine: bool, progress: Progress) -> Struct:
    info, writer, report, done = stream.info, new("fxs_scene_writer *"), new("fxs_scene_write_report"), 0
    options = sized("fxs_scene_write_options", count=info.count, sh_degree=info.sh_degree, antialiased=info.antialiased,
                    spz_version=spz_version, spz_fine=bool(spz_fine), origin=list(info.origin), time=info.time)
    if out.endswith(".glb"):
        _find_bounds(stream, options)
    call("fxs_scene_writer_open", file_name(out), options, writer)
    try:
        for batch, n in stream.batches():
            if progress is not None:
                progress(done / info.count)
            if stream.moves:
                motions = lib.fxs_scene_file_motions(stream.handle)
                call("fxs_scene_writer_put_moving", writer[0], batch, motions, n)
            else:
                call("fxs_scene_writer_put", writer[0], batch, n)
            done += n
    except BaseException:
        # Closing an unfinished writer removes its file.
        lib.fxs_scene_writer_close(writer[0], report, NULL, new("fxs_message"))
        raise
    call("fxs_scene_writer_close", writer[0], report, stream.calls.progress)
    return report
