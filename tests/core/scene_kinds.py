"""Kinds of random scenes: blocks on feet, tables on boxes, stacks, carts, frames, clamped bodies, bodies in grooves.

Each is a function of a random generator that gives a model. Sizes are about 1 m; all contacts are closed at the start,
and nothing approaches.
"""

import numpy as np
from scene_draw import G, SceneDraw
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    Axes,
    Constant,
    Fixed3D,
    HalfPlane2D,
    HalfSpace3D,
    Prismatic2D,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
)


def _radius(draw):
    return float(draw.rng.uniform(0.01, 0.05)) if draw.rng.random() < 0.5 else 0.0


def _block(draw):
    """A block on feet, at rest, sliding or spinning."""
    size, velocity = draw.size(), draw.sliding()
    spin = draw.rng.uniform(-5.0, 5.0) if draw.rng.random() < 0.3 else 0.0
    mass, radius = draw.body("b", size, (0.0, 0.0, 0.5 * size[2]), velocity, spin), _radius(draw)
    for x, y in draw.feet_places(size):
        draw.foot("b", (x, y, -0.5 * size[2]), radius)
    draw.push("b", size, mass * G)


def _box(draw):
    """A block that touches the floor as a shape; in space by its corners, in the plane on feet beside these."""
    size = draw.size()
    spin = draw.rng.uniform(-5.0, 5.0) if draw.rng.random() < 0.3 else 0.0
    mass = draw.body("b", size, (0.0, 0.0, 0.5 * size[2]), draw.sliding(), spin)
    draw.between("floor", [HalfSpace3D() if draw.space else HalfPlane2D()], [draw.box("b", (0.0, 0.0, 0.0), size)])
    if not draw.space:
        draw.foot("b", (draw.rng.uniform(-0.4, 0.4) * size[0], 0.0, -0.5 * size[2]))
    draw.push("b", size, mass * G)


def _table(draw):
    """A block on feet on a box on the floor; the upper one may slide on the lower one."""
    low, high = draw.size() * np.array([1.5, 1.5, 1.0]), draw.size() * np.array([0.9, 0.9, 1.0])
    lower = draw.body("low", low, (0.0, 0.0, 0.5 * low[2]))
    upper = draw.body("high", high, (0.0, 0.0, low[2] + 0.5 * high[2]), draw.sliding())
    box, radius = draw.box("low", (0.0, 0.0, 0.0), low), float(draw.rng.uniform(0.01, 0.05))
    feet = [draw.ball("high", (x, y, radius - 0.5 * high[2]), radius) for x, y in draw.feet_places(high)]
    draw.between("on", [box], feet)
    draw.between("floor", [HalfSpace3D() if draw.space else HalfPlane2D()], [box])
    draw.push("high", high, upper * G)
    draw.push("low", low, (lower + upper) * G)


def _stack(draw):
    """Boxes on each other, in the plane."""
    boxes, height, weight, velocity = [], 0.0, 0.0, draw.sliding()
    for k in range(int(draw.rng.integers(2, 5))):
        size = draw.size()
        weight += G * draw.body(f"b{k}", size, (draw.rng.uniform(-0.1, 0.1), 0.0, height + 0.5 * size[2]), velocity)
        height += size[2]
        boxes.append(draw.box(f"b{k}", (0.0, 0.0, 0.0), size))
        draw.push(f"b{k}", size, weight)
    draw.between("stack", [HalfPlane2D(), *boxes])


def _cart(draw):
    """A chassis on wheels, at rest or rolling; some wheels may drag a foot's weight of friction in their joints."""
    rng, size, radius = draw.rng, draw.size(), float(draw.rng.uniform(0.05, 0.2))
    speed = rng.uniform(-2.0, 2.0) if rng.random() < 0.4 else 0.0
    weight = G * draw.body("chassis", size, (0.0, 0.0, radius + 0.3 * size[2]), (speed, 0.0, 0.0))
    places = draw.feet_places(size, int(rng.integers(2, 7)))
    for k, (x, y) in enumerate(places):
        side, mass = 2.0 * radius, float(rng.uniform(0.05, 0.5))
        weight += G * draw.body(f"wheel{k}", (side,) * 3, (x, y, radius), (speed, 0.0, 0.0), mass=mass)
        wheel = draw.bodies[-1]
        spin = {"angular_velocity": (0.0, speed / radius, 0.0)} if draw.space else {"angular_velocity": -speed / radius}
        draw.bodies[-1] = wheel.model_copy(update=spin)
        own = {"attitude": Axes(z=(0, 1, 0), x=(1, 0, 0))} if draw.space else {}
        a, b = draw.marker("chassis", (x, y, -0.3 * size[2]), **own), draw.marker(f"wheel{k}", (0.0, 0.0, 0.0), **own)
        draw.joints.append((Revolute3D if draw.space else Revolute2D)(name=f"axle{k}", a=a, b=b))
        draw.foot(f"wheel{k}", (0.0, 0.0, -radius), radius)
    draw.push("chassis", size, weight)


