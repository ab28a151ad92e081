"""The page: one HTML file with scene, styles and player in it, which loads nothing."""

import json
from importlib.resources import files
from string import Template

from .scene import SPACE, Scene

COMMON = ("marks.js", "symbols.js", "plots.js", "timeline.js", "controls.js")
PLANE = ("data.js", "camera.js", *COMMON, "draw.js", "main.js")
SOLID = ("three.js", "data.js", "space_camera.js", *COMMON, "space_draw.js", "main.js")
"""In the order in which they stand in the page; they share one scope. three.js is made by `make three`."""
HINTS = {
    2: "Drag to move, wheel or pinch to zoom.",
    SPACE: "Drag to turn, shift and drag to move, wheel or pinch to zoom.",
}


def page_text(scene: Scene) -> str:
    """The whole page as HTML text."""
    folder = files(__package__).joinpath("page")

    def text(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    return Template(text("page.html")).substitute(
        title=_escaped(scene.title),
        style=text("style.css"),
        scene=_in_script(json.dumps(scene.to_data(), separators=(",", ":"), allow_nan=False)),
        hint=HINTS[scene.dimension],
        script="\n".join(text(name) for name in (SOLID if scene.dimension == SPACE else PLANE)),
    )


def _in_script(data: str) -> str:
    """JSON text that cannot end the element that it stands in."""
    return data.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
