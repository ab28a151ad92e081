"""`method="auto"`: which of the methods, from what the model and its start say.

Measured on the catalogue, on cables and on chains (docs/methods.md), Adams formulas of order 6 to 8 cost least wherever
they are stable, also with impacts: one stage a step. They are stable for a vibration of w (rad/s) only with steps up to
about 0.55/w (order 6), for decay of d (1/s) up to about 1.2/d. Runge-Kutta formulas, stable with any step, are for what
the steps do not resolve:

* vibrations and decay faster than the steps that error control would allow the motion. These are 0.06 of the model's
  time (`assembly/scales.py`) at rtol 1e-2, and fall as rtol^0.3: cables of 8 to 128 elements. Where such a step turns
  the fastest vibration by `RESOLVED` rad, both cost the same;
* what impacts excite in a mesh with vibrations of many kinds; in one with those of one kind, such as a rod, they are
  what is asked for;
* force laws of contacts, whose stiffness shows only when they close; damping beyond the critical one;
* many contacts: after each event a multistep formula starts anew, with five stages a step.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .method import Formula, Method
from .registry import METHODS

RESOLVED = 8.0
"""Angle of the fastest vibration in a step that error control allows, rad, up to which Adams formulas cost less."""
ALLOWED_STEP, OF_TOLERANCE, AT_TOLERANCE = 0.06, 0.3, 1e-2
"""That step, in parts of the model's time at `AT_TOLERANCE`, and its exponent of the tolerance."""
CRITICAL = 2.0
"""Decay over the vibration that takes the same steps of order 6, 1.2 over 0.55: that of critical damping."""
MOST_CONTACTS = 7
"""Contacts up to which new starts after events cost less than Runge-Kutta stages throughout."""
ONE_KIND = 100.0
"""Fastest over slowest vibration of single coordinates, up to which they count as of one kind."""
TIGHT = 1e-7
"""Tolerance below which order 8 costs less than order 6."""
ROUGH = 3e-4
"""Tolerance above which the stages of `sdirk4`, one after the other, cost less than the coupled ones of `radau3` where
a body has a mesh."""


def _refuse(options: Mapping[str, Any]) -> Formula:
    raise NotImplementedError("method 'auto' is a choice among formulas and has none of its own")


AUTO = Method(
    "auto",
    "chosen from the model, its start and the tolerance: adams where steps resolve all vibrations and decay, irk where "
    "they do not and with force laws or many contacts; the result says what was taken, and why",
    {},
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
    rate : inverse of the time in which the start's motion and forces cross the model's lengths, 1/s; 0: all rests.
    vibration : fastest vibration that the stiffness makes possible, rad/s.
    slowest : that of the coordinate whose vibration is the slowest, rad/s.
    decay : fastest decay that the damping makes possible, 1/s.
    waves : whether a body has a mesh or modes.
    """

    contacts: int = 0
    force_laws: bool = False
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


def choose(start: Start, rtol: float, step: float | None = None, outer: str = "newton") -> Choice:
    """The method for a start, a tolerance, a fixed step (s) or None, and an outer loop."""
    if step is not None:
        return Choice("ebdf", {}, "the default, since steps are fixed and no tolerance tells how large they may be")
    if outer != "newton":
        return Choice("ebdf", {}, f"the default, whose stages any outer loop solves, here '{outer}'")
    unresolved = _at_contacts(start) or _unresolved(start, rtol)
    if unresolved:
        rough = start.waves and not start.contacts and rtol > ROUGH
        return Choice(
            "irk", {"tableau": "sdirk4" if rough else "radau3"}, f"{unresolved}, and this is stable with any step"
        )
    what = f"the steps that rtol {rtol:g} allows resolve {_fastest(start)[1]}"
    if start.vibration == start.decay == 0.0:
        what = "nothing is stiff or damped"
    elif start.contacts:
        what = f"impacts excite {_fastest(start)[1]}, which the steps have to resolve"
    return Choice("adams", {"order": 8 if rtol < TIGHT else 6}, f"{what}, so that one stage a step will do")


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


def _unresolved(start: Start, rtol: float) -> str:
    """What the steps of this tolerance do not resolve; empty if there is nothing of that."""
    fastest, what = _fastest(start)
    if start.contacts and fastest == start.vibration:
        return ""
    # all rests: what vibrates gives the time, but of a mesh nobody knows which of its waves will
    rate = start.rate if start.rate > 0.0 or start.waves else fastest
    if ALLOWED_STEP * (rtol / AT_TOLERANCE) ** OF_TOLERANCE * fastest <= RESOLVED * rate:
        return ""
    return f"rtol {rtol:g} allows steps that do not resolve {what}"