def _frame(draw):
    """Blocks on feet in a row, each held to the next by more joints than it takes."""
    rng, count = draw.rng, int(draw.rng.integers(2, 4))
    velocity, size, weight = draw.sliding(), draw.size(), 0.0
    for k in range(count):
        weight += G * draw.body(f"b{k}", size, (1.1 * size[0] * k, 0.0, 0.5 * size[2]), velocity)
        for x, y in draw.feet_places(size, int(rng.integers(1, 4)) if not draw.space else int(rng.integers(3, 5))):
            draw.foot(f"b{k}", (x, y, -0.5 * size[2]))
        for j in range(0 if k == 0 else 2):
            z, y = (0.3 * (2 * j - 1) * size[2] * rng.uniform(0.5, 1.0) for _ in range(2))
            a, b = (0.55 * size[0], y, z), (-0.55 * size[0], y, z)
            own = {"attitude": Axes(z=(0, 1, 0), x=(1, 0, 0))} if draw.space else {}
            kind = Revolute2D if not draw.space else (Fixed3D if rng.random() < 0.5 else Revolute3D)
            draw.joints.append(
                kind(name=f"j{k}{j}", a=draw.marker(f"b{k - 1}", a, **own), b=draw.marker(f"b{k}", b, **own))
            )
    draw.push(f"b{int(rng.integers(count))}", size, weight)


def _clamp(draw):
    """A body between a wall and a pad that a force presses on it, with several feet on both sides."""
    rng, size, radius = draw.rng, draw.size(), float(draw.rng.uniform(0.01, 0.03))
    mass = draw.body("b", size, (0.0, 0.0, 0.0))
    pad = np.array([0.1, 1.2 * size[1], 1.2 * size[2]])
    draw.body("pad", pad, (0.5 * size[0] + 0.05, 0.0, 0.0), mass=float(rng.uniform(0.1, 1.0)))
    shape = draw.box("pad", (0.0, 0.0, 0.0), pad)
    across = {"attitude": Axes(z=(1, 0, 0), x=(0, 1, 0))} if draw.space else {"angle": -0.5 * np.pi}
    wall = draw.marker("ground", (-0.5 * size[0], 0.0, 0.0), **across)
    plane = HalfSpace3D(marker=wall) if draw.space else HalfPlane2D(marker=wall)
    for side in (-1, 1):
        feet = []
        for y, z in draw.feet_places(np.array([size[1], size[2], 0.0]) if draw.space else np.array([size[2], 0, 0])):
            place = (side * (0.5 * size[0] - radius), *((y, z) if draw.space else (0.0, y)))
            if side < 0:
                draw.foot("b", place, radius, plane)
            else:
                feet.append(draw.ball("b", place, radius))
        if feet:
            draw.between("pads", [shape], feet)
    own = {"attitude": Axes(z=(1, 0, 0), x=(0, 1, 0))} if draw.space else {}
    guide = Prismatic3D if draw.space else Prismatic2D
    at = (0.5 * size[0] + 0.05, 0.0, 0.0)
    draw.joints.append(guide(name="guide", a=draw.marker("ground", at, **own), b=draw.marker("pad", (0, 0, 0), **own)))
    force = Constant(value=-float(rng.uniform(0.6, 3.0) * mass * G / (2.0 * draw.mu)))
    load = AppliedForce3D if draw.space else AppliedForce2D
    draw.forces.append(load(name="press", marker=draw.marker("pad", (0.0, 0.0, 0.0)), force_x=force))


def _groove(draw):
    """A body that lies with several feet on each of two slopes, at rest."""
    rng = draw.rng
    mass = draw.body("b", (0.4, 0.4, 0.4), (0.0, 0.0, 0.6))
    for side in (-1, 1):
        slope = rng.uniform(0.2, 1.0)
        normal = np.array([-side * np.sin(slope), 0.0, np.cos(slope)])
        way = {"attitude": Axes(z=tuple(normal), x=(0, 1, 0))} if draw.space else {"angle": side * float(slope)}
        marker = draw.marker("ground", (0.0, 0.0, 0.0), **way)
        plane = HalfSpace3D(marker=marker) if draw.space else HalfPlane2D(marker=marker)
        for _ in range(int(rng.integers(1, 4))):
            up = rng.uniform(0.2, 0.8)
            y = rng.uniform(-0.4, 0.4)
            place = np.array([side * up * np.cos(slope), y, up * np.sin(slope) - 0.6])
            draw.foot("b", place, 0.0, plane)
    draw.push("b", np.array([0.2, 0.2, 0.2]), mass * G, 1.0)


def _kind(make, space):
    def drawn(rng):
        draw = SceneDraw(rng, space)
        make(draw)
        return draw.model()

    return drawn


_BOTH = {
    "block": _block, "box": _box, "table": _table, "cart": _cart, "frame": _frame, "clamp": _clamp, "groove": _groove,
}  # fmt: skip
PLANE = {name: _kind(make, False) for name, make in {**_BOTH, "stack": _stack}.items()}
SPACE = {name: _kind(make, True) for name, make in _BOTH.items()}
"""Functions of a random generator that give models."""
