"""What is known of a contact's geometry beyond its kernel: enough to bound how far its gap can move within a step."""

from typing import Any

(
    OWN, DISKS, PLANE, SEGMENT, LINEAR, LINE, CABLE, EQUATIONS, SPHERE,
    OUTLINE, RING, ROPE, TURN, STOP, CABLE_IN_SPACE, JOINT,
) = range(16)  # fmt: skip
"""OWN: a gap of which nothing is known; LINEAR: a gap that is linear in the coordinates; EQUATIONS: a gap function
of an `EquationSystem`, which is asked for through the whole system; SPHERE: two shapes in space, such as a sphere and a
half-space; OUTLINE: a disk on a convex outline in the plane; RING: a disk in a round hole; TURN: an end stop of an
angle in the plane; STOP: an end stop or a rope in space; JOINT: the friction of a joint, whose gap is always zero."""
NOT_BOUND = (OWN, EQUATIONS)
"""Kinds of which nothing bounds how far the gap can go within a step."""

_KINDS: dict[Any, int] = {}
MAY_SLEEP = (DISKS, PLANE, SEGMENT, SPHERE)
"""Kinds whose kernels leave out contacts that sleep (`event_detection/contact_sleeping.py`), but those with bristles in
the plane."""


SHOWN = (OWN, DISKS, SPHERE, OUTLINE, RING, ROPE)
"""Kinds whose kernels, in part, go through those elements alone that are asked for (`compiled/kernels.shown`)."""


def are(kind: int, *kernels: Any) -> None:
    """Say, where these kernels (or formulas of gaps) stand, of which kind they are."""
    _KINDS.update(dict.fromkeys(kernels, kind))


def kind_of(kernel: Any) -> int:
    """The kind of a contact with this kernel, or this formula of its gap (not of the record's class, whose heirs may
    bring one of theirs)."""
    return _KINDS.get(kernel, OWN)
