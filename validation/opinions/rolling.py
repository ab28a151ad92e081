"""Third opinion on the rolling disk: its equations in angles and spins, by scipy."""

import math

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .mechanism import Array, Course
from .rotation import components


@opinion("rolling_disk")
def rolling_disk(scenario: Scenario) -> Opinion | None:
    """w = b' e1 + p e2 + n e3 with e3 the axle, b its angle from the vertical, e1 level, e2 = e3 x e1 up the disk:

        (A + m r^2) b'' = A p^2 cot b - (C + m r^2) p n - m g r cos b
        A p' = (C n - A p cot b) b'            (C + m r^2) n' = m r^2 p b'

    and the axle goes round the vertical with p/sin b. From the moments about the centre and v = w x r e2. None for a
    rounded rim, whose lever is another.
    """
    p = scenario.parameters
    if float(p["rim_radius"]) != 0.0:
        return None
    m, r, g = float(p["mass"]), float(p["radius"]), float(p["gravity"])
    axial, across = float(p["axial_inertia"]), float(p["transverse_inertia"])
    tilt = float(p["tilt"])

    def frame(lean: float, turn: float) -> tuple[Array, Array, Array]:
        s, c = math.sin(lean), math.cos(lean)
        level = np.array([-math.sin(turn), math.cos(turn), 0.0])
        axle = np.array([s * math.cos(turn), s * math.sin(turn), c])
        return level, np.cross(axle, level), axle

    def rates(t: float, y: Array) -> Array:
        lean, fall, climb, spin, turn = y[:5]
        s, c = math.sin(lean), math.cos(lean)
        level, _, axle = frame(lean, turn)
        go = r * (fall * axle - spin * level)
        falls = (across * climb**2 * c / s - (axial + m * r * r) * climb * spin - m * g * r * c) / (across + m * r * r)
        climbs = (axial * spin - across * climb * c / s) * fall / across
        spins = m * r * r * climb * fall / (axial + m * r * r)
        return np.array([fall, falls, climbs, spins, climb / s, go[0], go[1]])

    course = Course()
    start = [tilt, float(p["tilt_rate"]), float(p["precession"]) * math.sin(tilt), float(p["spin"]), 0.0, 0.0, 0.0]
    course.go_on(rates, np.array(start), scenario.t_end, [])

    def at(t: float) -> Array:
        lean, fall, climb, spin, turn, x, y = course.pieces[0](t)
        level, up, axle = frame(lean, turn)
        return np.concatenate([[x, y, r * math.sin(lean)], fall * level + climb * up + spin * axle])

    names = ("x", "y", "z", "angular_velocity_x", "angular_velocity_y", "angular_velocity_z")
    channels = components([f"disk.{name}" for name in names], at)
    return Opinion("scipy, angles and spins of the disk", channels=channels)
