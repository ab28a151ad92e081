"""What people see of an FMU is in all of them: documentation, the licence, the icon and the terminals."""

import zipfile

import pytest
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load

NATIVE = pytest.param(
    True, marks=pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
)
LICENCE = "documentation/licenses/license.txt"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("native", [False, NATIVE])
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_papers(native, version, tmp_path):
    path = export_fmu(load("pendulum_stop"), tmp_path / "x.fmu", version, native=native)
    with zipfile.ZipFile(path) as archive:
        held = set(archive.namelist())
        page, licence = (archive.read(x).decode() for x in ("documentation/index.html", LICENCE))
    icons = {"2.0": {"model.png"}, "3.0": {f"terminalsAndIcons/{x}" for x in ("icon.png", "icon.svg")}}
    assert icons[version] <= held
    assert ("terminalsAndIcons/terminalsAndIcons.xml" in held) == (version == "3.0")
    assert "torque" in page and "<svg" in page and "pendulum.angle" in page
    assert ("RigidBody2D" in page) != native  # numbers, not the model's parts
    assert "MIT License" in licence and "Copyright" in licence


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
def test_a_protected_one_has_the_page_of_its_variables_and_the_licence(tmp_path):
    path = export_fmu(load("pendulum_stop"), tmp_path / "x.fmu", "3.0", native=True, protect=True, outputs=["stop.gap"])
    with zipfile.ZipFile(path) as archive:
        page, held = archive.read("documentation/index.html").decode(), archive.namelist()
    assert "stop.gap" in page and "<svg" not in page and "restitution" not in page and "ebdf" not in page
    assert LICENCE in held and not [x for x in held if "erminals" in x or x.endswith((".png", ".svg", ".glb"))]
