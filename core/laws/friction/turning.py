"""Friction against rolling and spinning of two shapes that touch at a point: torques in proportion to the normal force.

|M_T| <= rho F_n against rolling, |M_n| <= sigma F_n against spinning about the normal, as Coulomb's friction has them
(Johnson, Contact Mechanics, 1985, chapter 8), smoothed near rest. A patch of contact of radius eps under a constant
pressure has sigma = (2/3) mu eps, under Hertz's (3 pi/16) mu eps (Leine and Glocker 2003).
"""

from typing import Literal

from pydantic import model_validator

from ...model.base import NonNegative, Positive, Record


class TurningFriction(Record):
    """M_T = -rho F_n w_T/sqrt(w_T^2 + w_s^2) against rolling, M_n = -sigma F_n w_n/sqrt(w_n^2 + w_s^2) against spin.

    w_T and w_n are the parts across and along the normal of the angular velocity of one shape on the other. Where a
    load turns a shape that would stay at rest it creeps: with w_s L/sqrt(1 - L^2) under the part L < 1 of the full
    torque. Collisions, which are over at once, take nothing by it.
    """

    type: Literal["Turning"] = "Turning"
    rolling: NonNegative = 0.0
    """rho, m: the lever of the normal force against rolling."""
    spinning: NonNegative = 0.0
    """sigma, m: the same against spinning about the normal."""
    transition_speed: Positive = 1e-4
    """w_s, rad/s: 71 % of the full torque is reached there."""

    @model_validator(mode="after")
    def _some(self) -> "TurningFriction":
        if self.rolling == 0.0 and self.spinning == 0.0:
            raise ValueError(
                "friction against turning without an arm does nothing: give rolling or spinning in m, or leave it out"
            )
        return self

    def parameters(self) -> tuple[float, float, float]:
        """rho, sigma, w_s."""
        return self.rolling, self.spinning, self.transition_speed
