"""Intermediate update (FMI 3.0): the master looks, and may set inputs or end the step, where the solver's steps end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .errors import CallOrderError
from .variables import Variable

UpdateCallback = Callable[[float, bool], float | None]
"""Called with the time (s) that the solver has reached and whether the step can end early; answers with the time at
which it shall end, or None to go on."""


@dataclass(frozen=True)
class Updates:
    """What a master wants of intermediate updates: a call at each, and the inputs that it may set in them."""

    call: UpdateCallback
    variables: frozenset[int]
    """Value references."""

    def check(self, variables: Sequence[Variable]) -> None:
        """Refuse, with CallOrderError, inputs that the master has not asked for when it made the instance."""
        if others := [v.name for v in variables if v.reference not in self.variables]:
            raise CallOrderError(
                f"in an intermediate update only the required intermediate variables can be set, not {others}: name "
                "them when the instance is made"
            )
