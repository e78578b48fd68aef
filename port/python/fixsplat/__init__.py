"""fixsplat: 3D Gaussian splatting in fixed point. Scenes are rendered and fitted with the same bytes on every machine.

    import fixsplat
    scene = fixsplat.load("scene.ply")
    picture = scene.render(K, world_to_camera, 1280, 720, targets=("colour", "median_depth"))
    picture.colour          # (720, 1280, 4) uint8

Camera axes: x right, y down, z forward; pixel centres at +0.5; units are the scene's. docs/python.md has more.

Threads: all functions may be called by several threads at the same time, and let go of the GIL while the library
works. A Scene, a Camera, an Object may be shared; what of a Renderer may be is said there.
"""
from ._camera import Camera, from_nerfstudio, load_cameras, to_nerfstudio
from ._fit import FitProgress, fit
from ._library import Error
from ._render import NOTHING, Backend, Crop, Object, Picture, Renderer, backends, render
from ._scene import Conversion, Scene, convert, load
from ._version import VERSION as __version__

__all__ = ["NOTHING", "Backend", "Camera", "Conversion", "Crop", "Error", "FitProgress", "Object", "Picture",
           "Renderer", "Scene", "__version__", "backends", "convert", "fit", "from_nerfstudio", "load", "load_cameras",
           "render", "to_nerfstudio"]
