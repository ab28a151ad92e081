"""Drawings of mechanisms: all scenarios can be drawn, and what is drawn is where the model says."""

import math
import struct

import pytest
from fmu_helpers import ball_model
from tlismni.core.elements import Gear2D, RigidBody2D
from tlismni.core.model.markers import Marker2D
from tlismni.core.multibody_model import Model
from tlismni.models import load, names
from tlismni.viewer.drawing import draw, to_png, to_svg
from tlismni.viewer.drawing.mechanism import add_surroundings, round_length
from tlismni.viewer.drawing.shapes import TOUCH, Circle, Label, Path, hull


@pytest.mark.parametrize("name", names())
def test_every_scenario_can_be_drawn(name):
    model = load(name).model
    drawing = draw(model)
    add_surroundings(drawing, model)
    svg = to_svg(drawing, title=name)
    width, height = (float(svg.get(key)) for key in ("width", "height"))
    assert 640 <= width < 1200 and 100 < height < 1200
    for element in svg.iter("{*}polyline", "{*}polygon"):
        values = [float(x) for pair in element.get("points").split() for x in pair.split(",")]
        assert len(values) >= 4 and all(-1.0 <= x <= max(width, height) + 1.0 for x in values)
    assert any(isinstance(s, Label) for s in drawing.shapes)


def test_parts_are_where_the_model_says():
    """The crank's pins are a crank's length apart, the ball is at its height above the floor's line."""
    model = load("slider_crank").model
    pins = [s.centre for s in draw(model).shapes if isinstance(s, Circle) and s.fill == "white" and s.width == 0.45]
    by_name = {j.name: j for j in model.joints}
    length = 2.0 * math.dist(model.bodies[0].position, (0.0, 0.0))
    assert len(pins) == 3 and len(by_name) == 4
    assert min(abs(math.dist(a, b) - length) for a in pins for b in pins) < 1e-12
    drawing = draw(ball_model(height=0.75))
    (floor,) = [s for s in drawing.shapes if isinstance(s, Path) and s.stroke == TOUCH]
    assert {y for _, y in floor.points} == {0.0}
    assert (0.0, 0.75) in [s.centre for s in drawing.shapes if isinstance(s, Circle)]


def test_gears_are_their_pitch_circles():
    centres = (0.0, 0.0), (0.5, 0.0)
    bodies = [
        RigidBody2D(name=name, mass=1.0, inertia=1.0, position=centre)
        for name, centre in zip("ab", centres, strict=True)
    ]
    ring = Gear2D(name="gear", a=Marker2D(body="a"), b=Marker2D(body="b"), radius_a=-0.8, radius_b=0.3)
    drawing = draw(Model(bodies=bodies, joints=[ring]))
    circles = {(shape.centre, round(shape.radius, 12)) for shape in drawing.behind if isinstance(shape, Circle)}
    assert {(centres[0], 0.8), (centres[1], 0.3)} <= circles
    # the whole ring is in the picture
    assert drawing.size >= 1.6


def test_a_picture_of_the_size_asked():
    data = to_png(draw(load("pendulum_stop").model), 128)
    assert data.startswith(b"\x89PNG") and struct.unpack(">II", data[16:24]) == (128, 128)


def test_a_model_without_extent():
    """One body at the origin, and none at all."""
    lone = Model(bodies=[RigidBody2D(name="b", mass=1.0, inertia=0.01)])
    for model in (lone, Model()):
        drawing = draw(model)
        add_surroundings(drawing, model)
        assert to_svg(drawing).get("viewBox") and to_png(drawing)


def test_hull_and_round_lengths():
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0)]
    assert hull(square) == [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    assert hull([(0.0, 0.0), (1.0, 1.0), (0.5, 0.5)]) == [(0.0, 0.0), (1.0, 1.0)]
    assert [round_length(x) for x in (0.3, 1.0, 7.0, 0.06)] == [0.2, 1.0, 5.0, 0.05]
