"""A tippe top: it spins on a sphere, turns over by friction, and rises on its stem."""

import math

from ..core.contacts.contact3d import HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from ..core.elements import RigidBody3D
from ..core.laws.friction import TurningFriction
from ..core.model.attitude import RotationVector
from ..core.model.channels import Parameter
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_model_parameter, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 6e-3, "kg", "mass of the top", 0.0, exclusive=True),
    ScenarioParameter("inertia_across", 8e-7, "kg.m^2", "about axes across that of symmetry", 0.0, exclusive=True),
    ScenarioParameter("inertia_along", 7e-7, "kg.m^2", "about the axis of symmetry", 0.0, exclusive=True),
    ScenarioParameter("radius", 15e-3, "m", "of the sphere that it starts on", 0.0, exclusive=True),
    ScenarioParameter("centre", 3e-3, "m", "of this sphere, along the axis from the centre of mass towards the stem"),
    ScenarioParameter("stem_radius", 5e-3, "m", "of the sphere at the stem's end", 0.0, exclusive=True),
    ScenarioParameter("stem_centre", 16e-3, "m", "of this sphere, along the axis from the centre of mass"),
    ScenarioParameter("tilt", 0.1, "rad", "of the axis against the vertical at the start", 0.0),
    ScenarioParameter("spin", 180.0, "rad/s", "angular velocity at the start"),
    ScenarioParameter(
        "spin_tilt", 0.0, "rad", "angle of the angular velocity against the axis of symmetry, to the side of the tilt"
    ),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=0.0, stiffness=1e5),
    *friction_parameters(0.3, None, 1e-2),
    ScenarioParameter(
        "patch_radius", 5e-4, "m", "of the patch of contact, under constant pressure; 0: a point", 0.0
    ),
)  # fmt: skip
OF_PATCH = Parameter(
    name="friction_radius", unit="m", minimum=0.0, description="of the patch: torque against spinning over friction",
    targets=("floor.turning.friction_radius", "stem.turning.friction_radius"),
)  # fmt: skip


@scenario("tippe_top", "a tippe top spins on a sphere, turns over by friction and rises on its stem", PARAMETERS)
def tippe_top(
    *, mass: float, inertia_across: float, inertia_along: float, radius: float, centre: float, stem_radius: float,
    stem_centre: float, tilt: float, spin: float, spin_tilt: float, gravity: float, law: str, restitution: float,
    stiffness: float, exponent: float, damping: float | None, relaxation_time: float | None, friction: float,
    static_friction: float | None, transition_speed: float, patch_radius: float,
) -> Scenario:  # fmt: skip
    """Body `top`, contacts `floor` (the large sphere) and `stem` at z = 0; figures of Leine and Glocker (2003), and
    their friction, of Coulomb and Contensou: on a patch of contact the spin makes friction against sliding nearly
    viscous, so that a top that spins about its axis slides on, turns over, and rises on its stem. Here friction on the
    patch has an ellipsoid as its limit surface (`friction_radius` of two thirds of the patch's); the stem touches at
    1.373 s, with the integral over the patch in its place at 1.372 s (tests/models/test_tippe_top.py).

    With `patch_radius` 0 it spins on a point. Then a top that spins about its axis rolls after 0.04 s and stays
    upright; one that starts a little beside it (`spin_tilt` 0.1) turns over. A force at a sphere's lowest point has no
    moment along the line from the centre of mass to this point, so that, while only one sphere touches, on a point,
    L.(centre e - radius n) is constant (Jellett): L is the angular momentum, e the axis, n upwards. Friction takes
    energy, and the top lifts its centre of mass. `stem` touches first where
    cos(tilt) = (stem_radius - radius)/(stem_centre - centre).

    Raises ScenarioError if the stem's sphere is in the floor at the start.
    """
    up = math.cos(tilt)
    height = stem_centre * up - stem_radius - (centre * up - radius)
    if height < 0.0:
        raise ScenarioError(
            f"the sphere of the stem starts {-height:g} m in the floor: it must not reach lower than the other one; "
            f"give a larger stem_centre (now {stem_centre:g}), or a smaller stem_radius (now {stem_radius:g}) or tilt "
            f"(now {tilt:g})"
        )
    touch = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=mass,
    )  # fmt: skip
    rubs = contact_friction(
        touch, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    drills = TurningFriction(friction_radius=2.0 / 3.0 * patch_radius) if patch_radius > 0.0 else None
    top = RigidBody3D(
        name="top", mass=mass, inertia=(inertia_across, inertia_across, inertia_along),
        position=(0.0, 0.0, radius - centre * up), attitude=RotationVector(vector=(tilt, 0.0, 0.0)),
        angular_velocity=(0.0, -spin * math.sin(spin_tilt), spin * math.cos(spin_tilt)),
    )  # fmt: skip
    balls = {
        name: Sphere3D(marker=Marker3D(body="top", point=(0.0, 0.0, place)), radius=size)
        for name, place, size in (("floor", centre, radius), ("stem", stem_centre, stem_radius))
    }
    model = Model(
        name="tippe_top",
        gravity=(0.0, 0.0, -gravity),
        bodies=(top,),
        contacts=tuple(
            SphereOnHalfSpace3D(name=name, plane=HalfSpace3D(), sphere=ball, law=touch, friction=rubs, turning=drills)
            for name, ball in balls.items()
        ),
        parameters=(
            *law_model_parameters("floor", touch, "stem"),
            friction_model_parameter("floor", "stem"),
            *(() if drills is None else (OF_PATCH,)),
        ),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0,
        parameters={"damping": getattr(touch, "damping", None)},
        compare=("top.x", "top.y", "top.z", "floor.normal_force", "floor.gap"),
    )
