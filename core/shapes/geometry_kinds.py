"""What is known of a contact's geometry beyond its kernel: enough to bound how far its gap can move within a step."""

from typing import Any

OWN, DISKS, PLANE, SEGMENT, LINEAR, LINE, CABLE, EQUATIONS, SPHERE = range(9)
"""OWN: a kernel of which nothing is known; LINEAR: a gap that is linear in the coordinates; EQUATIONS: a gap function
of an `EquationSystem`, which is asked for through the whole system; SPHERE: a sphere in space, on another, on a
half-space or a mesh."""

_KINDS: dict[Any, int] = {}
MAY_SLEEP = (DISKS, PLANE, SEGMENT, SPHERE)
"""Kinds whose kernels leave out contacts that sleep (`location/asleep.py`), but those with bristles in the plane."""


def are(kind: int, *kernels: Any) -> None:
    """Say, where these kernels stand, of which kind they are."""
    _KINDS.update(dict.fromkeys(kernels, kind))


def kind_of(kernel: Any) -> int:
    """The kind of a contact with this kernel (not of the record's class, whose heirs may bring a kernel of theirs)."""
    return _KINDS.get(kernel, OWN)
