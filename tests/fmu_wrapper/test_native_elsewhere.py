"""FMUs without Python on other processors, systems and C libraries, where there is what runs them (`elsewhere.py`): the
bits of this machine through all of FMI 2.0 and 3.0 that a host takes."""

import subprocess
from pathlib import Path

import fmpy
import pytest
from elsewhere import LIBRARIES, TARGETS, library_for, missing, output, zig
from native_pair import TAKE_PYTHON
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.platforms import PLATFORMS
from tlismni.models import load, names

HOST, HEADERS = Path(__file__).with_name("host_elsewhere.c"), Path(fmpy.__file__).parent / "c-code"
FMI_PLATFORMS = {"linux-aarch64": "aarch64-linux", "windows-x86_64": "x86_64-windows"}
"""Of FMI 3.0; it has none for musl, where an FMU carries the library under the name for glibc."""


@pytest.fixture(scope="module", params=TARGETS)
def elsewhere(request):
    """A system whose programs run here."""
    if missing(request.param):
        pytest.skip(f"{request.param} needs {missing(request.param)}")
    return request.param


@pytest.fixture(scope="module", params=[2, 3])
def hosts(request, elsewhere, tmp_path_factory):
    """The host of this FMI version for this system, and for the other one, as commands."""
    folder = tmp_path_factory.mktemp("hosts")
    here, there = folder / "here", folder / "there.exe"
    flags = ["-O2", f"-DFMI={request.param}", f"-I{HEADERS}", HOST]
    subprocess.run(["cc", *map(str, flags), "-o", str(here), "-ldl"], check=True)
    system, before = TARGETS[elsewhere]
    # with musl zig makes static programs, which open no libraries, unless they are linked with one
    linked = [library_for(elsewhere), f"-Wl,-rpath,{library_for(elsewhere).parent}"] if "musl" in system else []
    zig("cc", "-target", system, *flags, *linked, "-o", there)
    return request.param, [here], [*before, there]


USUAL = {
    "bouncing_ball": ("gravity", 3.7),
    "slider_crank_stop": ("crank_mass", 0.5),
    "dropped_box": (),
    "cable_ground": (),
}
"""Scenarios, with a parameter that is set before the run."""
OTHERS = [pytest.param(x, marks=pytest.mark.full) for x in names() if x not in (*TAKE_PYTHON, *USUAL)]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*USUAL, *OTHERS])
def test_the_same_bits(hosts, elsewhere, name, tmp_path, monkeypatch):
    monkeypatch.setenv("TLISMNI_LIBRARIES", str(LIBRARIES))
    (version, here, there), scenario = hosts, load(name)
    parameter, value = USUAL.get(name) or (None, 0.0)
    others = [FMI_PLATFORMS[elsewhere]] if elsewhere in FMI_PLATFORMS else []
    path = export_fmu(scenario, tmp_path / "x.fmu", f"{version}.0", native=True, platforms=others)
    # a program's arguments have letters of the system's own on Windows, a URI has none
    unzipped = Path(fmpy.extract(str(path), unzipdir=str(tmp_path / ("Räder 2" if version == 2 else "wheels 3"))))
    binary = library_for(elsewhere)
    if others:
        (carried,) = unzipped.glob(f"binaries/{PLATFORMS[others[0]].folder(f'{version}.0')}/*")
        assert carried.read_bytes() == binary.read_bytes()
    description = fmpy.read_model_description(str(unzipped))
    variables = description.modelVariables
    inputs = [v.valueReference for v in variables if v.causality == "input"]
    outputs = [v.valueReference for v in variables if v.causality == "output" and v.type in ("Real", "Float64")]
    set_before = next((v.valueReference for v in variables if v.name == parameter), 0)
    numbers = [repr(scenario.t_end / 40.0), 40, set_before, value, inputs[0] if inputs else 0, *outputs]

    def said(command, binary, drive):
        uri = (unzipped / "resources").as_uri().replace("file:///", f"file:///{drive}")
        place = uri if version == 2 else f"{drive}{unzipped / 'resources'}/"
        return output([*command, binary, place, description.guid, *numbers])

    found = said(here, LIBRARY.path, "")
    assert found == said(there, binary, "Z:/" if elsewhere.startswith("windows") else "")
    lines = found.splitlines()
    (between,) = [k for k, line in enumerate(lines) if "bytes" in line]
    again = len(lines) - between - 1
    assert again >= 20 and len({tuple(lines[k - again : k]) for k in (len(lines), between, between - again)}) == 1
