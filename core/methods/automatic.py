"""`method="auto"`, the default: which of the methods, from what the model and its start say.

Measured on the catalogue, on cables and on chains (docs/methods.md), Adams formulas of order 6 to 8 cost least wherever
they are stable, also with impacts: one stage a step. They are stable for a vibration of w (rad/s) only with steps up to
about 0.55/w (order 6), for decay of d (1/s) up to about 1.2/d. Other formulas, stable with any step, are for what the
steps do not resolve:

* vibrations faster than the steps that error control would allow the motion. These are 0.06 of the model's time
  (`assembly/scales.py`) at rtol 1e-2, and fall as rtol^0.3, with a mesh, whose slow waves have to be followed too, as
  rtol^0.6: there Runge-Kutta formulas. Where such a step turns the fastest vibration by `RESOLVED` rad, both cost the
  same; with a mesh `OF_MESH`, measured on cables of 8 to 256 elements;
* decay that is faster than that, which dies out and then limits the steps of an Adams formula for the rest of the run:
  `ebdf`, which has few steps to make then;
* what impacts excite in a mesh with vibrations of many kinds; in one with those of one kind, such as a rod, they are
  what is asked for;
* force laws of contacts, whose stiffness shows only when they close;
* many contacts: after each event a multistep formula starts anew, with five stages a step;
* friction against turning and LuGre's, which let what nearly rests creep: `ebdf`, as for contacts at tight tolerances;
* a model at rest with something stiff in it: nobody knows how slowly it will be moved.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .default import DEFAULT_METHOD, FIXED_STEPS_METHOD
from .method import Formula, Method
from .registry import METHODS

RESOLVED = 8.0
"""Angle of the fastest vibration in a step that error control allows, rad, up to which Adams formulas cost less."""
ALLOWED_STEP, OF_TOLERANCE, AT_TOLERANCE = 0.06, 0.3, 1e-2
"""That step, in parts of the model's time at `AT_TOLERANCE`, and its exponent of the tolerance."""
OF_MESH = 8.5
"""Of a mesh: fastest vibration over the model's rate, times rtol^0.6, up to which Adams formulas cost less."""
MESH_OF_TOLERANCE = 0.6
"""That exponent."""
CRITICAL = 2.0
"""Decay over the vibration that takes the same steps of order 6, 1.2 over 0.55: that of critical damping."""
DIES_OUT = 0.5
"""Decay in a step that error control allows, dimensionless, beyond which Adams formulas may be held by stability."""
MOST_CONTACTS = 7
"""Contacts up to which new starts after events cost less than Runge-Kutta stages throughout."""
ONE_KIND = 100.0
"""Fastest over slowest vibration of single coordinates, up to which they count as of one kind."""
TIGHT = 1e-7
"""Tolerance below which order 8 costs less than order 6, and with contacts `ebdf` less than `WITH_CONTACTS`."""
WITH_CONTACTS = 5
"""Order with contacts: accelerations may jump without an event (a wheel that rolls over the end of a ledge), which
estimates of higher orders judge as of smooth motion. Of 150 such runs for each of four tolerances some erred by 7 to
4400 times the tolerance with orders 6 and 8, none by more than it with order 5. It costs at most 1.2 times the time."""
ROUGH = 3e-4
"""Tolerance above which the stages of `sdirk4`, one after the other, cost less than the coupled ones of `radau3` where
a body has a mesh."""


def _refuse(options: Mapping[str, Any]) -> Formula:
    raise NotImplementedError("method 'auto' is a choice among formulas and has none of its own")


AUTO = Method(
    DEFAULT_METHOD,
    "chosen from the model, its start and the tolerance: adams where steps resolve all vibrations and decay, irk where "
    "they do not and with force laws or many contacts, ebdf for fast decay, with fixed steps and with an option of it; "
    "the result says what was taken, and why",
    dict(METHODS[FIXED_STEPS_METHOD].options),  # given one of these it takes that method
    _refuse,
)
METHOD_NAMES = (*METHODS, AUTO.name)
"""All that `method` may be."""


def described(name: str) -> Method:
    """What is known about one of `METHOD_NAMES`."""
    return AUTO if name == AUTO.name else METHODS[name]


@dataclass(frozen=True)
class Start:
    """What a model and its start say.

    Attributes
    ----------
    contacts : number of contacts, stops and joints with Coulomb friction.
    force_laws : whether any of them is a force law.
    creep : whether the friction of any is a force that lets what nearly rests creep: against turning, or LuGre's.
    rate : inverse of the time in which the start's motion and forces cross the model's lengths, 1/s; 0: all rests.
    vibration : fastest vibration that the stiffness makes possible, rad/s.
    slowest : that of the coordinate whose vibration is the slowest, rad/s.
    decay : fastest decay that the damping makes possible, 1/s.
    waves : whether a body has a mesh or modes.
    """

    contacts: int = 0
    force_laws: bool = False
    creep: bool = False
    rate: float = 0.0
    vibration: float = 0.0
    slowest: float = 0.0
    decay: float = 0.0
    waves: bool = False


