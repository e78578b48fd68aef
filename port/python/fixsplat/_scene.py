"""Packed scenes: loaded from files and bytes, packed from arrays, saved."""
from __future__ import annotations

import os
import weakref
from types import TracebackType
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

from ._camera import Camera, number, numbers
from ._gaussians import Gaussians, Progress, Stream, file_options, open_options
from ._library import PROFILES, Calls, PathLike, Struct, call, context, ffi, file_name, lib, new, sized, string, whole

if TYPE_CHECKING:
    from ._convert import Conversion
    from ._render import Picture

Box = Tuple[Tuple[float, float, float], Tuple[float, float, float]]


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

    def sealed(self) -> Any:
        """Returns the scene as the bytes of an .fxs file. Where it was packed in memory, it has no checksums: they are
        put into a copy, because other threads may read the scene."""
        if self._opened is not None and string(self._opened.info.format) == "fxs":
            return self.data
        block = np.empty(self.size + 63, np.uint8)
        data = ffi.from_buffer(block[-block.ctypes.data % 64:])
        ffi.memmove(data, self.data, self.size)
        lib.fxs_file_seal(data, self.size)
        return data

    def check(self) -> None:
        """Raises an Error if the mapped file of the scene has been written to."""
        if self._opened is not None:
            call("fxs_opened_check", self._opened)


