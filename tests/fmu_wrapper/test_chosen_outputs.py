"""FMUs that show chosen outputs, protected FMUs, and parameters that a model file declares."""

import zipfile

import fmpy
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
from fmu_helpers import ball_model
from tlismni.core import Model, RigidBody2D, simulate
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.model.channels import Formula, Parameter
from tlismni.fmu_wrapper import ExportError, Slave, export_fmu
from tlismni.fmu_wrapper.chosen import with_outputs, without_secrets


def outputs(path):
    return [v.name for v in fmpy.read_model_description(path).modelVariables if v.causality == "output"]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_only_chosen_outputs_are_there_and_their_values_are_the_same(version, tmp_path):
    settings = {"t_end": 0.6, "communication_step": 0.1}
    full = export_fmu(ball_model(), tmp_path / "full.fmu", version, **settings)
    few = export_fmu(ball_model(), tmp_path / "few.fmu", version, outputs=["ball.v*", "floor.gap"], **settings)
    assert outputs(few) == ["solver.events", "ball.vx", "ball.vy", "floor.gap"]
    assert validate_fmu(str(few)) == []
    found = [simulate_fmu(str(p), output=["ball.vy", "floor.gap"], fmi_call_logger=None) for p in (full, few)]
    assert found[0].tobytes() == found[1].tobytes() and found[0]["floor.gap"][-1] < 1.0


def test_an_unknown_output_is_refused_with_near_names(tmp_path):
    with pytest.raises(ExportError, match=r"no channel is called 'ball.yy'; did you mean \['ball.y'"):
        export_fmu(ball_model(), tmp_path / "x.fmu", outputs=["ball.yy"])


def test_an_fmu_with_python_cannot_be_protected(tmp_path):
    with pytest.raises(ExportError, match=r"carries the model as text.*native=True"):
        export_fmu(ball_model(), tmp_path / "x.fmu", protect=True)


def test_a_protected_table_tells_neither_numbers_nor_laws():
    table = without_secrets(with_outputs(Slave(ball_model()).variables, ["ball.y"]))
    assert [v.name for v in table.variables] == ["time", "solver.events", "push", "ball.y"]
    assert [v.reference for v in table.variables] == [1, 2, 3, 4] and not table.by_name["ball.y"].description


@pytest.mark.sampled(1)
@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_a_protected_fmu_runs_and_holds_no_words_of_the_model(version, tmp_path):
    path = export_fmu(
        ball_model(), tmp_path / "p.fmu", version, native=True, protect=True, outputs=["ball.y"], t_end=0.6,
        communication_step=0.1,
    )  # fmt: skip
    assert outputs(path) == ["solver.events", "ball.y"] and validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        words = b"".join(archive.read(name) for name in archive.namelist() if "binaries" not in name)
    assert not any(word in words for word in (b"restitution", b"NewtonImpact", b"PointMass2D", b"mass", b"0.7"))
    y = simulate_fmu(str(path), output=["ball.y"], start_values={"push": 1.0})["ball.y"]
    full = export_fmu(ball_model(), tmp_path / "f.fmu", version, native=True, t_end=0.6, communication_step=0.1)
    assert y.tobytes() == simulate_fmu(str(full), output=["ball.y"], start_values={"push": 1.0})["ball.y"].tobytes()


def test_a_length_of_a_model_file_is_a_parameter_of_the_fmu(tmp_path):
    """A rod thrown up with a spin: what follows from the length by a formula follows in the FMU too."""
    rod = Model(
        name="rod",
        bodies=[RigidBody2D(name="rod", mass=2.0, inertia=1.0, velocity=(0.0, 1.0), angular_velocity=1.0)],
        parameters=[Parameter(name="length", value=1.2, unit="m", description="length of the rod", minimum=0.1)],
        formulas=[
            Formula(target="rod.inertia", formula="2 * length**2 / 12"),
            Formula(target="rod.position.1", formula="length / 2"),
        ],
    )
    path = export_fmu(rod, tmp_path / "rod.fmu", t_end=0.5, communication_step=0.1)
    (length,) = [v for v in fmpy.read_model_description(path).modelVariables if v.name == "length"]
    assert (length.causality, length.unit, length.start, length.min) == ("parameter", "m", "1.2", "0.1")
    found = simulate_fmu(str(path), start_values={"length": 2.0}, output=["rod.y", "energy.kinetic"])
    here = simulate(rod.with_parameters({"length": 2.0}), 0.5)
    assert found["rod.y"][-1] == pytest.approx(here["rod.y"][-1], abs=1e-9)
    assert found["energy.kinetic"][0] == pytest.approx(0.5 * 2.0 + 0.5 * 2.0 * 4.0 / 12.0)
