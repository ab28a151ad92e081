"""Results in words and figures, and models that go on from them."""

from pathlib import Path

import numpy as np
import pytest
from tlismni.core import (
    AxialRod,
    Cable2D,
    EquationSystem,
    LinearSystem,
    Model,
    ModelError,
    PointMass2D,
    Result,
    simulate,
)
from tlismni.models import load

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


@pytest.fixture(scope="module")
def swing() -> Result:
    return simulate(load("pendulum_stop").model, 2.5, **TIGHT)


def test_print_says_what_it_is(swing: Result) -> None:
    text = str(swing)
    assert text.splitlines()[0] == "Result of pendulum_stop"
    for part in ("0 to 2.5 s", f"{len(swing)} samples", "ebdf (rtol 1e-10", "3: impact of stop 3", "energy balance"):
        assert part in text
    assert "<table>" in swing._repr_html_()
    assert "a system of equations" in str(
        simulate(EquationSystem(mass=np.eye(1), force=lambda t, q, v: -q, q0=[1.0], v0=[0.0]), 0.1)
    )
    assert "no samples" in str(simulate(load("pendulum_stop").model, 0.1, t_eval=[]))


def test_the_event_list_is_a_table(swing: Result) -> None:
    lines = swing.event_list().splitlines()
    assert len(lines) == 4 and lines[0].split()[0] == "time"
    assert lines[1].split()[:3] == [f"{swing.events[0].t:.9g}", "impact", "stop"]
    assert swing.event_list(1).endswith("... and 2 more")


@pytest.mark.parametrize(
    "name, text",
    [
        ("pendulum", "'pendulum' is not a channel but has some: ['pendulum.x', 'pendulum.vx'"),
        ("pendulum.angel", "did you mean ['pendulum.angle'"),
        ("stop.zzzzzzzz", "'stop' has ['stop.gap'"),
        ("qqqq", "there is no channel 'qqqq'. `result.channels` lists all"),
        (3, "a channel's name is needed, a text such as 'pendulum.x', not 3"),
    ],
)
def test_unknown_names_are_answered(swing: Result, name: str, text: str) -> None:
    with pytest.raises(KeyError) as caught:
        swing[name]
    assert text in str(caught.value)


