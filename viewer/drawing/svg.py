"""A drawing as SVG."""

from collections.abc import Callable
from typing import Any

from .shapes import Circle, Drawing, Label, Path, Point

NAMESPACE = "http://www.w3.org/2000/svg"
LETTER = 0.62  # width of a letter, of the size of the font


def to_svg(drawing: Drawing, width: int = 640, names: bool = True, title: str = "") -> Any:
    """The `svg` element (lxml), `width` pixels wide; `names` says whether there are labels."""
    from lxml import etree  # only the export needs it

    font = 14.0
    (x0, y0), (x1, y1) = drawing.box()
    scale = width / (x1 - x0)
    labels = [s for s in drawing.shapes if isinstance(s, Label)] if names else []
    places = _apart([_box(label, ((label.at[0] - x0) * scale, (y1 - label.at[1]) * scale), font) for label in labels])
    boxes = [box for _, box in places]
    left = min((b[0] for b in boxes), default=0.0)
    right = max(max((b[2] for b in boxes), default=0.0), width)
    top = min((b[1] for b in boxes), default=0.0)
    bottom = max(max((b[3] for b in boxes), default=0.0), (y1 - y0) * scale)
    left, top = min(left, 0.0), min(top, 0.0)
    view = f"{_n(left)} {_n(top)} {_n(right - left)} {_n(bottom - top)}"
    size = {"width": _n(right - left), "height": _n(bottom - top), "viewBox": view}
    root = etree.Element("svg", size, nsmap={None: NAMESPACE})
    root.set("role", "img")
    if title:
        etree.SubElement(root, "title").text = title

    def place(p: Point) -> Point:
        return (p[0] - x0) * scale, (y1 - p[1]) * scale

    unit = 0.01 * drawing.size * scale
    for shape in (*drawing.behind, *drawing.shapes):
        if not isinstance(shape, Label):
            _shape(root, shape, place, scale, unit)
    for label, (foot, _) in zip(labels, places, strict=True):
        _text(root, label, foot, font)
    return root


def _shape(root: Any, shape: Path | Circle, place: Callable[[Point], Point], scale: float, unit: float) -> None:
    from lxml import etree

    style = {
        "fill": shape.fill or "none",
        "stroke": shape.stroke or "none",
        "stroke-width": _n(shape.width * unit),
    }
    if isinstance(shape, Circle):
        x, y = place(shape.centre)
        etree.SubElement(root, "circle", cx=_n(x), cy=_n(y), r=_n(shape.radius * scale), **style)
        return
    points = " ".join(f"{_n(x)},{_n(y)}" for x, y in map(place, shape.points))
    style |= {"stroke-linejoin": "round", "stroke-linecap": "round"}
    if shape.dashed:
        style["stroke-dasharray"] = _n(2.0 * unit)
    etree.SubElement(root, "polygon" if shape.closed else "polyline", points=points, **style)


_ANCHORS = {"right": ("start", 6.0, 0.35), "left": ("end", -6.0, 0.35), "above": ("middle", 0.0, -0.5),
            "below": ("middle", 0.0, 1.2), "centre": ("middle", 0.0, 0.35)}  # fmt: skip


Box = tuple[float, float, float, float]


def _text(root: Any, label: Label, foot: Point, font: float) -> None:
    from lxml import etree

    anchor = _ANCHORS[label.side][0]
    style = {"x": _n(foot[0]), "y": _n(foot[1]), "font-size": _n(font), "text-anchor": anchor}
    style["font-family"] = "sans-serif"
    # a light edge under it keeps a name readable on lines; not all readers know `paint-order`
    edge = {"fill": "white", "stroke": "white", "stroke-width": "3", "stroke-linejoin": "round", "aria-hidden": "true"}
    etree.SubElement(root, "text", style, **edge).text = label.text
    etree.SubElement(root, "text", style, fill=label.colour).text = label.text


def _box(label: Label, at: Point, font: float) -> tuple[Point, Box]:
    """Where a label's text is anchored, and its left, top, right and bottom, roughly; pixels."""
    anchor, dx, dy = _ANCHORS[label.side]
    wide = LETTER * font * len(label.text) + 6.0
    left = at[0] + dx - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * wide
    base = at[1] + dy * font
    return (at[0] + dx, base), (left, base - font, left + wide, base + 0.3 * font)


def _apart(places: list[tuple[Point, Box]]) -> list[tuple[Point, Box]]:
    """The same places, later ones moved up where they would cover earlier ones."""
    kept: list[tuple[Point, Box]] = []
    for (x, y), (left, top, right, bottom) in places:
        up = 0.0
        for _, (l, t, r, b) in sorted(kept, key=lambda place: -place[1][3]):
            if left < r and l < right and top - up < b and t < bottom - up:
                up = bottom - t
        kept.append(((x, y - up), (left, top - up, right, bottom - up)))
    return kept


def _n(x: float) -> str:
    """A number of pixels."""
    return f"{x:.1f}".rstrip("0").rstrip(".") if abs(x) >= 0.05 else "0"
