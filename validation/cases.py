"""How each scenario of the catalogue is cross-checked: the parameters with which exudyn can follow, and what cannot be.

A scenario stands here with one case or more: contact as a constraint, contact by force, ... A new scenario that is not
listed is cross-checked with its defaults.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..models import names


@dataclass(frozen=True)
class Case:
    """One cross-check of the catalogue.

    Attributes
    ----------
    parameters : of the scenario.
    t_end : s, if not the scenario's. step : exudyn's in s, if not chosen by the comparison.
    coarse : what changes in the coarse form, for tests: parameters, or `t_end`, `step` and `tolerance` of the
        cross-check.
    why : why these parameters, or why this end.
    whole : whether the whole run is compared too, up to some Lyapunov times (not in the coarse form).
    not_comparable : the reason, if there is nothing in exudyn to compare with; nothing is run then.
    seconds : of the processor, what it takes, roughly; long ones start first.
    cables : elements of the cables that exudyn gets for beams in a floating frame.
    tolerance : relative, of every quantity, if wider than the comparison's own: where the two sides are different
        models of one thing.
    accuracy : (rtol, atol) of our run, if tighter than the scenario's, with which our own error bars are wider than the
        tolerance.
    """

    scenario: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    t_end: float | None = None
    step: float | None = None
    coarse: Mapping[str, Any] = field(default_factory=dict)
    why: str = ""
    not_comparable: str = ""
    seconds: float = 5.0
    cables: int = 8
    tolerance: float = 0.0
    whole: bool = False
    accuracy: tuple[float, float] | None = None

    @property
    def name(self) -> str:
        """Of its files: the scenario and what is set."""
        return "_".join([self.scenario, *(f"{k}-{v}" for k, v in self.parameters.items())]).replace(".", "p")


HALF = "half of a mechanism, whose inputs come from the other half: `split_whole` is compared"
FORCE = {"law": "hunt_crossley"}
DAMPED = {"elements": 100, "damping_time": 4e-6}
COARSE_RODS = {"elements": 40, "damping_time": 2.5e-5}
CRADLE = {"length": 0.05, "gravity": 100.0, "t_end": 0.0395}
"""Short and heavy: the first impacts come after 1/6 of the time, with steps of exudyn that are no smaller."""
RESOLVED = "with damping of the material, which gives the front of the wave a width that the mesh resolves"
SHARP = "without damping the fronts are sharp, which no mesh resolves: the error bars are wider than the tolerance"
GRAZING = "until the rod's end has left the mass; later it grazes it once more, and that depends on the mesh"
CASES: Mapping[str, Sequence[Case]] = {
    "bouncing_ball": (
        Case("bouncing_ball", coarse={"t_end": 1.3}),
        Case("bouncing_ball", FORCE, coarse={"t_end": 1.3}),
        Case("bouncing_ball", {"law": "kelvin_voigt", "stiffness": 1e5}, coarse={"t_end": 1.3},
             why="a force that jumps at the touch"),
        Case("bouncing_ball", {"law": "kelvin_voigt_gap", "stiffness": 1e5, "height": 0.3}, t_end=0.7, step=5e-7,
             seconds=20.0, coarse={"step": 5e-6, "tolerance": 1e-3},
             why="a force that jumps at the touch and at the release: exudyn's fixed steps meet neither, and have to "
             "be small"),
        Case("bouncing_ball", {"law": "tsuji", "stiffness": 1e5}, t_end=1.0, why="a law by user function",
             coarse={"t_end": 0.6, "step": 2e-5}),
    ),
    "pendulum_stop": (
        Case("pendulum_stop", coarse={"t_end": 1.4}),
        Case("pendulum_stop", FORCE, coarse={"t_end": 1.4}),
    ),
    "slider_crank_stop": (
        Case("slider_crank_stop", coarse={"t_end": 0.6}),
        Case("slider_crank_stop", FORCE, coarse={"t_end": 0.6}),
    ),
    "double_pendulum_wall": (
        Case("double_pendulum_wall", coarse={"t_end": 1.2}, whole=True, seconds=25.0),
        Case("double_pendulum_wall", FORCE, coarse={"t_end": 1.2, "step": 1e-5}, whole=True, seconds=25.0),
    ),
    "impact_oscillator": (
        Case("impact_oscillator", t_end=25.0, whole=True, coarse={"t_end": 2.5}, seconds=65.0,
             why="chaotic: the run goes on beyond what can be compared"),
        Case("impact_oscillator", FORCE, t_end=3.0, seconds=25.0, why="compared until the second impact",
             coarse={"step": 2e-5}),
    ),
    "newtons_cradle": (
        Case("newtons_cradle", not_comparable="balls that touch: how the blow goes through them at once is a choice of "
             "the impact law (sequential or simultaneous), while a penalty passes it on as a wave, whatever its "
             "stiffness"),
        Case("newtons_cradle", {"gap": 2e-3, "balls": 3}, t_end=0.3, why="with gaps the impacts come one by one",
             coarse=CRADLE),
        Case("newtons_cradle", {"gap": 2e-3, "balls": 3, "law": "hertz", "stiffness": 1e8}, t_end=0.3,
             why="with gaps the impacts come one by one", coarse=CRADLE),
    ),
    "bricard": (
        Case("bricard", coarse={"t_end": 1.0}, why="exudyn's last hinge leaves free what is redundant"),
    ),
    "spatial_slider_crank": (
        Case("spatial_slider_crank", coarse={"t_end": 1.0}, accuracy=(1e-11, 1e-13), seconds=20.0),
    ),
    "arm_stop": (
        Case("arm_stop", {"law": "hertz"}, t_end=0.25, step=2e-5, seconds=15.0,
             coarse={"step": 1e-4, "tolerance": 1e-3}, why="a blow of the elbow's end stop, by force"),
        Case("arm_stop", {"law": "hertz", "elbow_limit": None}, t_end=0.42, step=2e-5, seconds=15.0,
             coarse={"t_end": 0.3, "step": 1e-4, "tolerance": 1e-3},
             why="without the end stop: a blow of the tip and one of the elbow, by force"),
    ),
    "dropped_box": (
        Case("dropped_box", {"law": "hertz", "stiffness": 1e5}, t_end=0.28, step=2e-5, seconds=15.0,
             coarse={"step": 1e-4, "tolerance": 1e-3}, why="the first blow, on a corner, by force"),
    ),
    "spatial_cradle": (
        Case("spatial_cradle", {"law": "hertz", "stiffness": 1e7}, t_end=0.25, seconds=15.0,
             coarse={"step": 1e-5, "tolerance": 1e-3},
             why="two blows one after the other, outside the plane of the strings"),
    ),
    "spatial_slider_crank_stop": (
        Case("spatial_slider_crank_stop", {"law": "hertz", "stiffness": 1e6}, t_end=0.23, step=2e-5, seconds=10.0,
             coarse={"step": 5e-5, "tolerance": 1e-3},
             why="the first blow on the stop by force"),
    ),
    "spinning_sphere": (
        Case("spinning_sphere", {**FORCE, "transition_speed": 1e-2}, t_end=0.26,
             why="a blow with friction against a velocity of two components; for friction with an exact cone exudyn "
             "has no equal, the closed form is in the tests"),
    ),
    "tippe_top": (
        Case("tippe_top", {"law": "hertz", "patch_radius": 0.0, "spin_tilt": 0.1}, t_end=0.05, step=1e-5, seconds=15.0,
             coarse={"t_end": 0.02, "step": 4e-5, "tolerance": 1e-3},
             why="friction on a patch is not written for exudyn; and the contact begins at rest, where laws that "
             "divide by the approach speed are different laws here and in exudyn, which has no settling speed"),
    ),
    "heavy_top": (Case("heavy_top", coarse={"t_end": 0.3}, accuracy=(1e-12, 1e-14)),),
    "free_body": (Case("free_body", accuracy=(1e-13, 1e-14)),),
    "rolling_disk": (Case("rolling_disk", coarse={"t_end": 0.3}, accuracy=(1e-12, 1e-14)),),
    "chain": (Case("chain", coarse={"t_end": 0.5, "links": 3}),),
    "four_bar": (Case("four_bar", t_end=0.6, why="at 0.7 s it passes its stretched position, where its constraints "
                      "lose rank and exudyn's Newton iteration fails", coarse={"t_end": 0.4}),),
    "pendulum": (Case("pendulum", coarse={"t_end": 2.0}),),
    "slider_crank": (Case("slider_crank", coarse={"t_end": 0.3}),),
    "cable_pendulum": (
        Case("cable_pendulum", {"damping_time": 1e-3}, t_end=0.5, coarse={"t_end": 0.1, "elements": 4},
             why="with damping of the material: without, the fast axial waves that the start excites are compared"),
    ),
    "cantilever": (
        Case("cantilever", {"damping_time": 1e-4}, t_end=0.5, coarse={"t_end": 0.1, "elements": 4},
             why="with damping of the material: without, the fast axial waves that the start excites are compared"),
    ),
    "cable_ground": (
        Case("cable_ground", {"law": "hertz", "elements": 4}, t_end=0.4, coarse={"t_end": 0.25, "step": 1e-4},
             why="by force; hundreds of impacts of nodes without restitution in a chain of waves have no order that a "
             "penalty would keep"),
    ),
    "hub_beam_stop": (
        Case("hub_beam_stop", {"formulation": "ancf", "contact": "ccfm"}, t_end=0.06, step=5e-6, seconds=30.0,
             coarse={"elements": 4, "t_end": 0.03, "step": 4e-5, "tolerance": 2e-3}),
        Case("hub_beam_stop", {"formulation": "ancf"}, t_end=0.065, seconds=60.0,
             coarse={"elements": 4, "t_end": 0.03, "step": 2e-5},
             why="until the tip leaves the stop; it then grazes it once more in the limit, which the penalties of the "
             "three times T do not yet"),
        Case("hub_beam_stop", {"contact": "ccfm", "modes": 16, "speed": 0.2, "start_angle": 0.002}, t_end=0.06,
             step=1e-5, cables=32, coarse={"t_end": 0.03}, seconds=40.0,
             why="our beam in a floating frame, exudyn's of ANCF elements: two models of one beam, the same while its "
             "deflections are small"),
        Case("hub_beam_stop", {"contact": "ccfm", "modes": 16}, t_end=0.06, step=1e-5, cables=32, tolerance=5e-3,
             coarse={"t_end": 0.03}, seconds=20.0,
             why="the same at ten times the speed: the floating frame's deflections are linear, those of ANCF elements "
             "are not; the difference is a hundred times that of the case before, as a second order effect must be"),
    ),
    "flexible_slider_crank_stop": (
        Case("flexible_slider_crank_stop", {**FORCE, "stiffness": 1e6, "axial": True, "modes": 8}, t_end=0.135,
             step=5e-5, cables=16, tolerance=2e-4, seconds=25.0,
             coarse={"t_end": 0.06, "step": 2e-4, "tolerance": 2e-3},
             why="our rod in a floating frame with one damping ratio for all modes, exudyn's of ANCF elements with "
             "damping in proportion to the stiffness, the same in the first mode only; by force, because an impact as "
             "a constraint would find another mass at the end of a rod that stretches"),
    ),
    "rod_wall": (
        Case("rod_wall", {"elements": 100}, coarse={"elements": 20, "tolerance": 1e-2}, why=SHARP),
        Case("rod_wall", DAMPED, coarse=COARSE_RODS, why=RESOLVED),
    ),
    "rod_rod": (
        Case("rod_rod", {"elements": 100}, why=SHARP, coarse={"elements": 40}),
        Case("rod_rod", DAMPED, coarse=COARSE_RODS, why=RESOLVED),
    ),
    "mass_on_rod": (
        Case("mass_on_rod", {"elements": 100}, t_end=1.19e-3, why=f"{SHARP}; {GRAZING}"),
        Case("mass_on_rod", DAMPED, t_end=1.19e-3, why=f"{RESOLVED}; {GRAZING}", coarse=COARSE_RODS),
    ),
    "sphere_beam": (Case("sphere_beam", coarse={"modes": 5}),),
    "stick_slip": (
        Case("stick_slip", seconds=40.0, coarse={"t_end": 0.8, "step": 2.5e-4}),
        Case("stick_slip", {"law": "kelvin_voigt_gap", "stiffness": 1e5, "damping": 600.0, "transition_speed": 1e-2},
             step=2e-4, why="by force, with Brown's and McPhee's friction", coarse={"t_end": 0.6, "step": 1e-3}),
    ),
    "rocking_block": (
        Case("rocking_block", t_end=1.0, seconds=70.0, why="until after the second change of corner",
             coarse={"t_end": 0.35, "step": 2e-4}),
        Case("rocking_block", {"law": "kuwabara_kono", "stiffness": 1e9, "relaxation_time": 6e-4,
                               "transition_speed": 1e-2},
             t_end=0.41, step=5e-6, seconds=35.0, coarse={"step": 2e-5, "tolerance": 1e-3},
             why="by force that begins softly, with Brown's and McPhee's friction; until after the first change of "
             "corner"),
    ),
    "split_whole": (Case("split_whole", coarse={"t_end": 0.1, "step": 2e-5}, seconds=25.0),),
    "split_striker": (Case("split_striker", not_comparable=HALF),),
    "split_wall": (Case("split_wall", not_comparable=HALF),),
    "woodpecker": (
        Case("woodpecker", t_end=0.1, step=5e-6, seconds=45.0, coarse={"t_end": 0.02, "step": 1e-5},
             why="past the peck, up to which the two can be compared; the third opinion goes on through all pecks"),
    ),
}  # fmt: skip


def cases(scenarios: Sequence[str] | None = None) -> tuple[Case, ...]:
    """The cases of these scenarios, of the whole catalogue if left out."""
    chosen = names() if scenarios is None else scenarios
    return tuple(case for name in chosen for case in CASES.get(name, (Case(name),)))
