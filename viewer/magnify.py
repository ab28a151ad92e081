"""Elastic rods: micrometres beside metres, so their displacements and gaps are drawn magnified."""

import numpy as np

from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import AxialRod
from .motion import Motion
from .scene import Floats

VISIBLE = 0.08
"""The largest displacement as drawn, in parts of the shortest rod."""


class Magnified:
    """How places along x are drawn in a model with rods.

    A rod's node is drawn at its place at the start plus `factor` times its displacement. Rods that follow one another
    are drawn apart by the magnified gap, and what touches a rod where the rod's node would be if the gap were closed,
    so that things touch in the picture when they touch.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        rods = [body for body in motion.model.bodies if isinstance(body, AxialRod)]
        x = {rod.name: motion.table(rod.name)[0] for rod in rods}
        largest = max((float(np.max(np.abs(q - q[0]))) for q in x.values()), default=0.0)
        shortest = min((rod.length for rod in rods), default=1.0)
        wanted = VISIBLE * shortest / largest if largest > 0.0 else 1.0
        self.factor = max(1.0, float(f"{wanted:.1g}"))
        self._shift: dict[str, float] = {}
        shift, end = 0.0, None
        for name in sorted(x, key=lambda name: float(x[name][0, 0])):
            if end is not None:
                shift += (self.factor - 1.0) * (float(x[name][0, 0]) - end)
            end = float(x[name][0, -1])
            self._shift[name] = shift

    @property
    def note(self) -> str:
        """What a reader must know; empty where nothing is magnified."""
        return f"Displacements along the rods are drawn {self.factor:g} times as large." if self.factor > 1.0 else ""

    def rod(self, rod: str, x: Floats) -> Floats:
        """Where places x (F, P) of a rod's points are drawn."""
        return self._shift[rod] + x[:1] + self.factor * (x - x[:1])

    def node(self, rod: str, coordinate: str, x: Floats) -> Floats:
        """Where something is drawn that is at x (F,), seen from a node of a rod."""
        start = self.motion.coordinate(rod, coordinate)[0]
        found: Floats = self._shift[rod] + start + self.factor * (x - start)
        return found

    def touched(self, contact: CoordinateContact) -> tuple[CoordinateTerm, Floats] | None:
        """The term of a rod in a contact, and where its node would be if the gap were closed (F,), as it is drawn; None
        of a contact with no rod, or with two."""
        own = [t for t in contact.terms if t.body in self._shift and t.coordinate.startswith("x")]
        if len(own) != 1 or not own[0].factor:
            return None
        face = np.full(len(self.motion.t), -contact.offset / own[0].factor)
        for term in contact.terms:
            if term is not own[0]:
                face = face - term.factor / own[0].factor * self.motion.coordinate(term.body, term.coordinate)
        return own[0], self.node(own[0].body, own[0].coordinate, face)

    def beside(self, body: str) -> Floats | None:
        """Where a body is drawn that touches a rod (F,); None of one that touches none."""
        for contact in self.motion.model.contacts:
            if isinstance(contact, CoordinateContact) and any(t.body == body for t in contact.terms):
                found = self.touched(contact)
                if found is not None:
                    return found[1]
        return None
