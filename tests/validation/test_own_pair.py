"""A pair of shapes that `own_ledge.py` adds from outside of the package has all that the library's pairs have."""

import logging
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from own_ledge import DiskOnLedge2D, Ledge2D
from tlismni.core import (
    Box2D,
    ContactGroup2D,
    CoulombFriction,
    Disk2D,
    DiskOnBox2D,
    DiskOnPolygon2D,
    HalfPlane2D,
    KelvinVoigt,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Polygon2D,
    RigidBody2D,
    ScalarContact2D,
    Segment2D,
    contacts_between,
    scalar_contact,
    simulate,
)
from tlismni.core.contacts.pair_table import pair, touching
from tlismni.fmu_wrapper.slave import Slave
from tlismni.validation import NotTranslatable, crosscheck
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.viewer import animate
from tlismni.viewer.drawing.mechanism import draw
from tlismni.viewer.drawing.shapes import Path

G, MASS, RADIUS, MU = 9.81, 0.8, 0.1, 0.2
SPEED = 1.5


def wheel(position, velocity=(0.0, 0.0)):
    return RigidBody2D(
        name="wheel", mass=MASS, inertia=0.5 * MASS * RADIUS**2, position=position, velocity=velocity
    )  # fmt: skip


def on_ledge(law, friction=None, **body):
    """A wheel and the table, their contact found by their shapes."""
    shapes = [Ledge2D(), Disk2D(marker=Marker2D(body="wheel"), radius=RADIUS)]
    contacts = contacts_between("at", shapes, law=law, friction=friction)
    assert [type(contact) for contact in contacts] == [DiskOnLedge2D]
    return Model(bodies=[wheel(**body)], contacts=contacts, gravity=(0.0, -G))


@pytest.fixture(scope="module")
def sliding():
    """A wheel that slides until it rolls, and falls over the edge at the end."""
    model = on_ledge(NewtonImpact(restitution=0.0), CoulombFriction(coefficient=MU), position=(-1.0, RADIUS),
                     velocity=(SPEED, 0.0))  # fmt: skip
    return simulate(model, 0.6, rtol=1e-9, atol=1e-11)


def test_it_slides_with_friction_and_then_rolls(sliding) -> None:
    """Of a disk v falls from v_0 to 2/3 v_0, where it rolls."""
    until = SPEED / (3.0 * MU * G)
    assert sliding["wheel.vx"][-1] == pytest.approx(2.0 / 3.0 * SPEED, rel=1e-7)
    assert sliding["wheel.angular_velocity"][-1] == pytest.approx(-2.0 / 3.0 * SPEED / RADIUS, rel=1e-7)
    (stick,) = [event.t for event in sliding.events if event.kind == "stick"]
    assert stick == pytest.approx(until, rel=1e-7)
    friction = sliding["at_ground_wheel.friction_force"][sliding.t < 0.9 * until]
    assert friction == pytest.approx(-MU * MASS * G, rel=1e-7)


def test_it_bounces() -> None:
    height, restitution = 0.3, 0.6
    model = on_ledge(NewtonImpact(restitution=restitution), position=(-1.0, RADIUS + height))
    result = simulate(model, 0.3, rtol=1e-9, atol=1e-11)
    speed = math.sqrt(2.0 * G * height)
    (impact,) = [event for event in result.events if event.kind == "impact"]
    assert impact.t == pytest.approx(speed / G, rel=1e-8)
    assert impact.impulse == pytest.approx((1.0 + restitution) * MASS * speed, rel=1e-8)


def test_a_force_law_and_bristles_carry_it() -> None:
    """The wheel sinks in by m g/k, and LuGre friction brings it to rolling."""
    stiffness = 2e4
    friction = LuGreFriction(coefficient=MU, static_coefficient=MU, stribeck_speed=0.1, bristle_stiffness=1e5,
                             bristle_damping=100.0)  # fmt: skip
    model = on_ledge(KelvinVoigt(stiffness=stiffness, damping=100.0), friction,
                     position=(-2.0, RADIUS - MASS * G / stiffness), velocity=(SPEED, 0.0))  # fmt: skip
    result = simulate(model, 0.8)
    assert result["at_ground_wheel.normal_force"][-1] == pytest.approx(MASS * G, rel=1e-3)
    assert result["wheel.vx"][-1] == pytest.approx(2.0 / 3.0 * SPEED, rel=1e-2)
    assert result["wheel.vx"][-1] == pytest.approx(-RADIUS * result["wheel.angular_velocity"][-1], rel=1e-3)


