"""Pictures: objects, targets, back ends."""
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
                       new, string, whole)
from ._scene import Memory, Scene

NOTHING: int = lib.FXS_NOTHING
TARGETS = ("colour", "coverage", "mean_depth", "median_depth", "ids")


# ---- Objects ---------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Crop:
    """A box in the scene's own units, for the centres of Gaussians: keeps what is inside, or (outside=True) leaves that
    out. low, high: (3,)."""
    low: Any
    high: Any
    outside: bool = False


@dataclass(frozen=True)
class Object:
    """A scene placed in the world: world = translation + scale * rotation * position. SH turn with it.

    rotation: a quaternion w, x, y, z of any length but 0, (4,), or a matrix from scene to world, (3, 3).
    translation: (3,), world units. scale: 2^-16 to 2^16. opacity: a factor, 0 to 1. tint: factors of red, green and
    blue, 0 to 4, (3,). visible: False: not drawn. id: what the id target has for it, 0 to 2^32 - 2. crops: up to 8
    boxes: a Gaussian is drawn where it lies in one that keeps, or there is none of these, and in none that leaves out.
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
    """Of a rotation: the eigenvector, of the largest eigenvalue, of the symmetric matrix whose form is q^T N q = the
    trace of R(q)^T M (Horn 1987)."""
    m = rotation_of("rotation", matrix)
    form = np.array([
        [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
        [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
        [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1]]])
    return np.asarray(np.linalg.eigh(form)[1][:, 3])


class _Placed:
    """Objects as C has them, with what they point to, which is held as long as this is."""

    def __init__(self, objects: "Sequence[Object]"):
        if len(objects) > lib.FXS_MAX_OBJECTS:
            raise ValueError(f"{len(objects)} objects: at most {lib.FXS_MAX_OBJECTS}")
        self.memories = [o.scene.memory for o in objects]
        self.placements = [o._placement() for o in objects]
        self.array = ffi.new("fxs_object[]", len(objects))
        self._crops = ffi.new("fxs_crop[]", lib.FXS_MAX_CROPS * len(objects))
        for i, (memory, placement) in enumerate(zip(self.memories, self.placements)):
            call("fxs_object_place", self.array + i, memory.scene, placement, self._crops + i * lib.FXS_MAX_CROPS)

    def depth_bits(self, camera: Camera) -> int:
        """As many as hold every depth from this camera, up to 28: those of `fixsplat render --depth`."""
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
    """A way to render. devices: their names, by number. missing: why there is none, in words; None where there are.
    exact: its pictures have the bytes of the processor's. depths: it has depth and id targets."""
    name: str
    does: str
    devices: Tuple[str, ...]
    missing: Optional[str]
    exact: bool
    depths: bool


def backends() -> "list[Backend]":
    """Those of this build, the processor's first; and those that it is without, with the reason."""
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
                              bool(table.can & lib.FXS_CAN_EXACT), bool(table.can & lib.FXS_CAN_TRACE)))


