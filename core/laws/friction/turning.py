"""Friction against rolling and spinning of two shapes that touch at a point or a small patch: torques in proportion to
the normal force.

|M_T| <= rho F_n against rolling, |M_n| <= sigma F_n against spinning about the normal, as Coulomb's friction has them
(Johnson, Contact Mechanics, 1985, chapter 8), smoothed near rest.

On a patch, spinning and sliding share one friction (Contensou 1963; Leine and Glocker 2003): a fast spin makes friction
against sliding nearly viscous. What both may be together is the limit surface, here the ellipsoid of Howe and Cutkosky
(1996), (F_T/mu)^2 + (M_n/(mu r))^2 <= F_n^2; of all friction within it that takes most power acts:
    F_T = -mu F_n v_T/s,   M_n = -mu F_n r^2 w_n/s,   s^2 = |v_T|^2 + r^2 w_n^2.
r is the radius at which mu F_n has the torque of spinning alone, as that of a clutch: of a patch of radius eps under a
constant pressure (2/3) eps, under Hertz's (3 pi/16) eps. Sliding and spinning alone are exact; between them the force
is up to half as much again as the integral over the patch has it where v_T is much less than r w_n.
"""

from typing import Literal

from pydantic import model_validator

from ...model.base import NonNegative, Positive, Record


class TurningFriction(Record):
    """M_T = -rho F_n w_T/sqrt(w_T^2 + w_s^2) against rolling, M_n = -sigma F_n w_n/sqrt(w_n^2 + w_s^2) against spin.

    w_T and w_n are the parts across and along the normal of the angular velocity of one shape on the other. Where a
    load turns a shape that would stay at rest it creeps: with w_s L/sqrt(1 - L^2) under the part L < 1 of the full
    torque. Collisions, which are over at once, take nothing by it.

    With `friction_radius` in place of `spinning`, friction against sliding and spinning is one, in collisions too.
    """

    type: Literal["Turning"] = "Turning"
    rolling: NonNegative = 0.0
    """rho, m: the lever of the normal force against rolling."""
    spinning: NonNegative = 0.0
    """sigma, m: the same against spinning about the normal, whether the shape slides or not."""
    friction_radius: NonNegative = 0.0
    """r, m: the torque against spinning alone is mu F_n r, and friction against sliding and spinning lies on an
    ellipsoid: a spin takes from the one, sliding from the other; 0: a point, which spins freely but for `spinning`."""
    transition_speed: Positive = 1e-4
    """w_s, rad/s: 71 % of the full torques against rolling, and by `spinning`, is reached there."""

    @model_validator(mode="after")
    def _some(self) -> "TurningFriction":
        if self.rolling == 0.0 and self.spinning == 0.0 and self.friction_radius == 0.0:
            raise ValueError(
                "friction against turning without an arm does nothing: give rolling, spinning or friction_radius in m, "
                "or leave it out"
            )
        if self.spinning > 0.0 and self.friction_radius > 0.0:
            raise ValueError(
                f"spinning = {self.spinning:g} m is a torque of its own, friction_radius = {self.friction_radius:g} m "
                "says that of the friction against sliding: give one of them"
            )
        return self

    def parameters(self) -> tuple[float, float, float, float]:
        """rho, sigma, w_s, r."""
        return self.rolling, self.spinning, self.transition_speed, self.friction_radius
