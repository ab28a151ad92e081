"""Deformed shape, strain, force, moment and stress along a cable against statics and kinematics."""

import math

import numpy as np
import pytest
from cables import EA, EI, LENGTH, LINE, straight
from helpers import GROUND, on
from tlismni.core import (
    Cable2D,
    Clamp2D,
    MaterialPoint2D,
    Model,
    ModelError,
    axial_force,
    axial_strain,
    bending_moment,
    bending_stress,
    curvature,
    deformed_shape,
    simulate,
    stress,
)

POINTS = np.linspace(0.0, LENGTH, 11)


def run(cable, t_end=0.0, *, gravity=(0.0, 0.0), clamp=False, **options):
    points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("mid", 0.77))]
    joints = [Clamp2D(name="clamp", a=GROUND, b=on("root"))] if clamp else []
    return simulate(Model(gravity=gravity, bodies=[cable, *points], joints=joints), t_end, **options)


def test_shape_and_strains_of_a_stretched_arc():
    """A node circle of radius R stretched by lambda: strain lambda - 1, turning per undeformed length 1/R."""
    radius, stretch, elements = 1.5, 1.1, 16
    s = np.linspace(0.0, LENGTH, elements + 1) / radius
    shape = stretch * np.stack([radius * np.sin(s), radius * (1.0 - np.cos(s)), np.cos(s), np.sin(s)], axis=1)
    cable = Cable2D(**straight(elements, shape=tuple(map(tuple, shape.tolist()))))
    result = run(cable)
    places = deformed_shape(result, cable, POINTS)[0]
    exact = stretch * radius * np.stack([np.sin(POINTS / radius), 1.0 - np.cos(POINTS / radius)], axis=1)
    assert np.abs(places - exact).max() < 1e-6
    assert np.abs(axial_strain(result, cable, POINTS)[0] - 0.1).max() < 1e-4
    assert np.abs(curvature(result, cable, POINTS)[0] - 1.0 / radius).max() < 2e-3
    assert np.abs(axial_force(result, cable, POINTS)[0] - 0.1 * EA).max() < 1e-4 * EA
    assert np.abs(bending_moment(result, cable, POINTS)[0] - EI / radius).max() < 2e-3 * EI


def test_a_relaxed_arc_has_no_force():
    shape = tuple((math.sin(x), 1.0 - math.cos(x), math.cos(x), math.sin(x)) for x in (0.0, 0.5, 1.0))
    cable = Cable2D(**straight(2, shape=shape, relaxed="start", reference_strain=0.02))
    result = run(cable)
    assert np.abs(axial_force(result, cable, POINTS) + 0.02 * EA).max() < 1e-12 * EA
    assert np.abs(bending_moment(result, cable, POINTS)).max() < 1e-12 * EI
    assert np.abs(curvature(result, cable, POINTS)).max() > 0.1


def test_shape_follows_the_material_points_and_force_its_clamp():
    """Along a swing, at any time; the force at the clamped end is the clamp's (up to the order of the elements)."""
    cable = Cable2D(**straight(8, bending_damping=0.05, axial_damping=0.5, bending_stiffness=5.0))
    result = run(cable, 0.2, gravity=(0.0, -9.81), clamp=True, method="irk", rtol=1e-7)
    places = deformed_shape(result, cable, [0.0, 0.77])
    assert np.abs(places[:, 1, 0] - result["mid.x"]).max() < 1e-13
    assert np.abs(places[:, 1, 1] - result["mid.y"]).max() < 1e-13
    moment = bending_moment(result, cable, [0.0])[:, 0]
    assert np.abs(moment + result["clamp.torque"]).max() < 0.05 * np.abs(moment).max()
    times = np.linspace(0.0, 0.2, 7)
    between = deformed_shape(result, cable, [0.77], times)[:, 0]
    exact = simulate(Model(**_model(cable)), 0.2, method="irk", rtol=1e-8, t_eval=times)
    assert np.abs(between - np.stack([exact["mid.x"], exact["mid.y"]], axis=1)).max() < 1e-5


def _model(cable):
    points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("mid", 0.77))]
    return {"bodies": [cable, *points], "joints": [Clamp2D(name="clamp", a=GROUND, b=on("root"))]}


