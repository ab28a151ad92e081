"""A drawing as PNG: the icon that FMI wants beside a drawing in SVG."""

import io
from typing import Any

from .shapes import Circle, Drawing, Label, Point

FINER = 4  # Pillow draws without smoothing: draw this much larger, then shrink


def to_png(drawing: Drawing, pixels: int = 256) -> bytes:
    """A square picture without names, on a transparent ground.

    Raises
    ------
    ImportError : without Pillow.
    """
    out = io.BytesIO()
    to_image(drawing, drawing.box(), (pixels, pixels), (255, 255, 255, 0)).save(out, "PNG", optimize=True)
    return out.getvalue()


def to_image(drawing: Drawing, box: tuple[Point, Point], size: tuple[int, int], ground: tuple[int, ...]) -> Any:
    """What lies in `box` (lower left and upper right corner, m) as a Pillow image without names.

    Parameters
    ----------
    size : width and height, pixels. ground : colour, red, green, blue and, for a transparent one, alpha.

    Raises
    ------
    ImportError : without Pillow.
    """
    from PIL import Image, ImageDraw

    (x0, y0), (x1, y1) = box
    wide, high = FINER * size[0], FINER * size[1]
    scale = min(wide / (x1 - x0), high / (y1 - y0))
    left, top = 0.5 * (wide - (x1 - x0) * scale), 0.5 * (high - (y1 - y0) * scale)
    unit = max(0.01 * drawing.size * scale, max(wide, high) / 95.0 if len(ground) == 4 else 1.5 * FINER)

    def place(p: Point) -> Point:
        return left + (p[0] - x0) * scale, top + (y1 - p[1]) * scale

    image = Image.new("RGBA" if len(ground) == 4 else "RGB", (wide, high), ground)
    canvas = ImageDraw.Draw(image)
    for shape in (*drawing.behind, *drawing.shapes):
        if isinstance(shape, Label):
            continue
        width = max(1, round(shape.width * unit))
        if isinstance(shape, Circle):
            (x, y), r = place(shape.centre), max(shape.radius * scale, unit)
            canvas.ellipse((x - r, y - r, x + r, y + r), shape.fill, shape.stroke, width)
            continue
        points = [place(p) for p in shape.points]
        if shape.closed:
            canvas.polygon(points, shape.fill)
            points = [*points, points[0]]
        if shape.stroke:
            canvas.line(points, shape.stroke, width, joint="curve")
            r = 0.5 * width
            for x, y in points:  # round ends and corners
                canvas.ellipse((x - r, y - r, x + r, y + r), shape.stroke)
    return image.resize(size, Image.Resampling.LANCZOS)
