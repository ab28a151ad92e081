"""A mass on a spring, driven by a harmonic force, strikes a stop: periodic, with many impacts, or chaotic."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import AppliedForce2D, Bushing2D, Prismatic2D, RigidBody2D
from ..core.model.markers import Marker2D
from ..core.model.signals import Sine
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("damping_ratio", 0.05, "-", "of the free oscillator, whose frequency is 1 rad/s", 0.0),
    ScenarioParameter("frequency", 2.8, "rad/s", "of the force cos(frequency t)", 0.0, exclusive=True),
    ScenarioParameter("stop_position", 0.0, "m", "x at which the mass strikes, moving to the right; 0: spring relaxed"),
    ScenarioParameter("start_position", -0.5, "m", "x at the start, left of the stop"),
    ScenarioParameter("start_velocity", 0.0, "m/s", "at the start"),
    *law_parameters(restitution=0.8),
)  # fmt: skip


@scenario("impact_oscillator", "a driven oscillator strikes a stop: periodic or chaotic motion", PARAMETERS)
def impact_oscillator(
    *,
    damping_ratio: float,
    frequency: float,
    stop_position: float,
    start_position: float,
    start_velocity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Body `mass` (1 kg) on the guide `guide` along x, held by `spring`, driven by `drive`; contact `stop`.

    x'' + 2 damping_ratio x' + x = cos(frequency t) for x <= stop_position, v+ = -restitution v- there: the impact
    oscillator of Shaw & Holmes, "A periodically forced piecewise linear oscillator", J. Sound Vib. 90 (1983) 129.
    """
    if start_position > stop_position:
        raise ScenarioError(
            f"start_position = {start_position:g} lies behind the stop at stop_position = {stop_position:g}: start "
            "left of it"
        )
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=1.0,
    )  # fmt: skip
    on_mass = Marker2D(body="mass")
    model = Model(
        name="impact_oscillator",
        gravity=(0.0, 0.0),
        # the mass does not turn: its inertia plays no part
        bodies=(
            RigidBody2D(
                name="mass", mass=1.0, inertia=1.0, position=(start_position, 0.0), velocity=(start_velocity, 0.0)
            ),
        ),
        joints=(Prismatic2D(name="guide", a=Marker2D(), b=on_mass),),
        forces=(
            Bushing2D(name="spring", a=Marker2D(), b=on_mass, stiffness=1.0, damping=2.0 * damping_ratio),
            AppliedForce2D(
                name="drive",
                marker=on_mass,
                force_x=Sine(amplitude=1.0, angular_frequency=frequency, phase=0.5 * math.pi),
            ),
        ),
        contacts=(
            DiskOnHalfPlane2D(
                name="stop",
                # the half-plane's normal, its marker's second axis, points to the left
                plane=HalfPlane2D(marker=Marker2D(point=(stop_position, 0.0), angle=0.5 * math.pi)),
                disk=Disk2D(marker=on_mass),
                law=contact,
            ),
        ),
        parameters=law_model_parameters("stop", contact),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=6.0 * 2.0 * math.pi / frequency,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("mass.x", "mass.vx", "stop.normal_force", "stop.gap"),
    )
