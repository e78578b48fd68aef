"""Cameras as numpy matrices, the files of cameras, and the axes of nerfstudio."""
from __future__ import annotations

from typing import Any, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from ._library import PathLike, Struct, call, copy, file_name, lib, new, release, string, whole

Floats = npt.NDArray[np.float64]


def numbers(name: str, values: Any, *shapes: "Tuple[int, ...]") -> Floats:
    """Returns values as an array of float64. They must be finite real numbers and have one of the shapes; otherwise a
    TypeError or ValueError with the name of the values is raised."""
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name}: expected the shape {' or '.join(map(str, shapes))}") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, not {array.dtype}")
    if array.shape not in shapes:
        raise ValueError(f"{name}: expected the shape {' or '.join(map(str, shapes))}, not {array.shape}")
    array = array.astype(np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: has a number that is not finite")
    return array


def number(name: str, value: Any, low: float, high: float) -> float:
    """Returns a value as a float. It must be a real number from low to high; otherwise a ValueError or TypeError with
    its name is raised."""
    result = float(numbers(name, value, ()))
    if not low <= result <= high:
        raise ValueError(f"{name}={result}: expected {low} to {high}")
    return result


def rotation_of(name: str, matrix: Floats) -> Floats:
    """Returns the matrix if it is a rotation, and raises a ValueError otherwise."""
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-3 or np.linalg.det(matrix) < 0:
        raise ValueError(f"{name}: is not a rotation: its rows are to be of length 1, at right angles and right-handed "
                         "(within 1e-3)")
    return matrix


class Camera:
    """A camera: its position, its direction, and the size of its picture.

    K: the matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] of shape (3, 3), in pixels. The centre of the first pixel is at
    (0.5, 0.5).
    world_to_camera: the pose, of shape (4, 4), in scene units. The axes of the camera are x right, y down, z forward,
    as in COLMAP and OpenCV.
    width, height: the size of the picture in pixels, 1 to 16384.
    near: the depth of the near plane in scene units, 2^-20 to 2^28. None stands for 0.2.
    orthographic: True for parallel rays along the z axis; fx and fy are then pixels per scene unit.
    name: any text, such as the name of the photograph.

    A camera does not change, and any number of threads may use it. Values out of range raise a ValueError, a TypeError
    or an Error.
    """

    def __init__(self, K: Any, world_to_camera: Any, width: int, height: int, *, near: Optional[float] = None,
                 orthographic: bool = False, name: str = ""):
        k = numbers("K", K, (3, 3))
        if k[0, 1] != 0 or k[1, 0] != 0 or (k[2] != (0, 0, 1)).any():
            raise ValueError("K: expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]; a skew is not drawn")
        pose = numbers("world_to_camera", world_to_camera, (4, 4))
        if (pose[3] != (0, 0, 0, 1)).any():
            raise ValueError("world_to_camera: expected 0, 0, 0, 1 as its last row")
        rotation = rotation_of("world_to_camera", pose[:3, :3])
        view = new("fxs_view", name=name.encode()[:127], width=whole("width", width, 1, lib.FXS_MAX_SIZE),
                   height=whole("height", height, 1, lib.FXS_MAX_SIZE), fx=k[0, 0], fy=k[1, 1], cx=k[0, 2], cy=k[1, 2],
                   rotation=list(rotation.ravel()), position=list(np.linalg.solve(rotation, -pose[:3, 3])),
                   projection=lib.FXS_ORTHOGRAPHIC if orthographic else lib.FXS_PERSPECTIVE)
        if near is not None:
            view.near = number("near", near, 2.0**-20, 2.0**28)
        self._view = view
        self.rounded()

    @classmethod
    def _of(cls, view: Struct) -> "Camera":
        camera = cls.__new__(cls)
        camera._view = view
        return camera

    @classmethod
    def look_at(cls, eye: Sequence[float], target: Sequence[float], width: int, height: int, *, fov: float = 50,
                up: Sequence[float] = (0, -1, 0)) -> "Camera":
        """Makes a camera at the position `eye` that looks towards the point `target`, both in scene units. fov: the
        vertical field of view, 1 to 170 degrees. up: the direction that is up in the picture."""
        view = new("fxs_view")
        vectors = [list(numbers(name, values, (3,))) for name, values in (("eye", eye), ("target", target), ("up", up))]
        picture = new("fxs_picture", fov=number("fov", fov, 1, 170), width=whole("width", width, 1, lib.FXS_MAX_SIZE),
                      height=whole("height", height, 1, lib.FXS_MAX_SIZE))
        call("fxs_view_look_at", view, *vectors, picture)
        return cls._of(view)

    @property
    def K(self) -> Floats:
        """The matrix of intrinsics, of shape (3, 3), in pixels."""
        v = self._view
        return np.array([[v.fx, 0, v.cx], [0, v.fy, v.cy], [0, 0, 1]])

    @property
    def world_to_camera(self) -> Floats:
        """The pose, of shape (4, 4), in scene units. The axes of the camera are x right, y down, z forward."""
        rotation = np.reshape(list(self._view.rotation), (3, 3))
        pose = np.eye(4)
        pose[:3, :3] = rotation
        pose[:3, 3] = -rotation @ self.position
        return pose

    @property
    def camera_to_world(self) -> Floats:
        """The inverse of world_to_camera, of shape (4, 4), in scene units."""
        return np.linalg.inv(self.world_to_camera)

    @property
    def position(self) -> Floats:
        """The centre of the camera in the world, of shape (3,), in scene units."""
        return np.array(list(self._view.position))

    @property
    def width(self) -> int:
        return int(self._view.width)

    @property
    def height(self) -> int:
        return int(self._view.height)

    @property
    def near(self) -> Optional[float]:
        """The depth of the near plane in scene units. None stands for 0.2."""
        return float(self._view.near) or None

    @property
    def orthographic(self) -> bool:
        return bool(self._view.projection == lib.FXS_ORTHOGRAPHIC)

    @property
    def name(self) -> str:
        return string(self._view.name)

    def resized(self, width: int, height: int) -> "Camera":
        """Makes the same camera for a picture of another size, as `fixsplat render --size` does. fx, fy and the
        distance of the principal point from the centre of the picture are multiplied by new width / old width, or by
        sqrt(new area / old area) where the shape is another."""
        view = copy(self._view)
        lib.fxs_view_resize(view, whole("width", width, 1, lib.FXS_MAX_SIZE),
                            whole("height", height, 1, lib.FXS_MAX_SIZE))
        return self._of(view)

    def rounded(self, near: Optional[float] = None) -> Struct:
        """Returns the camera as the integers of the renderer. near: a near plane in place of the one of the camera.
        Raises an Error where the camera is out of the range of the integers."""
        view, camera = copy(self._view), new("fxs_camera")
        if near is not None:
            view.near = number("near", near, 2.0**-20, 2.0**28)
        call("fxs_camera_from_view", camera, view)
        return camera

    def __repr__(self) -> str:
        return f"<fixsplat.Camera {self.name!r}, {self.width} x {self.height}>"


def load_cameras(path: PathLike) -> "list[Camera]":
    """Reads the cameras of a file: Inria's cameras.json, a transforms.json of nerfstudio or Blender, or a COLMAP model,
    named by its folder, its images.bin or its images.txt. All cameras are turned to the axes x right, y down, z
    forward. Raises an Error where the file cannot be read."""
    views = new("fxs_view *")
    count = call("fxs_camera_file_read", file_name(path), views)
    try:
        return [Camera._of(copy(views[0] + i)) for i in range(count)]
    finally:
        release(views[0])


def from_nerfstudio(camera_to_world: Any) -> Floats:
    """Converts the pose camera_to_world of nerfstudio, of shape (3, 4) or (4, 4), into world_to_camera, of shape (4,
    4). The axes of a camera in nerfstudio are x right, y up, z backward, as in OpenGL and Blender."""
    pose = np.eye(4)
    given = numbers("camera_to_world", camera_to_world, (3, 4), (4, 4))
    pose[:len(given)] = given
    rotation_of("camera_to_world", pose[:3, :3])
    return np.asarray(np.linalg.inv(pose @ np.diag([1.0, -1, -1, 1])))


def to_nerfstudio(world_to_camera: Any) -> Floats:
    """Converts world_to_camera, of shape (4, 4), into the pose camera_to_world of nerfstudio, of shape (4, 4)."""
    return np.asarray(np.linalg.inv(numbers("world_to_camera", world_to_camera, (4, 4))) @ np.diag([1.0, -1, -1, 1]))
