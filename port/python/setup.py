"""Builds a wheel that holds the shared library: the file that FIXSPLAT_LIBRARY names, or the one in the build folder of
the checkout. The wheel is for any Python 3 on the platform that FIXSPLAT_PLATFORM names, or else on this one."""
import os
import shutil
from pathlib import Path
from sysconfig import get_platform

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
VERSION = (HERE / "fixsplat" / "_version.py").read_text().split('"')[-2]


class WithLibrary(build_py):
    def run(self):
        super().run()
        built = HERE.parents[1] / "build" / f"libfixsplat.so.{VERSION}"
        library = Path(os.environ.get("FIXSPLAT_LIBRARY") or built)
        if not library.exists():
            raise SystemExit(f"fixsplat: {library}: no such file; build it (make) or name it in FIXSPLAT_LIBRARY")
        soname = f"libfixsplat.so.{VERSION.partition('.')[0]}"
        shutil.copyfile(library, Path(self.build_lib, "fixsplat", soname))


PLATFORM = os.environ.get("FIXSPLAT_PLATFORM") or get_platform()
setup(cmdclass={"build_py": WithLibrary}, options={"bdist_wheel": {"plat_name": PLATFORM}})
