"""Result of a run: arrays, channels by name, events, statistics."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..assembly.redundancy import RedundantRow
from ..errors import ModelError, UnknownNameError
from ..events import Event, Fallback
from ..model.channels import Channel
from ..multibody_model import Model
from ..state.run_records import LOG_COLUMNS

if TYPE_CHECKING:
    from .animation import Animation


class Table(Protocol):
    """The channels of a run, and where things stand in its samples."""

    channels: tuple[Channel, ...]
    index: dict[str, int]

    @property
    def parts(self) -> Mapping[str, Any]:
        """Columns of q, v, a and the multipliers."""
        ...

    def column(self, samples: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """One channel over all samples."""
        ...

    def plain_columns(self) -> dict[str, int]:
        """Channels that stand in a sample as they are, with their columns."""
        ...

    def contact_table(self, sample: NDArray[np.float64], group: str) -> NDArray[Any]:
        """The contacts of a group that carry force in a sample."""
        ...


class Result:
    """What a run has recorded.

    At an impact there are two samples with the same time: before and after.

    Attributes
    ----------
    events : what happened at contacts (`Event`).
    stats : steps, rejected, outer_iterations, inner_iterations, factorizations, partitions ...; wall_time, s: of the
        run alone, without building the simulation, and without loading and compiling.
    fallbacks : where another outer loop took over (only with fallback=True).
    redundant : constraint rows that others imply (`RedundantRow`): left out of the equations but checked. These
        joints and those that they repeat share their loads as equally compliant ones do.
    system : the Model or EquationSystem of the run; None if it is not known.
    settings : what the run was started with: method, rtol, atol, step ...
    """

    def __init__(
        self,
        samples: NDArray[np.float64],
        table: Table,
        events: Sequence[Event],
        stats: Mapping[str, float],
        fallbacks: Sequence[Fallback] = (),
        step_log: NDArray[np.float64] | None = None,
        redundant: Sequence[RedundantRow] = (),
        system: Any = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        self.samples = samples
        self._table = table
        self.events = list(events)
        self.stats = dict(stats)
        self.fallbacks = tuple(fallbacks)
        self.step_log = step_log
        self.redundant = tuple(redundant)
        self.system = system
        self.settings = dict(settings or {})

    @property
    def method_chosen(self) -> str:
        """What `method="auto"` took, with its options, and why; empty if the method was given."""
        return str(self.settings.get("method_chosen", ""))

    @property
    def t(self) -> NDArray[np.float64]:
        """Times (N,), s."""
        return self.samples[:, 0]

    @property
    def q(self) -> NDArray[np.float64]:
        """Coordinates (N, n)."""
        return self.samples[:, self._table.parts["q"]]

    @property
    def v(self) -> NDArray[np.float64]:
        """Velocities (N, n)."""
        return self.samples[:, self._table.parts["v"]]

    @property
    def a(self) -> NDArray[np.float64]:
        """Accelerations (N, n): those of the equations of motion, at the recorded times."""
        return self.samples[:, self._table.parts["a"]]

    @property
    def multipliers(self) -> NDArray[np.float64]:
        """Multipliers (N, m): joints, then one column a contact (zero while it is open)."""
        return self.samples[:, self._table.parts["multipliers"]]

    def contact_table(self, group: str, at: int = -1) -> NDArray[Any]:
        """The contacts of a group with `most_contacts` that carry force in one sample.

        Parameters
        ----------
        group : its name.
        at : number of the sample; the last one unless given.

        Returns
        -------
        A structured array with the fields contact (name of the pair), point (m), normal, gap (m), normal_force (N),
        friction_force (N) and sliding_velocity (m/s); the normal goes from the first shape, a half-space if there is
        one, to the second.

        Raises
        ------
        UnknownNameError : for a group without `most_contacts`.
        IndexError : for a sample that there is not.
        ModelError : of a result that comes from a file.
        """
        return self._table.contact_table(self.samples[at], group)

    @property
    def steps(self) -> dict[str, NDArray[np.float64]]:
        """What each accepted step took, arrays (steps,) by name: t (its end, s), h (s), error (norm; at most 1), k
        (of a multistep formula), rejected (trials before it), outer, inner, factorizations, evaluations and krylov.

        Raises
        ------
        ModelError : if they were not asked for (`step_records=True`).
        """
        if self.step_log is None:
            raise ModelError("no per-step records were kept: ask for them with simulate(..., step_records=True)")
        columns = dict(zip(LOG_COLUMNS, self.step_log.T, strict=True))
        running = ("outer", "inner", "factorizations", "evaluations", "krylov")
        return {name: np.diff(x, prepend=0.0) if name in running else x.copy() for name, x in columns.items()}

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(channel.name for channel in self._table.channels)

    @property
    def channel_records(self) -> tuple[Channel, ...]:
        """The channels with units and descriptions."""
        return self._table.channels

    @property
    def layout(self) -> Mapping[str, Any]:
        """Columns of `samples` that are q, v, a and the multipliers."""
        return self._table.parts

    def plain_columns(self) -> dict[str, int]:
        """Channels that stand in `samples` as they are, with their columns."""
        return self._table.plain_columns()

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """One channel (N,). Raises KeyError with the nearest names, or what a body of this name has."""
        if name == "time":
            return self.t
        if name not in self._table.index:
            from .names import unknown_channel

            raise UnknownNameError(unknown_channel(name, self.channels))
        return self._table.column(self.samples, name)

    def __len__(self) -> int:
        return len(self.samples)

    def to_dict(self, channels: Sequence[str] | None = None) -> dict[str, Any]:
        """Plain data: times, channels, events, statistics."""
        names = self.channels if channels is None else channels
        return {
            "t": self.t.tolist(),
            "channels": {name: self[name].tolist() for name in names},
            "events": [event.to_dict() for event in self.events],
            "stats": self.stats,
        }

    # ---- to read ----------------------------------------------------------------------------------------------------

    def __repr__(self) -> str:
        from .text import summary

        return summary(self)

    def _repr_html_(self) -> str:
        from .text import summary_html

        return summary_html(self)

    def event_list(self, most: int | None = None) -> str:
        """The events as a table of text, the first `most` of them."""
        from .text import event_list

        return event_list(self, most)

    # ---- to see -----------------------------------------------------------------------------------------------------

    def animate(self, path: str | Path | None = None, *, model: Model | None = None, **options: Any) -> "Animation":
        """The motion as a page to play (.html), or a film (.gif, .mp4); in a notebook it shows itself.

        Parameters
        ----------
        path : where to write it; left out: nowhere.
        model : of the run, where the result does not know it.
        options : title, channels (to plot at first), outlines (polygons of bodies, m), sections (for stress), sketches,
            points (by their channels), frames; of films fps, seconds and width. See `tlismni.viewer.animate` and
            `tlismni.viewer.film.write_film`.

        Raises
        ------
        ModelError : for a result of user-written equations, or options that do not fit.
        ImportError : for a film without the library that writes it, and where no installed package animates results.
        """
        from .animation import animator

        film = {name: options.pop(name) for name in ("fps", "seconds", "width") if name in options}
        made = animator()(self, model, **options)
        if path is not None:
            made.save(path, **film)
        return made

    def plot(self, *channels: str, path: str | Path | None = None) -> Any:
        """A matplotlib figure with a panel a channel; written to `path` if given. KeyError for an unknown one."""
        from .plots import plot_channels, written

        return written(plot_channels(self, channels), path)

    def plot_phase(self, x: str, y: str, path: str | Path | None = None) -> Any:
        """A figure with channel `y` over channel `x`: a phase portrait."""
        from .plots import plot_phase, written

        return written(plot_phase(self, x, y), path)

    def plot_energy(self, path: str | Path | None = None) -> Any:
        """A figure of the energy ledger: stored, put in, lost, and what does not add up."""
        from .plots import plot_energy, written

        return written(plot_energy(self), path)

    # ---- for others, and to go on ------------------------------------------------------------------------------------

    def to_pandas(self, channels: Sequence[str] | None = None) -> Any:
        """A DataFrame of the channels over the time, units in `attrs`."""
        from .tables import to_pandas

        return to_pandas(self, channels)

    def events_to_pandas(self) -> Any:
        """A DataFrame with a row an event."""
        from .tables import events_to_pandas

        return events_to_pandas(self)

    def to_xarray(self, channels: Sequence[str] | None = None) -> Any:
        """A Dataset of the channels over the time, with units and descriptions."""
        from .tables import to_xarray

        return to_xarray(self, channels)

    def save(self, path: str | Path) -> Path:
        """Store everything as .npz; `load_result` gives it back bit for bit. Raises ModelError for another suffix."""
        from .files import save

        return save(self, path)

    def export(self, path: str | Path, channels: Sequence[str] | None = None) -> Path:
        """Write channels for others: .csv, .json, .parquet, .nc (NetCDF) or .h5 (HDF5)."""
        from .files import export

        return export(self, path, channels)

    def start_at(self, t: float | None = None) -> dict[str, float]:
        """Coordinates and rates at a recorded time (left out: the last), for `simulate(..., start_values=...)`."""
        from .restart import start_at

        return start_at(self, t)

    def model_at(self, t: float | None = None) -> Model:
        """The model, starting where the run was at a recorded time (the last one if left out).

        Raises
        ------
        ModelError : for a body whose record cannot say it, such as a cable that swings: `start_at` can.
        """
        from .restart import model_at

        return model_at(self, t)
