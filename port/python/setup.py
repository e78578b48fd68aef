"""Builds a wheel that holds the shared library: the file that FIXSPLAT_LIBRARY names, or the one in the build folder of
the checkout. The wheel is for any Python 3 on the platform that FIXSPLAT_PLATFORM names, or else on this one. The
library has the name there by which the package looks for it."""
import os
import shutil
from pathlib import Path
from sysconfig import get_platform

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
VERSION = (HERE / "fixsplat" / "_version.py").read_text().split('"')[-2]
MAJOR = VERSION.partition(".")[0]
PLATFORM = os.environ.get("FIXSPLAT_PLATFORM") or get_platform()
if PLATFORM.startswith("win"):
    NAME, BUILT = f"libfixsplat-{MAJOR}.dll", f"windows/libfixsplat-{MAJOR}.dll"
else:
    NAME, BUILT = f"libfixsplat.so.{MAJOR}", f"libfixsplat.so.{VERSION}"


class WithLibrary(build_py):
    def run(self):
        super().run()
        library = Path(os.environ.get("FIXSPLAT_LIBRARY") or HERE.parents[1] / "build" / BUILT)
        if not library.exists():
            raise SystemExit(f"fixsplat: {library}: no such file; build it (make) or name it in FIXSPLAT_LIBRARY")
        shutil.copyfile(library, Path(self.build_lib, "fixsplat", NAME))


setup(cmdclass={"build_py": WithLibrary}, options={"bdist_wheel": {"plat_name": PLATFORM}})
