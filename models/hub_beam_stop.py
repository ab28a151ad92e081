"""A turning hub with a flexible beam, whose tip strikes a stop."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import (
    Attachment,
    BodyElement,
    Cable2D,
    Clamp2D,
    FloatingBeam2D,
    MaterialPoint2D,
    Revolute2D,
    RigidBody2D,
)
from ..core.laws import ContactLaw, Hertz, NewtonImpact
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .laws import law_model_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("formulation", "floating", "-", "of the beam: modes in a floating frame, or ANCF elements",
                      choices=("floating", "ancf")),
    ScenarioParameter("contact", "ccm", "-", "constraint with impact, or Hertz's force", choices=("ccm", "ccfm")),
    ScenarioParameter("modes", 4, "-", "of the beam in the floating frame, besides the tip's static shape", 1, 40),
    ScenarioParameter("elements", 8, "-", "ANCF elements", 1, 400),
    ScenarioParameter("beam_length", 0.5, "m", "length of the beam", 0.0, exclusive=True),
    ScenarioParameter("beam_width", 0.02, "m", "of its section, along the axis of rotation", 0.0, exclusive=True),
    ScenarioParameter("beam_height", 0.005, "m", "of its section, in the plane of motion", 0.0, exclusive=True),
    ScenarioParameter("youngs_modulus", 2.1e11, "Pa", "of the beam", 0.0, exclusive=True),
    ScenarioParameter("density", 7850.0, "kg/m^3", "of the beam", 0.0, exclusive=True),
    ScenarioParameter("damping_time", 1e-4, "s", "damping of the beam = this time times its stiffness", 0.0),
    ScenarioParameter("hub_radius", 0.05, "m", "where the beam is clamped", 0.0),
    ScenarioParameter("hub_inertia", 0.1, "kg.m^2", "moment of inertia of the hub about its axis", 0.0, exclusive=True),
    ScenarioParameter("speed", 2.0, "rad/s", "of hub and beam at the start", 0.0, exclusive=True),
    ScenarioParameter("start_angle", 0.02, "rad", "of the hub before it touches", 0.0, 1.0, exclusive=True),
    ScenarioParameter("restitution", 0.0, "-", "of ccm", 0.0, 1.0),
    ScenarioParameter("stiffness", 1e8, "N/m^1.5", "of ccfm", 0.0, exclusive=True),
)  # fmt: skip


@scenario("hub_beam_stop", "a turning hub with a flexible beam whose tip strikes a stop", PARAMETERS)
def hub_beam_stop(
    *,
    formulation: str,
    contact: str,
    modes: int,
    elements: int,
    beam_length: float,
    beam_width: float,
    beam_height: float,
    youngs_modulus: float,
    density: float,
    damping_time: float,
    hub_radius: float,
    hub_inertia: float,
    speed: float,
    start_angle: float,
    restitution: float,
    stiffness: float,
) -> Scenario:
    """Bodies `hub`, `beam`, `tip` (of the beam; with ancf also `root`); joints `axle`, `clamp`; contact `stop`.

    No gravity. The tip has next to no mass of its own, so that an impact of the constraint takes next to no energy with
    restitution 0, and the rebound comes from the bending of the beam: with r = hub_radius + beam_length, hub and beam
    come back after about pi sqrt(J/(k r^2)), k = 3 EI/L^3, and the impulse is near twice J speed/r. In between the tip
    may leave the stop and come back.
    """
    law: ContactLaw = NewtonImpact(restitution=restitution) if contact == "ccm" else Hertz(stiffness=stiffness)
    area, reach = beam_width * beam_height, hub_radius + beam_length
    bending_stiffness = youngs_modulus * beam_width * beam_height**3 / 12.0
    c, s = math.cos(start_angle), -math.sin(start_angle)
    root, velocity = (hub_radius * c, hub_radius * s), (-speed * hub_radius * s, speed * hub_radius * c)
    tip = MaterialPoint2D(name="tip", body="beam", point=(beam_length, 0.0))
    parts: tuple[BodyElement, ...]
    if formulation == "floating":
        beam = FloatingBeam2D(
            name="beam", mass=density * area * beam_length, length=beam_length, bending_stiffness=bending_stiffness,
            modes=modes, attachments=(Attachment(position=beam_length),), geometric_stiffening=True, position=root,
            angle=-start_angle, velocity=velocity, angular_velocity=speed,
        )  # fmt: skip
        ratios = tuple(float(0.5 * damping_time * w) for w in beam.frequencies())
        parts, clamped = (beam.model_copy(update={"damping_ratio": ratios}), tip), "beam"
    else:
        cable = Cable2D(
            name="beam", elements=elements, length=beam_length, mass_per_length=density * area,
            axial_stiffness=youngs_modulus * area, bending_stiffness=bending_stiffness,
            axial_damping=damping_time * youngs_modulus * area, bending_damping=damping_time * bending_stiffness,
            position=root, angle=-start_angle, velocity=velocity, angular_velocity=speed,
        )  # fmt: skip
        parts, clamped = (cable, MaterialPoint2D(name="root", body="beam", point=(0.0, 0.0)), tip), "root"
    model = Model(
        name="hub_beam_stop",
        gravity=(0.0, 0.0),
        bodies=(
            # the mass of the hub moves nothing: it turns about its centre
            RigidBody2D(name="hub", mass=1.0, inertia=hub_inertia, angle=-start_angle, angular_velocity=speed),
            *parts,
        ),
        joints=(
            Revolute2D(name="axle", a=Marker2D(), b=Marker2D(body="hub")),
            Clamp2D(name="clamp", a=Marker2D(body="hub", point=(hub_radius, 0.0)), b=Marker2D(body=clamped)),
        ),
        contacts=(
            DiskOnHalfPlane2D(
                name="stop",
                plane=HalfPlane2D(marker=Marker2D(point=(reach, 0.0), angle=math.pi)),
                disk=Disk2D(marker=Marker2D(body="tip")),
                law=law,
            ),
        ),
        parameters=law_model_parameters("stop", law),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=0.15,
        atol=1e-8,
        compare=("hub.angle", "hub.angular_velocity", "tip.y", "stop.normal_force", "stop.gap"),
    )
