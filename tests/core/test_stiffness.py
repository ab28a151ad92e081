"""Hertz's stiffness from material and geometry."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core import Material, ModelError, sphere_on_plane, sphere_on_sphere
from tlismni.core.laws.stiffness import effective_mass, effective_modulus, effective_radius

quick = settings(deadline=None, max_examples=40, derandomize=True)
STEEL = Material(youngs_modulus=2.1e11, poisson_ratio=0.3)
RUBBER = Material(youngs_modulus=1e7, poisson_ratio=0.5)
materials = st.builds(Material, youngs_modulus=st.floats(1e5, 1e12), poisson_ratio=st.floats(-0.9, 0.5))
radii = st.floats(1e-6, 1e3)


def test_worked_number():
    assert sphere_on_plane(0.01, STEEL, STEEL) == pytest.approx(1.538462e10, rel=5e-7)


@quick
@given(radii, materials, radii, materials)
def test_two_spheres_as_lankarani_and_nikravesh_write_it(r1, a, r2, b):
    """K = 4/(3 (s1 + s2)) sqrt(R1 R2/(R1 + R2)), s = (1 - nu^2)/E."""
    s1, s2 = ((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in (a, b))
    expected = 4.0 / (3.0 * (s1 + s2)) * math.sqrt(r1 * r2 / (r1 + r2))
    assert sphere_on_sphere(r1, a, r2, b) == pytest.approx(expected, rel=1e-14)
    assert sphere_on_sphere(r1, a, r2, b) == pytest.approx(sphere_on_sphere(r2, b, r1, a), rel=1e-14)


@quick
@given(radii, materials, materials)
def test_limits(radius, a, b):
    assert sphere_on_sphere(radius, a, 1e16 * radius, b) == pytest.approx(sphere_on_plane(radius, a, b), rel=1e-14)
    hard = Material(youngs_modulus=1e30, poisson_ratio=0.0)
    assert sphere_on_plane(radius, a, hard) == pytest.approx(sphere_on_plane(radius, a), rel=1e-14)
    # equal spheres meet at a plane that stays plane: half the radius, half the modulus
    assert sphere_on_sphere(radius, a, radius, a) == pytest.approx(
        sphere_on_plane(radius, a) / (2.0 * math.sqrt(2.0)), rel=1e-14
    )
    assert effective_modulus(a, b) == pytest.approx(effective_modulus(b, a), rel=1e-15)
    assert effective_radius(radius, radius) == pytest.approx(0.5 * radius)
    assert effective_mass(radius, radius) == pytest.approx(0.5 * radius)
    assert effective_radius(radius) == effective_mass(radius) == radius


@pytest.mark.parametrize("wrong", [0.0, -0.01, math.inf, math.nan])
def test_wrong_sizes_are_refused(wrong):
    for call in (
        lambda: sphere_on_plane(wrong, STEEL),
        lambda: sphere_on_sphere(0.01, STEEL, wrong, RUBBER),
        lambda: sphere_on_sphere(wrong, STEEL, 0.01, RUBBER),
        lambda: effective_mass(1.0, wrong),
    ):
        with pytest.raises(ModelError, match=f"{wrong!r} (m|kg): a positive, finite"):
            call()


@pytest.mark.parametrize(
    "modulus, ratio, text",
    [(0.0, 0.3, "youngs_modulus"), (-1.0, 0.3, "youngs_modulus"), (1.0, 0.6, "poisson"), (1.0, -1.0, "poisson")],
)
def test_wrong_materials_are_refused(modulus, ratio, text):
    with pytest.raises(ModelError, match=text):
        Material(youngs_modulus=modulus, poisson_ratio=ratio)