def test_no_touch_is_missed(caplog) -> None:
    """The wheel flies past the edge, over which it would be in for 7 ms of a step of 0.2 s."""
    grazing = 0.999 * RADIUS
    at = grazing * math.sqrt(0.5)
    model = on_ledge(NewtonImpact(restitution=1.0), position=(at - 1.0, at + 1.0), velocity=(20.0, -20.0))
    model = model.model_copy(update={"gravity": (0.0, 0.0)})
    with caplog.at_level(logging.WARNING):
        result = simulate(model, 0.2, method="hht", step=0.2)
    assert "nothing bounds" not in caplog.text
    (impact,) = [event for event in result.events if event.kind == "impact"]
    # the centre comes along the diagonal, and is RADIUS from the edge half a chord before the middle
    chord = math.sqrt(RADIUS**2 - grazing**2)
    assert impact.t == pytest.approx((math.sqrt(2.0) - chord) / (20.0 * math.sqrt(2.0)), abs=1e-9)


def test_the_viewer_shows_it(sliding) -> None:
    scene = animate(sliding).scene
    outline = Ledge2D().outline()
    assert any(isinstance(s, Path) and tuple(s.points) == outline for part in scene.parts for s in part.shapes)
    (arrow,) = [arrow for arrow in scene.arrows if arrow.kind == "contact"]
    row = int(np.argmin(np.abs(scene.t - 0.1)))
    assert arrow.at[row] == pytest.approx((np.interp(0.1, sliding.t, sliding["wheel.x"]), 0.0), abs=2e-2)
    assert arrow.at[row, 1] == pytest.approx(0.0, abs=1e-6)
    assert arrow.vector[row] == pytest.approx((-MU * MASS * G, MASS * G), rel=1e-6)
    assert any(isinstance(s, Path) and s.closed for s in draw(sliding.system).shapes)


def test_it_stands_in_a_group(sliding, tmp_path) -> None:
    """Beside shapes of the library, from a file too, whose contacts are those that `contacts_between` makes."""
    alone = sliding.system
    disk = Disk2D(marker=Marker2D(body="wheel"), radius=RADIUS)
    high = HalfPlane2D(marker=Marker2D(point=(0.0, 5.0), angle=math.pi))
    group = ContactGroup2D(
        name="at", disks=[disk], shapes=[Ledge2D(), high], law=NewtonImpact(restitution=0.0),
        friction=CoulombFriction(coefficient=MU), pass_through=[("Ledge2D", "HalfPlane2D")],
    )  # fmt: skip
    model = Model(bodies=alone.bodies, groups=[group], gravity=alone.gravity)
    assert [type(contact).__name__ for contact in model.contacts] == ["DiskOnLedge2D", "DiskOnHalfPlane2D"]
    assert model.contacts[0].model_copy(update={"name": "at_ground_wheel"}) == alone.contacts[0]
    model.save(tmp_path / "model.json")
    again = Model.load(tmp_path / "model.json")
    assert again == model and isinstance(again.groups[0].shapes[0], Ledge2D)
    result = simulate(again, 0.6, rtol=1e-9, atol=1e-11)
    assert result["wheel.x"][-1] == pytest.approx(sliding["wheel.x"][-1], abs=1e-9)
    outline = Ledge2D().outline()
    parts = animate(result).scene.parts
    assert any(isinstance(s, Path) and tuple(s.points) == outline for part in parts for s in part.shapes)


