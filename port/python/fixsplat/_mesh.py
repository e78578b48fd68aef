"""Triangle meshes of files: area, volume, and ways along the surface."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from ._library import PathLike, call, ffi, file_name, lib, new, whole

Vector = Tuple[float, float, float]


@dataclass(frozen=True)
class MeshMeasures:
    """The size of a mesh, in the units of its file.

    parts: number of parts connected by shared vertices. open_edges: number of edges of a single triangle.
    turned_edges: number of other edges where triangles face opposite ways. low, high: corners of the box.
    volume: of a closed mesh, negative if its triangles face inwards; None for an open one.
    """
    parts: int
    open_edges: int
    turned_edges: int
    low: Vector
    high: Vector
    area: float
    volume: Optional[float]


@dataclass(frozen=True)
class Route:
    """A way along a mesh, between the points of the mesh nearest to two given ones.

    straight: the length of the straight line. along: the length of the way. points: (N, 3), one at each edge that the
    way crosses, the two ends included.
    """
    straight: float
    along: float
    points: npt.NDArray[np.float64]


def _three(values: Any) -> Vector:
    return values[0], values[1], values[2]


def _point(name: str, value: Sequence[float]) -> "list[float]":
    array = np.asarray(value, np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected three finite numbers")
    return [float(x) for x in array]


class Mesh:
    """A mesh of a .glb, .gltf, .ply or .obj of any program, in the units and axes of the file.

    vertices: (N, 3) positions. triangles: (M, 3) numbers of vertices. max_memory: limit of the bytes of memory for
    reading; 0: in proportion to the size of the file. Experimental, as the functions of C are.
    """

    def __init__(self, path: PathLike, *, max_memory: int = 0):
        found = new("fxs_mesh *")
        call("fxs_mesh_open", found, file_name(path), whole("max_memory", max_memory, 0, 2 ** 64 - 1))
        self._mesh: Any = ffi.gc(found[0], lib.fxs_mesh_free)
        mesh = self._mesh
        places = np.frombuffer(ffi.buffer(mesh.places, 12 * mesh.vertex_count), np.int32).reshape(-1, 3)
        self.vertices = np.array(list(mesh.origin)) + mesh.step / 65536 * places
        corners = np.frombuffer(ffi.buffer(mesh.triangles, 12 * mesh.triangle_count), np.uint32)
        self.triangles = corners.reshape(-1, 3).copy()

    def measure(self) -> MeshMeasures:
        """Returns the size of the mesh, as `fixsplat info` prints it."""
        m = new("fxs_mesh_measures")
        call("fxs_mesh_measure", m, self._mesh)
        is_closed = not m.open_edges and not m.turned_edges
        return MeshMeasures(m.parts, m.open_edges, m.turned_edges, _three(m.low), _three(m.high), m.area,
                            m.volume if is_closed else None)

    def route(self, start: Sequence[float], end: Sequence[float]) -> Route:
        """Returns a shortest way along the surface. Raises an Error if no way joins the points."""
        route = new("fxs_mesh_route")
        call("fxs_mesh_find_route", route, self._mesh, _point("start", start), _point("end", end))
        try:
            points = np.frombuffer(ffi.buffer(route.points, 24 * route.count), np.float64).reshape(-1, 3).copy()
            return Route(route.straight, route.along, points)
        finally:
            lib.fxs_mesh_route_free(route)
