"""A slider-crank that turns freely, with a rigid or an elastic wrist pin: a stiff problem of adjustable stiffness."""

import cmath
import math
from dataclasses import dataclass

from ..core.elements import Bushing2D, Prismatic2D, Revolute2D, RigidBody2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("crank_length", 0.15, "m", "length of the crank", 0.0, exclusive=True),
    ScenarioParameter("rod_length", 0.3, "m", "of the connecting rod, more than the crank's", 0.0, exclusive=True),
    ScenarioParameter("crank_mass", 0.36, "kg", "mass of the crank, a slender rod", 0.0, exclusive=True),
    ScenarioParameter("rod_mass", 0.15, "kg", "mass of the connecting rod, a slender rod", 0.0, exclusive=True),
    ScenarioParameter("slider_mass", 0.075, "kg", "mass of the slider", 0.0, exclusive=True),
    ScenarioParameter("crank_angle", 0.25 * math.pi, "rad", "angle of the crank at the start, from the x axis"),
    ScenarioParameter("crank_speed", 30.0, "rad/s", "angular velocity of the crank at the start"),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    ScenarioParameter("bushing_stiffness", 0.0, "N/m", "of the wrist pin between rod and slider; 0: a rigid pin", 0.0),
    ScenarioParameter("bushing_damping", 0.0, "N.s/m", "of the wrist pin; only with bushing_stiffness", 0.0),
)  # fmt: skip

LARGEST_DEFLECTION = 0.01
"""Of the bushing at the start, relative to the rod: beyond, the expansion in 1/k that starts it is no use."""


@dataclass(frozen=True)
class Dimensions:
    """Of the rigid mechanism: r, l (m), masses (kg), g (m/s^2), a flywheel on the crank (kg m^2)."""

    r: float
    l: float
    crank: float
    rod: float
    slider: float
    gravity: float
    flywheel: float = 0.0

    def effective_mass(self, angle: float) -> float:
        """Mass that a blow on the slider along its axis feels at a crank angle (rad), kg; infinite at dead centre."""
        r, l = self.r, self.l
        sin_phi = -r / l * math.sin(angle)
        cos_phi = math.sqrt(1.0 - sin_phi**2)
        c, s = math.cos(angle), math.sin(angle)
        p = -r * c / (l * cos_phi)
        slider = -r * s - l * sin_phi * p
        rod = (-r * s - 0.5 * l * sin_phi * p) ** 2 + (r * c + 0.5 * l * cos_phi * p) ** 2
        inertia = self.flywheel + self.crank * r**2 / 3.0 + self.rod * (rod + l**2 / 12.0 * p**2)
        return (inertia + self.slider * slider**2) / slider**2 if slider else math.inf

    def motion(self, angle: complex, rate: complex) -> tuple[complex, complex, complex]:
        """(crank's acceleration, force x, force y of the rod on the slider) in a state of the rigid mechanism.

        phi is the angle of the rod, sin phi = -(r/l) sin(angle), phi' = p w, phi'' = p w' + s w^2. The equation of
        motion in the crank's angle is that of Lagrange; the force follows from the slider (x) and from the moments
        of the rod about the crank pin (y).
        """
        r, l = self.r, self.l
        sin_phi = -r / l * cmath.sin(angle)
        cos_phi = cmath.sqrt(1.0 - sin_phi**2)
        c, s = cmath.cos(angle), cmath.sin(angle)
        p = -r * c / (l * cos_phi)
        curve = (r * s / l + sin_phi * p**2) / cos_phi  # of phi over the angle
        # points: velocity = (x1, y1) w, acceleration = (x1, y1) w' + (x2, y2) w^2
        rod = (-r * s - 0.5 * l * sin_phi * p, r * c + 0.5 * l * cos_phi * p)
        rod_curve = (
            -r * c - 0.5 * l * (cos_phi * p**2 + sin_phi * curve),
            -r * s - 0.5 * l * (sin_phi * p**2 - cos_phi * curve),
        )
        slider = -r * s - l * sin_phi * p
        slider_curve = -r * c - l * (cos_phi * p**2 + sin_phi * curve)
        rod_inertia = self.rod * l**2 / 12.0
        mass = (
            self.flywheel
            + self.crank * r**2 / 3.0
            + self.rod * (rod[0] ** 2 + rod[1] ** 2)
            + rod_inertia * p**2
            + self.slider * slider**2
        )
        quadratic = (
            self.rod * (rod[0] * rod_curve[0] + rod[1] * rod_curve[1])
            + rod_inertia * p * curve
            + self.slider * slider * slider_curve
        )
        weight = self.gravity * (0.5 * self.crank * r * c + self.rod * rod[1])
        acceleration = -(quadratic * rate**2 + weight) / mass
        force_x = self.slider * (slider * acceleration + slider_curve * rate**2)
        # moments of the rod about its joint with the crank: l e x (-F) + l/2 e x (-m g) = J phi'' + l/2 e x m a
        ax = rod[0] * acceleration + rod_curve[0] * rate**2
        ay = rod[1] * acceleration + rod_curve[1] * rate**2
        turning = rod_inertia * (p * acceleration + curve * rate**2)
        moment = turning / l + 0.5 * self.rod * (cos_phi * (ay + self.gravity) - sin_phi * ax)
        force_y = (sin_phi * force_x - moment) / cos_phi
        return acceleration, force_x, force_y