@dataclass(frozen=True)
class Choice:
    """A method with its options, and why it was taken: one sentence."""

    method: str
    options: dict[str, Any] = field(default_factory=dict)
    reason: str = ""

    def __str__(self) -> str:
        options = ", ".join(f"{name}={value}" for name, value in self.options.items())
        return f"{self.method}{f' ({options})' if options else ''}: {self.reason}"


def choose_by_settings(options: Mapping[str, Any], step: float | None = None, outer: str = "newton") -> Choice | None:
    """The method for options, a fixed step (s) or None, and an outer loop, if these decide; None: the model does.

    An option of `ebdf`, which was the default before, means `ebdf`; others are left to be refused.
    """
    if options and set(options) <= set(METHODS[FIXED_STEPS_METHOD].options):
        named = ", ".join(repr(name) for name in sorted(options))
        return Choice(FIXED_STEPS_METHOD, dict(options), f"the method that has the option {named}")
    if step is not None:
        return Choice(FIXED_STEPS_METHOD, {}, "steps are fixed, and no tolerance tells how large they may be")
    if outer != "newton":
        return Choice(FIXED_STEPS_METHOD, {}, f"its stages are solved by any outer loop, here '{outer}'")
    return None


def choose_unmeasured(why: str) -> Choice:
    """The method where the figures of the start cannot be had."""
    return Choice(FIXED_STEPS_METHOD, {}, f"the start could not be measured ({why}), and this is the most general one")


def choose(start: Start, rtol: float) -> Choice:
    """The method for a start and a tolerance, with error control."""
    many = _at_contacts(start)
    if not many and _dies_out(start, rtol):
        return Choice(
            "ebdf",
            {},
            f"decay of up to {start.decay:.3g} 1/s dies out long before a step that rtol {rtol:g} allows ends",
        )
    if not many and start.creep:
        why = "friction against turning, or LuGre's, whose stiffness shows only when the motion nearly ends"
        return Choice("ebdf", {}, f"the model has {why}")
    unresolved = many or _unresolved(start, rtol)
    if unresolved:
        rough = start.waves and not start.contacts and rtol > ROUGH
        return Choice(
            "irk", {"tableau": "sdirk4" if rough else "radau3"}, f"{unresolved}, and this is stable with any step"
        )
    if start.contacts and rtol < TIGHT:
        return Choice("ebdf", {}, f"the model has contacts, and rtol {rtol:g} takes an order beyond {WITH_CONTACTS}")
    what = f"the steps that rtol {rtol:g} allows resolve {_fastest(start)[1]}"
    if start.vibration == start.decay == 0.0:
        what = "nothing is stiff or damped"
    elif start.contacts:
        what = f"impacts excite {_fastest(start)[1]}, which the steps have to resolve"
    order = WITH_CONTACTS if start.contacts else 8 if rtol < TIGHT else 6
    return Choice("adams", {"order": order}, f"{what}, so that one stage a step will do")


def _fastest(start: Start) -> tuple[float, str]:
    """The vibration, or what decay is like, in rad/s and in words."""
    if start.decay > CRITICAL * start.vibration:
        return start.decay / CRITICAL, f"decay of up to {start.decay:.3g} 1/s"
    return start.vibration, f"vibrations of up to {start.vibration:.3g} rad/s"


def _at_contacts(start: Start) -> str:
    """Why contacts ask for a one-step formula that is stable with any step; empty if they do not."""
    if start.force_laws:
        return "the model has contacts with force laws, whose stiffness shows only when they close"
    if start.contacts > MOST_CONTACTS:
        return f"the model has {start.contacts} contacts, after whose events multistep formulas start anew"
    if start.contacts and start.waves and start.vibration > ONE_KIND * start.slowest:
        return f"impacts excite vibrations of {start.slowest:.3g} to {start.vibration:.3g} rad/s"
    return ""


def _allowed_step(rtol: float) -> float:
    """The step that error control allows, in parts of the model's time."""
    return float(ALLOWED_STEP * (rtol / AT_TOLERANCE) ** OF_TOLERANCE)


def _dies_out(start: Start, rtol: float) -> bool:
    """Whether there is decay, beyond that of damped vibrations, that may hold the steps of an Adams formula."""
    if start.waves or start.decay <= CRITICAL * start.vibration:
        return False
    return _allowed_step(rtol) * start.decay > DIES_OUT * start.rate


def _unresolved(start: Start, rtol: float) -> str:
    """What the steps of this tolerance do not resolve; empty if there is nothing of that."""
    fastest, what = _fastest(start)
    if fastest == 0.0 or (start.contacts and fastest == start.vibration):
        return ""
    if start.rate == 0.0:
        return f"all rests, so that nobody knows whether the steps will resolve {what}"
    mesh = start.waves and fastest == start.vibration
    if mesh and rtol**MESH_OF_TOLERANCE * fastest <= OF_MESH * start.rate:
        return ""
    if not mesh and _allowed_step(rtol) * fastest <= RESOLVED * start.rate:
        return ""
    return f"rtol {rtol:g} allows steps that do not resolve {what}"
