"""Objects, back ends, and the pictures that are rendered from them."""
from __future__ import annotations

import math
import os
import threading
import weakref
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Callable, Dict, Iterator, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

from ._camera import Camera, number, numbers, rotation_of
from ._library import (CUTOFFS, NULL, Calls, Error, PathLike, Struct, call, check, choose, colour, ffi, file_name, lib,
                       new, signals, sized, string, whole)
from ._scene import Memory, Scene

NOTHING: int = lib.FXS_NOTHING
TARGETS = ("colour", "coverage", "mean_depth", "median_depth", "ids")


# ---- Objects ---------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Crop:
    """A box in the coordinates of the scene. It keeps the Gaussians with a centre inside the box, or with outside=True
    leaves them out.

    low, high: the corners of the box with the least and the greatest x, y, z, of shape (3,), in scene units.
    """
    low: Any
    high: Any
    outside: bool = False


@dataclass(frozen=True)
class Object:
    """A scene placed in the world. A position in the scene becomes translation + scale * rotation * position in the
    world, and the SH turn with the scene.

    rotation: a quaternion w, x, y, z of shape (4,) and any length but 0, or a matrix of shape (3, 3) that turns from
    the scene to the world.
    translation: the position of the scene's origin in the world, of shape (3,), in world units.
    scale: the size of the scene in the world, 2^-16 to 2^16.
    opacity: a factor for the opacity of all Gaussians, 0 to 1.
    tint: factors for red, green and blue, 0 to 4 each, of shape (3,).
    visible: False leaves the object out of pictures.
    id: the number that the target "ids" has for the object, 0 to 2^32 - 2.
    time: seconds that are added to the moment of a picture, if the scene moves.
    crops: at most 8 boxes. A Gaussian is drawn where it lies in at least one box that keeps Gaussians, if there is such
    a box, and in no box that leaves Gaussians out.
    """
    scene: Scene
    rotation: Any = (1, 0, 0, 0)
    translation: Any = (0, 0, 0)
    scale: float = 1
    opacity: float = 1
    tint: Any = (1, 1, 1)
    visible: bool = True
    id: int = 0
    crops: Sequence[Crop] = field(default=())
    time: float = 0

    def _placement(self) -> Struct:
        placement = new("fxs_placement")
        lib.fxs_placement_init(placement, 0, whole("id", self.id, 0, NOTHING - 1))
        placement.translation = list(numbers("translation", self.translation, (3,)))
        rotation = numbers("rotation", self.rotation, (4,), (3, 3))
        placement.rotation = list(rotation if rotation.ndim == 1 else _quaternion(rotation))
        placement.scale = number("scale", self.scale, 2.0**-16, 2.0**16)
        placement.opacity = number("opacity", self.opacity, 0, 1)
        placement.tint = list(numbers("tint", self.tint, (3,)))
        placement.visible = bool(self.visible)
        if len(self.crops) > lib.FXS_MAX_CROPS:
            raise ValueError(f"crops: {len(self.crops)} boxes, at most {lib.FXS_MAX_CROPS}")
        placement.crop_count = len(self.crops)
        for i, crop in enumerate(self.crops):
            placement.crops[i] = {"low": list(numbers("crop.low", crop.low, (3,))),
                                  "high": list(numbers("crop.high", crop.high, (3,))), "outside": bool(crop.outside)}
        return placement


