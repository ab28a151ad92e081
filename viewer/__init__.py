"""Pictures that move: a model and a result as a page to play, a GIF or an MP4.

The scene is data (`scene.py`: shapes, where they are in every frame, events, channels); the player is plain JavaScript
(`page/`). Nothing here runs or changes a model.
"""

from .animation import Animation, animate, show
from .fields import CrossSection
from .sketches import Sketch

__all__ = ["Animation", "CrossSection", "Sketch", "animate", "show"]
