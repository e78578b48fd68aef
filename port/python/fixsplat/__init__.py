"""fixsplat: 3D Gaussian splatting in fixed point. Scenes are rendered and fitted with the same bytes on every machine.

    import fixsplat
    scene = fixsplat.load("scene.ply")
    picture = scene.render(K, world_to_camera, 1280, 720, targets=("colour", "median_depth"))
    picture.colour          # (720, 1280, 4) uint8

`Gaussians` has the arrays of a scene. The axes of a camera are x right, y down, z forward. The centre of the first
pixel is at (0.5, 0.5). Lengths are in the units of the scene. docs/python.md has more.

Several threads may call all functions at the same time, and the functions release the GIL while the library works.
Threads may share a Scene, a Camera and an Object. The docstring of Renderer says how threads share a Renderer.
"""
try:
    import numpy  # noqa: F401
except SystemError as error:
    raise ImportError(f"fixsplat: NumPy cannot be imported in a second interpreter of one process: {error}") from None

from ._camera import Camera, from_nerfstudio, load_cameras, to_nerfstudio
from ._convert import Conversion, convert
from ._fit import FitProgress, fit
from ._gaussians import Gaussians, load_gaussians
from ._library import Error
from ._measure import Measurement, Metrics, compare, measure
from ._mesh import Mesh, MeshMeasures, Route
from ._render import NOTHING, Backend, Crop, Object, Picture, Renderer, backends, render
from ._scene import Scene, load
from ._version import VERSION as __version__

__all__ = ["NOTHING", "Backend", "Camera", "Conversion", "Crop", "Error", "FitProgress", "Gaussians", "Measurement",
           "Mesh", "MeshMeasures", "Metrics", "Object", "Picture", "Renderer", "Route", "Scene", "__version__",
           "backends", "compare", "convert", "fit", "from_nerfstudio", "load", "load_cameras", "load_gaussians",
           "measure", "render", "to_nerfstudio"]
