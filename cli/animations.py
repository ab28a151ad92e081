"""Animations as files, and on the screen."""

import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from ..core import Model, Result
from ..models import Scenario, load, names
from ..viewer import Animation, Sketch, animate
from .errors import Failure
from .result_files import replace_whole
from .screen import say


def write_animation(result: Result, scenario: Scenario, path: Path) -> Path:
    """Write the motion of a run, beside the channels that the scenario looks at."""
    wanted = [name for name in scenario.compare if name in result.channels]
    made = animate(result, title=scenario.name, channels=wanted or None, sketches=scenario.sketches)
    return save_animation(made, path)


def sketches_for(result: Result) -> tuple[Sketch, ...]:
    """Sketches of the scenario that a stored result's model is of, if they fit the model still."""
    model = result.system
    if not isinstance(model, Model) or model.name not in names():
        return ()
    coordinates = {f"{body.name}.{name}" for body in model.bodies for name in body.coordinate_names}
    sketches = load(model.name).sketches
    used = {name for sketch in sketches for factors in (sketch.x, sketch.y, sketch.angle) for name in factors}
    return sketches if used <= coordinates else ()


def save_animation(animation: Animation, path: Path, **film: Any) -> Path:
    """Write an animation, whole or not at all."""
    return replace_whole(path, lambda name: animation.save(name, **film))


def deliver(animation: Animation, output: Path | None, name: str) -> None:
    """Write an animation to `output`; without one, open it in the browser.

    Raises
    ------
    Failure : if there is no browser; says where the page is.
    """
    if output is not None:
        save_animation(animation, output)
        say(f"wrote {output}")
        return
    page = Path(tempfile.mkdtemp(prefix="tlismni-")) / f"{name}.html"
    animation.save(page)
    if not webbrowser.open(page.as_uri()):
        raise Failure(f"no browser could be opened: the page is '{page}'; --output writes it where you want it")
    say(f"opened {page}")
