"""Reduction to kept coordinates and modes, and the partition of a rod at an impact."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from tlismni.core import (
    AxialRod,
    CoordinateContact,
    CoordinateTerm,
    KelvinVoigt,
    Model,
    ModelError,
    NewtonImpact,
    Result,
    simulate,
)
from tlismni.core.flexible import craig_bampton, local_impulse, partition_rod
from tlismni.models import load

ELEMENTS, GAP = 100, 5e-5
SCENARIO = load("rod_wall", elements=ELEMENTS, mass_matrix="lumped")
ROD = SCENARIO.model.bodies[0]
MOMENTUM, WAVE = 7800.0 * 3.14e-4 * 0.1, ROD.wave_speed
THEORY = 0.1 * math.sqrt(7800.0 * 3.14e-4 * ROD.axial_stiffness)


def test_rigid_motion_and_statics_at_kept_coordinates_are_exact() -> None:
    mass, stiffness = ROD.matrices()
    kept = (3, 40, 100)
    found = craig_bampton(mass, stiffness, kept, 4)
    rigid = np.append(np.ones(3), np.zeros(4))
    assert np.max(np.abs(found.basis @ rigid - 1.0)) < 1e-10
    assert rigid @ found.mass @ rigid == pytest.approx(np.sum(mass), rel=1e-12)
    load_at = np.zeros(101)
    load_at[100] = 1.0
    # node 3 held: the same displacements as the full model's
    rest = np.delete(np.arange(101), 3)
    exact = np.linalg.solve(stiffness[np.ix_(rest, rest)], load_at[rest])
    reduced = np.delete(np.arange(7), 0)
    motion = np.linalg.solve(found.stiffness[np.ix_(reduced, reduced)], (found.basis.T @ load_at)[reduced])
    assert np.max(np.abs(found.basis[:, reduced] @ motion - np.insert(exact, 3, 0.0))) < 1e-9 * np.max(exact)


def test_modes_are_those_with_the_kept_coordinates_held() -> None:
    """A rod held at one end: omega = (k - 1/2) pi c / L."""
    mass, stiffness = AxialRod(
        name="r", elements=200, length=1.0, axial_stiffness=ROD.axial_stiffness, mass_per_length=ROD.mass_per_length
    ).matrices()
    found = craig_bampton(mass, stiffness, [0], 5)
    assert found.frequencies == pytest.approx((np.arange(5) + 0.5) * math.pi * WAVE, rel=3e-4)
    z = slice(1, 6)
    assert np.max(np.abs(found.mass[z, z] - np.eye(5))) < 1e-10
    assert np.max(np.abs(found.stiffness[0, z])) < 1e-9 * np.max(stiffness)


def test_all_modes_give_the_structure_back() -> None:
    mass, stiffness = ROD.matrices()
    found = craig_bampton(mass, stiffness, range(80, 101), 80)
    for exact, reduced in ((mass, found.mass), (stiffness, found.stiffness)):
        back = np.linalg.solve(found.basis.T, np.linalg.solve(found.basis.T, reduced).T)
        assert np.max(np.abs(back - exact)) < 1e-8 * np.max(np.abs(exact))


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda m, k: craig_bampton(m, k, [], 1), "at least one"),
        (lambda m, k: craig_bampton(m, k, [3, 3], 1), "different coordinates"),
        (lambda m, k: craig_bampton(m, k, [3], 101), "at most 100"),
        (lambda m, k: craig_bampton(m, k[:5], [3], 1), "of one size"),
        (lambda m, k: craig_bampton(np.eye(2), np.diag([1.0, 0.0]), [0], 1), "does not hold the structure"),
        (lambda m, k: partition_rod(ROD, 101, 1), "region = 101"),
    ],
)
def test_what_cannot_be_reduced_is_refused(call, text: str) -> None:
    with pytest.raises(ModelError, match=text):
        call(*ROD.matrices())


# ---- rod against a wall ----


def run(model: Model) -> Result:
    return simulate(model, SCENARIO.t_end, SCENARIO.method, **SCENARIO.options)


@cache
def full() -> Result:
    return run(SCENARIO.model)


@cache
def partitioned(region: int, modes: int) -> Result:
    body, _ = partition_rod(ROD, region, modes)
    wall = CoordinateContact(
        name="wall", offset=GAP, law=NewtonImpact(restitution=0.0),
        terms=(CoordinateTerm(body="rod", coordinate=f"u{region}", factor=-1.0),),
    )  # fmt: skip
    return run(Model(gravity=(0.0, 0.0), bodies=[body], contacts=[wall]))


def force_error(result: Result) -> float:
    """Rms of the force against that of the full model, while both are in contact, in parts of EA v/c."""
    t = GAP / 0.1 + np.linspace(0.02, 1.95, 500) / WAVE
    both = (np.interp(t, r.t, r["wall.normal_force"]) for r in (result, full()))
    return float(np.sqrt(np.mean((next(both) - next(both)) ** 2)) / THEORY)


def span(result: Result) -> float:
    times = {kind: [e.t for e in result.events if e.kind == kind] for kind in ("close", "open")}
    return (times["open"][-1] - times["close"][0]) * WAVE


def test_force_duration_and_impulse_converge_with_the_modes() -> None:
    errors = [force_error(partitioned(20, modes)) for modes in (5, 10, 20, 40)]
    assert all(finer < 0.75 * coarser for coarser, finer in pairwise(errors))
    assert force_error(partitioned(20, 80)) < 1e-6
    assert span(partitioned(20, 40)) == pytest.approx(span(full()), rel=2e-3)
    assert partitioned(20, 20)["wall.impulse"][-1] == pytest.approx(full()["wall.impulse"][-1], rel=2e-3)


def test_until_the_border_sends_an_echo_the_region_alone_decides_the_force() -> None:
    """There and back through the region: 2 region l / c."""
    t = GAP / 0.1 + np.linspace(0.01, 0.35, 200) / WAVE
    few, many = (np.interp(t, r.t, r["wall.normal_force"]) for r in (partitioned(20, 5), full()))
    assert np.max(np.abs(few - many)) < 0.01 * THEORY


@pytest.mark.parametrize("mass_matrix", ["consistent", "lumped"])
def test_a_partitioned_rod_has_the_weight_and_the_place_of_the_full_one(mass_matrix: str) -> None:
    """Thrown, it falls on a spring at its end under gravity along x: with all modes the same motion; with few of them
    the same total weight."""
    rod = ROD.model_copy(update={"elements": 12, "position": 0.3, "velocity": 0.1, "mass_matrix": mass_matrix})
    law, results = KelvinVoigt(stiffness=1e5, damping=0.0), []
    part, basis = partition_rod(rod, 4, 8, gravity=-300.0)
    wide = 0.3 + rod.length
    for body, node, offset in ((rod, "x12", wide), (part, "u4", 0.3)):
        term = CoordinateTerm(body="rod", coordinate=node)
        spring = CoordinateContact(name="spring", offset=-offset, terms=(term,), law=law)
        model = Model(gravity=(-300.0, 0.0), bodies=[body], contacts=[spring])
        results.append(simulate(model, 4e-3, "newmark", step=4e-6))
    full, part_result = results
    places = basis @ np.stack([part_result[f"rod.{name}"] for name in part.coordinates])
    exact = np.stack([full[f"rod.x{k}"] for k in range(13)]) - rod.nodes[:, None]
    moved = np.abs(exact - 0.3).max()
    assert np.abs(exact[:, 0] - 0.3).max() < 1e-12 and moved > 5e-4
    assert np.abs(places - exact).max() < 1e-6 * moved
    assert full["spring.normal_force"].max() > 0.0
    few, _ = partition_rod(rod, 4, 1, gravity=-300.0)
    rigid = np.array([1.0] * 5 + [0.0])
    assert rigid @ np.array(few.force) == pytest.approx(-300.0 * ROD.mass_per_length * ROD.length, rel=1e-12)
    assert partition_rod(rod, 4, 1)[0].force is None


def test_local_impulse_comes_to_that_of_the_whole_rod_with_the_regions_size() -> None:
    rod = ROD.model_copy(update={"mass_matrix": "consistent"})
    mass, _ = rod.matrices()
    end = np.zeros(101)
    end[100] = 1.0
    whole, jump = local_impulse(mass, end, 0.1)
    impact = next(e for e in run(load("rod_wall", elements=ELEMENTS).model).events if e.kind == "impact")
    assert impact.impulse == pytest.approx(whole, rel=1e-7) and jump[100] == pytest.approx(0.1)
    decay = 2.0 - math.sqrt(3.0)
    assert jump[60:100] / jump[61:101] == pytest.approx(-decay, rel=1e-9)
    errors = []
    for region in (1, 2, 3, 4):
        local, _ = local_impulse(mass[-region - 1 :, -region - 1 :], end[-region - 1 :], 0.1, held=[0])
        errors.append(local / whole - 1.0)
    assert np.array(errors[1:]) / np.array(errors[:-1]) == pytest.approx(decay**2, rel=0.1)


def test_with_lumped_mass_the_local_impulse_is_the_whole() -> None:
    mass, _ = ROD.matrices()
    local, jump = local_impulse(mass[-3:, -3:], [0.0, 0.0, 1.0], 0.1, held=[0], restitution=0.5)
    assert local == pytest.approx(1.5 * 0.1 * 0.5 * MOMENTUM / 0.1 / ELEMENTS, rel=1e-12)
    assert jump[:2] == pytest.approx([0.0, 0.0])
