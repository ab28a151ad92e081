"""No contact is missed, however large the steps and small the shapes: first touches and lift-offs in closed form."""

import numpy as np
import pytest
from helpers import events, on
from passages import PASSAGES, lift_offs, shaken_table
from tlismni.core import Disk2D, DiskOnDisk2D, Hertz, Model, PointMass2D, simulate

CONTROLLED = [(method, {}) for method in ("ebdf", "bdf", "mebdf", "irk", "hht", "newmark", "adams", "trapezoidal")]
COMPARED = [(method, {}) for method in ("baumgarte", "hht_i3", "hht_ggl", "generalized_alpha")]
FIXED = [("ebdf", {"step": 0.02}), ("irk", {"step": 0.1}), ("newmark", {"step": 0.02}), ("hht", {"step": 0.05})]
SAMPLE = 40
"""Passages of each kind in the ordinary suite."""


def missed(kind, seeds, ways):
    """Passages without their event, or with one at another time; the ways to integrate take turns."""
    found = []
    for seed in seeds:
        model, touch = PASSAGES[kind](np.random.default_rng(seed))
        method, options = ways[seed % len(ways)]
        result = simulate(model, 1.1 * touch + 1e-3, method, **options)
        hits = events(result, "impact", "graze")
        if not hits or abs(hits[0].t - touch) > 1e-6 * max(touch, 1e-3) + 1e-8:
            found.append((kind, seed, method, options, touch, hits[:1]))
    return found


@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", PASSAGES)
def test_no_passage_is_missed(kind):
    assert missed(kind, range(SAMPLE), CONTROLLED + FIXED + COMPARED) == []


@pytest.mark.full
@pytest.mark.parametrize("kind", PASSAGES)
def test_no_passage_of_thousands_is_missed(kind):
    assert missed(kind, range(1000, 3000), CONTROLLED + FIXED + COMPARED) == []


def lost(excess, seed, method, options, count, friction=None):
    """Lift-offs without an event; with friction slips."""
    rng = np.random.default_rng(seed)
    frequency, phase = rng.uniform(3.0, 30.0), rng.uniform(2.5, 6.5)
    options = {name: 10.0 * step / frequency for name, step in options.items()}
    model = shaken_table(excess, frequency, phase, friction)
    expected = lift_offs(excess, frequency, phase, count, 2.0 * np.pi if friction is None else np.pi)
    result = simulate(model, expected[-1] + 1.0 / frequency, method, **options)
    opened = np.array([event.t for event in events(result, "open" if friction is None else "slip")])
    return [t for t in expected if not np.any(np.abs(opened - t) < 1e-6 / frequency)]


@pytest.mark.parametrize("method, options", [("ebdf", {}), ("irk", {}), ("hht", {}), ("irk", {"step": 0.1})])
def test_block_lifts_off_from_a_shaken_table_in_every_period(method, options):
    for seed, excess in enumerate((1e-2, 1e-3, 3e-4, 1e-4)):
        assert lost(excess, seed, method, options, 4) == []


@pytest.mark.parametrize("method, options", [("ebdf", {}), ("irk", {}), ("irk", {"step": 0.1})])
def test_block_slips_on_a_shaken_table_twice_a_period(method, options):
    for seed, excess in enumerate((1e-2, 1e-3, 1e-4)):
        assert lost(excess, seed, method, options, 6, friction=0.3) == []


@pytest.mark.full
@pytest.mark.parametrize("method, options", [*CONTROLLED, *FIXED[:3]])
def test_no_lift_off_of_many_is_missed(method, options):
    for seed in range(20):
        assert lost(1e-4, seed, method, options, 10) == []
        assert lost(1e-4, seed, method, options, 10, friction=0.3) == []
    assert lost(1e-6, 0, method, options, 10) == []


@pytest.mark.parametrize("method", ["hht", "newmark", "ebdf", "irk"])
def test_no_step_jumps_over_a_whole_contact_of_stiff_disks(method):
    """The contact lasts 0.6 ms; a step of 40 ms from its beginning would end where the disks are apart again.
    Equal masses exchange their velocities."""
    bodies = [
        PointMass2D(name=name, mass=1.0, position=(x, 0.0), velocity=(speed, 0.0))
        for name, x, speed in (("thrown", -1.0, 1.0), ("hit", 0.0, 0.0))
    ]
    pair = DiskOnDisk2D(
        name="pair", a=Disk2D(marker=on("thrown"), radius=0.01), b=Disk2D(marker=on("hit"), radius=0.01),
        law=Hertz(stiffness=1e9),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, contacts=[pair]), 3.0, method)
    np.testing.assert_allclose(result.v[-1], [0.0, 0.0, 1.0, 0.0], atol=2e-3)
