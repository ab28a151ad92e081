"""Coulomb's friction as it is: set-valued at zero speed. It has no formula; contacts as constraints resolve it."""

from typing import Literal

from .coefficients import StaticAndKinetic


class CoulombFriction(StaticAndKinetic):
    """|F_t| <= mu_s F_n while it sticks, F_t = -mu F_n sgn(v_t) while it slips."""

    type: Literal["Coulomb"] = "Coulomb"
