"""What goes on along a rod during a run: displacement, velocity, strain, axial force and stress, for wave diagrams."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..elements.axial_rod import AxialRod
from ..errors import ModelError

if TYPE_CHECKING:
    from ..results.result import Result

Field = NDArray[np.float64]


@dataclass(frozen=True)
class RodFields:
    """Fields over time and place; N times, n elements, n + 1 nodes.

    Attributes
    ----------
    t : times (N,), s; twice where an impact happens.
    s : distance of the nodes from the left end of the unstrained rod (n + 1,), m.
    middle : the same of the elements' middles (n,), m.
    position, velocity : of the nodes (N, n + 1), m and m/s.
    displacement : position less that of the unstrained rod at its initial place (N, n + 1), m.
    strain : of the elements (N, n).
    axial_force : in the elements, viscous part included, tension positive (N, n), N.
    """

    t: Field
    s: Field
    middle: Field
    position: Field
    velocity: Field
    displacement: Field
    strain: Field
    axial_force: Field

    def stress(self, area: float) -> Field:
        """Axial stress for a cross-section in m^2 (N, n), Pa."""
        if not area > 0.0:
            raise ModelError(f"area = {area!r} of the cross-section must be positive, in m^2")
        return self.axial_force / area


def rod_fields(result: "Result", rod: AxialRod, most_times: int | None = None) -> RodFields:
    """The fields of `rod` at the recorded times of a run, or at about `most_times` of them.

    Raises
    ------
    ModelError : if the run has no rod of that name and size.
    """
    nodes = rod.elements + 1
    if f"{rod.name}.x{rod.elements}" not in result.channels:
        raise ModelError(f"the result has no channels of a rod '{rod.name}' with {rod.elements} elements")
    step = 1 if most_times is None else max(1, len(result) // max(most_times, 1))
    rows = slice(None, None, step)
    position = np.column_stack([result[f"{rod.name}.x{k}"][rows] for k in range(nodes)])
    velocity = np.column_stack([result[f"{rod.name}.vx{k}"][rows] for k in range(nodes)])
    s = rod.nodes
    middle = 0.5 * (s[1:] + s[:-1])
    found = rod.section(middle, position, velocity)
    return RodFields(
        result.t[rows],
        s,
        middle,
        position,
        velocity,
        position - (rod.position + s),
        found.axial_strain,
        found.axial_force,
    )