def test_stress_of_a_bent_and_stretched_section():
    """Force N and moment M on a rectangle b x h: N/A -+ 6 M/(b h^2)."""
    width, height = 0.02, 0.05
    cable = Cable2D(**straight(2, shape=((0, 0, 1.01, 0), (1.01, 0.1, 1.0, 0.3), (2.0, 0.5, 1.0, 0.5))))
    result = run(cable)
    area, inertia = width * height, width * height**3 / 12.0
    force, moment = axial_force(result, cable, POINTS), bending_moment(result, cable, POINTS)
    for side in (-0.5, 0.5):
        found = stress(result, cable, POINTS, area=area, second_moment=inertia, height=side * height)
        assert np.allclose(found, force / area - 2.0 * side * 6.0 * moment / (width * height**2), rtol=1e-12)


def test_stress_is_the_strain_of_a_fibre():
    """Young's modulus times what a fibre on the left (height > 0) or right of the axis is longer than at first, by the
    places of its ends."""
    width, height, modulus, half = 0.02, 0.05, 2e6, 1e-4
    area, inertia = width * height, width * height**3 / 12.0
    stiff = {"axial_stiffness": modulus * area, "bending_stiffness": modulus * inertia}
    shape = ((0, 0, 1.01, 0), (1.01, 0.1, 1.0, 0.3), (2.0, 0.5, 1.0, 0.5))
    cable = Cable2D(**straight(2, shape=shape, **stiff))
    result = run(cable)
    inner = POINTS[1:5]  # within the first element
    for h in (-0.5 * height, 0.0, 0.5 * height):
        ends = []
        for s in (inner - half, inner + half):
            here, low, high = (deformed_shape(result, cable, s + d)[0] for d in (0.0, -half, half))
            along = (high - low) / np.linalg.norm(high - low, axis=1)[:, None]
            ends.append(here + h * np.stack([-along[:, 1], along[:, 0]], axis=1))
        strain = np.linalg.norm(ends[1] - ends[0], axis=1) / (2.0 * half) - 1.0
        found = stress(result, cable, inner, area=area, second_moment=inertia, height=h)[0]
        assert np.abs(found / modulus - strain).max() < 1e-5
        bent = bending_stress(result, cable, inner, second_moment=inertia, height=h)[0]
        assert np.abs(bent - found + axial_force(result, cable, inner)[0] / area).max() < 1e-9 * modulus
        assert np.abs(bent).min() > 1e-4 * modulus or h == 0.0


def test_at_the_time_of_an_impact_the_state_after_it_counts():
    """Two samples have that time; also when it is the last one, as where the first impact ends the run."""
    cable = Cable2D(**straight(2, axial_damping=5.0, velocity=(1.0, 0.0)))
    result = run(cable)
    t, q, v = np.array([0.0, 0.5, 0.5]), np.repeat(result.q, 3, axis=0), np.repeat(result.v, 3, axis=0)
    v[2, :4] = 0.0  # its first node stops: compression rates, and so a force of the damping
    stopped = _Sampled(t, {name: q[:, k] for k, name in enumerate(cable.coordinate_names)}
                       | {r.rate: v[:, k] for k, r in enumerate(cable.coordinate_records())})  # fmt: skip
    exact = axial_force(stopped, cable, [0.2])
    assert exact[0, 0] == exact[1, 0] != exact[2, 0]
    assert axial_force(stopped, cable, [0.2], times=[0.5])[0, 0] == exact[2, 0]
    assert axial_force(stopped, cable, [0.2], times=[0.0])[0, 0] == exact[0, 0]


class _Sampled:
    """A result of given samples of one body."""

    def __init__(self, t, columns):
        self.t, self.columns = t, columns

    def __getitem__(self, name):
        return self.columns[name.split(".")[1]]


def test_weight_of_a_hanging_cable():
    cable = Cable2D(**straight(4, angle=-0.5 * math.pi, axial_damping=40.0, bending_stiffness=50.0))
    result = run(cable, 1.5, gravity=(0.0, -9.81), clamp=True, method="irk", rtol=1e-6)
    found = axial_force(result, cable, POINTS, times=[1.5])[0]
    assert np.abs(found - LINE * 9.81 * (LENGTH - POINTS)).max() < 1e-2


def test_bad_questions():
    cable = Cable2D(**straight(2))
    result = run(cable)
    with pytest.raises(ModelError, match="no point at s"):
        deformed_shape(result, cable, [2.5])
    with pytest.raises(ModelError, match="second_moment"):
        stress(result, cable, [0.5], area=1.0, second_moment=0.0, height=0.1)
    with pytest.raises(ModelError, match="but the result from 0 to 0"):
        curvature(result, cable, [0.5], times=[1.0])
    for times in ([], [[0.0]]):
        with pytest.raises(ModelError, match="at least one time"):
            curvature(result, cable, [0.5], times=times)
    with pytest.raises(ModelError, match="reach from nan"):
        curvature(result, cable, [0.5], times=[math.nan])
