"""Friction on a patch of contacts in space that are constraints: force and torque as one friction.

With r the friction radius (`laws/friction/turning.py`), z = r w_n stands beside the sliding velocity x and y along both
tangents, and the torque over r beside both forces. What slides or spins has a direction in space, d at the last event,
at the angle `sliding_lean` out of the tangent plane:

    F_T = -mu F_N (g_1, g_2)   M_n = -mu F_N r g_3   g = (p-hat d + y t_2 + q e)/|...|,   p-hat^2 = p^2 + v_0^2

with v_0 as in `coulomb3d.py`, where p is the part of (x, y, z) along d, and q that along e, across d and t_2. With
r = 0 that is friction of a point (`coulomb3d.py`). What sticks has the rows of both tangents, and the torque mu F_N r
z/sqrt(z^2 + c^2), c = 2 v_0: it creeps where nobody sees it, and what it holds is within the ellipsoid with this
torque (`assembly/sticking_force.py`)."""

import math
from typing import Any

from ..compiled.jit import inlined, internal

STILL_SPEED = 3
"""Column of the parameters: STILL, m/s."""
CREEPS = 2.0
"""Of the speed that has no direction: z at which a contact that sticks has 71 % of the torque against spinning."""


@internal
def direction(x: float, y: float, z: float, lean: float, slow: float) -> Any:
    """(p, p-hat, size, components of g along d, t_2 and e, sine and cosine of the lean)."""
    c, s = math.cos(lean), math.sin(lean)
    p, q = c * x + s * z, c * z - s * x
    ahead = math.sqrt(p * p + slow * slow)
    size = math.sqrt(ahead * ahead + y * y + q * q)
    return p, ahead, size, ahead / size, y / size, q / size, c, s


@internal
def turn_of_direction(way: Any, x: float, y: float, z: float) -> Any:
    """How g changes, along t_1, t_2 and n, as (x, y, z) changes by this."""
    p, ahead, size, g_d, g_y, g_e, c, s = way
    d_p, d_q = p / ahead * (c * x + s * z), c * z - s * x
    faster = g_d * d_p + g_y * y + g_e * d_q
    of_d, of_e = (d_p - g_d * faster) / size, (d_q - g_e * faster) / size
    return c * of_d - s * of_e, (y - g_y * faster) / size, s * of_d + c * of_e


@inlined
def creep_size(par: Any, memory: Any, x: float, y: float, z: float) -> float:
    """In parts of which z is the torque against spinning of a contact that does not slide; with what it slides by, for
    an instant asks for it before it is known."""
    slow = CREEPS * max(par[STILL_SPEED], memory.slow_sliding)
    return math.sqrt(x * x + y * y + z * z + slow * slow)
