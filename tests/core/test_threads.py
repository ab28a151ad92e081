"""Runs in threads: compiled code leaves Python's lock to others, own functions take it back, and nothing is shared."""

import sys
import threading

import numpy as np
import pytest
from tlismni.core import EquationSystem, GapContact, NewtonImpact, Simulation, simulate
from tlismni.models import load


@pytest.fixture
def in_turns_only():
    """Python changes threads only where one waits or gives its lock away."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    yield
    sys.setswitchinterval(before)


@pytest.fixture
def hectic():
    """Python changes threads as often as it can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def in_threads(*tasks):
    """What the tasks give, each in a thread of its own, begun at once."""
    found: list[object] = [None] * len(tasks)
    begin = threading.Barrier(len(tasks))

    def work(k):
        begin.wait()
        try:
            found[k] = tasks[k]()
        except BaseException as error:
            found[k] = error

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(tasks))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


def bytes_of(result):
    return [x.tobytes() for x in (result.t, result.q, result.v, result.a)] + [repr(result.events)]


def test_others_run_while_a_run_is_computed(in_turns_only):
    """With the lock held, the thread that waits would wake up after the run."""
    simulation = Simulation(load("chain", links=20).model, "ebdf", rtol=1e-9)
    simulation.advance(0.01)  # compiled
    begun, done = threading.Event(), threading.Event()

    def work():
        begun.set()
        simulation.advance(2.0)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    begun.wait()
    beside = not done.is_set()
    thread.join()
    assert beside and done.is_set()


def lawful_ball():
    """A ball that falls and bounces, its equations in Python."""
    return EquationSystem(
        mass=lambda t, q: np.eye(2) * (2.0 + 0.0 * q[0]),
        force=lambda t, q, v: np.array([np.sin(3.0 * t), -19.62 - 0.1 * v[1] ** 3]),
        q0=[0.0, 1.0], v0=[0.3, 0.0], contacts=[GapContact("floor", lambda t, q: q[1], NewtonImpact(restitution=0.6))],
    )  # fmt: skip


def circle():
    """A point on a circle that breathes, differentiated by jets and by the complex step."""
    return EquationSystem(
        mass=np.eye(2),
        force=lambda t, q, v: [0.0, -9.81],
        constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - (1.0 + 0.1 * np.sin(t)) ** 2,
        q0=[1.0, 0.0], v0=[0.1, 0.0],
    )  # fmt: skip


def complex_step():
    """An oscillator whose force knows real and complex numbers only."""

    def force(t, q, v):
        x = np.asarray(q, dtype=complex if np.iscomplexobj(q) else float)
        return -x - 0.1 * x**3

    return EquationSystem(mass=np.eye(2), force=force, q0=[1.0, -0.5], v0=[0.0, 0.3])


def test_runs_in_threads_are_those_one_after_the_other(hectic):
    shared = lawful_ball()
    cases = [
        *((load("pendulum_stop", restitution=e).model, method) for e, method in ((0.3, "ebdf"), (0.8, "irk"))),
        (load("chain", links=12).model, "hht"),
        (shared, "ebdf"),
        (shared, "irk"),
        (circle(), "bdf"),
        (complex_step(), "ebdf"),
    ]
    tasks = [lambda system=system, method=method: simulate(system, 0.6, method=method) for system, method in cases]
    alone = [bytes_of(task()) for task in tasks]
    for _ in range(2):
        found = in_threads(*tasks, *tasks)
        errors = [x for x in found if isinstance(x, BaseException)]
        assert not errors, errors
        assert [bytes_of(x) for x in found] == alone + alone


def test_an_exception_in_an_own_function_comes_out_in_its_thread(hectic):
    class Own(Exception):
        pass

    def failing(when):
        def force(t, q, v):
            if t > when:
                raise Own(when)
            return -q

        return lambda: simulate(EquationSystem(mass=np.eye(1), force=force, q0=[1.0], v0=[0.0]), 2.0)

    times = [0.3, 0.7, 1.1, 5.0]
    found = in_threads(*map(failing, times))
    assert [type(x) for x in found[:3]] == [Own] * 3 and [x.args for x in found[:3]] == [(t,) for t in times[:3]]
    np.testing.assert_allclose(found[3].q[:, 0], np.cos(found[3].t), atol=1e-4)
