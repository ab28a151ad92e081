"""simulate_many: many runs of one model on threads, results as one table."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .batch_result import Runs
from .compiled_model import CompiledModel, compile_model
from .errors import ModelError
from .simulate_one import check_end, check_times
from .worker_threads import in_threads, run_into

Columns = Mapping[str, ArrayLike]

_KEPT = 100_000
"""Elements of variants of the model that are kept between check and run; beyond that they are made twice."""


def simulate_many(
    model: Any,
    parameters: Columns | None,
    t_end: float,
    *,
    start: Columns | None = None,
    inputs: Columns | None = None,
    channels: Iterable[str] | None = None,
    t_eval: ArrayLike | None = None,
    runs: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
    **settings: Any,
) -> Runs:
    """Integrate one model many times from t0 to t_end, with other numbers each time.

    Every run is the one that `simulate` makes of the model with these numbers, bit for bit, whatever the number of
    threads. Steps, event location and impacts that bounce back are computed without Python's lock; what else happens
    at events, and a run's start, is Python and takes its turn.

    Parameters
    ----------
    model : Model, EquationSystem or CompiledModel (`compile_model`), which saves the building at each call.
    parameters : for each name of a parameter, or place of a number ("ball.mass"), its values (runs,), or one for all.
    t_end : end time, s.
    start : the same of coordinates and rates at the start, by the names of their channels ("ball.y", "ball.vy").
    inputs : the same of inputs, which keep these values.
    channels : names of the channels wanted; left out: all.
    t_eval : times (times,) at which channels are wanted, ascending within [t0, t_end]; left out: at t_end.
    runs : number of runs, where no column says it.
    threads : how many work at once; left out: as many as the process may use.
    progress : called with the number of runs done, in the thread of the caller, now and then.
    settings : those of `Simulation` (method, rtol, atol, step, ...), unless `model` is compiled.

    Returns
    -------
    Runs: a table with a row for each run. A run that fails is a row with its cause.

    Raises
    ------
    ModelError : before anything runs, for bad arguments, and for values that the model refuses: says which row.
    """
    if isinstance(model, CompiledModel):
        if settings:
            raise ModelError(f"{sorted(settings)} belong to compile_model: this model is compiled with its settings")
        compiled = model
    else:
        compiled = compile_model(model, **settings)
    check_end(compiled.t0, t_end)
    times = None if t_eval is None else check_times(t_eval, compiled.t0, float(t_end))
    table = _Rows({"parameters": parameters, "start": start, "inputs": inputs}, runs)
    wanted = _channels(compiled, channels)
    variants = _checked(compiled, table)
    found = Runs(table.columns, wanted, table.count, None if times is None else times)
    place = [compiled.channels.index(name) for name in wanted]

    def one(row: int) -> None:
        system = variants[row] if variants else _variant(compiled, table, row)
        start = table.row("start", row)
        run_into(found, row, place, lambda: compiled.run_of(system, start), compiled.t0, float(t_end), times)

    in_threads(one, table.count, threads, progress)
    return found


class _Rows:
    """The columns of parameters, start values and inputs, of one length."""

    def __init__(self, groups: Mapping[str, Columns | None], runs: int | None) -> None:
        given: dict[str, dict[str, NDArray[np.float64]]] = {group: {} for group in groups}
        for group, columns in groups.items():
            if columns is not None and not isinstance(columns, Mapping):
                raise ModelError(
                    f"{group} must be a mapping from names to values, such as {{'mass': [1.0, 2.0]}}, not "
                    f"{type(columns).__name__}"
                )
            for name, values in (columns or {}).items():
                given[group][name] = _column(group, name, values)
        lengths = {name: len(x) for group in given.values() for name, x in group.items() if x.ndim}
        if runs is not None and (isinstance(runs, bool) or not isinstance(runs, int) or runs < 0):
            raise ModelError(f"runs must be a whole number, not {runs!r}")
        counts = set(lengths.values()) | ({runs} if runs is not None else set())
        if len(counts) > 1:
            raise ModelError(
                f"columns must be of one length, or one number for all runs: {lengths}"
                + ("" if runs is None else f", and runs = {runs}")
            )
        self.count = counts.pop() if counts else 1
        self._groups = {
            group: {name: np.broadcast_to(x, (self.count,)) for name, x in columns.items()}
            for group, columns in given.items()
        }
        self.columns: dict[str, NDArray[np.float64]] = {}
        for group, columns in self._groups.items():
            for name, x in columns.items():
                self.columns[f"start.{name}" if group == "start" else name] = x
        if len(self.columns) < sum(map(len, self._groups.values())):
            raise ModelError(f"a parameter and an input have the same name: {[list(x) for x in self._groups.values()]}")

    def row(self, group: str, row: int) -> dict[str, float]:
        """The numbers of one run."""
        return {name: float(x[row]) for name, x in self._groups[group].items()}


def _column(group: str, name: str, values: Any) -> NDArray[np.float64]:
    try:
        x = np.asarray(values)
        if x.dtype.kind not in "fiu" or x.ndim > 1:
            raise ValueError
        x = x.astype(np.float64)
    except (TypeError, ValueError):
        raise ModelError(f"{group}: '{name}' must be a number or a list of numbers (runs,), not {values!r}") from None
    bad = np.flatnonzero(~np.isfinite(np.atleast_1d(x)))
    if len(bad):
        raise ModelError(f"row {bad[0]}: {group}: '{name}' = {np.atleast_1d(x)[bad[0]]}: a finite number is needed")
    return x


def _channels(compiled: CompiledModel, channels: Iterable[str] | None) -> tuple[str, ...]:
    if channels is None:
        return compiled.channels
    if isinstance(channels, str):
        raise ModelError(f"channels must be a list of names, not the text {channels!r}: write [{channels!r}]")
    wanted = tuple(dict.fromkeys(channels))
    unknown = [name for name in wanted if name not in compiled.channels]
    if unknown:
        raise ModelError(f"there are no channels {unknown}; there are {list(compiled.channels)}")
    return wanted


def _variant(compiled: CompiledModel, table: _Rows, row: int) -> Any:
    return compiled.variant(table.row("parameters", row), table.row("inputs", row))


def _checked(compiled: CompiledModel, table: _Rows) -> list[Any]:
    """The system of each run, where they are not too many to be kept; all rows are looked at first.

    Raises
    ------
    ModelError : says which row is refused and why.
    """
    size = len(list(compiled.system.elements())) if hasattr(compiled.system, "elements") else 1
    kept: list[Any] | None = [] if table.count * size <= _KEPT else None
    for row in range(table.count):
        try:
            compiled.check_start(table.row("start", row))
            system = _variant(compiled, table, row)
        except ModelError as error:
            raise ModelError(f"row {row}: {error}") from None
        if kept is not None:
            kept.append(system)
    return kept or []
