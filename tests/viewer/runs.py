"""Runs that several tests look at, each made once."""

from functools import cache

from tlismni.core import Result, simulate
from tlismni.models import load


@cache
def run(name: str, t_end: float | None = None, **parameters: float | str) -> Result:
    """The result of a scenario."""
    s = load(name, **parameters)
    return simulate(s.model, t_end or s.t_end, s.method, s.rtol, s.atol, **s.options)
