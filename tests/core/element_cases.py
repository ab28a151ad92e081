"""More elements for the tests of tangents: what stands between two bodies, or a body and the ground."""

from helpers import on
from tlismni.core import (
    AngleStop2D,
    Belt2D,
    CoordinateRelation,
    Disk2D,
    DiskInRing2D,
    KelvinVoigt,
    KnifeEdge2D,
    NewtonImpact,
    PIDController2D,
    Rack2D,
    RelationTerm,
    RelativeLoad2D,
    RelativeMotor2D,
    RevoluteFriction2D,
    Ring2D,
    Rope2D,
    Servo2D,
    Sine,
    SlideFriction2D,
    SlideSpring2D,
    SpringDamper2D,
    TableSpring2D,
    TorsionSpring2D,
)
from tlismni.core.state.modes import ACTIVE, CLOSED

LEFT, RIGHT = on("a", 0.3, -0.2, 0.4), on("b", -0.4, 0.1, -0.3)
ENDS = {"a": LEFT, "b": RIGHT}
GROUNDED = {"a": on("ground", 0.1, -0.2, 0.4), "b": on("p")}
SINE = Sine(amplitude=0.7, angular_frequency=2.0, phase=0.3, offset=0.2)
HARD, SOFT = NewtonImpact(restitution=0.5), KelvinVoigt(stiffness=4.0, damping=0.8)

CASES = {
    "torsion spring": {"forces": [TorsionSpring2D(name="f", **ENDS, stiffness=2.0, damping=0.4, natural_angle=0.3)]},
    "slide spring": {"forces": [SlideSpring2D(name="f", **ENDS, stiffness=2.0, damping=0.4, natural_position=0.3)]},
    "slide spring on ground": {"forces": [SlideSpring2D(name="f", **GROUNDED, stiffness=2.0)]},
    "friction of a revolute joint": {"forces": [RevoluteFriction2D(name="f", **ENDS, torque=0.8, transition_rate=2.0)]},
    "friction of a slide": {"forces": [SlideFriction2D(name="f", **ENDS, force=0.8, transition_speed=2.0)]},
    "table spring": {
        "forces": [
            TableSpring2D(
                name="f", **ENDS, lengths_table=(0.5, 1.0, 2.0, 3.0), forces=(-1.0, 0.2, 1.5, 4.0), damping=0.3
            )
        ]
    },
    "knife edge": {"joints": [KnifeEdge2D(name="j", marker=RIGHT)]},
    "rack": {"joints": [Rack2D(name="j", **ENDS, radius=0.7)]},
    "rack above": {"joints": [Rack2D(name="j", a=RIGHT, b=on("ground", 0.2, 1.0, 0.5), radius=-0.7)]},
    "belt": {"joints": [Belt2D(name="j", **ENDS, radius_a=0.7, radius_b=0.4)]},
    "crossed belt": {"joints": [Belt2D(name="j", **ENDS, radius_a=0.7, radius_b=0.4, crossed=True)]},
    "relation": {
        "joints": [
            CoordinateRelation(
                name="j",
                terms=[
                    RelationTerm(body="a", coordinate="x", factor=2.0),
                    RelationTerm(body="b", coordinate="angle", factor=-0.5),
                    RelationTerm(body="p", coordinate="y"),
                ],
                offset=0.4,
            )
        ]
    },
    **{
        f"{measure} motor": {"joints": [RelativeMotor2D(name="j", **ENDS, motion=SINE, measure=measure)]}
        for measure in ("angle", "slide", "distance")
    },
    **{
        f"{measure} servo": {
            "forces": [Servo2D(name="f", **ENDS, target=SINE, measure=measure, gain=2.0, rate_gain=0.7)]
        }
        for measure in ("angle", "slide", "distance")
    },
    "servo that saturates": {
        "forces": [Servo2D(name="f", **ENDS, target=SINE, measure="distance", gain=2.0, rate_gain=0.7, largest=0.5)]
    },
    **{
        f"controller of {driven} by {sensed}": {
            "forces": [
                PIDController2D(
                    name="f", **ENDS, target=SINE, measure=driven, sensor_a=RIGHT, sensor_b=on("p"), sensed=sensed,
                    gain=2.0, integral_gain=0.9, rate_gain=0.7, largest=largest,
                )
            ]
        }
        for driven, sensed, largest in (
            ("angle", "slide", None), ("slide", "angle", 6.0), ("distance", "distance", 6.0),
            ("slide", "distance", None),
        )
    },
    "controller of what it drives": {
        "forces": [PIDController2D(name="f", **ENDS, target=SINE, gain=-2.0, integral_gain=-0.9, measure="slide")]
    },
    **{
        f"{measure} load": {"forces": [RelativeLoad2D(name="f", **ENDS, load=SINE, measure=measure)]}
        for measure in ("angle", "slide", "distance")
    },
    "spring whose length moves": {
        "forces": [SpringDamper2D(name="f", **ENDS, stiffness=2.0, damping=0.4, natural_length=SINE)]
    },
    "disk in a ring": {
        "contacts": [
            DiskInRing2D(
                name="c", shape=Ring2D(marker=LEFT, radius=0.9), disk=Disk2D(marker=RIGHT, radius=0.5), law=SOFT
            )
        ],
        "mode": ACTIVE,
    },
    "rate servo": {"forces": [Servo2D(name="f", **ENDS, target=SINE, rate_gain=0.7, of_rate=True)]},
    "taut rope": {"contacts": [Rope2D(name="c", **ENDS, length=1.2, law=HARD)], "mode": CLOSED},
    "elastic rope": {"contacts": [Rope2D(name="c", **ENDS, length=1.2, law=SOFT)], "mode": ACTIVE},
    "angle stop": {"contacts": [AngleStop2D(name="c", **ENDS, limit=0.4, law=HARD)], "mode": CLOSED},
    "elastic angle stop": {
        "contacts": [AngleStop2D(name="c", **ENDS, limit=0.4, side="lower", law=SOFT)], "mode": ACTIVE
    },
}  # fmt: skip
