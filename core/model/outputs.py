"""Outputs that a model shows beyond those that its parts have by themselves."""

from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field

from .base import Name, Record
from .derived import Derived
from .frame3d import Frame3D
from .marker_channels2d import MarkerChannels2D, MarkerPlace2D
from .marker_channels3d import MarkerChannels3D
from .markers import Marker, Marker2D, Marker3D

Frame = Callable[[Marker], Sequence[int]]
"""Indices of the coordinates that place the frame of a marker's body; -1 for those that it lacks."""


class MarkerOutput2D(Record):
    """Position, velocity and acceleration of a marker, and its angle's unless it is on a point mass.

    Channels NAME.x, .y, .angle, .vx, .vy, .angular_velocity, .ax, .ay, .angular_acceleration, in the inertial frame.
    """

    type: Literal["MarkerOutput2D"] = "MarkerOutput2D"
    name: Name
    """Unique in its model; channels begin with it."""
    marker: Marker2D
    """Whose motion is shown."""

    @classmethod
    def derived(cls, outputs: Sequence[Any], frame: Frame) -> Derived:
        """The channels of all of them."""
        return MarkerChannels2D([MarkerPlace2D(o.name, o.marker, frame(o.marker)) for o in outputs])


class MarkerOutput3D(Record):
    """Position, velocity and acceleration of a marker in space, its attitude and the angular velocity of its body.

    Channels NAME.x, .y, .z, .vx ... .az in the inertial frame; with `attitude` "matrix" NAME.axis_xx, .axis_xy ... (the
    component along x of the marker's x axis, of its y axis, ...), with a sequence such as "zxz" or "xyz" NAME.angle_1,
    .angle_2, .angle_3: the marker's frame is reached by these turns one after another, the first and third angle within
    half a turn.
    """

    type: Literal["MarkerOutput3D"] = "MarkerOutput3D"
    name: Name
    """Unique in its model; channels begin with it."""
    marker: Marker3D
    """Whose motion is shown."""
    attitude: Annotated[str, Field(pattern=r"^(none|matrix|xyz|xzy|yxz|yzx|zxy|zyx|xyx|xzx|yxy|yzy|zxz|zyz)$")] = "none"
    """How its attitude is shown: not, as a matrix, or as three angles in this order."""

    @classmethod
    def derived(cls, outputs: Sequence[Any], frame: Frame) -> Derived:
        """The channels of all of them."""
        return MarkerChannels3D([(o.name, Frame3D.of(o.marker, frame(o.marker)), o.attitude) for o in outputs])


MarkerOutput = Annotated[MarkerOutput2D | MarkerOutput3D, Field(discriminator="type")]
"""Any of these."""