@scenario("slider_crank", "a slider-crank turning freely, with a rigid or elastic wrist pin", PARAMETERS)
def slider_crank(
    *,
    crank_length: float,
    rod_length: float,
    crank_mass: float,
    rod_mass: float,
    slider_mass: float,
    crank_angle: float,
    crank_speed: float,
    gravity: float,
    bushing_stiffness: float,
    bushing_damping: float,
) -> Scenario:
    """Bodies `crank`, `rod`, `slider`; joints `main` at the origin, `crank_pin`, `guide` along the x axis, and the
    `wrist` pin between rod and slider: a revolute joint, or with `bushing_stiffness` a bushing.

    Dimensions after the slider-crank of Simeon, "Modelling a flexible slider crank mechanism by a mixed system of
    DAEs and PDEs" (1996), with rigid rods and no drive. With the bushing there are two vibrations of high
    frequency, omega ~ sqrt(k). The start is on the slow motion, up to O(1/k^2): the bushing is deflected by -F/k
    and deflects at the rate -F'/k, F being the force that a rigid pin would carry in the same state of the crank,
    so that the vibrations stay far below the deflection that the motion itself makes. A start with the bushing
    unloaded would excite them with the amplitude of that deflection.
    """
    if rod_length <= crank_length:
        raise ScenarioError(
            f"rod_length = {rod_length:g} must exceed crank_length = {crank_length:g}: else the crank cannot turn"
        )
    if bushing_damping and not bushing_stiffness:
        raise ScenarioError(
            f"bushing_damping = {bushing_damping:g} needs bushing_stiffness > 0: a rigid pin has no damping"
        )
    dimensions = Dimensions(crank_length, rod_length, crank_mass, rod_mass, slider_mass, gravity)
    bodies = crank_bodies(dimensions, crank_angle, crank_speed, *_deflection(
        dimensions, crank_angle, crank_speed, bushing_stiffness, bushing_damping
    ))  # fmt: skip
    crank_end = Marker2D(body="crank", point=(0.5 * crank_length, 0.0))
    rod_end = Marker2D(body="rod", point=(0.5 * rod_length, 0.0))
    joints = (
        Revolute2D(name="main", a=Marker2D(), b=Marker2D(body="crank", point=(-0.5 * crank_length, 0.0))),
        Revolute2D(name="crank_pin", a=crank_end, b=Marker2D(body="rod", point=(-0.5 * rod_length, 0.0))),
        Prismatic2D(name="guide", a=Marker2D(), b=Marker2D(body="slider")),
    )
    on_slider = Marker2D(body="slider")
    if bushing_stiffness:
        bushing = Bushing2D(name="wrist", a=rod_end, b=on_slider, stiffness=bushing_stiffness, damping=bushing_damping)
        model = Model(name="slider_crank", gravity=(0.0, -gravity), bodies=bodies, joints=joints, forces=(bushing,))
    else:
        pin = Revolute2D(name="wrist", a=rod_end, b=on_slider)
        model = Model(name="slider_crank", gravity=(0.0, -gravity), bodies=bodies, joints=(*joints, pin))
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.0,
        compare=("crank.angle", "crank.angular_velocity", "rod.angle", "slider.x", "slider.vx"),
    )


