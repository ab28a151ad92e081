"""An animation: a scene that can be saved as a page or a film, and shows itself in a notebook."""

import html
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.errors import ModelError
from ..core.multibody_model import Model
from .build import scene_of_result, scene_of_start
from .fields import CrossSection
from .page_text import page_text
from .scene import SPACE, Scene
from .sketches import Sketch
from .space.gltf import write_glb
from .timing import EVEN

if TYPE_CHECKING:
    from ..core.results.result import Result

KINDS = (".html", ".gif", ".mp4", ".glb")
HEIGHT = 560
"""Of the picture in a notebook, pixels."""


class Animation:
    """A scene to play: `save` writes a page (.html), a film (.gif, .mp4) or, in space, glTF (.glb); a notebook shows
    it by itself.

    Attributes
    ----------
    scene : the data that is shown.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def html(self) -> str:
        """The page as text."""
        return page_text(self.scene)

    def save(self, path: str | Path, **film: Any) -> Path:
        """Write a page, glTF, or a film with the options of `tlismni.viewer.film.write_film` (fps, seconds, width).

        Raises
        ------
        ModelError : for a file of another kind, options of a film for what is none, or glTF of a model in the plane.
        ImportError : for a film without the library that writes it; says what to install.
        """
        target = Path(path)
        kind = target.suffix.lower()
        if kind not in KINDS:
            raise ModelError(f"'{path}' must end in .html (a page to play), .gif or .mp4 (a film), or .glb (glTF)")
        if kind in (".html", ".glb") and film:
            raise ModelError(f"{sorted(film)} are options of films (.gif, .mp4), not of {kind} files")
        if kind == ".html":
            target.write_text(self.html(), encoding="utf-8")
        elif kind == ".glb":
            if self.scene.dimension != SPACE:
                raise ModelError(
                    f"'{path}': glTF is for models in space; for one in the plane take .html, .gif or .mp4"
                )
            write_glb(self.scene, target)
        else:
            from .film import write_film

            write_film(self.scene, target, **film)
        return target

    def __repr__(self) -> str:
        t = self.scene.t
        return f"Animation({self.scene.title!r}, {len(t)} frames, {t[0]:g} to {t[-1]:g} s)"

    def _repr_html_(self) -> str:
        page = html.escape(self.html(), quote=True)
        return (
            f'<iframe srcdoc="{page}" sandbox="allow-scripts" title="{html.escape(self.scene.title, quote=True)}" '
            f'style="width:100%;height:{HEIGHT}px;border:1px solid #8884;border-radius:6px"></iframe>'
        )


def animate(
    result: "Result",
    model: Model | None = None,
    *,
    title: str = "",
    channels: Iterable[str] | None = None,
    outlines: Mapping[str, Sequence[tuple[float, float]]] | None = None,
    sections: Mapping[str, CrossSection] | None = None,
    sketches: Sequence[Sketch] = (),
    points: Mapping[str, tuple[str, ...]] | None = None,
    frames: int = EVEN,
) -> Animation:
    """A run as an animation; parameters as those of `scene_of_result`.

    Raises
    ------
    ModelError : if it is not known of which model the result is, or for what `scene_of_result` refuses.
    """
    found = result.system if model is None else model
    if not isinstance(found, Model) and points:
        found = Model(name="equations" if result.system is not None else "run")
    if not isinstance(found, Model):
        what = "user-written equations" if found is not None else "a model that it does not know"
        raise ModelError(
            f"this result is of {what}: there are no bodies to draw; give the Model as `model`, or points by their "
            "channels, points={'name': ('x', 'y')}, or plot channels with result.plot(...)"
        )
    return Animation(scene_of_result(found, result, title, channels, outlines, sections, sketches, points, frames))


def show(
    model: Model,
    *,
    title: str = "",
    outlines: Mapping[str, Sequence[tuple[float, float]]] | None = None,
    sketches: Sequence[Sketch] = (),
) -> Animation:
    """The start of a model as a picture of the same kind."""
    return Animation(scene_of_start(model, title, outlines, sketches))
