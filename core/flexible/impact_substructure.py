"""Partition method for impact: the neighbourhood of the contact as finite elements, the rest by modes.

The stresses of an impact are local at first and travel as waves. So the elements near the contact stay as they are; the
rest of the body is reduced to constraint modes and fixed-interface modes (`reduction.py`) and is joined to them by the
node that they share. The partition method (of Shen and Yin, for transient responses after impact) begins the contact
with the momentum balance of the local region alone, the node at its border held: an impulse does not reach it in no
time.
`local_impulse` gives that impulse; the run itself takes that of the whole reduced body, as the impact equations ask.
With a lumped mass matrix the two are the same; with a consistent one the velocities' jump falls off by 2 - sqrt(3) =
0.27 from node to node, and so fast the two come together with the region's size.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..elements.axial_rod import AxialRod
from ..elements.linear_system import LinearSystem
from ..errors import ModelError
from .reduction import craig_bampton


def partition_rod(
    rod: AxialRod, region: int, modes: int, gravity: float = 0.0
) -> tuple[LinearSystem, NDArray[np.float64]]:
    """A rod whose last `region` elements stay, while those before them are reduced to `modes` modes.

    Parameters
    ----------
    gravity : along x, m/s^2; as the model's gravity does not act on a LinearSystem, the weight is a force of the body.

    Returns
    -------
    body : LinearSystem of the rod's name with coordinates `u0` .. `u{region}`, displacements (m) of the nodes from the
        border of the region to the rod's right end, then `z1` .. `z{modes}`, modal amplitudes. Displacements are those
        of the rod whose left end is at 0; they start at its `position`. The potential energy of the weight is zero
        without displacements.
    basis : displacements of all nodes of the rod from them, (elements + 1, region + 1 + modes).

    Raises
    ------
    ModelError : for a region that is not a part of the rod, too many modes, or massless ends, whose contacts exchange
        constraint rows that a LinearSystem has not.
    """
    if not 1 <= region <= rod.elements:
        raise ModelError(f"region = {region} must be 1 to {rod.elements}, the number of elements of '{rod.name}'")
    if rod.massless_ends:
        raise ModelError(f"'{rod.name}' has massless ends {rod.massless_ends}: a partitioned rod keeps its masses")
    mass, stiffness = rod.matrices()
    kept = range(rod.elements - region, rod.elements + 1)
    found = craig_bampton(mass, stiffness, kept, modes)
    nodes = tuple(f"u{k}" for k in range(region + 1))
    size = region + 1 + modes
    body = LinearSystem(
        name=rod.name,
        coordinates=(*nodes, *(f"z{k + 1}" for k in range(modes))),
        mass=_rows(found.mass),
        stiffness=_rows(found.stiffness),
        damping=_rows(rod.damping_time * found.stiffness) if rod.damping_time else None,
        force=tuple((found.basis.T @ rod.weight(gravity)).tolist()) if gravity else None,
        position=(*(rod.position,) * (region + 1), *(0.0,) * modes),
        velocity=(*(rod.velocity,) * (region + 1), *(0.0,) * modes),
        units=(*("m",) * (region + 1), *("-",) * modes),
        scales=(rod.length,) * size,
    )
    return body, found.basis


def _rows(matrix: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in matrix.tolist())


def local_impulse(
    mass: ArrayLike, direction: ArrayLike, approach: float, held: ArrayLike = (), restitution: float = 0.0
) -> tuple[float, NDArray[np.float64]]:
    """Impulse along `direction` that stops an approach, with the coordinates `held` at rest or unmoved by it.

    M dv = P g + reactions at `held`,  dv = 0 there,  g . dv = (1 + restitution) approach.

    Parameters
    ----------
    mass : of the local region, (n, n).
    direction : gradient g of the gap, (n,).
    approach : speed at which the gap closes, m/s.
    held : coordinates at the border of the region.

    Returns
    -------
    P (N s) and dv (n,). Without `held` this is the impact of the whole body.
    """
    m, g = np.asarray(mass, dtype=float), np.asarray(direction, dtype=float)
    free = np.setdiff1d(np.arange(len(m)), np.asarray(held, dtype=np.int64))
    response = np.linalg.solve(m[np.ix_(free, free)], g[free])
    impulse = (1.0 + restitution) * approach / float(g[free] @ response)
    jump = np.zeros(len(m))
    jump[free] = impulse * response
    return impulse, jump
