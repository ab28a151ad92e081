"""Channels of a result over the frames: which are shown, and how they go on between samples."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ..core.elements import MaterialPoint2D
from ..core.interpolation import Between
from ..core.multibody_model import Model
from .scene import Floats, Track

if TYPE_CHECKING:
    from ..core.results.result import Result

MOST_NUMBERS = 400_000
"""Values of channels in one page: 2 MB."""
STILL = 1e-9
"""Part of the largest change of a body's coordinates below which another one is none."""
ENERGIES = ("kinetic", "potential", "strain", "dissipation", "impact_loss")


class Tracks:
    """The channels of a result over the frames."""

    def __init__(self, result: "Result", model: Model, frames: Between) -> None:
        self._result, self._model, self._frames = result, model, frames
        self._records = {channel.name: channel for channel in result.channel_records}
        self.struck = frozenset(event.contact for event in result.events)
        """Contacts with events."""
        self._rates: dict[str, str] = {}
        for name in getattr(result.system, "coordinates", ()):  # of user-written equations
            self._rates |= {name: f"d_{name}", f"d_{name}": f"dd_{name}"}
        for body in model.bodies:
            for c in body.coordinate_records():
                self._rates |= {f"{body.name}.{c.name}": f"{body.name}.{c.rate}"}
                self._rates |= {f"{body.name}.{c.rate}": f"{body.name}.{c.acceleration}"}

    def values(self, name: str) -> Floats:
        """A channel (F,): cubics where its rate is a channel too, else straight lines; switches keep their values.

        Raises
        ------
        KeyError : for an unknown channel.
        """
        y = self._result[name]
        if self._records[name].kind != "real":
            return self._frames.held(y)
        rate = self._rates.get(name)
        return self._frames.line(y) if rate is None else self._frames.cubic(y, self._result[rate])

    def rate(self, name: str) -> Floats | None:
        """Rate of a channel (F,); None if it is not a channel too."""
        return self.values_or_none(self._rates.get(name, ""))

    def values_or_none(self, name: str) -> Floats | None:
        """The same; None for a channel that there is not."""
        return self.values(name) if name in self._records else None

    def interesting(self) -> tuple[str, ...]:
        """What to plot of a model that does not say: the last body's motion as far as it moves, the first contacts'
        forces, energies."""
        bodies = [b for b in self._model.bodies if not isinstance(b, MaterialPoint2D)]
        points = [b for b in self._model.bodies if isinstance(b, MaterialPoint2D)]
        shown = (points or bodies)[-1:]
        found = list(getattr(self._result.system, "coordinates", ()))[:4]
        found += self._moving([f"{body.name}.{name}" for body in shown for name in body.coordinate_names[:3]])
        found += [f"{contact.name}.normal_force" for contact in self._model.contacts[:2]]
        return tuple(name for name in (*found, "energy.kinetic") if name in self._records)

    def _moving(self, names: list[str]) -> list[str]:
        """Those that change by more than rounding; all of them where none does."""
        spans = [float(np.ptp(self._result[name])) if name in self._records else 0.0 for name in names]
        found = [name for name, span in zip(names, spans, strict=True) if span > STILL * max(spans)]
        return found or names

    def chosen(self, first: Iterable[str]) -> list[Track]:
        """`first`, then energies, contacts and all others as far as a page can hold them."""
        energies = [f"energy.{name}" for name in ENERGIES]
        contacts = [f"{c.name}.{what}" for c in self._model.contacts for what in ("normal_force", "gap")]
        plain = [name for name in self._records if not name.startswith("residual.")]
        names = dict.fromkeys(n for n in (*first, *energies, *contacts, *plain) if n in self._records)
        most = max(len(tuple(first)), MOST_NUMBERS // max(len(self._frames.t), 1))
        return [self._track(name) for name in list(names)[:most]]

    def _track(self, name: str) -> Track:
        record = self._records[name]
        return Track(name, record.unit, record.description, self.values(name), record.kind != "real")
