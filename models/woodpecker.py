"""The woodpecker toy: a bird on a spring hops down a pole, held and let go by the friction of its sleeve."""

from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import LinearSystem
from ..core.laws import NewtonImpact
from ..core.laws.friction import CoulombFriction
from ..core.model.channels import Parameter
from ..core.multibody_model import Model
from ..viewer.sketches import Sketch
from .frictions import friction_model_parameter
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

# of the toy that Pfeiffer, Glocker and Leine take; m, kg, N.m/rad
SLEEVE_MASS, SLEEVE_INERTIA = 3e-4, 5e-9
BIRD_MASS, BIRD_INERTIA = 4.5e-3, 7e-7
SPRING = 5.6e-3
POLE_RADIUS, SLEEVE_RADIUS = 2.5e-3, 3.1e-3
SLEEVE_HALF_HEIGHT = 5.8e-3
SPRING_ARM, BIRD_ARM = 10e-3, 15e-3
"""From the sleeve's centre to the spring, and from the spring to the bird's centre of mass."""
BEAK_HEIGHT, BEAK_ARM = 20e-3, 20.1e-3
"""Of the tip of the beak, from the bird's centre of mass."""
START = (0.0, -(SLEEVE_RADIUS - POLE_RADIUS) / SLEEVE_HALF_HEIGHT, -0.2788)
START_RATES = (-0.3411, 0.0, -7.4583)
"""On the periodic motion, the lower edge of the sleeve against the pole (there -0.1036 rad, rounded)."""

PARAMETERS = (
    ScenarioParameter("friction", 0.3, "-", "coefficient of friction at beak and sleeve", 0.0),
    ScenarioParameter("restitution", 0.5, "-", "of the beak; the sleeve has none", 0.0, 1.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
)


@scenario("woodpecker", "a toy bird hops down a pole: impacts, jamming and slipping of a sleeve", PARAMETERS)
def woodpecker(*, friction: float, restitution: float, gravity: float) -> Scenario:
    """Body `toy` with the coordinates `y` of the sleeve, `sleeve` and `bird` (angles); contacts `beak`, `lower`,
    `upper` (edges of the sleeve) with the pole.

    Model and numbers: Glocker, "Dynamik von Starrkoerpersystemen mit Reibung und Stoessen" (1995); Leine, van Campen
    and Glocker, "Nonlinear dynamics and modeling of various wooden toys with impact and friction" (2003). The start is
    on a stable periodic motion: 0.1460 s and 19.5 mm down from peck to peck.
    """
    arm = SPRING_ARM
    mass = (
        (BIRD_MASS + SLEEVE_MASS, BIRD_MASS * arm, BIRD_MASS * BIRD_ARM),
        (BIRD_MASS * arm, SLEEVE_INERTIA + BIRD_MASS * arm**2, BIRD_MASS * arm * BIRD_ARM),
        (BIRD_MASS * BIRD_ARM, BIRD_MASS * arm * BIRD_ARM, BIRD_INERTIA + BIRD_MASS * BIRD_ARM**2),
    )
    toy = LinearSystem(
        name="toy",
        coordinates=("y", "sleeve", "bird"),
        units=("m", "rad", "rad"),
        scales=(0.02, 0.1, 0.3),
        mass=mass,
        stiffness=((0.0, 0.0, 0.0), (0.0, SPRING, -SPRING), (0.0, -SPRING, SPRING)),
        force=tuple(-gravity * x for x in (BIRD_MASS + SLEEVE_MASS, BIRD_MASS * arm, BIRD_MASS * BIRD_ARM)),
        position=START,
        velocity=START_RATES,
    )
    rubbing = CoulombFriction(coefficient=friction)

    def terms(**factors: float) -> tuple[CoordinateTerm, ...]:
        return tuple(CoordinateTerm(body="toy", coordinate=name, factor=value) for name, value in factors.items())

    clearance = SLEEVE_RADIUS - POLE_RADIUS
    contacts = (
        CoordinateContact(
            name="beak",
            offset=SPRING_ARM + BIRD_ARM - BEAK_ARM - POLE_RADIUS,
            terms=terms(bird=-BEAK_HEIGHT),
            slide=terms(y=1.0, sleeve=SPRING_ARM, bird=BIRD_ARM - BEAK_ARM),
            law=NewtonImpact(restitution=restitution),
            friction=rubbing,
        ),
        *(
            CoordinateContact(
                name=name,
                offset=clearance,
                terms=terms(sleeve=side * SLEEVE_HALF_HEIGHT),
                slide=terms(y=1.0, sleeve=SLEEVE_RADIUS),
                law=NewtonImpact(restitution=0.0),
                friction=rubbing,
            )
            for name, side in (("lower", 1.0), ("upper", -1.0))
        ),
    )
    model = Model(
        name="woodpecker",
        gravity=(0.0, -gravity),
        bodies=(toy,),
        contacts=contacts,
        parameters=(
            friction_model_parameter("beak", "lower", "upper"),
            Parameter(name="restitution", minimum=0.0, maximum=1.0, description="of the beak",
                      targets=("beak.law.restitution",)),
        ),
    )  # fmt: skip
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=0.6,
        rtol=1e-8,
        atol=1e-10,
        compare=("toy.y", "toy.sleeve", "toy.bird", "toy.d_bird"),
        sketches=_sketches(),
    )


def _sketches() -> tuple[Sketch, ...]:
    """Pole, sleeve and bird, to first order in the angles, as the model is."""
    height, inner, arm = SLEEVE_HALF_HEIGHT, SLEEVE_RADIUS, SPRING_ARM + BIRD_ARM
    beak = (-BEAK_ARM, BEAK_HEIGHT)
    bird = (
        (-BIRD_ARM, -4e-4), (-4e-3, -1e-3), (-1e-3, -22e-3), (3e-3, -23e-3), (6e-3, -4e-3), (3e-3, 14e-3),
        (-2e-3, 23e-3), (-9e-3, 23.5e-3), beak, (-9e-3, 17.5e-3), (-5e-3, 9e-3), (-5e-3, 1e-3), (-BIRD_ARM, 4e-4),
    )  # fmt: skip
    box = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    # the sleeve is open: two plates, and the arm that carries the spring
    plates = ((-SLEEVE_RADIUS - 6e-4, -SLEEVE_RADIUS), (SLEEVE_RADIUS, SLEEVE_RADIUS + 6e-4))
    y, turn = {"toy.y": 1.0}, {"toy.sleeve": 1.0}
    return (
        Sketch("pole", tuple((POLE_RADIUS * x, 0.075 * y) for x, y in box), at=(0.0, -0.03, 0.0)),
        *(
            Sketch(name, ((low, -height), (high, -height), (high, height), (low, height)), y=y, angle=turn)
            for name, (low, high) in zip(("left plate", "right plate"), plates, strict=True)
        ),
        Sketch("arm", ((inner, -4e-4), (SPRING_ARM, -4e-4), (SPRING_ARM, 4e-4), (inner, 4e-4)), y=y, angle=turn),
        Sketch(
            "bird", bird, at=(arm, 0.0, 0.0), y={"toy.y": 1.0, "toy.sleeve": SPRING_ARM, "toy.bird": BIRD_ARM},
            angle={"toy.bird": 1.0},
        ),
    )  # fmt: skip
