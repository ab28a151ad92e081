"""What a body in space looks like: the shapes that touch, or the uniform body with its inertia."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...core.contacts.contact3d import Contact3D, Sphere3D
from ...core.contacts.cornered3d import Box3D, Capsule3D, Cornered3D, Cylinder3D
from ...core.contacts.mesh3d import TriangleMesh3D
from ...core.contacts.support3d import SmoothShape3D
from ...core.elements import RigidBody3D, SpatialFrame
from ...core.model.attitude import parameters_of_matrix
from ...core.model.markers import Marker3D
from ...core.multibody_model import Model
from ..scene import Floats, Solid
from . import meshes
from .rounds import smooth_mesh
from .stage import Stage3D

ROD = 0.010
"""Radius of the bars from a body's centre to what is attached, in parts of the scene's size."""
LINK = 0.016
"""The same of a body that is nothing but a link: with two such bars or more."""
POINT = 0.018
"""Radius of a point mass."""
LARGEST = 0.3
"""Reach of a body that is made up from its inertia: a larger one would hide the mechanism, and is no body like that."""
ALIKE = 1e-6
"""Relative difference of moments of inertia that count as equal."""
CORNERS = 4
"""Fewest points that touch and make a body of a hull."""


def add_body(stage: Stage3D, body: SpatialFrame) -> None:
    """The solids of a body."""
    size = stage.size
    model = stage.motion.model
    ends = [point for point in attached(model, body.name) if math.hypot(*point) > 2.0 * ROD * size]
    balls = [ball for ball in _balls(model) if ball.marker.body == body.name and ball.radius > 0.0]
    # a ball at the end of an arm does not hover there
    apart = [ball.marker.point for ball in balls if math.hypot(*ball.marker.point) > ball.radius]
    shaped = body.name in stage.shaped or _touching(stage, body.name)
    link = not shaped and len(ends) > 1
    if not shaped and not link and not (isinstance(body, RigidBody3D) and _uniform(stage, body)):
        stage.solid(Marker3D(body=body.name), meshes.ball(), (POINT * size,) * 3)
    for end in dict.fromkeys((*ends, *apart)):
        stage.rod(body.name, (0.0, 0.0, 0.0), end, (LINK if link else ROD) * size, meshes.cylinder())


def attached(model: Model, body: str) -> list[tuple[float, float, float]]:
    """Points of a body where joints and forces are."""
    found = [
        marker.point
        for element in (*model.joints, *model.forces)
        for marker in element.markers()
        if marker.body == body and isinstance(marker, Marker3D)
    ]
    return list(dict.fromkeys(found))


def _touching(stage: Stage3D, body: str) -> bool:
    """The shapes that a body touches with; False if there are none."""
    model, found = stage.motion.model, add_shapes(stage, body)
    points: list[Floats] = []
    for ball in single_balls(model):
        if ball.marker.body == body and ball.radius > 0.0:
            add_ball(stage, ball)
            found = True
        elif ball.marker.body == body:
            points.append(np.array(ball.marker.point))
    if len(points) >= CORNERS and np.linalg.matrix_rank(np.array(points) - points[0], tol=1e-9 * stage.size) == 3:
        corners = tuple((float(x), float(y), float(z)) for x, y, z in points)
        stage.solid(Marker3D(body=body), meshes.hull(corners), (1.0, 1.0, 1.0))
        found = True
    return found


def add_shapes(stage: Stage3D, body: str) -> bool:
    """The shapes of groups on a body or the ground, and of single contacts those that are no balls; False: none."""
    model = stage.motion.model
    shapes = [shape for shape in (*_grouped(model), *_single_shapes(model)) if shape.marker.body == body]
    for shape in shapes:
        if hasattr(shape, "surface"):
            stage.solid(shape.marker, meshes.surface(*shape.surface()), (1.0, 1.0, 1.0))
        elif isinstance(shape, SmoothShape3D):
            stage.solid(shape.marker, smooth_mesh(shape), (1.0, 1.0, 1.0))
        elif isinstance(shape, Cornered3D):
            add_cornered(stage, shape)
        else:
            add_ball(stage, shape)
    return bool(shapes)


def _grouped(model: Model) -> Iterator[Any]:
    for group in model.groups:
        yield from (shape for shape in group.all_shapes() if isinstance(shape, Sphere3D) or _is_shown(shape))


def _is_shown(shape: Any) -> bool:
    """Whether it is a shape other than a ball that has a look; planes and cables are drawn elsewhere."""
    return isinstance(shape, Cornered3D | SmoothShape3D) or hasattr(shape, "surface")


def _single(model: Model) -> list[Contact3D]:
    """The contacts that stand by themselves."""
    made = {contact.name for group in model.groups for contact in group.contacts()}
    return [c for c in model.contacts if isinstance(c, Contact3D) and c.name not in made]


def _single_shapes(model: Model) -> list[Any]:
    """Their shapes other than balls, each once."""
    shapes = [shape for contact in _single(model) for shape in contact.shapes()]
    found = [shape for shape in shapes if _is_shown(shape)]
    return [shape for k, shape in enumerate(found) if shape not in found[:k]]


def _balls(model: Model) -> list[Sphere3D]:
    """Those of groups, and of contacts that stand by themselves."""
    return [*(shape for shape in _grouped(model) if isinstance(shape, Sphere3D)), *single_balls(model)]


def single_balls(model: Model) -> list[Sphere3D]:
    """The balls and points of contacts that stand by themselves, each once."""
    balls = [ball for contact in _single(model) for ball in contact.spheres()]
    return [ball for k, ball in enumerate(balls) if ball not in balls[:k]]


def add_ball(stage: Stage3D, ball: Sphere3D) -> None:
    """A ball; a point is a small one."""
    radius = max(ball.radius, 0.004 * stage.size)
    stage.solid(ball.marker, meshes.ball(), (radius,) * 3)


def add_cornered(stage: Stage3D, shape: Cornered3D) -> None:
    """A box, a capsule, a cylinder, a mesh, or the hull of rounded corners."""
    if isinstance(shape, Box3D):
        stage.solid(shape.marker, meshes.box(), shape.size)
    elif isinstance(shape, Capsule3D):
        r = shape.radius
        stage.solid(shape.marker, meshes.cylinder(marked=True), (r, r, shape.length))
        for end in (0.5, -0.5):
            stage.solid(shape.marker, meshes.ball(), (r, r, r), shift=(0.0, 0.0, end * shape.length))
    elif isinstance(shape, Cylinder3D):
        stage.solid(shape.marker, meshes.cylinder(marked=True), (shape.radius, shape.radius, shape.length))
    elif isinstance(shape, TriangleMesh3D):
        stage.solid(shape.marker, meshes.surface(shape.vertices, shape.faces), (1.0, 1.0, 1.0))
    else:
        places = shape.places()
        if shape.rounding() > 0.0:
            places = (places[:, None] + shape.rounding() * meshes.ball().vertices[::4]).reshape(-1, 3)
        if np.linalg.matrix_rank(places - places[0], tol=1e-9 * stage.size) == 3:
            corners = tuple((float(x), float(y), float(z)) for x, y, z in places)
            stage.solid(shape.marker, meshes.hull(corners), (1.0, 1.0, 1.0))


def _uniform(stage: Stage3D, body: RigidBody3D) -> bool:
    """The ball, cylinder or box of uniform density with the body's mass and inertia; False if it would be too large."""
    xx, yy, zz = body.inertia
    xy, xz, yz = body.inertia_products
    moments, axes = np.linalg.eigh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    odd = _odd_one(moments)
    a, b, c = (moments / body.mass).tolist()
    if odd is None:  # J = 2/5 m r^2
        mesh, size, reach = meshes.ball(), np.full(3, math.sqrt(2.5 * a)), math.sqrt(2.5 * a)
    elif odd < 3:  # along the axis m r^2/2, across it m (3 r^2 + h^2)/12
        along, across = moments[odd] / body.mass, moments[(odd + 1) % 3] / body.mass
        r, h = math.sqrt(2.0 * along), math.sqrt(max(12.0 * across - 6.0 * along, 0.0))
        axes = np.roll(axes, 2 - odd, axis=1)
        mesh, size, reach = meshes.cylinder(marked=True), np.array([r, r, h]), max(r, 0.5 * h)
    else:  # J_xx = m (y^2 + z^2)/12
        size = np.sqrt(np.maximum(6.0 * np.array([b + c - a, a + c - b, a + b - c]), 0.0))
        mesh, reach = meshes.box(), 0.5 * float(size.max())
    alone = len(stage.motion.model.bodies) == 1 and not stage.motion.model.joints
    if reach > LARGEST * stage.size and not alone:
        return False
    size = np.maximum(size, 0.008 * stage.size)
    e0, e1, e2, e3 = parameters_of_matrix(axes)
    x, y, z = size.tolist()
    stage.scene.solids.append(Solid(stage.number(body.name), mesh, turn=(e0, e1, e2, e3), size=(x, y, z)))
    return True


def _odd_one(moments: Floats) -> int | None:
    """Which of three moments differs from two equal ones; None if all are equal, 3 if all differ."""
    small = ALIKE * float(moments.max())
    if float(np.ptp(moments)) <= small:
        return None
    return next((k for k in range(3) if abs(moments[(k + 1) % 3] - moments[(k + 2) % 3]) <= small), 3)
