"""Which contacts two shapes have: one table, to which each contact adds its pair where it stands, a user's own too."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product
from typing import Any

from ..errors import ModelError
from ..model.base import Record
from ..model.markers import Marker2D
from ..model.words import an
from .element import ContactElement

Make = Callable[..., ContactElement]
"""Makes a contact of the fields that those of all pairs have: its name, law, friction and so on."""
Found = Callable[[Any, Any], Iterable[Make]]
"""The contacts of two shapes: several where they touch by corners or by parts."""
Types = type[Record] | tuple[type[Record], ...]
_TABLE: dict[tuple[type, type], Found | str] = {}
_KNOWN: dict[tuple[type, type], tuple[Found, bool] | str | None] = {}
"""What `_find` has found, until the table changes."""
IN_SPACE = (
    "in space all shapes touch spheres and half-spaces, and boxes, convex polyhedra and capsules each other. Give one "
    "of them such shapes in its place; or, if they shall pass through each other, say so: pass_through=[{kinds}]"
)
IN_THE_PLANE = "give one of them disks at its corners, or let them pass through each other (pass_through)"


def pair(contact: type[ContactElement], **shapes: type[Record]) -> None:
    """Say that a contact is that of two shapes: `pair(DiskInRing2D, shape=Ring2D, disk=Disk2D)`.

    Parameters
    ----------
    shapes : the fields that hold its shapes, and of which class these are; shapes of classes that inherit have it too.

    Raises
    ------
    TypeError : for other than two fields, one that the contact does not have, or a class that is no contact.
    """
    if not (isinstance(contact, type) and issubclass(contact, ContactElement)):
        raise TypeError(
            f"a pair is that of a contact, a class that inherits Contact2D or Contact3D, not of {contact!r}: "
            "ScalarContact2D is one made from formulas"
        )
    missing = [name for name in shapes if name not in contact.model_fields]
    if len(shapes) != 2 or missing:
        raise TypeError(
            f"a pair of {contact.__name__} is two of its fields with the classes of their shapes, not "
            f"{sorted(shapes)}: it has {sorted(contact.model_fields)}"
        )
    one, other = shapes

    @touching(*shapes.values())
    def _one_contact(a: Record, b: Record) -> Sequence[Make]:
        return (lambda **more: contact(**{one: a, other: b}, **more),)


def touching(first: Types, second: Types) -> Callable[[Found], Found]:
    """Decorator: the function says which contacts two shapes of these classes have."""

    def register(found: Found) -> Found:
        _add(first, second, found)
        return found

    return register


def no_pair(first: Types, second: Types, remedy: str) -> None:
    """Say that two shapes of these classes have no contact, and what to do."""
    _add(first, second, remedy)


def _add(first: Types, second: Types, what: Found | str) -> None:
    _KNOWN.clear()
    ones, others = (each if isinstance(each, tuple) else (each,) for each in (first, second))
    _TABLE.update(dict.fromkeys(product(ones, others), what))


def contacts_of(a: Any, b: Any) -> Iterable[Make]:
    """The contacts of two shapes.

    Raises
    ------
    ModelError : for two shapes that have no contact.
    """
    kinds = type(a), type(b)
    if kinds not in _KNOWN:
        _KNOWN[kinds] = next(_find(*kinds), None)
    found = _KNOWN[kinds]
    if isinstance(found, tuple):
        return found[0](b, a) if found[1] else found[0](a, b)
    if in_plane(a) != in_plane(b):
        found = "one is of the plane and one of space; make a group of each"
    one, other = (f"{an(type(shape).__name__)} on '{body_of(shape)}'" for shape in (a, b))
    names = f'("{kinds[0].__name__}", "{kinds[1].__name__}")'
    remedy = found or (IN_THE_PLANE if in_plane(a) else IN_SPACE.format(kinds=names))
    raise ModelError(f"{one} and {other} have no contact: {remedy}")


def _find(first: type, second: type) -> Iterator[tuple[Found, bool] | str]:
    """What the table says of two classes, nearest first: the contacts, and whether it names the second one first; or
    the remedy."""
    for a, b in product(first.__mro__, second.__mro__):
        for both, swapped in (((a, b), False), ((b, a), True)):
            what = _TABLE.get(both)
            if what is not None:
                yield what if isinstance(what, str) else (what, swapped)


def in_plane(shape: Any) -> bool:
    """True of shapes of the plane."""
    return isinstance(getattr(shape, "marker", None), Marker2D)


def body_of(shape: Any) -> str:
    """Name of the body, or cable, that a shape belongs to."""
    return str(shape.marker.body if hasattr(shape, "marker") else shape.cable)
