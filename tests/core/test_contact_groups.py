"""Groups of shapes as one record of a model: the contacts that are made of them."""

import pytest
from tlismni.core import (
    Box2D,
    ContactGroup2D,
    CoulombFriction,
    Disk2D,
    HalfPlane2D,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Parameter,
    RigidBody2D,
    contacts_between,
    simulate,
)

RADIUS = 0.05


def heap(**more):
    """Three disks over a floor."""
    names = [f"disk{k}" for k in range(3)]
    group = ContactGroup2D(
        name="heap",
        disks=[Disk2D(marker=Marker2D(body=name), radius=RADIUS) for name in names],
        half_planes=[HalfPlane2D()],
        law=NewtonImpact(restitution=0.2),
        friction=CoulombFriction(coefficient=0.3),
    )
    bodies = [
        RigidBody2D(name=name, mass=1.0, inertia=1e-3, position=(0.101 * k, 0.06)) for k, name in enumerate(names)
    ]
    return Model(bodies=bodies, groups=[group], **more)


def test_a_group_makes_the_contacts_of_all_its_pairs():
    model = heap()
    (group,) = model.groups
    by_hand = contacts_between("heap", (*group.disks, *group.half_planes), law=group.law, friction=group.friction)
    assert model.contacts == by_hand and len(by_hand) == 3 + 3


def test_it_runs_and_rests_as_contacts_by_hand_do():
    model = heap()
    plain = Model(bodies=model.bodies, contacts=model.contacts)
    runs = [simulate(m, 0.4, rtol=1e-6) for m in (model, plain)]
    assert runs[0]["disk1.y"].tobytes() == runs[1]["disk1.y"].tobytes()
    assert runs[0]["disk1.y"][-1] == pytest.approx(RADIUS, abs=1e-9)


def test_files_hold_the_group_and_not_its_contacts(tmp_path):
    model = heap()
    model.save(tmp_path / "m.json")
    text = (tmp_path / "m.json").read_text(encoding="utf-8")
    assert "heap_disk0_disk1" not in text and '"heap"' in text
    again = Model.load(tmp_path / "m.json")
    assert again == model and again.with_parameters({}) == model


def test_its_law_is_changed_for_all_its_contacts():
    model = heap(parameters=[Parameter(name="e", targets=["heap.law.restitution"])])
    for changed in (model.with_parameters({"e": 0.7}), model.with_parameters({"heap.law.restitution": 0.7})):
        assert {contact.law.restitution for contact in changed.contacts} == {0.7}
        assert len(changed.contacts) == 6


def test_a_number_of_one_of_its_contacts_is_refused():
    with pytest.raises(ModelError, match=r"is a contact of group 'heap': set the number in the group"):
        heap().with_parameters({"heap_disk0_disk1.law.restitution": 0.1})


def test_what_cannot_touch_is_refused():
    box = Box2D(marker=Marker2D(), width=1.0, height=1.0)
    with pytest.raises(ModelError, match=r"group 'g' has no two shapes that can touch"):
        Model(groups=[ContactGroup2D(name="g", boxes=[box], law=NewtonImpact(restitution=0.0))])
    with pytest.raises(ModelError, match=r"ContactGroup2D 'g': disk: there is no such field; did you mean 'disks'"):
        Model(groups=[{"name": "g", "disk": [], "law": {"type": "NewtonImpact", "restitution": 0.0}}])
    with pytest.raises(ModelError, match=r"body 'gone', which does not exist"):
        Model(groups=[ContactGroup2D(name="g", disks=[Disk2D(marker=Marker2D(body="gone"), radius=1.0)],
                                     half_planes=[HalfPlane2D()], law=NewtonImpact(restitution=0.0))])  # fmt: skip
