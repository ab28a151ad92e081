"""Stacks of blocks, one of them pulled out: many contacts that repeat each other, which stick, slip, tip and fall."""

import numpy as np
import pytest
from helpers import G
from stacks import CORNER, HEIGHT, START, WIDTH, stack
from tlismni.core import SimulationError, simulate

RATE = 100.0
METHODS = {"ebdf": {}, "irk": {}, "hht": {"rtol": 1e-5, "atol": 1e-8}}
ENDS = 0.45


def dissipated(result):
    """Energy that contacts have taken so far, J."""
    held = result["energy.kinetic"] + result["energy.potential"]
    return result["energy.input_work"] - (held - held[0])


def check_energies(result, rtol):
    level = np.max(result["energy.kinetic"]) + np.max(np.abs(result["energy.input_work"]))
    assert np.max(np.abs(result["energy.balance"])) < 100.0 * rtol * level
    # friction and impacts only ever take
    assert np.min(np.diff(dissipated(result))) > -100.0 * rtol * level


def slip_begins(blocks, pulled, friction=0.3):
    """When the pull has reached the friction of what holds it least: the block alone on both its faces, or it and
    all above it on the face below, s."""
    above = (blocks - 1 - pulled) * friction * G
    below = (blocks - pulled) * friction * G
    return START + min(below + above, below) / RATE


@pytest.mark.parametrize("pulled", range(4))
@pytest.mark.parametrize("method", METHODS)
def test_a_stack_that_is_pulled_apart(method, pulled):
    options = METHODS[method]
    result = simulate(stack(4, pulled, RATE), ENDS, method, **options)
    check_energies(result, options.get("rtol", 1e-6))
    slips = [e.t for e in result.events if e.kind == "slip"]
    assert slips[0] == pytest.approx(slip_begins(4, pulled), abs=1e-8)
    for name in ("position", "velocity"):
        assert np.max(result[f"residual.{name}"]) < 1e-9
    if method != "ebdf":
        same = simulate(stack(4, pulled, RATE), ENDS)
        size = np.max(np.abs(same.q[-1]))
        assert np.max(np.abs(result.q[-1] - same.q[-1])) < 300.0 * options.get("rtol", 1e-6) * size


def test_blocks_below_the_pulled_one_stay_where_they_are():
    result = simulate(stack(4, 2, RATE), 0.3)
    x = result.q[:, [0, 3]]
    assert np.max(np.abs(x)) < 1e-9
    # the one that rides on the pulled block moves with it until the friction between them, mu g, is not enough
    alone = START + (0.3 * 2.0 * G + 2.0 * 0.3 * G) / RATE
    together = np.abs(result.q[:, 6] - result.q[:, 9])
    assert np.max(together[result.t < alone]) < 1e-9 < np.max(together)


def test_corners_are_passed_without_a_blow():
    """A block slides by the size of its corners: the contacts that bear it change, its motion does not."""
    result = simulate(stack(2, 1, 40.0), 0.35, rtol=1e-9, atol=1e-12)
    moved = result.q[:, 3]
    assert moved[-1] > 2.0 * CORNER
    start = START + 0.3 * G / 40.0
    exact = np.where(result.t > start, 40.0 * (result.t - start) ** 3 / 6.0, 0.0)
    assert np.max(np.abs(moved - exact)) < 1e-8
    assert np.max(np.abs(result.q[:, 4] - 1.5 * HEIGHT)) < 1e-9
    assert np.max(np.abs(result.q[:, 5])) < 1e-8 / WIDTH


def test_ten_blocks():
    result = simulate(stack(10, 5, 300.0), 0.3)
    check_energies(result, 1e-6)
    # a corner that is passed changes the forces of all contacts at one instant: they share one search for it, and steps
    # over it are made in unequal parts
    assert result.stats["stages"] < 6_000


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method, pulled, ends", [("ebdf", 6, 0.33), ("hht", 8, 0.37), ("irk", 5, 0.32)])
def test_twenty_blocks_that_tip(method, pulled, ends):
    """A tower that turns about the corner of a block: contacts nearly repeat each other, and rounding must not make an
    instant, or a time without progress, of it."""
    result = simulate(stack(20, pulled, 300.0), ends, method, **METHODS[method])
    check_energies(result, METHODS[method].get("rtol", 1e-6))
    assert len({event.t for event in result.events}) < 200
    assert np.max(result["residual.position"]) < 1e-9


@pytest.mark.full
@pytest.mark.parametrize("blocks, pulled", [(n, p) for n in (10, 20) for p in range(n)])
@pytest.mark.parametrize("method", METHODS)
def test_a_tall_stack(method, blocks, pulled):
    options, ends = METHODS[method], 0.4 if blocks > 10 else 0.6
    result = simulate(stack(blocks, pulled, 300.0), ends, method, **options)
    check_energies(result, options.get("rtol", 1e-6))
    if method != "irk":
        # contacts that repeat each other make the motion sensitive to rounding, but not before this
        t = np.linspace(0.0, 0.2, 101)
        here, there = (
            simulate(stack(blocks, pulled, 300.0), 0.2, name, t_eval=t, **METHODS[name]) for name in (method, "irk")
        )
        assert np.max(np.abs(here.q - there.q)) < 1e-4


def test_a_run_that_does_not_get_on_is_bounded_by_its_steps():
    with pytest.raises(SimulationError, match="max_steps = 20 steps"):
        simulate(stack(4, 1, RATE), 1.0, max_steps=20)
