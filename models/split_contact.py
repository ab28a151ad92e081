"""One mechanism, whole and cut in two where its bodies touch: for co-simulation with a force and a motion as ports.

A hammer on a spring swings to the left against an anvil on a spring of its own. The half `split_striker` takes the
contact's force and gives the hammer's motion; the half `split_wall` takes that motion and gives the force.
"""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import AppliedForce2D, Bushing2D, Joint, MovingFrame2D, Prismatic2D, RigidBody2D
from ..core.model.channels import Input
from ..core.model.markers import Marker2D
from ..core.model.signals import InputSignal
from ..core.multibody_model import Model
from .laws import LAW_NAMES, contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

FORCE_LAWS = tuple(name for name in LAW_NAMES if name != "newton")
"""An impulse does not pass through a port, so the contact is a force."""
_HAMMER = (
    ScenarioParameter("hammer_mass", 1.0, "kg", "of the striking body", 0.0, exclusive=True),
    ScenarioParameter("hammer_frequency", 20.0, "rad/s", "of the hammer on its spring", 0.0, exclusive=True),
    ScenarioParameter("gap", 0.01, "m", "between hammer and anvil at the start", 0.0),
    ScenarioParameter("speed", 1.0, "m/s", "of the hammer at the start, towards the anvil", 0.0),
)  # fmt: skip
_ANVIL = (
    ScenarioParameter("anvil_mass", 2.0, "kg", "of the body that is struck", 0.0, exclusive=True),
    ScenarioParameter("anvil_frequency", 100.0, "rad/s", "of the anvil on its spring", 0.0, exclusive=True),
    ScenarioParameter("anvil_damping_ratio", 0.05, "-", "of the anvil on its spring", 0.0),
    ScenarioParameter("law", "flores", "-", "of the contact, a force", choices=FORCE_LAWS),
    *law_parameters(restitution=0.8, stiffness=1e6)[1:],
)  # fmt: skip
WHOLE = (*_HAMMER, *_ANVIL)
WALL = (*(p for p in _HAMMER if p.name != "hammer_frequency"), *_ANVIL)
T_END = 0.3


@scenario("split_whole", "a hammer on a spring strikes an anvil on a spring: in one piece", WHOLE)
def split_whole(
    *,
    hammer_mass: float,
    hammer_frequency: float,
    gap: float,
    speed: float,
    anvil_mass: float,
    anvil_frequency: float,
    anvil_damping_ratio: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Bodies `hammer` and `anvil` on guides along x, springs `hammer_spring` and `anvil_spring`; contact `blow`."""
    blow = _blow("hammer", law, restitution, stiffness, exponent, damping, relaxation_time, hammer_mass, anvil_mass)
    hammer, guide, spring = _guided("hammer", hammer_mass, gap, hammer_frequency, 0.0, speed)
    anvil, rail, block = _guided("anvil", anvil_mass, 0.0, anvil_frequency, anvil_damping_ratio)
    model = Model(
        name="split_whole", gravity=(0.0, 0.0), bodies=(hammer, anvil), joints=(guide, rail), forces=(spring, block),
        contacts=(blow,), parameters=law_model_parameters("blow", blow.law),
    )  # fmt: skip
    return _scenario(model, "hammer.x", "anvil.x", "blow.normal_force")


@scenario("split_striker", "the hammer of split_whole: takes the contact's force, gives its motion", _HAMMER)
def split_striker(*, hammer_mass: float, hammer_frequency: float, gap: float, speed: float) -> Scenario:
    """Body `hammer` with input `contact_force` (N, to the right: compression positive). Its outputs for the other half
    are `hammer.x` and `hammer.vx`."""
    hammer, guide, spring = _guided("hammer", hammer_mass, gap, hammer_frequency, 0.0, speed)
    push = AppliedForce2D(
        name="push", marker=Marker2D(body="hammer"), force_x=InputSignal(channel="contact_force")
    )  # fmt: skip
    model = Model(
        name="split_striker", gravity=(0.0, 0.0), bodies=(hammer,), joints=(guide,), forces=(spring, push),
        inputs=(Input(name="contact_force", unit="N", description="on the hammer, pushing it off the anvil"),),
    )  # fmt: skip
    return _scenario(model, "hammer.x", "hammer.vx")


@scenario("split_wall", "the anvil of split_whole: takes the hammer's motion, gives the contact's force", WALL)
def split_wall(
    *,
    hammer_mass: float,
    gap: float,
    speed: float,
    anvil_mass: float,
    anvil_frequency: float,
    anvil_damping_ratio: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Frame `face` that moves by the inputs `hammer_x` (m) and `hammer_vx` (m/s), against body `anvil`; contact `blow`,
    whose `blow.normal_force` is the output for the other half. `hammer_mass` is for the contact law's damping only."""
    blow = _blow("face", law, restitution, stiffness, exponent, damping, relaxation_time, hammer_mass, anvil_mass)
    face = MovingFrame2D(name="face", x=InputSignal(channel="hammer_x", rate="hammer_vx"))
    anvil, rail, block = _guided("anvil", anvil_mass, 0.0, anvil_frequency, anvil_damping_ratio)
    model = Model(
        name="split_wall", gravity=(0.0, 0.0), bodies=(face, anvil), joints=(rail,), forces=(block,), contacts=(blow,),
        parameters=law_model_parameters("blow", blow.law),
        inputs=(
            Input(name="hammer_x", unit="m", start=gap, description="position of the hammer"),
            Input(name="hammer_vx", unit="m/s", start=-speed, description="velocity of the hammer"),
        ),
    )  # fmt: skip
    return _scenario(model, "anvil.x", "anvil.vx", "blow.gap", "blow.normal_force")


def _guided(
    name: str, mass: float, x: float, frequency: float, damping_ratio: float, speed: float = 0.0
) -> tuple[RigidBody2D, Joint, Bushing2D]:
    """A body on a guide along x with a spring that is relaxed at x = 0; it does not turn."""
    marker = Marker2D(body=name)
    spring = Bushing2D(
        name=f"{name}_spring", a=Marker2D(), b=marker, stiffness=mass * frequency**2,
        damping=2.0 * damping_ratio * mass * frequency,
    )  # fmt: skip
    body = RigidBody2D(name=name, mass=mass, inertia=mass, position=(x, 0.0), velocity=(-speed, 0.0))
    return body, Prismatic2D(name=f"{name}_guide", a=Marker2D(), b=marker), spring


def _blow(
    striker: str,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
    hammer_mass: float,
    anvil_mass: float,
) -> DiskOnHalfPlane2D:
    """The contact of a point of `striker` with the anvil's right side."""
    effective = 1.0 / (1.0 / hammer_mass + 1.0 / anvil_mass)
    found = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=effective,
    )  # fmt: skip
    # the half-plane's normal, its marker's second axis, points to the right
    side = HalfPlane2D(marker=Marker2D(body="anvil", angle=-0.5 * math.pi))
    return DiskOnHalfPlane2D(name="blow", plane=side, disk=Disk2D(marker=Marker2D(body=striker)), law=found)


def _scenario(model: Model, *compare: str) -> Scenario:
    return Scenario(
        name=model.name, description="", model=model, t_end=T_END, rtol=1e-8, atol=1e-10, compare=compare
    )  # fmt: skip
