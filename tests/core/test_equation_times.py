"""Own equations whose functions jump in time: pulses, signals, driven constraints."""

from functools import partial

import numpy as np
import pytest
from tlismni.core import (
    EquationSystem,
    InputSignal,
    ModelError,
    Polynomial,
    Ramp,
    Simulation,
    Sine,
    Step,
    Table,
    TlismniError,
    simulate,
)

TIGHT = {"rtol": 1e-9, "atol": 1e-11}


def mass(force, **more):
    """1 kg that `force` pushes from rest."""
    return EquationSystem(mass=np.eye(1), force=force, q0=[0.0], v0=[0.0], **more)


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams", "hht"])
@pytest.mark.parametrize("seed", range(3))
def test_short_pulses_are_felt(method, seed):
    """1 ms long, 1 kN high, at random times: each gives 1 N s."""
    begins = np.sort(np.random.default_rng(seed).choice(np.arange(1, 99), 3, replace=False)) / 100.0
    ends = begins + 1e-3

    def force(t, q, v):
        return [1000.0 if any(a <= t < b for a, b in zip(begins, ends, strict=True)) else 0.0]

    result = simulate(mass(force, times=[*begins, *ends]), 1.0, method, **TIGHT)
    assert result["d_q0"][-1] == pytest.approx(3.0, rel=1e-9)
    assert result["q0"][-1] == pytest.approx(np.sum(1.0 - (begins + ends) / 2.0), rel=1e-7)


def test_steps_that_functions_refer_to_are_known():
    """As globals, in closures, lists, defaults, bound arguments, objects and functions that they call."""
    up, down = Step(time=0.3, after=1000.0), Step(time=0.301, after=-1000.0)
    both = [up, down]

    def total(t, signals=both):
        return sum(signal(t) for signal in signals)

    class Push:
        def __init__(self, *signals):
            self.signals = signals

        def __call__(self, t, q, v):
            return [sum(signal(t) for signal in self.signals)]

    def bound(first, second, t, q, v):
        return np.array([first(t) + second(t)])

    for force in (
        lambda t, q, v: np.array([up(t) + down(t)]),
        lambda t, q, v: [total(t)],
        Push(up, down),
        Push(up, down).__call__,
        partial(bound, up, down),
    ):
        system = mass(force)
        assert system.times == (0.3, 0.301)
        assert simulate(system, 1.0, **TIGHT)["d_q0"][-1] == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(
    "signal, exact",
    [
        (Sine(amplitude=0.1, angular_frequency=3.0), lambda t: 0.1 * np.sin(3.0 * t)),
        (Polynomial(coefficients=(0.0, 0.2, 0.3)), lambda t: 0.2 * t + 0.3 * t**2),
        (Table(times=np.linspace(0.0, 1.0, 5), values=np.linspace(0.0, 1.0, 5) ** 3), lambda t: t**3),
    ],
)
def test_a_signal_drives_a_constraint(signal, exact):
    """Its rate and acceleration come with it: the constraint is met at all levels."""
    start = (exact(1e-7) - exact(-1e-7)) / 2e-7
    system = EquationSystem(mass=np.eye(1), force=[0.0], constraint=lambda t, q: q[0] - signal(t), q0=[0.0], v0=[start])
    result = simulate(system, 1.0, **TIGHT)
    assert result["q0"] == pytest.approx(exact(result.t), abs=1e-9)
    for level in ("position", "velocity", "acceleration"):
        assert np.max(result[f"residual.{level}"]) < 1e-9


def test_a_ramp_strikes_where_its_rate_jumps():
    ramp = Ramp(start=0.25, duration=0.5, after=1.0)
    system = EquationSystem(mass=np.eye(1), force=[0.0], constraint=lambda t, q: q[0] - ramp(t), q0=[0.0], v0=[0.0])
    result = simulate(system, 1.0, t_eval=[0.1, 0.5, 0.9], **TIGHT)
    assert result["q0"] == pytest.approx([0.0, 0.5, 1.0], abs=1e-10)
    assert result["d_q0"] == pytest.approx([0.0, 2.0, 0.0], abs=1e-10)


def test_a_state_belongs_to_its_times():
    """The same functions with other times of events are other equations."""
    one, other = (Simulation(mass(lambda t, q, v: [1.0], times=[t])) for t in (0.1, 0.2))
    with pytest.raises(ModelError, match="belongs to another model"):
        other.restore(one.state())


def test_refusals():
    jump, led = Step(time=0.5), InputSignal(channel="x")
    with pytest.raises(TlismniError, match="a jump in position is no motion"):
        EquationSystem(mass=np.eye(1), force=[0.0], constraint=lambda t, q: q[0] - jump(t), q0=[0.0], v0=[0.0])
    with pytest.raises(ModelError, match="in the run of a Model alone"):
        mass(lambda t, q, v: [led(t)])
    with pytest.raises(TlismniError, match="times must be finite"):
        mass([0.0], times=[np.nan])
