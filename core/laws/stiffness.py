"""From material and geometry to Hertz's stiffness (Hertz 1881; Johnson, Contact Mechanics, 1985, chapter 4).

F = K delta^(3/2), K = 4/3 E* sqrt(R), with 1/R = 1/R1 + 1/R2 and 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2. It holds for
smooth elastic bodies whose area of contact is small beside R, pressed together slowly beside the speed of sound.
"""

import math
from typing import Annotated

from pydantic import Field

from ..errors import ModelError
from ..model.base import Positive, Record

PoissonRatio = Annotated[float, Field(gt=-1.0, le=0.5)]


class Material(Record):
    """An isotropic elastic material.

    Raises
    ------
    ModelError : unless the modulus is positive and the ratio in (-1, 0.5].
    """

    youngs_modulus: Positive
    """E, Pa."""
    poisson_ratio: PoissonRatio
    """nu, dimensionless."""

    @property
    def plane_strain_compliance(self) -> float:
        """(1 - nu^2)/E, 1/Pa."""
        return (1.0 - self.poisson_ratio**2) / self.youngs_modulus


def effective_modulus(first: Material, second: Material | None = None) -> float:
    """E*, Pa; `second` None is rigid."""
    return 1.0 / (first.plane_strain_compliance + (0.0 if second is None else second.plane_strain_compliance))


def effective_radius(first: float, second: float | None = None) -> float:
    """R of spheres with radii `first` and `second` (m), m; `second` None is a plane.

    Raises
    ------
    ModelError : for a radius that is not positive and finite.
    """
    _refuse_not_positive("radius", first, "m")
    if second is None:
        return first
    _refuse_not_positive("radius", second, "m")
    return first * second / (first + second)


def effective_mass(first: float, second: float | None = None) -> float:
    """m1 m2/(m1 + m2) of two free bodies in central impact (kg), kg; `second` None does not move.

    Raises
    ------
    ModelError : for a mass that is not positive and finite.
    """
    _refuse_not_positive("mass", first, "kg")
    if second is None:
        return first
    _refuse_not_positive("mass", second, "kg")
    return first * second / (first + second)


def sphere_on_sphere(radius: float, material: Material, other_radius: float, other: Material | None = None) -> float:
    """K of two spheres, N/m^(3/2); radii in m, `other` None is rigid.

    Raises
    ------
    ModelError : for a radius that is not positive and finite.
    """
    return _stiffness(effective_radius(radius, other_radius), effective_modulus(material, other))


def sphere_on_plane(radius: float, material: Material, plane: Material | None = None) -> float:
    """K of a sphere (radius in m) on a half-space, N/m^(3/2); `plane` None is rigid.

    Raises
    ------
    ModelError : for a radius that is not positive and finite.
    """
    return _stiffness(effective_radius(radius), effective_modulus(material, plane))


def _stiffness(radius: float, modulus: float) -> float:
    return 4.0 / 3.0 * modulus * math.sqrt(radius)


def _refuse_not_positive(what: str, value: float, unit: str) -> None:
    if not (value > 0.0 and math.isfinite(value)):
        raise ModelError(
            f"{what} {value!r} {unit}: a positive, finite {what} is needed (leave the second one out for a body "
            f"{'with a plane surface' if what == 'radius' else 'that does not move'})"
        )
