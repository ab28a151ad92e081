"""A result as tables of other libraries, with units."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..extras import require
from .text import name_of

if TYPE_CHECKING:
    from .result import Result


def columns(result: "Result", channels: Iterable[str] | None = None) -> dict[str, np.ndarray]:
    """Time and channels (N,) by name."""
    names = result.channels if channels is None else tuple(channels)
    return {"time": result.t, **{name: result[name] for name in names}}


def units(result: "Result") -> dict[str, str]:
    """Units by column, time included."""
    return {"time": "s", **{channel.name: channel.unit for channel in result.channel_records}}


def descriptions(result: "Result") -> dict[str, str]:
    """What the columns mean."""
    return {"time": "time", **{channel.name: channel.description for channel in result.channel_records}}


def to_pandas(result: "Result", channels: Iterable[str] | None = None) -> Any:
    """A DataFrame with a column a channel over the time; `attrs["units"]` has their units.

    Raises
    ------
    MissingExtraError : without pandas. KeyError : for an unknown channel.
    """
    require("a table of pandas", "data", pandas="")
    import pandas

    found = columns(result, channels)
    index = pandas.Index(found.pop("time"), name="time")
    frame = pandas.DataFrame(found, index=index)
    known = units(result)
    frame.attrs = {"units": {name: known[name] for name in ("time", *found)}, "model": name_of(result)}
    return frame


def events_to_pandas(result: "Result") -> Any:
    """A DataFrame with a row an event. Raises MissingExtraError without pandas."""
    require("a table of pandas", "data", pandas="")
    import pandas

    from ..events import Event

    names = list(Event.__dataclass_fields__)
    return pandas.DataFrame([event.to_dict() for event in result.events], columns=names)


def to_xarray(result: "Result", channels: Iterable[str] | None = None) -> Any:
    """A Dataset over the time, with units and descriptions as attributes.

    Raises
    ------
    MissingExtraError : without xarray. KeyError : for an unknown channel.
    """
    require("a dataset of xarray", "data", xarray="")
    import xarray

    found, known, texts = columns(result, channels), units(result), descriptions(result)
    time = xarray.Variable("time", found.pop("time"), {"units": "s", "long_name": "time"})
    variables = {
        name: xarray.Variable("time", x, {"units": known[name], "long_name": texts[name]}) for name, x in found.items()
    }
    return xarray.Dataset(variables, {"time": time}, {"model": name_of(result), "source": "tlismni"})
