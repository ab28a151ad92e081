"""Many runs on threads: each is the one that `simulate` makes, in whatever order threads come to it."""

import sys
from threading import Event

import numpy as np
import pytest
from tlismni.core import EquationSystem, ModelError, compile_model, simulate, simulate_many
from tlismni.models import load

RESTITUTION = np.linspace(0.2, 0.9, 12)


@pytest.fixture
def hectic():
    """Python changes threads as often as it can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def ball():
    return load("bouncing_ball").model


@pytest.mark.parametrize("name, end", [("bouncing_ball", 1.2), ("pendulum_stop", 1.0), ("woodpecker", 0.3)])
def test_runs_do_not_depend_on_the_number_of_threads(name, end, hectic):
    """Contacts that come to rest, stick and slip among them: their events are Python's."""
    model = load(name).model
    place = f"{model.contacts[0].name}.law.restitution"
    columns = {place: RESTITUTION}
    one, four = (simulate_many(model, columns, end, threads=threads) for threads in (1, 4))
    assert one.values.tobytes() == four.values.tobytes()
    assert one.events.tolist() == four.events.tolist() and one.steps.tolist() == four.steps.tolist()
    assert not one.failures and not four.failures
    for row in (0, 7, 11):
        alone = simulate(model.with_parameters({place: RESTITUTION[row]}), end)
        last = np.array([alone[channel][-1] for channel in one.channels])
        assert one.values[row, 0].tobytes() == last.tobytes()
        assert one.events[row] == len(alone.events)


def test_a_ball_rises_as_high_as_its_restitution_says():
    """Height after the first bounce: h(t) = e v0 s - g s^2 / 2 with s the time since, v0 = sqrt(2 g h)."""
    found = simulate_many(ball(), {"restitution": RESTITUTION}, 0.6, channels=["ball.y"])
    speed = np.sqrt(2.0 * 9.81)
    since = 0.6 - speed / 9.81
    free = RESTITUTION * speed / 9.81 * 2.0 > since
    expected = RESTITUTION * speed * since - 0.5 * 9.81 * since**2
    assert np.count_nonzero(free) > 5
    assert np.allclose(found["ball.y"][free], expected[free], atol=1e-7)


def test_channels_at_times_and_the_table():
    times = [0.0, 0.2, 0.4]
    found = simulate_many(
        ball(), {"ball.mass": 3.0}, 0.4, start={"ball.vy": [0.0, 1.0]}, channels=["ball.y", "energy.kinetic"],
        t_eval=times,
    )  # fmt: skip
    assert found["ball.y"].shape == (2, 3)
    for speed, heights in zip((0.0, 1.0), found["ball.y"], strict=True):
        assert heights == pytest.approx([1.0 + speed * t - 0.5 * 9.81 * t**2 for t in times], abs=1e-8)
    table = found.table
    assert table["ball.mass"].tolist() == [3.0, 3.0] and table["start.ball.vy"].tolist() == [0.0, 1.0]
    assert table["ball.y"].tobytes() == found["ball.y"].tobytes()
    assert table["reached"].tolist() == [0.4, 0.4] and table["cause"].tolist() == ["", ""]
    with pytest.raises(KeyError, match=r"no column 'ball\.z'"):
        found["ball.z"]


def test_failures_are_rows_with_their_cause():
    heights = [1.0, -0.5, 2.0]
    found = simulate_many(ball(), None, 0.3, start={"ball.y": heights})
    assert list(found.failures) == [1] and found.failed.tolist() == [False, True, False]
    assert "overlapping by 0.5 m" in str(found.failures[1])
    assert "overlapping" in found.table["cause"][1]
    assert np.isnan(found["ball.y"][1]) and found["ball.y"][2] == pytest.approx(2.0 - 0.5 * 9.81 * 0.09, abs=1e-8)


def test_failures_stand_in_the_order_of_the_rows_whichever_ended_first():
    first_ends = Event()

    def force(t, q, v):
        if v[0] == 0.0:
            return np.array([0.0])
        if v[0] > 2.0:
            first_ends.set()
        elif not first_ends.wait(60.0):
            raise TimeoutError("the other run has not begun")
        raise ArithmeticError("own")

    system = EquationSystem(mass=lambda t, q: np.array([[1.0]]), force=force, q0=[0.0], v0=[0.0])
    rate = compile_model(system).channels[1]
    found = simulate_many(system, None, 0.5, start={rate: [1.0, 3.0]}, threads=2)
    assert list(found.failures) == [0, 1]
    assert [str(error) for error in found.failures.values()] == ["own", "own"]


