"""The problem with a known solution: a point on a circle, swinging about the x axis, along which gravity pulls.

x^2 + y^2 = 1 m^2, mass 1 kg, gravity g along x, released at rest at the angle `amplitude` from the x axis. With
k = sin(amplitude/2), w = sqrt(g) and K the complete elliptic integral of the first kind

    sin(theta/2) = k sn(K - w t),   theta' = -2 w k cn(K - w t)       (Whittaker, Analytical Dynamics, 44)

and the multiplier of Phi = (r.r - 1)/2 is the tension of the rod, from the radial equation of motion
lambda = g cos(theta) + theta'^2. Below 45 degrees y stays the independent coordinate all the time: no change of
the partition disturbs the errors.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk

from ...core import Distance2D, Marker2D, Model, PointMass2D

Array = NDArray[np.float64]

GRAVITY = 9.81
"""m/s^2."""


@dataclass(frozen=True)
class Swing:
    """The swing from rest at `amplitude` (rad, below pi/4) over `t_end` (s)."""

    amplitude: float = 0.5
    t_end: float = 6.0

    def model(self) -> Model:
        """The model that is integrated."""
        x, y = math.cos(self.amplitude), math.sin(self.amplitude)
        return Model(
            gravity=(GRAVITY, 0.0),
            bodies=(PointMass2D(name="bob", mass=1.0, position=(x, y)),),
            joints=(Distance2D(name="rod", a=Marker2D(), b=Marker2D(body="bob"), length=1.0),),
        )

    def angle(self, t: Array) -> tuple[Array, Array]:
        """(angle in rad, its rate in rad/s) at the times t (N,) in s."""
        k, w = math.sin(0.5 * self.amplitude), math.sqrt(GRAVITY)
        sn, cn, _, _ = ellipj(ellipk(k * k) - w * np.asarray(t), k * k)
        return 2.0 * np.arcsin(k * sn), -2.0 * w * k * cn

    def exact(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions (N, 2) in m, velocities (N, 2) in m/s, multipliers (N, 1) in N."""
        angle, rate = self.angle(t)
        c, s = np.cos(angle), np.sin(angle)
        tension = GRAVITY * c + rate**2
        return np.stack([c, s], axis=1), np.stack([-s * rate, c * rate], axis=1), tension[:, None]
