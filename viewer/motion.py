"""Where a model's bodies are in every frame: from a result, or at the start."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..core.elements import BodyElement, FlexibleBody, PlanarFrame
from ..core.elements.flexible_body import Section
from ..core.flexible.section_loads import places
from ..core.interpolation import Between
from ..core.model.markers import GROUND, Marker2D
from ..core.multibody_model import Model
from .drawing.places import Places

if TYPE_CHECKING:
    from ..core.results.result import Result

Floats = NDArray[np.float64]
Table = tuple[Floats, Floats]


class Motion:
    """Coordinates and rates of a model's bodies in F frames.

    Attributes
    ----------
    t : (F,) times, s.
    places : the model at its start, where shapes are made up.
    moves : False for a picture of the start.
    """

    def __init__(self, model: Model, t: Floats, table: Callable[[BodyElement], Table], moves: bool = True) -> None:
        self.model, self.t, self.moves = model, t, moves
        self.places = Places(model)
        self.bodies = self.places.bodies
        self._tables: dict[str, Table] = {name: table(body) for name, body in self.bodies.items()}

    @classmethod
    def at_start(cls, model: Model) -> "Motion":
        """One frame: where the model's records say that it starts, before anything makes the start consistent."""
        bodies = {body.name: body for body in model.bodies}
        inputs = {channel.name: channel.start for channel in model.inputs}

        def table(body: BodyElement) -> Table:
            q, v = body.start_in(bodies, inputs)
            return np.array([q], dtype=float), np.array([v], dtype=float)

        return cls(model, np.zeros(1), table, moves=False)

    @classmethod
    def of_result(cls, model: Model, result: "Result", frames: Between) -> "Motion":
        """The frames of a result, with cubics between its samples.

        Raises
        ------
        KeyError : for a result of another model.
        """

        def table(body: BodyElement) -> Table:
            records = body.coordinate_records()
            q, v, a = (
                np.stack([result[f"{body.name}.{name}"] for name in names], axis=1)
                for names in zip(*((c.name, c.rate, c.acceleration) for c in records), strict=True)
            )
            return frames.cubic(q, v), frames.cubic(v, a)

        return cls(model, frames.t, table)

    def table(self, body: str) -> Table:
        """Coordinates and rates (F, n) of a body."""
        return self._tables[body]

    def coordinate(self, body: str, name: str) -> Floats:
        """One coordinate (F,)."""
        values: Floats = self._tables[body][0][:, self.bodies[body].coordinate_names.index(name)]
        return values

    def frame(self, body: str) -> Floats:
        """x, y, angle (F, 3) of a body's frame; zeros for the ground and for what has none."""
        found = np.zeros((len(self.t), 3))
        found_body = self.bodies.get(body)
        if isinstance(found_body, PlanarFrame):
            columns = [n for n in ("x", "y", "angle") if n in self.bodies[body].coordinate_names]
            for k, name in enumerate(columns):
                found[:, k] = self.coordinate(body, name)
        return found

    def velocity(self, body: str) -> Floats:
        """Of a body's origin (F, 2), m/s."""
        return self._tables[body][1][:, :2]

    def velocity_at(self, marker: Marker2D) -> Floats:
        """Of a marker (F, 2), m/s."""
        if marker.body == GROUND:
            return np.zeros((len(self.t), 2))
        x, y = (self.at(marker) - self.frame(marker.body)[:, :2]).T
        rates = self._tables[marker.body][1]
        turning = rates[:, 2] if "angle" in self.bodies[marker.body].coordinate_names else np.zeros(len(self.t))
        return rates[:, :2] + np.stack([-turning * y, turning * x], axis=1)

    def at(self, marker: Marker2D) -> Floats:
        """Places of a marker (F, 2)."""
        x, y, angle = self.frame(marker.body).T
        c, s = np.cos(angle), np.sin(angle)
        u, w = marker.point
        return np.stack([x + c * u - s * w, y + s * u + c * w], axis=1)

    def direction(self, marker: Marker2D) -> Floats:
        """Angle (F,) of a marker's first axis."""
        angle: Floats = self.frame(marker.body)[:, 2] + marker.angle
        return angle

    def points(self, body: FlexibleBody, points: list[tuple[float, float]]) -> Floats:
        """Places (F, points, 2) of material points, given in the undeformed body."""
        return places(body, points, self._tables[body.name][0])

    def section(self, body: FlexibleBody, s: Floats) -> Section | None:
        """Strains and internal forces at s (m along the axis); None of a body that does not tell them."""
        if type(body).section is FlexibleBody.section:
            return None
        return body.section(s, *self._tables[body.name])