def _deflection(d: Dimensions, angle: float, rate: float, stiffness: float, damping: float) -> tuple[float, ...]:
    """(x, y, x', y') of the slider against the end of the rod: the slow solution of k d + c d' = -F to O(1/k^2).

    F' by the complex step along the rigid motion (Squire and Trapp, 1998).
    """
    if not stiffness:
        return 0.0, 0.0, 0.0, 0.0
    step = 1e-30
    acceleration, *force = (z.real for z in d.motion(angle, rate))
    _, *rates = (z.imag / step for z in d.motion(angle + 1j * step * rate, rate + 1j * step * acceleration))
    lag = damping / stiffness
    found = (
        *((lag * df - f) / stiffness for f, df in zip(force, rates, strict=True)),
        *(-df / stiffness for df in rates),
    )
    if math.hypot(*found[:2]) > LARGEST_DEFLECTION * d.l:
        raise ScenarioError(
            f"bushing_stiffness = {stiffness:g} N/m is too soft: the pin's force of {math.hypot(*force):.3g} N would "
            f"deflect it by {math.hypot(*found[:2]):.3g} m, more than {LARGEST_DEFLECTION:g} of the rod"
        )
    return found


def crank_bodies(
    d: Dimensions, angle: float, rate: float, dx: float = 0.0, dy: float = 0.0, dvx: float = 0.0, dvy: float = 0.0
) -> tuple[RigidBody2D, ...]:
    """The bodies at the start, the slider at (dx, dy) against the end of the rod, on the x axis."""
    c, s = math.cos(angle), math.sin(angle)
    # height of the rod's end: -dy
    phi = math.asin((-dy - d.r * s) / d.l)
    phi_rate = (-dvy - d.r * c * rate) / (d.l * math.cos(phi))
    cp, sp = math.cos(phi), math.sin(phi)
    return (
        RigidBody2D(
            name="crank", mass=d.crank, inertia=d.crank * d.r**2 / 12.0 + d.flywheel,
            position=(0.5 * d.r * c, 0.5 * d.r * s), angle=angle,
            velocity=(-0.5 * d.r * s * rate, 0.5 * d.r * c * rate), angular_velocity=rate,
        ),
        RigidBody2D(
            name="rod", mass=d.rod, inertia=d.rod * d.l**2 / 12.0,
            position=(d.r * c + 0.5 * d.l * cp, d.r * s + 0.5 * d.l * sp), angle=phi,
            velocity=(-d.r * s * rate - 0.5 * d.l * sp * phi_rate, d.r * c * rate + 0.5 * d.l * cp * phi_rate),
            angular_velocity=phi_rate,
        ),
        # a square block as long as half the crank; it does not turn
        RigidBody2D(
            name="slider", mass=d.slider, inertia=d.slider * d.r**2 / 24.0,
            position=(d.r * c + d.l * cp + dx, 0.0),
            velocity=(-d.r * s * rate - d.l * sp * phi_rate + dvx, 0.0),
        ),
    )  # fmt: skip