def _quaternion(matrix: "npt.NDArray[np.float64]") -> "npt.NDArray[np.float64]":
    """Returns the quaternion of a rotation matrix M. It is the eigenvector with the largest eigenvalue of the symmetric
    matrix N for which q^T N q is the trace of R(q)^T M (Horn 1987)."""
    m = rotation_of("rotation", matrix)
    form = np.array([
        [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
        [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
        [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1]]])
    return np.asarray(np.linalg.eigh(form)[1][:, 3])


class _Placed:
    """An array of objects in the form of C, with the memory to which the objects point. The memory is kept as long as
    this array."""

    def __init__(self, objects: "Sequence[Object]"):
        if len(objects) > lib.FXS_MAX_OBJECTS:
            raise ValueError(f"{len(objects)} objects: at most {lib.FXS_MAX_OBJECTS}")
        self.memories = [o.scene.memory for o in objects]
        self.placements = [o._placement() for o in objects]
        self.array = ffi.new("fxs_object[]", len(objects))
        self._crops = ffi.new("fxs_crop[]", lib.FXS_MAX_CROPS * len(objects))
        for i, (memory, placement) in enumerate(zip(self.memories, self.placements)):
            call("fxs_object_place", self.array + i, memory.scene, placement, self._crops + i * lib.FXS_MAX_CROPS)
            self.array[i].time_q32 = _seconds(objects[i].time)

    def depth_bits(self, camera: Camera) -> int:
        """Returns the largest number of binary digits after the point, at most 28, with which the depths of all objects
        from this camera fit into 32 bits. `fixsplat render --depth` uses the same number."""
        farthest = 1.0
        for memory, placement in zip(self.memories, self.placements):
            low, high = ffi.new("double[3]"), ffi.new("double[3]")
            if placement.visible and lib.fxs_placement_box(placement, *memory.box, low, high):
                corners = np.stack(np.meshgrid(*zip(low, high)), -1).reshape(8, 3)
                farthest = max(farthest, ((corners - camera.position) @ camera.world_to_camera[2, :3]).max())
        exponent = math.frexp(2 * farthest)[1]
        return 28 if exponent < 4 else 32 - exponent if exponent < 31 else 1


# ---- Back ends -------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Backend:
    """A back end: one way to render a picture.

    name: the name that `render` takes. does: a description in words.
    devices: the names of its devices, in the order of their numbers.
    missing: the reason why the back end has no device, in words; None where it has one.
    depths: True where it can write the targets of depths and ids.
    """
    name: str
    does: str
    devices: Tuple[str, ...]
    missing: Optional[str]
    depths: bool


def backends() -> "list[Backend]":
    """Lists all back ends, the processor first. A back end that cannot be used on this machine or is not part of this
    build is listed too, with the reason in `missing`."""
    result: "list[Backend]" = []
    while True:
        table = lib.fxs_backend_at(len(result))
        if not table:
            return result
        message, name = new("fxs_message"), ffi.new("char[256]")
        devices: "list[str]" = []
        while table.device(len(devices), name, len(name), message) == 0:
            devices.append(string(name))
            if not table.can & lib.FXS_CAN_DEVICES:
                break
        missing = None if devices else string(message.text)
        result.append(Backend(string(table.name), string(table.does), tuple(devices), missing,
                              bool(table.can & lib.FXS_CAN_TRACE)))


class Renderer:
    """An open back end, with its threads, its working memory and, on a device, its copies of scenes.

    `render` opens a renderer for each thread of the program and keeps it. A program opens a renderer by itself if it
    wants to choose the time when the renderer is closed. It gives the renderer to `render` as `backend`. The renderer
    is closed by `close`, at the end of a `with`, or when it is no longer used. Threads may share a renderer and take
    turns, but a renderer of OpenGL may be used only by the thread that opened it.

    backend: "auto", which is the processor, or the name of one of `backends()`.
    threads: the number of threads of the processor, 1 to 64. 0 stands for one thread on each processor.
    device: the number of the device.
    max_memory: the largest number of bytes of working memory, or of memory on the device. 0 stands for no limit.
    A picture depends on none of the last three.
    """

    def __init__(self, backend: str = "auto", *, threads: int = 0, device: int = 0, max_memory: int = 0):
        if not isinstance(backend, str):
            raise TypeError(f"backend: expected a name or a Renderer, not {type(backend).__name__}")
        self._table = lib.fxs_backend_find(backend.encode())
        if not self._table:
            names = ", ".join(["auto"] + [b.name for b in backends()])
            raise ValueError(f"backend={backend!r}: expected one of {names}")
        options = sized("fxs_backend_options", device=whole("device", device, 0, 2**31 - 1),
                        max_memory=whole("max_memory", max_memory, 0, 2**64 - 1),
                        threads=whole("threads", threads, 0, 64))
        handle, message, self.name = new("void *"), new("fxs_message"), string(self._table.name)
        check(self._table.open(handle, options, message), message, f"backend {self.name}: ")
        self._handle = handle[0]
        self._lock, self._process, self._thread = threading.Lock(), os.getpid(), threading.get_ident()
        self._drawn: "Dict[Struct, weakref.ref[Memory]]" = {}
        self._close = weakref.finalize(self, _close_backend, self._table, self._handle, self._process)
        self._close.atexit = False

    @property
    def can(self) -> int:
        return int(self._table.can)

    @contextmanager
    def _turn(self) -> "Iterator[None]":
        if self._process != os.getpid():
            raise RuntimeError("the renderer was opened by another process, before a fork")
        if self.name.startswith(("gles", "osmesa")) and self._thread != threading.get_ident():
            raise RuntimeError(f"backend {self.name}: a renderer of OpenGL is used by the thread that opened it")
        with self._lock:
            if not self._close.alive:
                raise ValueError("the renderer is closed")
            yield

    def draw(self, placed: _Placed, request: Struct) -> None:
        """Draws into the targets of the request, and waits until the picture is complete, or until Ctrl-C raises an
        exception. A signal whose handler raises nothing leaves a picture to be drawn once more."""
        message, stop, given = new("fxs_message"), request.options.stop, bool(request.options.stop.call)
        with self._turn():
            self._forget_closed()
            for memory in placed.memories:
                self._drawn[memory.scene] = weakref.ref(memory)
            with signals() as byte:
                if byte and not given:
                    stop.call, stop.argument = lib.fxs_stop_by_byte, byte
                result = self._table.render(self._handle, request, NULL, message)
            if result == lib.FXS_ERR_STOPPED and not given:
                stop.call = NULL
                result = self._table.render(self._handle, request, NULL, message)
            check(result, message)

    def _forget_closed(self) -> None:
        """Drops a device's copies of closed scenes. The copy of a scene is found by the address of its struct, so the
        struct is kept until the copy is dropped."""
        for scene, memory in list(self._drawn.items()):
            if memory() is None:
                self._table.forget(self._handle, scene)
                del self._drawn[scene]

    def forget_closed(self) -> None:
        with self._turn():
            self._forget_closed()

    def close(self) -> None:
        """Frees the threads and the memory of the renderer. It may be called again."""
        with self._lock:
            self._close()

    def __enter__(self) -> "Renderer":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


def _close_backend(table: Struct, handle: Any, process: int) -> None:
    """Closes a back end, but only in the process that opened it. After a fork, the new process has none of the threads,
    and closing would wait for them forever."""
    if process == os.getpid():
        table.close(handle)


_of_thread = threading.local()


def _kept() -> "Dict[str, Tuple[Any, Renderer]]":
    """Returns the renderers of this thread and their options, by the names of their back ends."""
    if getattr(_of_thread, "process", None) != os.getpid():
        _of_thread.process, _of_thread.renderers = os.getpid(), {}
    renderers: "Dict[str, Tuple[Any, Renderer]]" = _of_thread.renderers
    return renderers


def _renderer(backend: "Union[str, Renderer]", threads: int, device: int, max_memory: int) -> Renderer:
    if isinstance(backend, Renderer):
        if (threads, device, max_memory) != (0, 0, 0):
            raise ValueError("threads, device, max_memory: a Renderer has its own")
        return backend
    options = threads, device, max_memory
    kept = _kept()
    if kept.get(backend, (None,))[0] != options:
        kept.pop(backend, None)
        kept[backend] = options, Renderer(backend, threads=threads, device=device, max_memory=max_memory)
    return kept[backend][1]


def forget_closed() -> None:
    """Drops the copies of closed scenes that the renderers of this thread keep. Without this call they are dropped at
    the next picture."""
    for _, renderer in _kept().values():
        renderer.forget_closed()


# ---- Pictures --------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Picture:
    """A picture: an array for each target that was asked for, and None for the others. An array has H rows, from the
    top down, and W columns.

    colour: of shape (H, W, 4), uint8: red, green, blue, 255. With alpha=True: red, green and blue times the coverage,
    and the coverage.
    coverage: of shape (H, W), uint8: the share of the light that the Gaussians take, times 255.
    mean_depth: of shape (H, W), float32: the mean depth of the Gaussians at the pixel, weighted by the contribution of
    each. Depths are distances along the z axis of the camera in scene units. Infinity stands for no depth.
    median_depth: of shape (H, W), float32: the depth of the Gaussian at which half of the light is taken. Infinity
    stands for no depth.
    ids: of shape (H, W, 2), uint32, for the Gaussian that contributes most: the id of its object, and its number in the
    packed scene. Both are NOTHING where no Gaussian contributes.
    """
    colour: "Optional[npt.NDArray[np.uint8]]" = None
    coverage: "Optional[npt.NDArray[np.uint8]]" = None
    mean_depth: "Optional[npt.NDArray[np.float32]]" = None
    median_depth: "Optional[npt.NDArray[np.float32]]" = None
    ids: "Optional[npt.NDArray[np.uint32]]" = None

    def save(self, path: PathLike) -> None:
        """Writes the colours to a file, whose name ends in .png, .webp, .jpg, .ppm or .raw. Raises a ValueError where
        the picture has no colours, and an Error where the file cannot be written."""
        if self.colour is None:
            raise ValueError("the picture has no colours: they were not among its targets")
        pixels = np.ascontiguousarray(self.colour)
        call("fxs_image_file_write", file_name(path), ffi.from_buffer(pixels), pixels.shape[1], pixels.shape[0])

    def _repr_png_(self) -> Optional[bytes]:
        """Returns the colours as the bytes of a .png, which a notebook shows."""
        if self.colour is None:
            return None
        pixels, encoded = np.ascontiguousarray(self.colour), new("fxs_encoded")
        try:
            call("fxs_image_encode", lib.FXS_IMAGE_PNG, 0, ffi.from_buffer(pixels), pixels.shape[1], pixels.shape[0],
                 encoded)
            return bytes(ffi.buffer(encoded.bytes, encoded.size))
        finally:
            lib.fxs_encoded_free(encoded)


def _arrays(targets: "Sequence[str]", width: int, height: int) -> "Dict[str, npt.NDArray[Any]]":
    if isinstance(targets, str) or not all(isinstance(target, str) for target in targets):
        raise TypeError(f"targets: expected a sequence of names, say ({TARGETS[0]!r},), not {targets!r}")
    if not targets or not set(targets) <= set(TARGETS):
        raise ValueError(f"targets={tuple(targets)}: expected some of {', '.join(TARGETS)}")
    shapes = {"colour": ((4,), np.uint8), "coverage": ((), np.uint8), "mean_depth": ((), np.uint32),
              "median_depth": ((), np.uint32), "ids": ((2,), np.uint32)}
    return {name: np.empty((height, width) + shape, kind) for name, (shape, kind) in shapes.items() if name in targets}


def _aim(arrays: "Dict[str, npt.NDArray[Any]]", alpha: bool, depth_bits: int) -> Struct:
    images = {"id" if name == "ids" else name: {"pixels": ffi.from_buffer(array), "stride": array.strides[0]}
              for name, array in arrays.items()}
    return sized("fxs_targets", format=lib.FXS_FORMAT_RGBA8_COVERAGE if alpha else lib.FXS_FORMAT_RGBA8,
                 depth_bits=depth_bits, **images)


def _in_units(depths: "npt.NDArray[Any]", bits: int) -> "npt.NDArray[np.float32]":
    units: "npt.NDArray[np.float32]" = np.ldexp(depths.astype(np.float64), -bits).astype(np.float32)
    units[depths == NOTHING] = np.inf
    return units


def _seconds(time: float) -> int:
    return round(2**32 * number("time", time, -1e6, 1e6))


def _options(cutoff: str, sh_degree: int, background: Any, alpha: bool, budget: int, detail: float,
             time: float) -> Struct:
    behind = colour("background", background)
    if alpha and any(behind):
        raise ValueError("background: with alpha=True there is none")
    return sized("fxs_options", cutoff=choose("cutoff", cutoff, CUTOFFS),
                 sh_degree=whole("sh_degree", sh_degree, 0, 3), background=behind,
                 budget=whole("budget", budget, 0, 2**32 - 1),
                 detail_q8=round(256 * number("detail", detail, 0, 16384)), time_q32=_seconds(time))


def _camera(K: Any, world_to_camera: Any, width: Optional[int], height: Optional[int]) -> Camera:
    given = [value is not None for value in (world_to_camera, width, height)]
    if isinstance(K, Camera):
        if any(given):
            raise TypeError("a Camera has its own world_to_camera, width and height; camera.resized(width, height) is "
                            "the same for another size")
        return K
    if not all(given):
        raise TypeError("expected a Camera, or K, world_to_camera, width and height")
    return Camera(K, world_to_camera, width, height)  # type: ignore[arg-type]


def _objects(objects: "Sequence[Union[Object, Scene]]") -> "list[Object]":
    if isinstance(objects, (Object, Scene)):
        raise TypeError("objects: expected a sequence of them")
    for o in objects:
        if not isinstance(o, (Object, Scene)):
            raise TypeError(f"objects: expected an Object or a Scene, not {type(o).__name__}")
    return [Object(o) if isinstance(o, Scene) else o for o in objects]


def render(objects: "Sequence[Union[Object, Scene]]", K: Any, world_to_camera: Any = None, width: Optional[int] = None,
           height: Optional[int] = None, *, targets: "Sequence[str]" = ("colour",),
           background: "Sequence[int]" = (0, 0, 0), alpha: bool = False, cutoff: str = "mahalanobis",
           sh_degree: int = 3, budget: int = 0, detail: float = 0, time: float = 0, near: Optional[float] = None,
           backend: "Union[str, Renderer]" = "auto",
           threads: int = 0, device: int = 0, max_memory: int = 0,
           stop: "Optional[Callable[[], object]]" = None) -> Picture:
    """Draws objects into one picture, with all their Gaussians in one order by depth.

    objects: a sequence of objects and scenes. A scene stands for an object at the origin. Without any object, the
    picture is the background.
    K: the matrix of intrinsics, of shape (3, 3), in pixels. Or a Camera, which takes the place of K, world_to_camera,
    width and height; with a Camera of `load_cameras`, the bytes are exactly those of `fixsplat render --view`.
    world_to_camera: the pose, of shape (4, 4), for camera axes x right, y down, z forward.
    width, height: the size of the picture in pixels, 1 to 16384.
    targets: some of "colour", "coverage", "mean_depth", "median_depth", "ids".
    background: the colour behind the scene as red, green, blue, 0 to 255 each.
    alpha: True for colours times coverage, and coverage, without a background.
    cutoff: "mahalanobis", where a Gaussian ends at a Mahalanobis distance of 3, or "square" as in Kerbl et al. 2023.
    sh_degree: the highest degree of SH that is evaluated, 0 to 3.
    budget: of scenes with levels of detail, draw at most so many Gaussians, coarse ones in place of those that matter
    least; 0: draw all. detail: of such scenes, draw nothing finer than about so many pixels.
    time: the moment of scenes that move, in seconds. A scene that loops starts again after its duration; others stay at
    their first and last moment.
    near: the depth of the near plane in scene units. None stands for the near plane of the camera, or 0.2.
    backend, threads, device, max_memory: as for `Renderer`; or backend is a Renderer. For each thread of the program
    and each name of a back end, one renderer is kept until other options are asked for or the thread ends.
    stop: a function that is asked often, from several threads. A true answer ends the picture with an Error. An
    exception in it ends the picture too.
    """
    placed = _Placed(_objects(objects))
    camera = _camera(K, world_to_camera, width, height)
    cameras, options = camera.rounded(near), _options(cutoff, sh_degree, background, alpha, budget, detail, time)
    arrays = _arrays(targets, camera.width, camera.height)
    depths = [name for name in arrays if name.endswith("depth")]
    bits = placed.depth_bits(camera) if depths else 0
    aimed = _aim(arrays, alpha, bits)
    request = sized("fxs_request", objects=placed.array, count=len(placed.memories), options=options[0], eyes=1,
                    cameras=[cameras[0]], targets=[aimed[0], sized("fxs_targets")[0]])
    renderer = _renderer(backend, threads, device, max_memory)
    if stop is None:
        renderer.draw(placed, request)
    else:
        with Calls(stop=stop) as calls:
            request.options.stop = calls.stop[0]
            renderer.draw(placed, request)
    for memory in placed.memories:
        memory.check()
    for name in depths:
        arrays[name] = _in_units(arrays[name], bits)
    return Picture(**arrays)
