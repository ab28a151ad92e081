"""What an FMU shows of its model: the icon, the terminals beside it, and a scene for models in space."""

import logging

from ..core.multibody_model import Model
from ..viewer import show
from ..viewer.drawing import draw, to_png, to_svg
from ..viewer.scene import SPACE
from ..viewer.space.gltf import to_glb
from .slave import Slave
from .terminals import terminals, terminals_and_icons

SCENE = "resources/scene.glb"
"""Where the scene stands in an FMU."""


def pictures(slave: Slave, fmi_version: str) -> dict[str, bytes]:
    """The icon, and for FMI 3.0 the terminals beside it."""
    from lxml import etree

    drawing, files = draw(slave.model), {}
    try:
        picture = to_png(drawing)
    except ImportError:
        logging.getLogger(__name__).warning(
            "the FMU gets no icon: that needs Pillow, which is not installed (pip install 'tlismni[fmu]')"
        )
        picture = None
    if fmi_version == "2.0":
        return {} if picture is None else {"model.png": picture}
    folder = "terminalsAndIcons"
    if picture is not None:
        files = {f"{folder}/icon.png": picture, f"{folder}/icon.svg": etree.tostring(to_svg(drawing, names=False))}
    if files or terminals(slave.model, slave.variables):
        described = terminals_and_icons(slave.model, slave.variables, bool(files))
        files[f"{folder}/terminalsAndIcons.xml"] = described
    return files


def scene(model: Model) -> dict[str, bytes]:
    """The start of a model in space as glTF, nothing for one in the plane.

    Nodes have the bodies' names, so that a viewer can move them by the outputs BODY.x, .y, .z (translation) and
    BODY.e1, .e2, .e3, .e0 (rotation).
    """
    shown = show(model).scene
    return {SCENE: to_glb(shown)} if shown.dimension == SPACE else {}
