"""System files: what they describe, what is refused, FMUs with and without their binary, masters' records."""

import re
import textwrap

import numpy as np
import pytest

pytest.importorskip("fmpy")

from split_oscillators import COUPLING, Oscillators
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.export import HERE, SHIM
from tlismni.fmu_wrapper.master import CouplingError, MasterError, read_system, simulate_system
from tlismni.models import load

HALVES = Oscillators(solver={"method": "ebdf", "rtol": 1e-9, "atol": 1e-12})
needs_shim = pytest.mark.skipif(not (HERE / SHIM).is_file(), reason="the FMU shim is not built")

SYSTEM = f"""
    name = "two"
    [instances.a]
    model = "a.json"
    solver = {{ method = "ebdf", rtol = 1e-9, atol = 1e-12 }}
    [instances.b]
    model = "b.json"
    solver = {{ method = "ebdf", rtol = 1e-9, atol = 1e-12 }}
    [[connections]]
    from = "a.mass.x"
    to = "b.force"
    factor = {COUPLING}
    unit = "N/m"
    [[connections]]
    from = "b.mass.x"
    to = "a.force"
    factor = {COUPLING}
    unit = "N/m"
    [master]
    algorithm = "jacobi"
    step = 0.05
    t_end = 0.5
"""


@pytest.fixture
def folder(tmp_path):
    for k, name in enumerate("ab"):
        (tmp_path / f"{name}.json").write_text(HALVES.model(k).to_json())
    return tmp_path


def simulate(folder, text=SYSTEM, *changes, **arguments):
    """Run a system file whose text has been changed by pairs (old, new)."""
    text = textwrap.dedent(text)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "system.toml").write_text(text)
    return simulate_system(read_system(folder / "system.toml"), folder, load_scenario=load, **arguments)


def test_a_file_is_the_run_that_it_describes(folder):
    found = simulate(folder)
    expected = HALVES.run("jacobi", 0.05, 0.5, record=("*",))
    assert found.channels == expected.channels and found.unconnected == () and found.loops == ()
    for name in expected.channels:
        assert np.array_equal(found[name], expected[name])
    assert found["b.force"] == pytest.approx(COUPLING * found["a.mass.x"], rel=1e-15)
    units = {c.name: c.unit for c in found.channel_records}
    assert units["a.mass.x"] == "m" and units["a.force"] == "N"


@pytest.mark.sampled(2)
@needs_shim
@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("algorithm", ["gauss-seidel", "newton"])
def test_fmus_with_and_without_binary_and_models_give_the_same(folder, version, algorithm):
    for k, name in enumerate("ab"):
        export_fmu(HALVES.model(k), folder / f"{name}.fmu", version, **HALVES.solver)
    solver = '    solver = { method = "ebdf", rtol = 1e-9, atol = 1e-12 }\n'
    chosen = ('"jacobi"', f'"{algorithm}"')
    plain = simulate(folder, SYSTEM, chosen)
    fmus = SYSTEM.replace(solver, "").replace("model =", "fmu =").replace(".json", ".fmu")
    for text in (fmus, fmus.replace('.fmu"', '.fmu"\n    in_process = true')):
        found = simulate(folder, text, chosen)
        assert found.stats == plain.stats
        for name in plain.channels:
            assert np.array_equal(found[name], plain[name])


