"""What the dry friction of all joints has in common: Coulomb's set-valued law, or a regularised one by choice."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..laws.friction.base import FrictionCoefficient
from ..model.base import Name, NonNegative, Positive
from .base import Element, Numbering, Part


class JointFrictionForce(Element):
    """Base of the friction of joints. The tables have it as a contact where its law is Coulomb's.

    Class attributes: `measured`, what it works against; `is_spherical`, whether that has three components.
    """

    measured: ClassVar[Literal["angle", "slide"]]
    is_spherical: ClassVar[bool] = False

    joint: Name | None = None
    """The joint whose force presses on what rubs; none: nothing but a preload does."""
    coefficient: FrictionCoefficient = 0.0
    """Friction over the size of that force, dimensionless."""
    static_ratio: Annotated[float, Field(ge=1.0)] = 1.0
    """Friction up to which it holds at rest over that while it moves, dimensionless."""

    @property
    def preload(self) -> float:
        """Friction without a force of the joint, N m or N."""
        raise NotImplementedError(f"{type(self).__name__} must say how large its friction is")

    @property
    def transition(self) -> float | None:
        """Rate or speed at which 76 % of a regularised friction act, rad/s or m/s; None: the law is Coulomb's."""
        raise NotImplementedError(f"{type(self).__name__} must say what its law is")

    @property
    def arm(self) -> float:
        """Friction by a unit of the joint's force, m or dimensionless."""
        return self.coefficient

    @model_validator(mode="after")
    def _law_fits(self) -> "JointFrictionForce":
        if self.transition is not None and (self.joint is not None or self.static_ratio != 1.0):
            what = "the force of a joint" if self.joint is not None else "static friction"
            raise ValueError(
                f"'{self.name}' has {what}, which a law regularised by a transition of {self.transition:g} does not "
                "know: leave one of them out"
            )
        if self.joint is None and self.coefficient != 0.0:
            raise ValueError(
                f"'{self.name}' has a coefficient of {self.coefficient:g} and no force that it goes with: name the "
                "`joint`, or give the friction itself"
            )
        return self

    def felt_joints(self) -> Sequence[str]:
        return () if self.joint is None else (self.joint,)

    @property
    def is_contact(self) -> bool:
        """True if its law is set-valued, and there is any friction: the tables have it as a contact."""
        return self.transition is None and (self.preload > 0.0 or self.arm > 0.0)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        # (a set-valued law without any friction is nothing)
        return () if self.transition is None else super().parts(numbering)


class TurningFriction(JointFrictionForce):
    """Base of friction against turning: `torque`, and `coefficient` times `radius` times the force of the `joint`."""

    measured: ClassVar[Literal["angle", "slide"]] = "angle"

    torque: NonNegative = 0.0
    """While it turns, N m, whatever the joint carries."""
    radius: Positive | None = None
    """Of the bearing or the ball, m; needed with a coefficient."""
    transition_rate: Positive | None = None
    """Of a regularised law, the rate at which 76 % of the torque act, rad/s; none: the law is Coulomb's."""

    @model_validator(mode="after")
    def _has_radius(self) -> "TurningFriction":
        if self.coefficient > 0.0 and self.radius is None:
            raise ValueError(
                f"'{self.name}' has a coefficient of {self.coefficient:g} and no radius that it acts at: give "
                "`radius`, that of the bearing"
            )
        if self.radius is not None and self.joint is None:
            raise ValueError(
                f"'{self.name}' has a radius of {self.radius:g} m and no `joint` whose force acts there: name it, or "
                "leave the radius out"
            )
        return self

    @property
    def preload(self) -> float:
        return self.torque

    @property
    def transition(self) -> float | None:
        return self.transition_rate

    @property
    def arm(self) -> float:
        return self.coefficient * (self.radius or 0.0)


class SlidingFriction(JointFrictionForce):
    """Base of friction against sliding: `force`, and `coefficient` times the force of the `joint`."""

    measured: ClassVar[Literal["angle", "slide"]] = "slide"

    force: NonNegative = 0.0
    """While it slides, N, whatever the joint carries."""
    transition_speed: Positive | None = None
    """Of a regularised law, the speed at which 76 % of the force act, m/s; none: the law is Coulomb's."""

    @property
    def preload(self) -> float:
        return self.force

    @property
    def transition(self) -> float | None:
        return self.transition_speed