def test_an_error_of_an_own_function_is_the_cause_of_its_row():
    def force(t, q, v):
        if t > 0.1 and v[0] > 1.0:
            raise ArithmeticError("too fast")
        return np.array([0.0])

    system = EquationSystem(mass=lambda t, q: np.array([[1.0]]), force=force, q0=[0.0], v0=[0.0])
    name, rate = compile_model(system).channels[:2]
    found = simulate_many(system, None, 0.5, start={rate: [0.5, 2.0, 0.25]}, threads=2)
    assert [type(error) for error in found.failures.values()] == [ArithmeticError] and found.failed[1]
    assert found[name][[0, 2]] == pytest.approx([0.25, 0.125])


def test_a_run_that_fails_on_its_way_tells_how_far_it_came():
    found = simulate_many(ball(), {"restitution": [0.5, 0.9]}, 3.0, t_eval=[0.1, 3.0], max_steps=40)
    # the ball of 0.5 comes to rest by then, after many short steps; that of 0.9 still flies
    assert found.failed.tolist() == [True, False]
    assert 0.1 < found.reached[0] < 3.0 and found.reached[1] == 3.0
    assert "max_steps" in str(found.failures[0])
    assert np.all(found["ball.y"][:, 0] > 0.9)
    assert np.isnan(found["ball.y"][0, 1]) and found["ball.y"][1, 1] > 0.0


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"parameters": {"restitution": [0.5, 0.6, 1.7]}}, r"row 2: .*restitution.*1\.7"),
        ({"parameters": {"ball.mass": [1.0, -1.0]}}, r"row 1: .*mass"),
        ({"parameters": {"restitution": [0.5, np.nan]}}, "row 1: parameters: 'restitution'"),
        ({"parameters": {"elasticity": [0.5]}}, "row 0: .*no parameter 'elasticity'"),
        ({"parameters": {"restitution": [0.5, 0.6], "ball.mass": [1.0, 2.0, 3.0]}}, "one length"),
        ({"parameters": {"restitution": "high"}}, "number or a list of numbers"),
        ({"parameters": [0.5, 0.6]}, "mapping from names to values"),
        ({"start": {"ball.height": [1.0]}}, "row 0: there is no start value 'ball.height'"),
        ({"channels": ["ball.z"]}, "no channels"),
        ({"channels": "ball.y"}, "list of names"),
        ({"threads": 0}, "threads must be"),
        ({"runs": -1}, "runs must be"),
        ({"t_eval": [0.5, 2.0]}, "t_eval must ascend"),
        ({"t_end": -1.0}, "lies before t0"),
    ],
)
def test_wrong_arguments_are_refused_before_anything_runs(arguments, words):
    reports = []
    with pytest.raises(ModelError, match=words):
        simulate_many(ball(), **{"parameters": None, "t_end": 1.0, "progress": reports.append, **arguments})
    assert reports == []


def test_progress_counts_the_runs():
    reports = []
    simulate_many(ball(), {"restitution": RESTITUTION}, 0.1, threads=2, progress=reports.append)
    assert reports == sorted(reports) and reports[-1] == len(RESTITUTION) and len(reports) > 2


def test_an_error_of_the_listener_ends_the_work():
    def refuse(done):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_many(ball(), {"restitution": RESTITUTION}, 0.1, progress=refuse)


def test_a_compiled_model_is_used_again_with_its_settings():
    compiled = compile_model(ball(), "irk", rtol=1e-9)
    first = simulate_many(compiled, {"restitution": RESTITUTION}, 0.6)
    again = simulate_many(compiled, {"restitution": RESTITUTION[::-1]}, 0.6)
    assert first.values.tobytes() == again.values[::-1].tobytes()
    with pytest.raises(ModelError, match="belong to compile_model"):
        simulate_many(compiled, None, 0.6, rtol=1e-6)


def test_no_runs_give_an_empty_table():
    found = simulate_many(ball(), {"restitution": []}, 1.0)
    assert len(found) == 0 and len(found.table) == 0
