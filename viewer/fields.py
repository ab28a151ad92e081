"""What colours show along flexible bodies: stress, axial force, bending moment."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ..core.elements import FlexibleBody
from ..core.errors import ModelError
from .motion import Motion
from .scene import Field, Floats


@dataclass(frozen=True)
class CrossSection:
    """Of a flexible body, for its stress: models have stiffnesses only.

    Raises
    ------
    ModelError : for numbers that are not positive.
    """

    area: float
    """m^2."""
    second_moment: float | None = None
    """I, m^4; left out: bending makes no stress."""
    height: float = 0.0
    """From the axis to the outermost fibre, m."""

    def __post_init__(self) -> None:
        if not self.area > 0.0 or (self.second_moment is not None and not self.second_moment > 0.0):
            raise ModelError(f"area = {self.area!r} and second_moment = {self.second_moment!r} must be positive")
        if (self.second_moment is not None) != (self.height > 0.0):
            raise ModelError("give both second_moment and height (from the axis to the outermost fibre), or neither")


NO_SECTIONS: Mapping[str, CrossSection] = MappingProxyType({})


def fields_of(motion: Motion, body: FlexibleBody, s: Floats, section: CrossSection | None) -> list[Field]:
    """What can be shown along a body at s (m along its axis): the stress where its cross-section is known, then axial
    force and bending moment, the one that does more work first."""
    found = motion.section(body, s) if motion.moves else None
    if found is None:
        return []
    fields = loads(found.axial_force, found.axial_strain, found.bending_moment, found.curvature)
    if section is not None:
        stress = _field("stress", "Pa", _stress(found.axial_force, found.bending_moment, section))
        fields = [*([stress] if stress is not None else []), *fields]
    return fields


def loads(axial: Floats, strain: Floats, bending: Floats, curvature: Floats) -> list[Field]:
    """Axial force and bending moment (F, P), the one that does more work first."""
    found = []
    for name, unit, values, way in (("axial force", "N", axial, strain), ("bending moment", "N.m", bending, curvature)):
        field = _field(name, unit, values)
        if field is not None:
            found.append((float(np.sum(np.abs(values * way))), field))
    return [field for _, field in sorted(found, key=lambda pair: -pair[0])]


def _field(name: str, unit: str, values: Floats) -> Field | None:
    """None of what is unknown, or zero everywhere."""
    limit = float(np.max(np.abs(values), initial=0.0))
    return Field(name, unit, values, limit) if limit > 0.0 and bool(np.all(np.isfinite(values))) else None


def _stress(force: Floats, moment: Floats, section: CrossSection) -> Floats:
    """Of the two outermost fibres, the one with the larger magnitude; an axial force that is not known counts as none,
    as of beams that keep their length."""
    axial = np.where(np.isfinite(force), force, 0.0) / section.area
    bent = np.zeros_like(moment) if section.second_moment is None else moment * section.height / section.second_moment
    upper, lower = axial - bent, axial + bent
    return np.where(np.abs(upper) > np.abs(lower), upper, lower)
