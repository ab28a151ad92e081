"""Bases of the shapes that touch, a user's own too."""

from inspect import get_annotations
from typing import Annotated, Any, ClassVar

from ..lazy_import import RecordsOf
from ..model.open_union import OpenRecord, OpenUnion


class Shape(OpenRecord):
    """Base of both kinds. A subclass of one of this library's shapes is read from a model file as that shape, since a
    contact's fields name them, unless it says its own `type`."""

    own_type: ClassVar[bool] = False
    """True: its subclasses have types of their own, as other records do."""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        said = any("type" in get_annotations(base) for base in cls.__mro__[1:])
        super(OpenRecord if said and not cls.own_type else Shape, cls).__pydantic_init_subclass__(**kwargs)


class Shape2D(Shape):
    """Base of the shapes of the plane: what inherits from it may stand in a `ContactGroup2D`.

    It has a `marker`. For drawings it may say its `outline()`, corners (x, y) along the axes of its marker, m. What it
    touches `pair` and `touching` say, where their contact stands (`pair_table.py`).
    """


class Shape3D(Shape):
    """The same in space: for a `ContactGroup3D`.

    For drawings it may say its `surface()`: corners (x, y, z) along the axes of its marker, m, and triangles, three
    numbers of corners each, counter-clockwise from outside.
    """


AnyShape2D = Annotated[Shape2D, OpenUnion(RecordsOf(str(__package__), Shape2D), Shape2D)]
AnyShape3D = Annotated[Shape3D, OpenUnion(RecordsOf(str(__package__), Shape3D), Shape3D)]
