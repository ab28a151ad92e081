"""Cones and independent directions of an instant, as those of `contact_solvers/planar_contacts.py` and
`contact_solvers/directions.py`."""

from typing import Any

from ..compiled.jit import internal, record_view
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.directions import call_independent
from ..contact_solvers.planar_contacts import CONES_TYPE
from .records import scalars

cones_at = record_view(CONES_TYPE)


@internal
def independent_of(instant: Any, workspace: Any, first: int, second: int, number: int, rank: float) -> int:
    """Positions of those of the first `number` directions in `some` that do not repeat others, to `chosen`; their
    number. They have three classes, as for `independent_directions`. `rank`: part of a direction's inverse mass that
    must be left of it."""
    rows = 3 * scalars(instant).count
    directions, responses = mat(instant.directions, rows, workspace.n), mat(instant.responses, rows, workspace.n)
    some, chosen, work = (
        ivec(instant.some, number),
        ivec(instant.chosen, 3 * instant.most),
        vec(instant.work, instant.work_size),
    )
    return int(call_independent(instant.independent, directions, responses, some, first, second, rank, chosen, work))
