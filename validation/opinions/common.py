"""From laws of the vocabulary to those of `mechanism`, and from a course to an opinion."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ...core.laws import ContactLaw, ForceLaw, ImpactLaw
from ..third_opinion import Opinion
from ..translation.formulas import friction_force, normal_force
from .mechanism import Blow, Course, Law


def law_of(law: ContactLaw, friction: Any = None) -> Law:
    """The law with formulas of its own; `friction` is a regularised one, or none."""
    if isinstance(law, ForceLaw):
        force, least = normal_force(law), law.least_approach_speed()
        rubs = None if friction is None else friction_force(friction)
        return Law(force=lambda d, dd, v0: force(d, dd, max(v0, least)), release=law.release, friction=rubs)
    if isinstance(law, ImpactLaw):
        return Law(restitution=law.restitution)
    raise TypeError(f"a contact law is an ImpactLaw or a ForceLaw, not {type(law).__name__}")


def opinion_on(
    course: Course, contacts: Sequence[str], channels: Mapping[str, Callable[[float], float]], source: str
) -> Opinion:
    """The blows of the course, named as the rows of the comparisons name them, and its channels."""
    values: dict[str, float] = {}
    for k, name in enumerate(contacts):
        own = [blow for blow in course.blows if blow.contact == k]
        if own:
            values |= _first(name, own[0])
    for count, blow in zip(("first", "second"), course.blows, strict=False):
        values[f"{contacts[blow.contact]}: time of the {count} impact"] = blow.start
    return Opinion(source, values, channels)


def _first(name: str, blow: Blow) -> dict[str, float]:
    found = {
        "start": blow.start, "approach speed": blow.approach_speed, "impulse": blow.impulse,
        "separation speed": blow.separation_speed, "momentum": blow.impulse,
    }  # fmt: skip
    if blow.end > blow.start:
        found |= {"duration": blow.end - blow.start, "peak force": blow.peak_force}
    return {f"{name}: {what}": value for what, value in found.items()}
