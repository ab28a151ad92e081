"""What shows a motion: a package beside the core, which says so by an entry point, as `tlismni.viewer` does."""

from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any, Protocol

GROUP, NAME = "tlismni.results", "animate"
"""Of the entry point: a function of a result, its model and options."""


class Animation(Protocol):
    """The motion of a run; a notebook shows it."""

    def save(self, path: Any, **options: Any) -> Any:
        """Write it as a page (.html) or a film (.gif, .mp4); options are those of films."""

    def _repr_html_(self) -> str: ...


def animator() -> Callable[..., Animation]:
    """The function that makes an animation. ImportError where no package has one."""
    for found in entry_points(group=GROUP, name=NAME):
        made: Callable[..., Animation] = found.load()
        return made
    raise ImportError(
        f"no installed package animates results: there is no entry point '{NAME}' of the group '{GROUP}', which "
        "tlismni's own package has; install tlismni again (pip install), or call tlismni.viewer.animate(result)"
    )
