"""A torque turns a slider-crank until its slider strikes a stop part of the way."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import AppliedTorque2D, Prismatic2D, Revolute2D
from ..core.model.channels import Input
from ..core.model.markers import Marker2D
from ..core.model.signals import Constant, InputSignal
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario
from .slider_crank import Dimensions, crank_bodies

PARAMETERS = (
    ScenarioParameter("crank_length", 0.15, "m", "length of the crank", 0.0, exclusive=True),
    ScenarioParameter("rod_length", 0.3, "m", "of the connecting rod, more than the crank's", 0.0, exclusive=True),
    ScenarioParameter("crank_mass", 0.36, "kg", "mass of the crank, a slender rod", 0.0, exclusive=True),
    ScenarioParameter("rod_mass", 0.15, "kg", "mass of the connecting rod, a slender rod", 0.0, exclusive=True),
    ScenarioParameter("slider_mass", 0.075, "kg", "mass of the slider", 0.0, exclusive=True),
    ScenarioParameter("flywheel_inertia", 0.01, "kg.m^2", "of a flywheel on the crank", 0.0),
    ScenarioParameter("torque", 1.0, "N.m", "on the crank, counter-clockwise; with `driven` the input's start value"),
    ScenarioParameter("driven", True, "-", "the torque is an input channel `torque`"),
    ScenarioParameter("crank_angle", -0.75 * math.pi, "rad", "at the start, from the x axis", -math.pi, 0.0),
    ScenarioParameter("crank_speed", 0.0, "rad/s", "angular velocity of the crank at the start"),
    ScenarioParameter("stop_angle", -0.25 * math.pi, "rad", "of the crank when the slider touches", -math.pi, 0.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    *law_parameters(restitution=0.5),
)  # fmt: skip


@scenario("slider_crank_stop", "a driven slider-crank whose slider strikes a stop part of the way", PARAMETERS)
def slider_crank_stop(
    *,
    crank_length: float,
    rod_length: float,
    crank_mass: float,
    rod_mass: float,
    slider_mass: float,
    flywheel_inertia: float,
    torque: float,
    driven: bool,
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
    """Bodies `crank`, `rod`, `slider`; joints `main`, `crank_pin`, `wrist`, `guide`; force `drive`; contact `stop`.

    The crank turns below the x axis, from where the slider is in towards where it is out; the stop stands in the way
    of the slider's outer face. With law newton the impacts accumulate and the slider rests against the stop, with the
    normal force of statics: the moment of torque and weights over -dx/d angle of the slider.
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
    d = Dimensions(crank_length, rod_length, crank_mass, rod_mass, slider_mass, gravity, flywheel_inertia)
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=d.effective_mass(stop_angle),
    )  # fmt: skip
    face = 0.25 * crank_length  # from the wrist pin
    s = crank_length * math.sin(stop_angle)
    stop = crank_length * math.cos(stop_angle) + math.sqrt(rod_length**2 - s * s) + face
    crank_end = Marker2D(body="crank", point=(0.5 * crank_length, 0.0))
    model = Model(
        name="slider_crank_stop",
        gravity=(0.0, -gravity),
        bodies=crank_bodies(d, crank_angle, crank_speed),
        joints=(
            Revolute2D(name="main", a=Marker2D(), b=Marker2D(body="crank", point=(-0.5 * crank_length, 0.0))),
            Revolute2D(name="crank_pin", a=crank_end, b=Marker2D(body="rod", point=(-0.5 * rod_length, 0.0))),
            Revolute2D(name="wrist", a=Marker2D(body="rod", point=(0.5 * rod_length, 0.0)), b=Marker2D(body="slider")),
            Prismatic2D(name="guide", a=Marker2D(), b=Marker2D(body="slider")),
        ),
        forces=(
            AppliedTorque2D(
                name="drive",
                body="crank",
                torque=InputSignal(channel="torque") if driven else Constant(value=torque),
            ),
        ),
        contacts=(
            DiskOnHalfPlane2D(
                name="stop",
                plane=HalfPlane2D(marker=Marker2D(point=(stop, 0.0), angle=0.5 * math.pi)),
                disk=Disk2D(marker=Marker2D(body="slider", point=(face, 0.0))),
                law=contact,
            ),
        ),
        inputs=(Input(name="torque", unit="N.m", start=torque, description="torque on the crank, counter-clockwise"),)
        if driven
        else (),
        parameters=law_model_parameters("stop", contact),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.5 if law == "newton" else 0.8,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("crank.angle", "crank.angular_velocity", "slider.x", "stop.normal_force", "stop.gap"),
    )
