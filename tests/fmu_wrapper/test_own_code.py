"""FMUs of models with own classes carry the modules that define them, and run where nobody has these."""

import json
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import fmpy
import pytest
from tlismni.core import Disk2D, DiskOnHalfPlane2D, HalfPlane2D, Marker2D, Model, Parameter, PointMass2D, simulate
from tlismni.fmu_wrapper import ExportError, export_fmu
from tlismni.fmu_wrapper.in_process import InProcess
from tlismni.fmu_wrapper.own_code import OwnCode

SOURCES = {
    "own_kit/__init__.py": "",
    "own_kit/curves.py": """
        import math

        def height(a, b, curvature):
            return b.y - a.y - 0.5 * curvature * math.sin(b.x - a.x) ** 2
    """,
    "own_kit/joints.py": """
        from tlismni.core import Marker2D, ScalarJoint2D, scalar_constraint

        from .curves import height

        class OnWave(ScalarJoint2D):
            formula = scalar_constraint(height)
            a: Marker2D = Marker2D()
            b: Marker2D
            curvature: float
    """,
    "own_numbers.py": "FACTOR = 0.25\n",
    "own_pads.py": """
        import tlismni.core as tl
        from numpy import sqrt
        import own_numbers

        def pad(delta, delta_dot, v0, stiffness):
            return stiffness * delta * (1.0 + own_numbers.FACTOR * delta_dot / v0) + 0.0 * sqrt(delta)

        class Pad(tl.ForceLaw):
            formula = tl.force_formula(pad)
            stiffness: float
    """,
    "not_used.py": "raise RuntimeError\n",
}


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A bead on a wave over a pad; the classes are in modules that only this process can import."""
    folder = tmp_path_factory.mktemp("user")
    for name, text in SOURCES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(textwrap.dedent(text))
    sys.path.insert(0, str(folder))
    try:
        from own_kit.joints import OnWave
        from own_pads import Pad
    finally:
        sys.path.remove(str(folder))
    marker = Marker2D(body="bead")
    return Model(
        name="own",
        bodies=[PointMass2D(name="bead", mass=0.5, velocity=(2.0, 0.0))],
        joints=[OnWave(name="wave", b=marker, curvature=1.2)],
        contacts=[
            DiskOnHalfPlane2D(
                name="pad",
                plane=HalfPlane2D(marker=Marker2D(point=(0.3, 0.0), angle=1.5)),
                disk=Disk2D(marker=marker),
                law=Pad(stiffness=3e3),
            )
        ],
        parameters=[Parameter(name="curvature", targets=["wave.curvature"])],
    )  # fmt: skip


@pytest.fixture(scope="module")
def fmu(model, tmp_path_factory):
    return export_fmu(model, tmp_path_factory.mktemp("fmu") / "own.fmu", t_end=1.0)


def last_values(fmu, python=""):
    """x and y of the bead after 1 s with another curvature, of a process that knows nothing of the modules."""
    script = f"""
import fmpy, json, sys
{python}
from tlismni.fmu_wrapper.in_process import InProcess
unzipped = fmpy.extract({str(fmu)!r})
instance = InProcess.of(unzipped)
found = fmpy.simulate_fmu(
    unzipped, fmu_instance=instance, fmi_type="CoSimulation", start_values={{"curvature": 1.3}}, stop_time=1.0,
    output_interval=0.1, output=["bead.x", "bead.y", "solver.events"],
)
kind = type(instance.slave.model.joints[0])
print(json.dumps([*map(float, found[-1]), kind.__name__, "own_kit" in sys.modules]))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd="/", timeout=1200)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_fmu_carries_what_its_classes_need_and_no_more(fmu):
    with zipfile.ZipFile(fmu) as archive:
        carried = {n.removeprefix("resources/own/") for n in archive.namelist() if n.startswith("resources/own/")}
    assert carried == set(SOURCES) - {"not_used.py"}


def test_fmu_runs_where_nobody_has_the_modules(fmu, model):
    result = simulate(model.with_parameters({"curvature": 1.3}), 1.0)
    assert len(result.events) >= 2
    time, x, y, events, kind, known = last_values(fmu)
    assert (time, kind, known) == (1.0, "OnWave", False)
    assert (x, y) == pytest.approx((result["bead.x"][-1], result["bead.y"][-1]), abs=1e-5)
    assert events == len(result.events)


def test_another_version_of_a_module_in_the_process_does_not_matter(fmu):
    """A class of the same name that does otherwise, defined later in the host's process."""
    other = """
from tlismni.core import Marker2D, ScalarJoint2D, scalar_constraint
class OnWave(ScalarJoint2D):
    formula = scalar_constraint(lambda a, b: b.x - a.x)
    a: Marker2D = Marker2D()
    b: Marker2D
    curvature: float
"""
    assert last_values(fmu, other) == last_values(fmu)


