"""Parameters of images (`core/native/parameters.py`): found, set, and the same bits as the model with other numbers."""

import math

import numpy as np
import pytest
from tlismni.core import Simulation, SimulationError
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.native.forms import BINARY, SUM, SUMS, UNARY, form_of
from tlismni.models import load

needs_library = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
VALUES = np.random.default_rng(1).uniform(0.2, 11.0, 75)


@pytest.mark.sampled(60)
@pytest.mark.parametrize("constant", [0.1, -3.7, 1.0 / 3.0, math.pi])
@pytest.mark.parametrize(
    "unary, binary", [(i, k) for i in range(len(UNARY)) for k in range(len(BINARY)) if i < SUMS or k < SUM]
)
def test_what_one_operation_makes_is_found(unary, binary, constant):
    """The form that is found gives the same words at other values between those too."""
    words = BINARY[binary](UNARY[unary](VALUES), constant)
    form = form_of(VALUES, words)
    other = np.linspace(0.3, 10.0, 97)
    found = BINARY[form.code % 8](UNARY[form.code // 8](other), form.constant)
    assert found.tobytes() == BINARY[binary](UNARY[unary](other), constant).tobytes()


def test_what_more_operations_make_is_not():
    assert form_of(VALUES, np.sin(VALUES)) is None
    assert form_of(VALUES, 0.7 * VALUES + 0.1) is None
    assert form_of(VALUES[:3], VALUES[:3]) is None  # too few values to be sure


def build(name, *wanted, **parameters):
    from tlismni.core.native.export import image_and_parameters
    from tlismni.core.native.in_process import NativeModel, NativeRun

    scenario = load(name, **parameters)
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    image, found, fixed = image_and_parameters(scenario.model, scenario.t_end, wanted or None, **settings)
    run = NativeRun(NativeModel(image, LIBRARY))
    return run, found, fixed, lambda model: Simulation(model, **settings), scenario.model


@needs_library
@pytest.mark.parametrize("value", [0.0, 0.31, 0.75, 1.0])
def test_the_same_bits_as_with_the_number_in_the_model(value):
    run, found, _, begun, model = build("bouncing_ball")
    (p,) = (p for p in found if p.name == "restitution")
    number = run.model.names(3).index("restitution")
    assert p.least <= value <= p.largest and run.parameters[number] == p.value
    run.set_parameter(number, value)
    sim = begun(model.with_parameters({"restitution": value}))
    for t in np.linspace(0.0, 1.9, 40)[1:]:
        sim.advance(float(t))
        assert run.step(float(t)).tobytes() == sim.values().tobytes(), t
    assert run.events == len(sim.events) > 0


@needs_library
def test_numbers_by_their_place_and_why_others_are_fixed():
    run, found, fixed, begun, model = build("bouncing_ball", "restitution", "ball.mass")
    assert [p.name for p in found] == list(run.model.names(3)) == ["restitution", "ball.mass"]
    assert [p.begins for p in found] == [False, True] and not fixed
    run.set_parameter(1, 0.3)
    sim = begun(model.with_parameters({"ball.mass": 0.3}))
    assert run.look().tobytes() == sim.values().tobytes()
    sim.advance(1.4)
    assert run.step(1.4).tobytes() == sim.values().tobytes()
    _, found, fixed, _, _ = build("bricard", "rod1.mass")
    assert not found and "begin as it was exported only" in fixed["rod1.mass"]


@needs_library
def test_when_and_what_may_be_set():
    run, found, _, _, _ = build("bouncing_ball")
    for wrong, reason in ((math.nan, "outside the range"), (found[0].largest + 1.0, "outside the range")):
        with pytest.raises(SimulationError, match=reason):
            run.set_parameter(0, wrong)
    with pytest.raises(SimulationError, match="no such parameter"):
        run.set_parameter(len(found), 0.5)
    before = run.save()
    run.set_parameter(0, 0.5)
    changed = run.save()
    run.step(0.1)
    with pytest.raises(SimulationError, match="before a run goes on"):
        run.set_parameter(0, 0.6)
    run.restore(changed)
    assert run.parameters[0] == 0.5
    run.restore(before)
    assert run.parameters[0] == found[0].value
