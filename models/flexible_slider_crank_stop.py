"""A slider-crank with a flexible connecting rod, whose slider strikes a stop part of the way."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import AppliedTorque2D, Attachment, FloatingBeam2D, MaterialPoint2D, Prismatic2D, Revolute2D
from ..core.model.markers import Marker2D
from ..core.model.signals import Constant
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario
from .slider_crank import Dimensions, crank_bodies

PARAMETERS = (
    ScenarioParameter("crank_length", 0.15, "m", "length of the crank", 0.0, exclusive=True),
    ScenarioParameter("rod_length", 0.3, "m", "of the connecting rod, more than the crank's", 0.0, exclusive=True),
    ScenarioParameter("rod_side", 0.008, "m", "side of the rod's square section", 0.0, exclusive=True),
    ScenarioParameter("youngs_modulus", 2e11, "Pa", "of the rod", 0.0, exclusive=True),
    ScenarioParameter("density", 7870.0, "kg/m^3", "of the rod", 0.0, exclusive=True),
    ScenarioParameter("modes", 3, "-", "bending modes of the rod", 1, 20),
    ScenarioParameter("axial", False, "-", "whether the rod stretches too: one mode and the static shape of its end"),
    ScenarioParameter("damping_ratio", 0.02, "-", "of the rod's modes", 0.0),
    ScenarioParameter("crank_mass", 0.36, "kg", "mass of the crank, a slender rod", 0.0, exclusive=True),
    ScenarioParameter("slider_mass", 0.075, "kg", "mass of the slider", 0.0, exclusive=True),
    ScenarioParameter("flywheel_inertia", 0.01, "kg.m^2", "of a flywheel on the crank", 0.0),
    ScenarioParameter("torque", 1.0, "N.m", "on the crank, counter-clockwise"),
    ScenarioParameter("crank_angle", -0.75 * math.pi, "rad", "at the start, from the x axis", -math.pi, 0.0),
    ScenarioParameter("crank_speed", 10.0, "rad/s", "angular velocity of the crank at the start"),
    ScenarioParameter("stop_angle", -0.25 * math.pi, "rad", "of the crank when the slider touches", -math.pi, 0.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    *law_parameters(restitution=0.5),
)  # fmt: skip


@scenario("flexible_slider_crank_stop", "a slider-crank with a flexible rod, its slider strikes a stop", PARAMETERS)
def flexible_slider_crank_stop(
    *,
    crank_length: float,
    rod_length: float,
    rod_side: float,
    youngs_modulus: float,
    density: float,
    modes: int,
    axial: bool,
    damping_ratio: float,
    crank_mass: float,
    slider_mass: float,
    flywheel_inertia: float,
    torque: float,
    crank_angle: float,
    crank_speed: float,
    stop_angle: float,
    gravity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Bodies `crank`, `rod`, `slider`, points `middle` and `end` of the rod; joints `main`, `crank_pin`, `wrist`,
    `guide`; force `drive`; contact `stop`.

    The mechanism of `slider_crank_stop` with the connecting rod of Simeon, "Modelling a flexible slider crank mechanism
    by a mixed system of DAEs and PDEs" (1996): its frame is the chord, with its origin at the crank pin. The rod starts
    straight, with the speeds of the rigid mechanism.
    """
    if rod_length <= crank_length:
        raise ScenarioError(
            f"rod_length = {rod_length:g} must exceed crank_length = {crank_length:g}: else the crank cannot turn"
        )
    if not -math.pi < crank_angle < stop_angle < 0.0:
        raise ScenarioError(
            f"crank_angle = {crank_angle:g} must lie below stop_angle = {stop_angle:g}, both between -pi and 0: "
            "the slider moves outwards until it touches"
        )
    rod_mass = density * rod_side**2 * rod_length
    d = Dimensions(crank_length, rod_length, crank_mass, rod_mass, slider_mass, gravity, flywheel_inertia)
    crank, rigid_rod, slider = crank_bodies(d, crank_angle, crank_speed)
    c, s = crank_length * math.cos(crank_angle), crank_length * math.sin(crank_angle)
    rod = FloatingBeam2D(
        name="rod",
        mass=rod_mass,
        length=rod_length,
        bending_stiffness=youngs_modulus * rod_side**4 / 12.0,
        axial_stiffness=youngs_modulus * rod_side**2 if axial else None,
        boundary_conditions="simply_supported",
        modes=modes,
        axial_modes=int(axial),
        attachments=(Attachment(position=rod_length, direction="axial"),) if axial else (),
        damping_ratio=damping_ratio,
        position=(c, s),
        angle=rigid_rod.angle,
        velocity=(-crank_speed * s, crank_speed * c),
        angular_velocity=rigid_rod.angular_velocity,
    )
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=d.effective_mass(stop_angle),
    )  # fmt: skip
    face = 0.25 * crank_length  # from the wrist pin
    height = crank_length * math.sin(stop_angle)
    stop = crank_length * math.cos(stop_angle) + math.sqrt(rod_length**2 - height**2) + face
    crank_end = Marker2D(body="crank", point=(0.5 * crank_length, 0.0))
    model = Model(
        name="flexible_slider_crank_stop",
        gravity=(0.0, -gravity),
        bodies=(
            crank, rod, slider,
            MaterialPoint2D(name="middle", body="rod", point=(0.5 * rod_length, 0.0)),
            MaterialPoint2D(name="end", body="rod", point=(rod_length, 0.0)),
        ),
        joints=(
            Revolute2D(name="main", a=Marker2D(), b=Marker2D(body="crank", point=(-0.5 * crank_length, 0.0))),
            Revolute2D(name="crank_pin", a=crank_end, b=Marker2D(body="rod")),
            Revolute2D(name="wrist", a=Marker2D(body="end"), b=Marker2D(body="slider")),
            Prismatic2D(name="guide", a=Marker2D(), b=Marker2D(body="slider")),
        ),
        forces=(AppliedTorque2D(name="drive", body="crank", torque=Constant(value=torque)),),
        contacts=(
            DiskOnHalfPlane2D(
                name="stop",
                plane=HalfPlane2D(marker=Marker2D(point=(stop, 0.0), angle=0.5 * math.pi)),
                disk=Disk2D(marker=Marker2D(body="slider", point=(face, 0.0))),
                law=contact,
            ),
        ),
        parameters=law_model_parameters("stop", contact),
    )  # fmt: skip
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=0.2,
        atol=1e-8,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("crank.angle", "crank.angular_velocity", "slider.x", "stop.normal_force", "stop.gap"),
    )
