"""Builds the FMU shim (fmu_wrapper/shim/*.c) with a C compiler; everything else stands in pyproject.toml.

The shim is a plain shared library, no extension module: it is not tied to a Python version. It is compiled with
$CC, or cc, gcc, clang, or where there is none with `python -m ziglang cc`, which is then a build requirement.
"""

import os
import shlex
import shutil
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

SHIM = Path("fmu_wrapper", "shim")
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
FLAGS = ["-std=c11", "-O2", "-shared", "-fvisibility=hidden", "-Wall", "-Wextra"]
SYSTEM_FLAGS = {"win32": [], "darwin": ["-fPIC"]}.get(sys.platform, ["-fPIC", "-ldl", "-lpthread"])


def compiler() -> list[str]:
    """The command of a C compiler on this machine, or an empty list."""
    if os.environ.get("CC"):
        return shlex.split(os.environ["CC"])
    found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    return [found] if found else []


class BuildShim(build_ext):
    """Compile the shim into the package folder."""

    def get_ext_filename(self, fullname: str) -> str:
        """Without the tag of a Python version."""
        return str(Path(*fullname.split("."))) + SUFFIX

    def build_extension(self, ext: Extension) -> None:
        """One call of the compiler."""
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        command = compiler() or [sys.executable, "-m", "ziglang", "cc"]
        self.spawn([*command, *FLAGS, "-o", str(target), *ext.sources, *SYSTEM_FLAGS])


class PlatformWheel(bdist_wheel):
    """A wheel for any Python 3 of one platform."""

    def get_tag(self) -> tuple[str, str, str]:
        """Python, ABI, platform."""
        return "py3", "none", super().get_tag()[2]


setup(
    ext_modules=[
        Extension(
            "tlismni.fmu_wrapper.tlismni_shim",
            sources=sorted(path.as_posix() for path in SHIM.glob("*.c")),
            depends=sorted(path.as_posix() for path in SHIM.glob("*.h")),
        )
    ],
    cmdclass={"build_ext": BuildShim, "bdist_wheel": PlatformWheel},
    setup_requires=[] if compiler() else ["ziglang"],
)
