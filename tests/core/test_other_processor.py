"""The library for another processor gives the bits of this one: aarch64 under qemu, where both are there.

apt-get install qemu-user libc6-arm64-cross
python -m tlismni.core.ahead --target linux-aarch64 --output build
"""

import os
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
SYSTEM = Path("/usr/aarch64-linux-gnu")
OTHER = Path(os.environ.get("TLISMNI_LIBRARIES", "build"), "linux-aarch64", "tlismni_core.so").resolve()
QEMU = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")


def missing():
    """What this needs and has not."""
    if LIBRARY is None or shutil.which("cc") is None:
        return "a C compiler and the library of machine code"
    if QEMU is None or not SYSTEM.is_dir():
        return "qemu-user and libc6-arm64-cross"
    if find_spec("ziglang") is None:
        return "ziglang, which compiles for another processor"
    if not OTHER.is_file() or any(x.encode() not in OTHER.read_bytes() for x in (core_digest(), c_digest())):
        return f"the library for linux-aarch64 of these sources at {OTHER}"
    return ""


pytestmark = pytest.mark.skipif(bool(missing()), reason=f"needs {missing()}")


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """The host for this processor and for the other one, as commands."""
    folder, commands = tmp_path_factory.mktemp("bits"), []
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-gnu.2.17"]
    for compiler, library, before in ((["cc"], LIBRARY.path.resolve(), []), (zig, OTHER, [QEMU, "-L", SYSTEM])):
        program = folder / str(len(commands))
        parts = [HERE / "bits_host.c", library, f"-Wl,-rpath,{library.parent}", "-lm"]
        subprocess.run([*compiler, "-O2", f"-I{NATIVE}", "-o", str(program), *map(str, parts)], check=True)
        commands.append([*map(str, before), str(program)])
    return commands


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
        subprocess.run([*command, *arguments], capture_output=True, text=True, check=True).stdout
        for command in programs
    )
    assert here == there and len(here.splitlines()) == 41
