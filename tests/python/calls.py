"""calls.py SCENE CAMERAS: prints which functions of the library the package calls, in order, to draw a scene by a camera
of a file, and the picture's hash last. tests/windows/wheel.c makes the same calls of the library for Windows."""
import os
import sys

import cffi
from checks import hash_of

if hasattr(os, "memfd_create"):
    del os.memfd_create                     # imitates Windows, which lacks memfd_create
opened = cffi.FFI.dlopen


class Told:
    """The library, each of whose functions says its name when it is called."""

    def __init__(self, library):
        self.library = library

    def __getattr__(self, name):
        found = getattr(self.library, name)
        if name.startswith("FXS_"):
            return found
        print(name)
        return found


cffi.FFI.dlopen = lambda *arguments: Told(opened(*arguments))
import fixsplat  # noqa: E402

with fixsplat.load(sys.argv[1]) as scene:
    print(hash_of(scene.render(fixsplat.load_cameras(sys.argv[2])[0], threads=1)))
