"""The library for another processor, system or C library gives the bits of this one, where there is what runs it
(`elsewhere.py`)."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from elsewhere import TARGETS, library_for, missing, output, zig
from tlismni.core.compiled.library import LIBRARY
from tlismni.models import load

HERE, NATIVE = Path(__file__).parent, Path(__file__).parents[2] / "core" / "native"


def host_here(folder):
    """The command of the host on this system."""
    library = LIBRARY.path.resolve()
    parts = [HERE / "bits_host.c", library, f"-Wl,-rpath,{library.parent}", "-lm"]
    subprocess.run(["cc", "-O2", f"-I{NATIVE}", "-o", str(folder / "here"), *map(str, parts)], check=True)
    return [str(folder / "here")]


def host_there(folder, target):
    """The command of the host for the target."""
    system, before = TARGETS[target]
    linked = library = Path(shutil.copy(library_for(target), folder))
    if target.startswith("windows"):  # programs are linked with a list of what the library has
        functions = sorted(set(re.findall(r"\b(tlismni_\w+)\(", (NATIVE / "tlismni.h").read_text())))
        names, linked = folder / "tlismni_core.def", folder / "libtlismni_core.a"
        names.write_text("\n".join([f"LIBRARY {library.name}", "EXPORTS", *functions, ""]))
        zig("dlltool", "-m", "i386:x86-64", "-d", names, "-l", linked)
    program = folder / "there.exe"
    parts = [HERE / "bits_host.c", linked, f"-Wl,-rpath,{folder}", "-lm"]
    zig("cc", "-target", system, "-O2", f"-I{NATIVE}", "-o", program, *parts)
    return [*before, program]


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
    here, there = (output([*command, path, repr(scenario.t_end), 40, *parameters]) for command in programs)
    assert here == there and len(here.splitlines()) == 41
