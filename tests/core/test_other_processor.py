"""The library for another processor, system or C library gives the bits of this one, where there is what runs it:

apt-get install qemu-user libc6-arm64-cross wine64 musl
python -m tlismni.core.ahead --target linux-aarch64 --target musl-x86_64 --target windows-x86_64 --output build
"""

import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from tlismni.core.compiled.library import LIBRARY, core_digest
from tlismni.core.native.c_sources import c_digest
from tlismni.models import load

HERE, NATIVE = Path(__file__).parent, Path(__file__).parents[2] / "core" / "native"
LIBRARIES = Path(os.environ.get("TLISMNI_LIBRARIES", "build")).resolve()
QEMU = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
ARM = Path("/usr/aarch64-linux-gnu")
WINE = shutil.which("wine") or shutil.which("wine64")
TARGETS = {
    "linux-aarch64": ("aarch64-linux-gnu.2.17", [QEMU, "-L", ARM] if QEMU and ARM.is_dir() else None),
    "musl-x86_64": ("x86_64-linux-musl", [] if Path("/lib/ld-musl-x86_64.so.1").exists() else None),
    "windows-x86_64": ("x86_64-windows-gnu", [WINE] if WINE else None),
}
"""zig's name, and what programs are run with; None: nothing here runs them."""


def missing(target):
    """What this needs and has not."""
    if LIBRARY is None or shutil.which("cc") is None:
        return "a C compiler and the library of machine code"
    if TARGETS[target][1] is None:
        return "what runs programs for it"
    if find_spec("ziglang") is None:
        return "ziglang, which compiles for it"
    library = next(LIBRARIES.glob(f"{target}/tlismni_core.*"), None)
    if library is None or any(x.encode() not in library.read_bytes() for x in (core_digest(), c_digest())):
        return f"the library of these sources in {LIBRARIES}"
    return ""


def host_here(folder):
    """The command of the host on this system."""
    library = LIBRARY.path.resolve()
    parts = [HERE / "bits_host.c", library, f"-Wl,-rpath,{library.parent}", "-lm"]
    subprocess.run(["cc", "-O2", f"-I{NATIVE}", "-o", str(folder / "here"), *map(str, parts)], check=True)
    return [str(folder / "here")]


def host_there(folder, target):
    """The command of the host for the target."""
    system, before = TARGETS[target]
    library = folder / next(LIBRARIES.glob(f"{target}/tlismni_core.*")).name
    shutil.copy(LIBRARIES / target / library.name, library)
    linked = library
    if target.startswith("windows"):  # programs are linked with a list of what the library has
        functions = sorted(set(re.findall(r"\b(tlismni_\w+)\(", (NATIVE / "tlismni.h").read_text())))
        names, linked = folder / "tlismni_core.def", folder / "libtlismni_core.a"
        names.write_text("\n".join([f"LIBRARY {library.name}", "EXPORTS", *functions, ""]))
        subprocess.run(
            [sys.executable, "-m", "ziglang", "dlltool", "-m", "i386:x86-64", "-d", str(names), "-l", str(linked)],
            check=True,
        )
    program = folder / "there.exe"
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", system, "-O2", f"-I{NATIVE}", "-o", str(program)]
    parts = [HERE / "bits_host.c", linked, f"-Wl,-rpath,{folder}", "-lm"]
    subprocess.run([*zig, *map(str, parts)], check=True)
    return [*map(str, before), str(program)]


@pytest.fixture(scope="module", params=TARGETS)
def programs(request, tmp_path_factory):
    """The host for this system and for another one, as commands."""
    if missing(request.param):
        pytest.skip(f"{request.param} needs {missing(request.param)}")
    folder = tmp_path_factory.mktemp("bits")
    return host_here(folder), host_there(folder, request.param)


@pytest.mark.parametrize(
    "name, parameters",
    [
        ("bouncing_ball", ["gravity=3.7", "mass=2.5"]),
        ("slider_crank_stop", ["crank_mass=0.5"]),
        ("rocking_block", []),
        ("spatial_slider_crank_stop", []),
    ],
)
def test_the_same_bits(programs, name, parameters, tmp_path):
    from tlismni.core.native import image_of
    from tlismni.core.native.parameters import Setting

    def setting(text):
        parameter = text.partition("=")[0]
        return Setting(
            parameter, load(name).parameters[parameter], 1e-3, 1e3, lambda values: load(name, **values).model
        )

    scenario = load(name)
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    wanted = [setting(text) for text in parameters]
    image = image_of(scenario.model, scenario.t_end, parameters=wanted, **settings)
    path = tmp_path / "run.image"
    path.write_bytes(image)
    arguments = [str(path), repr(scenario.t_end), "40", *parameters]
    here, there = (
        subprocess.run(
            [*command, *arguments], capture_output=True, text=True, check=True, env={**os.environ, "WINEDEBUG": "-all"}
        ).stdout
        for command in programs
    )
    assert here == there and len(here.splitlines()) == 41
