"""A slender rod swings about a fixed pin and strikes a stop with its tip."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import AppliedTorque2D, Revolute2D, RigidBody2D
from ..core.model.channels import Input
from ..core.model.markers import Marker2D
from ..core.model.signals import InputSignal
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("length", 1.0, "m", "length of the rod", 0.0, exclusive=True),
    ScenarioParameter("mass", 1.0, "kg", "mass of the rod", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    ScenarioParameter("start_angle", 0.0, "rad", "angle at the start, from the horizontal, at rest"),
    ScenarioParameter("stop_angle", -math.pi / 2, "rad", "angle at which the tip touches the stop"),
    ScenarioParameter("driven", True, "-", "with an input channel `torque` (N.m) on the pendulum"),
    *law_parameters(restitution=0.7),
)


@scenario("pendulum_stop", "a rod on a pin, released at rest, strikes a stop with its tip", PARAMETERS)
def pendulum_stop(
    *,
    length: float,
    mass: float,
    gravity: float,
    start_angle: float,
    stop_angle: float,
    driven: bool,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Body `pendulum`, joint `pin` at the origin, contact `stop`.

    The gap is L |sin(angle - stop_angle)| on the free side. The tip comes to the first impact with speed
    sqrt(3 g (y_start - y_stop)), y of the tip; the effective mass at the tip is m/3.
    """
    swing = start_angle - stop_angle
    if not 0.0 < abs(swing) < math.pi:
        raise ScenarioError(
            f"start_angle = {start_angle:g} and stop_angle = {stop_angle:g} must differ by more than 0 "
            "and less than pi: else the tip starts on or behind the stop"
        )
    contact = contact_law(
        law,
        restitution=restitution,
        stiffness=stiffness,
        exponent=exponent,
        damping=damping,
        relaxation_time=relaxation_time,
        mass=mass / 3.0,
    )
    half = 0.5 * length
    # the stop's outward normal (its marker's second axis) points to where the rod starts
    stop = Marker2D(
        point=(length * math.cos(stop_angle), length * math.sin(stop_angle)),
        angle=stop_angle if swing > 0.0 else stop_angle + math.pi,
    )
    model = Model(
        name="pendulum_stop",
        gravity=(0.0, -gravity),
        bodies=(
            RigidBody2D(
                name="pendulum",
                mass=mass,
                inertia=mass * length**2 / 12.0,
                position=(half * math.cos(start_angle), half * math.sin(start_angle)),
                angle=start_angle,
            ),
        ),
        joints=(Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="pendulum", point=(-half, 0.0))),),
        forces=(AppliedTorque2D(name="drive", body="pendulum", torque=InputSignal(channel="torque")),)
        if driven
        else (),
        contacts=(
            DiskOnHalfPlane2D(
                name="stop",
                plane=HalfPlane2D(marker=stop),
                disk=Disk2D(marker=Marker2D(body="pendulum", point=(half, 0.0))),
                law=contact,
            ),
        ),
        inputs=(Input(name="torque", unit="N.m", description="torque on the pendulum, counter-clockwise"),)
        if driven
        else (),
        parameters=law_model_parameters("stop", contact),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.5 * math.sqrt(length * 9.81 / gravity),  # three impacts with the other defaults
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("pendulum.angle", "pendulum.angular_velocity", "stop.normal_force", "stop.gap"),
    )