def test_two_versions_live_in_one_process(fmu, model, tmp_path):
    """The FMU with a formula that has been changed in it: each instance has its own."""
    unzipped = fmpy.extract(str(fmu), unzipdir=str(tmp_path / "one"))
    changed = fmpy.extract(str(fmu), unzipdir=str(tmp_path / "other"))
    path = Path(changed, "resources/own/own_kit/curves.py")
    path.write_text(path.read_text().replace("0.5 *", "1.5 *"))
    found = []
    for folder in (unzipped, changed, unzipped):
        run = fmpy.simulate_fmu(
            folder, fmu_instance=InProcess.of(folder), fmi_type="CoSimulation", stop_time=0.3, output=["bead.x"]
        )
        found.append(run["bead.x"][-1])
    assert found[0] == found[2] and abs(found[1] - found[0]) > 1e-3


@pytest.mark.parametrize(
    "change, text",
    [
        (
            lambda own: own.joinpath("own_kit", "joints.py").unlink(),
            "own modules in the FMU's resources cannot be read",
        ),
        (lambda own: own.joinpath("own_numbers.py").write_text("import no_such_package\n"), "no_such_package"),
        (lambda own: own.joinpath("own_kit", "joints.py").write_text("x = 1\n"), "'own_kit.joints:OnWave'"),
    ],
)
def test_modules_that_do_not_work_are_named(fmu, tmp_path, change, text):
    unzipped = fmpy.extract(str(fmu), unzipdir=str(tmp_path / "fmu"))
    change(Path(unzipped, "resources", "own"))
    with pytest.raises(ExportError, match=text):
        InProcess.of(unzipped)


def test_paths_that_lead_out_are_refused(tmp_path):
    for name in ("../x.py", "/x.py"):
        with pytest.raises(ExportError, match="leads out"):
            OwnCode.read({"types": {}, "modules": [name]}, tmp_path)


def test_classes_that_no_fmu_can_carry_are_named(tmp_path):
    from tlismni.core import ScalarJoint2D, scalar_constraint

    class Local(ScalarJoint2D):
        formula = scalar_constraint(lambda b: b.y)
        b: Marker2D

    model = Model(bodies=[PointMass2D(name="p", mass=1.0)], joints=[Local(name="j", b=Marker2D(body="p"))])
    with pytest.raises(ExportError, match=r"'Local' is defined inside a function.*module file of its own"):
        export_fmu(model, tmp_path / "x.fmu")


def test_fmu_without_own_classes_says_nothing_of_them(tmp_path):
    model = Model(bodies=[PointMass2D(name="p", mass=1.0)])
    path = export_fmu(model, tmp_path / "x.fmu")
    with zipfile.ZipFile(path) as archive:
        assert "own" not in json.loads(archive.read("resources/settings.json"))
        assert not [name for name in archive.namelist() if "/own" in name]


def test_bundled_fmu_joins_its_package_and_its_modules(model, tmp_path):
    """Without any `tlismni` on the path: in the own modules the name means the package that the FMU carries."""
    path = export_fmu(model, tmp_path / "own.fmu", t_end=1.0, bundle=True)
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "fmu"))
    token = json.loads(Path(unzipped, "resources/settings.json").read_text())["token"]
    script = f"""
import fmpy, runpy, sys, importlib, importlib.abc
class NoPackage(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name == "tlismni" or name.startswith("tlismni."):
            raise ImportError("no tlismni here")
sys.meta_path.insert(0, NoPackage())
resources = {str(unzipped)!r} + "/resources"
boot = runpy.run_path(resources + "/boot.py")
calls = boot["create"](2, "it", {token!r}, resources, 0, print, 0, 0, 0, None, b"")
joint = calls.slave.model.joints[0]
base = type(joint).__mro__[1].__module__
package = base.partition(".")[0]
direct = importlib.import_module(package + ".fmu_wrapper.in_process").InProcess(calls.slave)
found = fmpy.simulate_fmu({str(unzipped)!r}, fmu_instance=direct, fmi_type="CoSimulation", stop_time=0.3,
                          start_values={{"curvature": 1.3}}, output_interval=0.1, output=["bead.x"])
print(type(joint).__module__, base, found["bead.x"][-1])
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd="/", timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    own, base, x = done.stdout.split()
    package = base.partition(".")[0]
    assert package.startswith("tlismni_") and own.startswith(f"{package}_own_") and own.endswith(".own_kit.joints")
    expected = simulate(model.with_parameters({"curvature": 1.3}), 0.3)["bead.x"][-1]
    assert float(x) == pytest.approx(expected, abs=1e-6)