def test_plots_show_the_channels(swing: Result, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    figure = swing.plot("pendulum.angle", "stop.gap", path=tmp_path / "x.png")
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")
    first, second = figure.axes
    (angle, *_), label = first.lines, first.get_ylabel()
    assert label == "pendulum.angle\nrad" and second.get_ylabel() == "stop.gap\nm"
    assert np.isin(swing["pendulum.angle"], angle.get_ydata()).all()
    portrait = swing.plot_phase("pendulum.angle", "pendulum.angular_velocity").axes[0]
    assert np.isin(swing["pendulum.angular_velocity"], portrait.lines[0].get_ydata()).all()
    ledger = swing.plot_energy().axes[0]
    assert {"kinetic", "potential", "impact loss"} <= {text.get_text() for text in ledger.get_legend().get_texts()}
    with pytest.raises(ModelError, match="name the channels"):
        swing.plot()
    with pytest.raises(KeyError, match="did you mean"):
        swing.plot("pendulum.angel")


def test_a_run_goes_on_from_where_another_ended(swing: Result) -> None:
    half = simulate(swing.system, 1.2, **TIGHT)
    model = half.model_at()
    assert model.bodies[0].angle == half["pendulum.angle"][-1]
    by_model = simulate(model, 2.5, t0=1.2, **TIGHT)
    by_values = simulate(swing.system, 2.5, t0=1.2, start_values=half.start_at(), **TIGHT)
    for rest in (by_model, by_values):
        assert rest.t[0] == 1.2 and len(rest.events) == 2
        assert rest.q[-1] == pytest.approx(swing.q[-1], abs=1e-8)
        assert rest.events[-1].t == pytest.approx(swing.events[-1].t, abs=1e-8)


def test_it_can_begin_at_any_recorded_time_after_the_blow_if_two_are_there(swing: Result) -> None:
    strike = swing.events[0].t
    assert swing.model_at(strike).bodies[0].angular_velocity > 0.0
    with pytest.raises(ModelError, match=r"was not recorded; around it are \[0\.48"):
        swing.model_at(np.nextafter(strike, 1.0) + 1e-6)


def test_bodies_of_all_kinds_start_where_they_were() -> None:
    for name, t_end in (("hub_beam_stop", 0.01), ("woodpecker", 0.05), ("newtons_cradle", 0.1)):
        s = load(name)
        result = simulate(s.model, t_end, s.method, s.rtol, s.atol)
        again = simulate(result.model_at(), t_end + 1e-6, t0=t_end)
        assert again.q[0] == pytest.approx(result.q[-1], abs=1e-9), name
        assert again.v[0] == pytest.approx(result.v[-1], abs=1e-5), name


def test_a_resting_body_stays_at_rest() -> None:
    result = simulate(load("pendulum_stop", restitution=0.0, stop_angle=-1.0).model, 2.0)
    again = simulate(result.model_at(), 3.0, t0=2.0)
    assert result["stop.normal_force"][-1] > 1.0
    assert again["stop.normal_force"][1:] == pytest.approx(np.full(len(again) - 1, result["stop.normal_force"][-1]))


def test_what_a_record_cannot_say_is_refused_with_a_way_out() -> None:
    cable = load("cable_pendulum")
    result = simulate(cable.model, 0.05, cable.method, cable.rtol, cable.atol, **cable.options)
    with pytest.raises(ModelError, match=r"cable .* swings.*start_values=result\.start_at"):
        result.model_at()
    rest = simulate(cable.model, 0.06, "irk", t0=0.05, start_values=result.start_at())
    assert rest.q[0] == pytest.approx(result.q[-1], abs=1e-9)
    rod = load("rod_wall")
    with pytest.raises(ModelError, match="moves in waves"):
        simulate(rod.model, 6e-4).model_at()
    with pytest.raises(ModelError, match="not of a Model"):
        simulate(EquationSystem(mass=np.eye(1), force=lambda t, q, v: -q, q0=[1.0], v0=[0.0]), 0.1).model_at()


def test_rods_and_cables_that_fly_as_they_are_can_be_told() -> None:
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[
            AxialRod(name="rod", elements=3, length=1.0, axial_stiffness=1e3, mass_per_length=1.0, velocity=2.0),
            Cable2D(
                name="cable", elements=2, length=1.0, mass_per_length=1.0, axial_stiffness=1e3, bending_stiffness=1.0,
                velocity=(1.0, 0.5),
            ),
            LinearSystem(name="modes", coordinates=("u",), mass=((1.0,),), stiffness=((4.0,),), position=(1.0,)),
            PointMass2D(name="ball", mass=1.0, velocity=(0.0, 1.0)),
        ],
    )  # fmt: skip
    result = simulate(model, 0.5)
    again = simulate(result.model_at(), 0.6, t0=0.5)
    assert again.q[0] == pytest.approx(result.q[-1], abs=1e-9)
    assert again.v[0] == pytest.approx(result.v[-1], abs=1e-9)


def test_start_values_of_unknown_names_are_refused(swing: Result) -> None:
    with pytest.raises(ModelError, match=r"no start value 'pendulum\.angel'"):
        simulate(swing.system, 1.0, start_values={"pendulum.angel": 1.0})


def test_a_result_of_no_length_can_be_asked() -> None:
    empty = simulate(load("pendulum_stop").model, 0.1, t_eval=[])
    with pytest.raises(ModelError, match="no samples"):
        empty.model_at()
    with pytest.raises(ModelError, match="no samples"):
        empty.animate()


def test_start_values_keep_the_scales_of_the_model_where_it_is_a_point_at_the_origin_now() -> None:
    model = load("bouncing_ball").model
    result = simulate(model, 5.0)
    again = simulate(model, 6.0, t0=5.0, start_values=result.start_at())
    assert np.abs(again["ball.y"]).max() < 1e-12
    assert again["floor.normal_force"][-1] == pytest.approx(9.81 * model.bodies[0].mass)