def test_scenarios_with_parameters_and_start_values(tmp_path):
    text = """
        connections = [{ from = "a.pendulum.angle", to = "b.torque", factor = 0.5, unit = "N.m/rad" }]
        record = ["*.pendulum.angle", "b.torque", "*.solver.events"]
        [instances.a]
        scenario = "pendulum_stop"
        parameters = { restitution = 0.3 }
        [instances.b]
        scenario = "pendulum_stop"
        fmi = "2.0"
        start = { restitution = 0.8 }
        [master]
        step = 0.02
        t_end = 0.7
    """
    reached = []
    found = simulate(tmp_path, text, progress=reached.append)
    assert set(found.channels) == {f"{i}.{c}" for i in "ab" for c in ("solver.events", "pendulum.angle")} | {"b.torque"}
    assert reached == pytest.approx(found.t[1:]) and found.unconnected == ("a.torque",)
    assert found["a.solver.events"][-1] >= 1
    np.testing.assert_allclose(found["b.torque"], 0.5 * found["a.pendulum.angle"], rtol=1e-14)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"a.mass.x"', '"a.mass.xx"', r"no such variable; of the outputs near it are \['mass.x'"),
        ('"a.mass.x"', '"aa.mass.x"', r"no instance 'aa'; near it are \['a'\]"),
        ('"a.mass.x"', '"mass"', "instance.variable"),
        ('"b.force"', '"b.mass.x"', "causality output, an input is needed.*force"),
        ('"b.force"', '"a.force"', "fed twice, by 'a.mass.x' and 'b.mass.x'"),
        ('unit = "N/m"', 'unit = "N"', "in m, 'b.force' in N, the factor in N: the units do not fit"),
        ('"a.mass.x"', '"a.solver.events"', "only real variables"),
        ('"jacobi"', '"jakobi"', "gauss-seidel"),
        ("step = 0.05", "step = -0.05", "greater than 0"),
        ("step = 0.05", 'step = 0.05\n    order = ["a"]', "must name each of"),
        ("step = 0.05", 'step = 0.05\n    control = { estimate = "iteration" }', "does not iterate"),
        ('model = "a.json"', 'model = "a.json"\n    fmu = "x.fmu"', "one of fmu, scenario and model"),
        ('model = "a.json"', 'model = "c.json"', "c.json' cannot be read"),
        (
            'model = "a.json"',
            'model = "a.json"\n    start = { forc = 1.0 }',
            r"no variable 'forc'; near it are \['force'",
        ),
        ('model = "a.json"', 'model = "a.json"\n    start = { force = "1" }', "a number is needed, not '1'"),
        ('name = "two"', 'name = "two"\n    record = ["c.*"]', "nothing to record matches"),
        ('name = "two"', 'name = "two', "is no TOML"),
    ],
)
def test_refusals(folder, old, new, words):
    with pytest.raises((MasterError, Exception), match=words) as error:
        simulate(folder, SYSTEM, (old, new))
    assert type(error.value).__module__.startswith("tlismni")


def test_units_of_one_kind_are_converted(folder):
    found = simulate(folder, SYSTEM, ("factor = 40.0", "factor = 0.04"), ('unit = "N/m"', 'unit = "N/mm"'))
    np.testing.assert_allclose(found["b.force"], COUPLING * found["a.mass.x"], rtol=1e-12)


def test_a_failing_instance_is_named_with_its_reason(folder):
    with pytest.raises(MasterError, match=r"instance '[ab]' cannot (set inputs|step from t = \d).*: .*finite"):
        simulate(folder, SYSTEM, ("factor = 40.0", "factor = 1e308"))


def test_a_step_that_cannot_be_controlled_ends_with_its_reason(folder):
    control = ("t_end = 0.5", "t_end = 0.5\n    control = { tolerance = 1e-15, absolute = 1e-18, smallest = 1e-3 }")
    with pytest.raises(CouplingError, match=re.escape("falls below 0.001 s")):
        simulate(folder, SYSTEM, control)


SPLIT = """
    name = "split"
    record = ["*.hammer.*", "*.anvil.*", "*.normal_force", "*.contact_force"]
    connections = [
        { from = "striker.hammer.x", to = "wall.hammer_x", hold = "meet" },
        "striker.hammer.vx -> wall.hammer_vx",
        "wall.blow.normal_force -> striker.contact_force",
    ]
    [instances.striker]
    scenario = "split_striker"
    [instances.wall]
    scenario = "split_wall"
    [master]
    algorithm = "newton"
    step = 5e-4
    t_end = 0.014
"""


@needs_shim
def test_fmus_of_both_versions_in_one_system_are_their_scenarios(tmp_path):
    """Through the start of a contact, with rollbacks and derivatives."""
    scenarios = simulate(tmp_path, SPLIT)
    assert scenarios.stats["rollbacks"] > 10 and scenarios["wall.blow.normal_force"].max() > 100.0
    text = SPLIT
    for name, version in (("striker", "2.0"), ("wall", "3.0")):
        export_fmu(load(f"split_{name}"), tmp_path / f"{name}.fmu", version)
        text = text.replace(f'scenario = "split_{name}"', f'fmu = "{name}.fmu"')
    fmus = simulate(tmp_path, text)
    assert fmus.stats == scenarios.stats
    for name in scenarios.channels:
        assert np.array_equal(fmus[name], scenarios[name]), name


def test_a_position_that_shall_meet_the_end_needs_its_velocity(tmp_path):
    velocity = '    "striker.hammer.vx -> wall.hammer_vx",\n'
    with pytest.raises(MasterError, match=r"hold = 'meet'.*connect 'striker\.hammer\.vx'"):
        simulate(tmp_path, SPLIT, (velocity, ""))


@needs_shim
def test_an_fmu_that_is_none(folder):
    (folder / "a.fmu").write_text("nothing")
    with pytest.raises(MasterError, match="cannot be read as an FMU"):
        simulate(folder, SYSTEM.replace('solver = { method = "ebdf", rtol = 1e-9, atol = 1e-12 }', "", 1),
                 ('model = "a.json"', 'fmu = "a.fmu"'))  # fmt: skip
