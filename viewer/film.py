"""Films: GIF by Pillow, MP4 by imageio-ffmpeg."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..core.errors import ModelError
from ..core.extras import require
from .drawing.png import to_image
from .drawing.shapes import INK
from .scene import SPACE, Scene
from .space.still import still_in_space
from .still import still

LONGEST = 6.0
"""Seconds that a film takes if nobody says."""
MOST_PICTURES = 3000
BACKGROUND = (251, 252, 254)


def write_film(scene: Scene, path: Path, *, fps: int = 25, seconds: float | None = None, width: int = 640) -> None:
    """Write a scene as a GIF or MP4, as the suffix of `path` says.

    Parameters
    ----------
    fps : pictures a second.
    seconds : how long it takes to see it all; left out: real time for runs of 2 to 6 s, else 6 s.
    width : of the pictures, pixels.

    Raises
    ------
    ModelError : for a scene that does not move, or numbers that make no film.
    ImportError : without the library that writes it; says what to install.
    """
    duration = float(scene.t[-1] - scene.t[0])
    if duration <= 0.0:
        raise ModelError("a film needs a run: the picture of a start is a page (.html)")
    length = seconds if seconds is not None else (duration if 2.0 <= duration <= LONGEST else LONGEST)
    count = round(length * fps) if math.isfinite(length) else 0
    if not (fps > 0 and width >= 16 and 2 <= count <= MOST_PICTURES):
        raise ModelError(
            f"fps = {fps!r}, seconds = {length!r} and width = {width!r} give {count} pictures of {width} pixels: "
            f"needed are 2 to {MOST_PICTURES} of at least 16"
        )
    require(f"'{path.name}'", "film", PIL="pillow")
    if path.suffix.lower() == ".gif":
        _gif(_pictures(scene, count, width), path, fps)
    else:
        require(f"'{path.name}'", "film", imageio_ffmpeg="imageio-ffmpeg")
        _mp4(_pictures(scene, count, width), path, fps)


def _pictures(scene: Scene, count: int, width: int) -> Iterator[Any]:
    """Pictures at equal intervals, all of one size."""
    from PIL import ImageDraw

    x0, y0, x1, y1 = scene.box
    margin = 0.06 * max(x1 - x0, y1 - y0, 0.3 * scene.size)
    high = max(y1 - y0 + 2.0 * margin, 0.4 * (x1 - x0 + 2.0 * margin))
    middle = 0.5 * (y0 + y1)
    box = (x0 - margin, middle - 0.5 * high), (x1 + margin, middle + 0.5 * high)
    # tall mechanisms do not make pictures taller than wide
    scale = min(width / (box[1][0] - box[0][0]), width / high)
    # films take even numbers of pixels only
    size = 2 * max(8, round(0.5 * (box[1][0] - box[0][0]) * scale)), 2 * max(8, round(0.5 * high * scale))
    for t in np.linspace(scene.t[0], scene.t[-1], count):
        frame = int(np.clip(np.searchsorted(scene.t, t, side="right") - 1, 0, len(scene.t) - 1))
        drawn = still_in_space(scene, frame) if scene.dimension == SPACE else still(scene, frame)
        picture = to_image(drawn, box, size, BACKGROUND)
        ImageDraw.Draw(picture).text((8, 6), _time(float(t), scene), INK)
        yield picture


def _time(t: float, scene: Scene) -> str:
    """A time with as many digits as the run's length needs, in the unit that suits it."""
    length = max(abs(float(scene.t[0])), abs(float(scene.t[-1])))
    power, unit = next(((p, u) for p, u in ((1.0, "s"), (1e3, "ms"), (1e6, "us")) if length * p >= 1.0), (1e9, "ns"))
    return f"{t * power:.{3 - len(str(int(length * power))) if length * power < 100.0 else 0}f} {unit}"


def _gif(pictures: Iterator[Any], path: Path, fps: int) -> None:
    from PIL import Image

    first, *others = (picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=64) for picture in pictures)
    first.save(path, save_all=True, append_images=others, duration=round(1000 / fps), loop=0, optimize=True)


def _mp4(pictures: Iterator[Any], path: Path, fps: int) -> None:
    import imageio_ffmpeg

    first = next(pictures)
    writer = imageio_ffmpeg.write_frames(str(path), first.size, fps=fps, macro_block_size=2, quality=7)
    writer.send(None)
    try:
        writer.send(np.asarray(first.convert("RGB")).tobytes())
        for picture in pictures:
            writer.send(np.asarray(picture.convert("RGB")).tobytes())
    finally:
        writer.close()