class Scene:
    """A packed scene, the form that the renderer draws. `load`, `fit` and `Scene.from_arrays` make scenes.

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

    @classmethod
    def from_arrays(cls, positions: Any, scales: Any, rotations: Any, opacities: Any, sh: Any, *,
                    antialiased: bool = False, profile: str = "default", threads: int = 0,
                    progress: Progress = None) -> "Scene":
        """Packs Gaussians from arrays, and returns the scene. `Gaussians` says what the arrays hold: scales are
        logarithms, rotations w, x, y, z, opacities before the sigmoid, and SH of shape (N, K, 3). Gaussians with a
        number that is not finite are left out, and counted in left_out. profile, threads, progress: as for `load`."""
        gaussians = Gaussians(positions, scales, rotations, opacities, sh, antialiased)
        return gaussians.pack(profile=profile, threads=threads, progress=progress)

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
    def duration(self) -> float:
        """The duration of a scene that moves, in seconds: its times are 0 to the duration. 0 if the scene is still."""
        return float(lib.fxs_scene_motion(self.memory.scene).duration_q32) / 2**32

    @property
    def rate(self) -> float:
        """The frames a second of the source of a scene that moves; 0 if there are none, or the scene is still."""
        return float(lib.fxs_scene_motion(self.memory.scene).rate_q32) / 2**32

    @property
    def loops(self) -> bool:
        """Whether a scene that moves starts again after its duration."""
        return bool(lib.fxs_scene_motion(self.memory.scene).loops)

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

    @property
    def up(self) -> "Optional[npt.NDArray[np.float64]]":
        """The direction that is up in the scene, of length 1, as the .fxs says it; None where it does not."""
        start = new("fxs_start")
        lib.fxs_start_of(start, self.memory.data)
        up = np.array(list(start.up))
        return up if up.any() else None

    def frame(self, width: int, height: int, *, fov: Optional[float] = None,
              up: Optional[Sequence[float]] = None) -> Camera:
        """Makes a camera as `fixsplat render` does without one: the start view that an .fxs keeps, else one that shows
        most of the scene, upright by `Scene.up` or as found, which small pictures from many sides find. width, height:
        the size of the picture in pixels. fov: the vertical field of view, 1 to 170 degrees; None stands for that of
        the start view, or 50. up: the direction that is up. With it, the camera shows the whole scene from the front
        and slightly above. With `fov` or `up`, the start view is not taken."""
        view, start = new("fxs_view"), new("fxs_start")
        low, high = self.inner_box
        size = whole("width", width, 1, lib.FXS_MAX_SIZE), whole("height", height, 1, lib.FXS_MAX_SIZE)
        picture = new("fxs_picture", fov=number("fov", 50 if fov is None else fov, 1, 170), width=size[0],
                      height=size[1])
        if up is None and fov is None and lib.fxs_view_of_start(view, self.memory.data, *size):
            view.near = lib.fxs_near_of_box(list(low), list(high))
        elif up is None:
            memory = self.memory
            placed = sized("fxs_object", memory.scene)
            lib.fxs_start_of(start, memory.data)
            call("fxs_first_view", placed, 1, [low, high], start.up, picture, view)
        else:
            call("fxs_view_frame_box", view, low, high, list(numbers("up", up, (3,))), picture)
        return Camera._of(view)

    def render(self, K: Any, world_to_camera: Any = None, width: Optional[int] = None, height: Optional[int] = None,
               **options: Any) -> "Picture":
        """Draws the scene by itself, at the origin. It calls `fixsplat.render` with this scene as the only object, and
        takes the same arguments and options."""
        from ._render import Object, render
        return render([Object(self)], K, world_to_camera, width, height, **options)

    def arrays(self, *, progress: Progress = None) -> Gaussians:
        """Returns the Gaussians as arrays of floats: the values that the codes of the packed scene stand for, in the
        order of `numbers`. The floats of a file are those of `load_gaussians`."""
        with Calls(progress) as calls, Stream.of_scene(self.memory, calls) as stream:
            return stream.arrays(progress)

    @property
    def numbers(self) -> "npt.NDArray[np.uint32]":
        """The number that the target "ids" has for each Gaussian of `arrays`, of shape (count,), increasing. It is 0,
        1, 2 and so on, but for scenes with Gaussians that are far beyond all others."""
        numbers = np.empty(self.count, np.uint32)
        found = lib.fxs_scene_numbers(self.memory.scene, ffi.from_buffer("uint32_t[]", numbers))
        return numbers[:found]

    def select(self, mask: Any) -> "Scene":
        """Makes a scene of some of the Gaussians, in the same profile. mask: an array of `count` bools, an array of
        numbers of Gaussians, or a slice. The Gaussians are packed again, which rounds them again;
        `load_gaussians(path).select(mask)` does not round."""
        return self.arrays().select(mask).pack(profile=self.profile)

    def mark(self, camera: Camera, hints: "Sequence[Sequence[int]]", *, threads: int = 0) -> "npt.NDArray[np.uint8]":
        """Marks pixels of a picture of the scene from clicks and boxes, for `find`: an array of shape (height, width).
        hints: (x, y, object) for a click, (x, y, right, bottom, object) for a box around an object; object 0 stands for
        something else. threads: as for `load`."""
        made = ffi.new("fxs_select_hint[]", len(hints))
        for hint, values in zip(made, hints):
            if len(values) not in (3, 5):
                raise ValueError(f"hints: expected (x, y, object) or (x, y, right, bottom, object), not {values}")
            hint.x, hint.y, hint.right, hint.bottom = (*values[:-1], *values[:-1])[:4]
            hint.object = values[-1]
        marks = np.empty((camera.height, camera.width), np.uint8)
        with context(threads) as (made_context, _):
            call("fxs_select_mark", made_context, self.memory.scene, camera.rounded(), made, len(hints),
                 ffi.from_buffer("uint8_t[]", marks))
        return marks

    def find(self, views: "Sequence[Tuple[Camera, Any]]", *, objects: int = 1, bias: float = 0, trim: float = 0,
             alone: bool = False, threads: int = 0) -> "npt.NDArray[np.uint8]":
        """Finds the Gaussians of objects, as `fixsplat select` does. Returns the object of each Gaussian of `arrays`:
        1 to `objects`, 0 for none, 255 for one on a border. `scene.select(scene.find(...) == 1)` is the object.
        views: pairs of a camera and its marks, of shape (height, width): 1 to `objects` where the picture shows an
        object, 0 where it shows something else, 255 where it is unknown; as by `mark`, or from masks. bias, trim,
        alone, threads: as for `fixsplat select`, but the trim is 0 if it is omitted."""
        made, kept = ffi.new("fxs_select_view[]", len(views)), []
        for view, (camera, marks) in zip(made, views):
            kept.append(np.ascontiguousarray(marks, np.uint8))
            if kept[-1].shape != (camera.height, camera.width):
                raise ValueError(f"views: expected marks of shape {(camera.height, camera.width)}, "
                                 f"not {kept[-1].shape}")
            view.camera = camera.rounded()[0]
            view.marks = ffi.from_buffer("uint8_t[]", kept[-1])
        found = np.empty(self.memory.scene.chunk_count * lib.FXS_CHUNK, np.uint8)
        with context(threads) as (made_context, made_workers):
            options = sized("fxs_select_options", objects=whole("objects", objects, 1, lib.FXS_SELECT_OBJECTS),
                            bias=number("bias", bias, -1, 1), trim=number("trim", trim, 0, 1), exact=int(alone),
                            workers=made_workers[0])
            call("fxs_select", made_context, self.memory.scene, made, len(views), options,
                 ffi.from_buffer("uint8_t[]", found))
        return found[self.numbers]

    def save(self, path: PathLike, **options: Any) -> "Conversion":
        """Writes the scene to a file; the ending of its name chooses the format. An .fxs file can be opened without
        packing. Other formats get the values that the codes of the packed scene stand for. An existing file of this
        name is replaced when the new file is complete. options: as for `convert`; with options, an .fxs file is packed
        again."""
        from ._convert import Conversion, convert
        name, memory = file_name(path), self.memory
        if options or not name.endswith(b".fxs"):
            return convert(self, path, **options)
        call("fxs_file_write", name, memory.data, memory.size)
        return Conversion(self.count, self.count)

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
        low, high = ("(" + ", ".join(f"{x:.6g}" for x in corner) + ")" for corner in self.box)
        return (f"<fixsplat.Scene {self._memory.name!r}, {self.count} Gaussians, SH degree {self.sh_degree}, "
                f"from {low} to {high}>")


# ---- Reading scenes --------------------------------------------------------------------------------------------------

def load(source: "Union[PathLike, bytes, bytearray, memoryview]", *, profile: str = "default", level: int = 0,
         axes: str = "file", max_gaussians: int = 0, max_memory: int = 0, threads: int = 0,
         progress: Progress = None) -> Scene:
    """Opens a scene of any format that the library reads, and returns it. Raises an Error where it cannot be opened.

    source: the path of a scene file, or the bytes of one file. An .fxs file is mapped into memory and rendered from
    there; a file of another format is packed in memory.
    profile: how a file of another format is packed. At SH degree 3, a Gaussian takes 63.5 bytes with "default", 39.6
    with "compact" and 19.6 with "small".
    level: the level of detail of an .lcc, a .rad or a streamed .sog file. 0 is the finest level.
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
        file = file_options(level, axes, max_gaussians, max_memory, calls)
        options = open_options(file, profile, threads, calls)
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
