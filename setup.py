"""Builds the FMU shim (fmu_wrapper/fmi/*.c, fmu_wrapper/shim/*.c) with a C compiler, and the library of machine code of
the core where it is asked for; everything else stands in pyproject.toml.

An installation from the sources unpacks the library that the repository has for this machine, if it is of these very
sources (`core/aot/packed.py`).

The shim is a plain shared library, no extension module: it is not tied to a Python version. It is compiled with
$CC, or cc, gcc, clang, or where there is none with `python -m ziglang cc`, which is then a build requirement.

The machine code takes minutes and needs the core's own packages and numba, so it is made only with TLISMNI_AHEAD=1
(`TLISMNI_AHEAD=1 pip wheel . --no-build-isolation --no-deps`). A wheel that has it does not depend on numba. With
TLISMNI_AHEAD=FOLDER it is taken from there, as `python -m tlismni.core.aot --output FOLDER` has made it, and with
TLISMNI_TARGET=NAME the wheel is for another platform, which takes ziglang (`make dist` makes all).
"""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

SHIM = (Path("fmu_wrapper", "fmi"), Path("fmu_wrapper", "shim"))
COMPILED = "core/compiled"
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
FLAGS = ["-std=c11", "-O2", "-shared", "-fvisibility=hidden", "-Wall", "-Wextra", "-DTLISMNI_SHIM"]
SYSTEM_FLAGS = {"win32": [], "darwin": ["-fPIC"]}.get(sys.platform, ["-fPIC", "-ldl", "-lpthread"])


TARGETS = {
    "linux-x86_64": ("x86_64-linux-gnu.2.17", ".so", "manylinux_2_17_x86_64.manylinux2014_x86_64"),
    "linux-aarch64": ("aarch64-linux-gnu.2.17", ".so", "manylinux_2_17_aarch64.manylinux2014_aarch64"),
    "musl-x86_64": ("x86_64-linux-musl", ".so", "musllinux_1_1_x86_64"),
    "musl-aarch64": ("aarch64-linux-musl", ".so", "musllinux_1_1_aarch64"),
    "windows-x86_64": ("x86_64-windows-gnu", ".dll", "win_amd64"),
    "windows-aarch64": ("aarch64-windows-gnu", ".dll", "win_arm64"),
    "macos-x86_64": ("x86_64-macos.11.0", ".dylib", "macosx_11_0_x86_64"),
    "macos-aarch64": ("aarch64-macos.11.0", ".dylib", "macosx_11_0_arm64"),
}
"""Platforms that a wheel can be made for from another: zig's name, the suffix of libraries, the tag of the wheel."""
TARGET = os.environ.get("TLISMNI_TARGET", "")
if TARGET:
    if TARGET not in TARGETS:
        raise SystemExit(f"TLISMNI_TARGET={TARGET} is unknown: there are {', '.join(TARGETS)}")
    SUFFIX = TARGETS[TARGET][1]
    SYSTEM_FLAGS = ["-fPIC", "-ldl", "-lpthread"] if SUFFIX == ".so" else ["-fPIC"] if SUFFIX == ".dylib" else []
AHEAD = os.environ.get("TLISMNI_AHEAD", "")
NEEDED = ["numpy>=2.0", "scipy>=1.13", "pydantic>=2.9", *([] if AHEAD else ["numba>=0.61"])]


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
        zig = [sys.executable, "-m", "ziglang", "cc"]
        command = [*zig, "-target", TARGETS[TARGET][0], "-s"] if TARGET else compiler() or zig
        self.spawn([*command, *FLAGS, "-o", str(target), *ext.sources, *SYSTEM_FLAGS])
        for written_beside in target.parent.glob("*.lib"):  # what Windows programs would link with; nobody does
            written_beside.unlink()

    def run(self) -> None:
        """The shim, and the machine code of the sources that are in the wheel."""
        super().run()
        root = Path(self.build_lib).resolve()
        if not AHEAD and not TARGET:
            self.unpack_machine_code(Path(COMPILED) if self.inplace else root / "tlismni" / COMPILED)
        elif AHEAD and not self.inplace:
            self.leave_none_of_other_platforms(root)
            if AHEAD == "1":
                self.make_machine_code(root)
            else:
                self.take_machine_code(Path(AHEAD), root)

    def unpack_machine_code(self, folder: Path) -> None:
        """Put the library of the repository, if it is of these sources, beside them."""
        sys.path.insert(0, str(Path(__file__).parent))
        try:
            from core.aot.packed import take
        finally:
            del sys.path[0]
        folder.mkdir(parents=True, exist_ok=True)
        place = folder / f"tlismni_core{SUFFIX}"
        taken = take(Path("machine_code"), place)
        if not taken and not self.inplace:
            place.unlink(missing_ok=True)  # of an earlier wheel from the same folder
        self.announce(f"machine code of these sources {'is' if taken else 'is not'} in machine_code", level=2)

    @staticmethod
    def leave_none_of_other_platforms(root: Path) -> None:
        """What an earlier wheel has left in the same folder would be in this one too."""
        for name in (f"{COMPILED}/tlismni_core", "fmu_wrapper/tlismni_shim"):
            for suffix in {".so", ".dll", ".dylib"} - {SUFFIX}:
                (root / "tlismni" / f"{name}{suffix}").unlink(missing_ok=True)

    def take_machine_code(self, folder: Path, root: Path) -> None:
        """Put what was made before beside the sources."""
        found = [path for path in folder.rglob("tlismni_core.*") if not TARGET or path.parent.name == TARGET]
        if len(found) != 1:
            raise SystemExit(f"in '{folder}' there is not one library for {TARGET or 'this machine'}, but {len(found)}")
        shutil.copy(found[0], root / "tlismni" / "core" / "compiled" / found[0].name)

    def make_machine_code(self, root: Path) -> None:
        """Let the copied sources make their library, and put it beside them."""
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "tlismni.core.aot", "--output", folder]
            environment = {**os.environ, "PYTHONPATH": str(root)}
            # the package has no __init__.py: its parts could come from an installation
            ask = [sys.executable, "-c", "import tlismni.core; print(tlismni.core.__file__)"]
            found = subprocess.run(ask, check=True, capture_output=True, text=True, env=environment).stdout.strip()
            if not Path(found).is_relative_to(root):
                raise SystemExit(f"machine code would be made of '{found}', not of '{root}': uninstall tlismni before")
            self.announce(" ".join(command), level=2)
            subprocess.run(command, check=True, env=environment)
            (made,) = Path(folder).rglob("tlismni_core.*")
            shutil.copy(made, root / "tlismni" / "core" / "compiled" / made.name)


class PlatformWheel(bdist_wheel):
    """A wheel for any Python 3 of one platform."""

    def get_tag(self) -> tuple[str, str, str]:
        """Python, ABI, platform."""
        return "py3", "none", TARGETS[TARGET][2] if TARGET else super().get_tag()[2]


setup(
    install_requires=NEEDED,
    ext_modules=[
        Extension(
            "tlismni.fmu_wrapper.tlismni_shim",
            sources=[path.as_posix() for folder in SHIM for path in sorted(folder.glob("*.c"))],
            depends=[path.as_posix() for folder in SHIM for path in sorted(folder.glob("*.h"))],
        )
    ],
    cmdclass={"build_ext": BuildShim, "bdist_wheel": PlatformWheel},
    setup_requires=[] if compiler() else ["ziglang"],
)
