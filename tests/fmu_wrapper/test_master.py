"""The master on split oscillators: each algorithm is the map that theory says; orders, algebraic loops, sweeps."""

import numpy as np
import pytest

pytest.importorskip("fmpy")

from split_oscillators import EXACT, START, Oscillators, connections, state
from tlismni.core import CoordinateLoad, LinearSystem, Model
from tlismni.core.model.channels import Input
from tlismni.core.model.signals import InputSignal
from tlismni.fmu_wrapper.master import Connection, CouplingError, MasterError, MasterSettings, of_source, run

UNDAMPED = Oscillators()
ALGORITHMS = [
    ("jacobi", {}, None),
    ("gauss-seidel", {}, None),
    ("iterated", {"hold": "start"}, 0.0),
    ("iterated", {"hold": "mean"}, 0.5),
    ("iterated", {"hold": "end", "sweep": "jacobi", "aitken": True}, 1.0),
    ("iterated", {"hold": "end", "relaxation": 0.8}, 1.0),
    ("newton", {"hold": "mean"}, 0.5),
    ("newton", {"hold": "end", "jacobian": "steps"}, 1.0),
]


@pytest.mark.parametrize(("algorithm", "settings", "weight"), ALGORITHMS)
def test_a_step_is_the_map_of_theory(algorithm, settings, weight):
    h, steps = 0.07, 20
    tight = {} if weight is None else {"tolerance": 1e-11}
    found = UNDAMPED.run(algorithm, h, steps * h, **settings, **tight)
    expected = np.linalg.matrix_power(UNDAMPED.map(algorithm, h, weight), steps) @ START
    np.testing.assert_allclose(state(found), expected, atol=1e-7 * np.abs(expected).max())
    assert len(found.t) == steps + 1 and found.t[-1] == steps * h


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("algorithm", "settings", "order"),
    [
        ("jacobi", {}, 1),
        ("gauss-seidel", {}, 1),
        ("iterated", {"hold": "end"}, 1),  # agreeing at the end of a step does not mend what is held during it
        ("iterated", {"hold": "mean"}, 2),
        ("newton", {"hold": "mean"}, 2),
        ("newton", {"hold": "linear"}, 2),
        ("iterated", {"hold": "linear"}, 2),
        ("jacobi", {"extrapolation": "linear"}, 2),
        ("gauss-seidel", {"extrapolation": "linear"}, 2),
    ],
)
def test_order_of_the_coupling_error(algorithm, settings, order):
    t_end, exact = 0.8, UNDAMPED.monolithic(0.8)
    errors = [
        np.linalg.norm(state(UNDAMPED.run(algorithm, h, t_end, fmi="2.0", **settings)) - exact)
        for h in (0.02, 0.01, 0.005)
    ]
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    assert observed[-1] == pytest.approx(order, abs=0.15)


def added_mass(extra):
    """A mass whose own acceleration feeds back the inertia of another: an algebraic loop through one input."""
    model = Model(
        name="mass",
        bodies=[LinearSystem(name="mass", coordinates=("x",), mass=((1.0,),), stiffness=((9.0,),), position=(0.1,))],
        forces=[CoordinateLoad(name="load", body="mass", coordinate="x", load=InputSignal(channel="force"))],
        inputs=[Input(name="force", unit="N")],
    )
    link = Connection(source="a.mass.dd_x", target="a.force", factor=-extra, unit="N.s2/m")
    return [of_source("a", model, **EXACT)], [link]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("algorithm", ["gauss-seidel", "newton"])
def test_algebraic_loop_is_named_and_solved(algorithm):
    extra, t_end = 3.0, 2.0
    omega = np.sqrt(9.0 / (1.0 + extra))
    errors = []
    for h in (0.02, 0.01):
        found = run(*added_mass(extra), MasterSettings(algorithm=algorithm, step=h, t_end=t_end))
        assert found.loops == ("a.force",)
        np.testing.assert_allclose(found["a.mass.dd_x"][0], -0.1 * omega**2, rtol=1e-9)
        errors.append(abs(found["a.mass.x"][-1] - 0.1 * np.cos(omega * t_end)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1 if algorithm == "gauss-seidel" else 2, abs=0.25)


def test_derivatives_gain_convergence_where_the_fixed_point_has_none():
    """Each pass multiplies the loop's error by -extra (times 1/m = 1): more than 1 diverges, but not Newton."""
    for extra, converges in ((0.5, True), (3.0, False)):
        settings = {"step": 0.01, "t_end": 0.05, "predictor": "constant"}
        if converges:
            run(*added_mass(extra), MasterSettings(algorithm="iterated", **settings))
        else:
            with pytest.raises(CouplingError, match=r"a\.force"):
                run(*added_mass(extra), MasterSettings(algorithm="iterated", **settings))
        found = run(*added_mass(extra), MasterSettings(algorithm="newton", **settings))
        assert found.stats["passes"] <= 3 * found.stats["communication_steps"]


@pytest.mark.parametrize("algorithm", ["jacobi", "newton"])
def test_both_fmi_versions_give_the_same(algorithm):
    two, three = (UNDAMPED.run(algorithm, 0.05, 1.0, fmi=fmi, record=("*",)) for fmi in ("2.0", "3.0"))
    assert two.channels == three.channels
    for name in two.channels:
        assert np.array_equal(two[name], three[name])


def test_order_of_the_sweep():
    """Gauss-Seidel from the other end is another map."""
    there, back = (
        state(run(UNDAMPED.instances(), connections(), MasterSettings(
            algorithm="gauss-seidel", step=0.05, t_end=0.5, order=order)))
        for order in (("a", "b"), ("b", "a"))
    )  # fmt: skip
    assert np.linalg.norm(there - back) > 1e-4
    swapped = Oscillators(masses=UNDAMPED.masses[::-1], springs=UNDAMPED.springs[::-1])
    exchange = np.eye(4)[[2, 3, 0, 1]]
    expected = exchange @ np.linalg.matrix_power(swapped.map("gauss-seidel", 0.05), 10) @ exchange @ START
    np.testing.assert_allclose(back, expected, atol=1e-7)


def test_inputs_that_go_on_linearly_need_instances_that_let_them():
    for algorithm, settings in (("jacobi", {"extrapolation": "linear"}), ("newton", {"hold": "linear"})):
        with pytest.raises(MasterError, match=r"takes no derivatives of inputs, which '[ab]\.force' needs"):
            UNDAMPED.run(algorithm, 0.05, 0.5, fmi="3.0", **settings)


@pytest.mark.parametrize("control", [None, {"tolerance": 1e-3, "smallest": 0.01}])
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
def test_an_output_that_is_not_finite_ends_the_run(monkeypatch, algorithm, control):
    """An instance of somebody else's that hands out NaN after a while."""
    a, b = UNDAMPED.instances()
    plain = a.get
    monkeypatch.setattr(a, "get", lambda references: plain(references) * (np.nan if a.steps > 5 else 1.0))
    settings = MasterSettings(algorithm=algorithm, step=0.05, t_end=1.0, control=control)
    with pytest.raises(MasterError, match=r"'mass\.x' of instance 'a'.*nan"):
        run([a, b], connections(40.0), settings, ("*.mass.x",))
