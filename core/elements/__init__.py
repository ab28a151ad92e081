"""Elements: one file each, with its record and its kernel. The names that users see stand in `core/__init__.py`.

A user's own needs no name: subclasses of BodyElement, JointElement and ForceElement can stand in a model as they are.
"""

from typing import TYPE_CHECKING, Annotated

from ..lazy_import import RecordsOf, late_names
from ..model.open_union import OpenUnion
from .base import BodyElement, ForceElement, JointElement

if TYPE_CHECKING:
    from .. import *  # noqa: F403
    from .base import Element as Element
    from .flexible_body import FlexibleBody as FlexibleBody
    from .floating_body2d import FloatingBody2D as FloatingBody2D
    from .planar_body import PlanarBody as PlanarBody
    from .planar_body import PlanarFrame as PlanarFrame
    from .relation3d import Relation3D as Relation3D
    from .spatial_body import SpatialFrame as SpatialFrame

BODIES = RecordsOf(__name__, BodyElement)
JOINTS = RecordsOf(__name__, JointElement)
FORCES = RecordsOf(__name__, ForceElement)

Body = Annotated[BodyElement, OpenUnion(BODIES, BodyElement)]
Joint = Annotated[JointElement, OpenUnion(JOINTS, JointElement)]
Force = Annotated[ForceElement, OpenUnion(FORCES, ForceElement)]

__getattr__, __dir__, _ = late_names(__name__)