class Renderer:
    """A back end that is open: with threads, working memory and, on a device, its copies of scenes.

    `render` opens one by itself for each thread of the program and keeps it. To open one is for a program that
    chooses when it is closed: it is given to `render` as `backend`, and closed by `close`, at the end of a `with` or
    when it is no longer used. Threads may share it and take turns; one of OpenGL is used by the thread that opened it.

    backend: "auto" (the processor), or the name of one of `backends()`. threads: of the processor, 1 to 64; 0: one for
    each processor. device: its number. max_memory: bytes, of working memory or the device's; 0: as much as it takes.
    The picture depends on none of these.
    """

    def __init__(self, backend: str = "auto", *, threads: int = 0, device: int = 0, max_memory: int = 0):
        if not isinstance(backend, str):
            raise TypeError(f"backend: expected a name or a Renderer, not {type(backend).__name__}")
        self._table = lib.fxs_backend_find(backend.encode())
        if not self._table:
            names = ", ".join(["auto"] + [b.name for b in backends()])
            raise ValueError(f"backend={backend!r}: expected one of {names}")
        options = new("fxs_backend_options", device=whole("device", device, 0, 2**31 - 1),
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
        """Draws into the request's targets, and waits."""
        message = new("fxs_message")
        with self._turn():
            self._forget_closed()
            for memory in placed.memories:
                self._drawn[memory.scene] = weakref.ref(memory)
            check(self._table.render(self._handle, request, NULL, message), message)

    def _forget_closed(self) -> None:
        """What a device keeps of a scene is found by the address of its struct, which is held until it is dropped."""
        for scene, memory in list(self._drawn.items()):
            if memory() is None:
                self._table.forget(self._handle, scene)
                del self._drawn[scene]

    def forget_closed(self) -> None:
        with self._turn():
            self._forget_closed()

    def close(self) -> None:
        """Gives back what it has. It may be called again."""
        with self._lock:
            self._close()

    def __enter__(self) -> "Renderer":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


def _close_backend(table: Struct, handle: Any, process: int) -> None:
    """Behind a fork its threads are not there, and it would wait for them."""
    if process == os.getpid():
        table.close(handle)


_of_thread = threading.local()


def _kept() -> "Dict[str, Tuple[Any, Renderer]]":
    """The renderers of this thread, by name, with their options."""
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
    """What the renderers of this thread keep of scenes that are closed is dropped now, not with their next picture."""
    for _, renderer in _kept().values():
        renderer.forget_closed()


# ---- Pictures --------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Picture:
    """What was drawn: an array for each target that was asked for, else None. H rows from the top, W columns.

    colour: (H, W, 4) uint8: red, green, blue, 255; with alpha=True times coverage, and coverage.
    coverage: (H, W) uint8: 255 times the light that the Gaussians take.
    mean_depth: (H, W) float32, scene units along the camera's z axis: of all that contribute, weighted by that.
    median_depth: (H, W) float32: of the Gaussian at which half of the light is taken. Infinity: there is none.
    ids: (H, W, 2) uint32: the object's id and the Gaussian's number in the packed scene, of what contributes most;
    NOTHING where nothing does.
    """
    colour: "Optional[npt.NDArray[np.uint8]]" = None
    coverage: "Optional[npt.NDArray[np.uint8]]" = None
    mean_depth: "Optional[npt.NDArray[np.float32]]" = None
    median_depth: "Optional[npt.NDArray[np.float32]]" = None
    ids: "Optional[npt.NDArray[np.uint32]]" = None

    def save(self, path: PathLike) -> None:
        """Writes the colours: .png, .webp, .jpg, .ppm or .raw."""
        if self.colour is None:
            raise ValueError("the picture has no colours: they were not among its targets")
        pixels = np.ascontiguousarray(self.colour)
        call("fxs_image_file_write", file_name(path), ffi.from_buffer(pixels), pixels.shape[1], pixels.shape[0])


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
    return new("fxs_targets", format=lib.FXS_FORMAT_RGBA8_COVERAGE if alpha else lib.FXS_FORMAT_RGBA8,
               depth_bits=depth_bits, **images)


def _in_units(depths: "npt.NDArray[Any]", bits: int) -> "npt.NDArray[np.float32]":
    units: "npt.NDArray[np.float32]" = np.ldexp(depths.astype(np.float64), -bits).astype(np.float32)
    units[depths == NOTHING] = np.inf
    return units


def _options(cutoff: str, sh_degree: int, background: Any, alpha: bool) -> Struct:
    behind = colour("background", background)
    if alpha and any(behind):
        raise ValueError("background: with alpha=True there is none")
    return new("fxs_options", cutoff=choose("cutoff", cutoff, CUTOFFS), sh_degree=whole("sh_degree", sh_degree, 0, 3),
               background=behind)


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
           sh_degree: int = 3, near: Optional[float] = None, backend: "Union[str, Renderer]" = "auto",
           threads: int = 0, device: int = 0, max_memory: int = 0,
           stop: "Optional[Callable[[], object]]" = None) -> Picture:
    """Draws objects, placed in one world, in one order by depth.

    objects: a scene stands for itself at the origin. Without any, the picture is the background.
    K: (3, 3), pixels, with world_to_camera: (4, 4), axes x right, y down, z forward, width and height: pixels. Or a
    Camera in the place of all four: one of `load_cameras` gives the very bytes of `fixsplat render --view`.
    targets: some of "colour", "coverage", "mean_depth", "median_depth", "ids".
    background: red, green, blue, 0 to 255. alpha: colours times coverage and coverage, without background.
    cutoff: "mahalanobis", or "square" as in Kerbl et al. 2023. sh_degree: the highest evaluated, 0 to 3.
    near: depth of the near plane, scene units; None: the camera's, or 0.2.
    backend, threads, device, max_memory: as for `Renderer`, or a Renderer as the backend. One is kept for each thread
    of the program and name, until other options are asked for or the thread ends.
    stop: asked often, from several threads; what is true, as what it raises, ends a long picture with an Error.
    """
    placed = _Placed(_objects(objects))
    camera = _camera(K, world_to_camera, width, height)
    cameras, options = camera.rounded(near), _options(cutoff, sh_degree, background, alpha)
    arrays = _arrays(targets, camera.width, camera.height)
    depths = [name for name in arrays if name.endswith("depth")]
    bits = placed.depth_bits(camera) if depths else 0
    aimed = _aim(arrays, alpha, bits)
    request = new("fxs_request", objects=placed.array, count=len(placed.memories), options=options[0], eyes=1,
                  cameras=[cameras[0]], targets=[aimed[0]])
    renderer = _renderer(backend, threads, device, max_memory)
    if stop is None:
        renderer.draw(placed, request)
    else:
        with Calls(stop=stop) as calls:
            request.options.stop = calls.stop
            renderer.draw(placed, request)
    for memory in placed.memories:
        memory.check()
    for name in depths:
        arrays[name] = _in_units(arrays[name], bits)
    return Picture(**arrays)