def test_a_file_says_where_the_shape_is_imported_from(tmp_path) -> None:
    """Another process reads and runs it, which knows nothing of the ledge."""
    group = ContactGroup2D(
        name="at", shapes=[Ledge2D(), Disk2D(marker=Marker2D(body="wheel"), radius=RADIUS)],
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    Model(bodies=[wheel((-1.0, RADIUS))], groups=[group]).save(tmp_path / "model.json")
    code = (
        "import sys; from tlismni.core import Model; m = Model.load(sys.argv[1], allow_imports=['own_ledge']);"
        "print(type(m.groups[0].shapes[0]).__name__, len(m.contacts))"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "model.json")]
    paths = os.pathsep.join([str(pathlib.Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    found = subprocess.run(command, env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True)
    assert found.stdout.split() == ["Ledge2D", "1"], found.stderr


def test_a_shape_of_no_kind_is_refused() -> None:
    law = {"type": "NewtonImpact", "restitution": 0.0}
    for shape, words in (({"type": "Legde2D"}, "no type|none of"), ({"type": "Sphere3D"}, "none of")):
        with pytest.raises(ModelError, match=words):
            Model(groups=[{"name": "at", "shapes": [shape], "law": law}])


def test_a_kind_of_disk_is_a_disk_in_files(tmp_path) -> None:
    """Contacts hold disks: a subclass without a type of its own is read as one."""
    group = ContactGroup2D(
        name="at", disks=[_Coin2D(marker=Marker2D(body="wheel"), radius=RADIUS)], half_planes=[HalfPlane2D()],
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    Model(bodies=[wheel((0.0, RADIUS))], groups=[group]).save(tmp_path / "model.json")
    (disk,) = Model.load(tmp_path / "model.json").groups[0].disks
    assert type(disk) is Disk2D and disk.radius == RADIUS


def test_an_fmu_runs_it(sliding) -> None:
    slave = Slave(sliding.system, rtol=1e-9, atol=1e-11)
    slave.enter_initialization()
    slave.exit_initialization()
    for k in range(6):
        slave.do_step(0.1 * k, 0.1)
    assert slave["wheel.x"] == pytest.approx(sliding["wheel.x"][-1], abs=1e-8)


@pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
def test_the_cross_check_says_that_it_has_no_equal() -> None:
    model = on_ledge(KelvinVoigt(stiffness=1e4, damping=1.0), position=(-1.0, RADIUS))
    with pytest.raises(NotTranslatable, match="'at_ground_wheel' is a DiskOnLedge2D"):
        crosscheck(model, t_end=0.01)


def test_shapes_without_a_pair_are_refused() -> None:
    shapes = [Ledge2D(), Segment2D(marker=Marker2D(body="wheel"), length=1.0)]
    with pytest.raises(ModelError, match="a Ledge2D on 'ground' and a Segment2D on 'wheel' have no contact"):
        contacts_between("at", shapes, law=NewtonImpact(restitution=0.0))


# what is said to be convex


def dip(shape, centre, depth):
    """Distance from a curve that is bent inwards."""
    x, y = centre.x - shape.x, centre.y - shape.y
    return 0.5 * (y - depth * math.cos(x / depth))


def steep(shape, centre, factor):
    return factor * (centre.y - shape.y)


class OwnGap(ScalarContact2D):
    shape: Marker2D = Marker2D()
    centre: Marker2D
    depth: float = 1.0
    factor: float = 1.5


class InDip(OwnGap):
    formula = scalar_contact(dip, convex=True)


class OnSteep(OwnGap):
    formula = scalar_contact(steep, convex=True)


@pytest.mark.parametrize("kind, words", [(InDip, "in the mean"), (OnSteep, "grows faster")])
def test_a_gap_that_is_no_distance_from_a_convex_shape_is_refused(kind, words) -> None:
    contact = kind(name="gap", centre=Marker2D(body="wheel"), law=NewtonImpact(restitution=0.0))
    with pytest.raises(ModelError, match=words):
        Model(bodies=[wheel((0.0, 1.0))], contacts=[contact])


def test_those_of_the_library_are_distances_from_convex_shapes() -> None:
    given = {"disk": Disk2D(marker=Marker2D(body="wheel"), radius=0.2), "law": NewtonImpact(restitution=0.0)}
    DiskOnBox2D(name="box", shape=Box2D(marker=Marker2D(), width=1.0, height=0.3), **given).check_convex()
    corners = ((0.0, 0.0), (1.0, 0.2), (0.4, 0.9))
    DiskOnPolygon2D(name="polygon", shape=Polygon2D(marker=Marker2D(), vertices=corners), **given).check_convex()


class _Coin2D(Disk2D):
    """A shape of which `test_a_pair_of_no_contact_is_refused` declares a pair."""


def test_a_pair_of_no_contact_is_refused():
    with pytest.raises(TypeError, match="'DiskOnLedge2D'"):
        pair("DiskOnLedge2D", shape=Ledge2D, disk=Disk2D)

    @touching(_Coin2D, Ledge2D)
    def _bodies(coin, ledge):
        return (lambda *, name, **_: wheel((0.0, 0.0)).model_copy(update={"name": name}),)

    shapes = [Ledge2D(), _Coin2D(marker=Marker2D(body="wheel"), radius=RADIUS)]
    with pytest.raises(ModelError, match="RigidBody2D does not"):
        contacts_between("at", shapes, law=NewtonImpact(restitution=0.0))
