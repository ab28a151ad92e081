"""A scenario: a model, how to run it, and what to look at."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ..core.methods.default import DEFAULT_METHOD
from ..core.multibody_model import Model
from ..core.tolerances import DEFAULT_ATOL
from ..viewer.sketches import Sketch


def _no_entries() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True)
class Scenario:
    """A model ready to run: `simulate(s.model, s.t_end, s.method, s.rtol, s.atol, **s.options)`.

    Attributes
    ----------
    t_end : end time, s.
    method, rtol, atol, options : what `simulate` is called with.
    parameters : values of all parameters of the builder, defaults included.
    given : what the builder was called with: as `parameters`, but None where it was left to the builder.
    sketches : outlines that show generalised coordinates, for animations.
    compare : channels that a cross-check compares and plots.
    """

    name: str
    description: str
    model: Model
    t_end: float
    method: str = DEFAULT_METHOD
    rtol: float = 1e-6
    atol: float = DEFAULT_ATOL
    options: Mapping[str, Any] = field(default_factory=_no_entries)
    parameters: Mapping[str, Any] = field(default_factory=_no_entries)
    compare: tuple[str, ...] = ()
    sketches: tuple[Sketch, ...] = ()
    given: Mapping[str, Any] = field(default_factory=_no_entries)

    def __post_init__(self) -> None:
        # read-only views of copies: a frozen record must not change through a dict that someone else holds
        object.__setattr__(self, "options", MappingProxyType(dict(self.options)))
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        object.__setattr__(self, "given", MappingProxyType(dict(self.given)))
