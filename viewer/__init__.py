"""Pictures that move: a model and a result as a page to play, a GIF or an MP4.

The scene is data (`scene.py`: shapes, where they are in every frame, events, channels); the player is plain JavaScript
(`page/`). Nothing here runs or changes a model.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .animation import Animation, animate, show
    from .fields import CrossSection
    from .sketches import Sketch

__all__ = ["Animation", "CrossSection", "Sketch", "animate", "show"]

_HOMES = {
    "Animation": "animation",
    "CrossSection": "fields",
    "Sketch": "sketches",
    "animate": "animation",
    "show": "animation",
}


def __getattr__(name: str) -> Any:
    """What is drawn with is imported when it is asked for: scenarios have sketches, and most runs draw nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f".{_HOMES[name]}", __name__), name)
