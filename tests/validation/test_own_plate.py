"""A shape in space that `own_plate.py` adds from outside of the package stands in a group, in files, and is drawn."""

import numpy as np
import pytest
from own_plate import Plate3D
from tlismni.core import ContactGroup3D, Marker3D, Model, NewtonImpact, RigidBody3D, Sphere3D, simulate
from tlismni.viewer import animate

RADIUS, THICKNESS, HEIGHT, G = 0.1, 0.06, 0.5, 9.81


def model(bodies: int = 2) -> Model:
    """Balls over a plate on the ground, which touch each other too."""
    names = [f"ball{k}" for k in range(bodies)]
    balls = [
        RigidBody3D(name=name, mass=1.0, inertia=(0.004, 0.004, 0.004), position=(0.3 * k, 0.0, HEIGHT))
        for k, name in enumerate(names)
    ]
    shapes = [Plate3D(thickness=THICKNESS), *(Sphere3D(marker=Marker3D(body=name), radius=RADIUS) for name in names)]
    group = ContactGroup3D(name="on", shapes=shapes, law=NewtonImpact(restitution=0.5))
    return Model(bodies=balls, groups=[group], gravity=(0.0, 0.0, -G))


def test_it_is_touched_where_its_upper_face_is(tmp_path) -> None:
    made = model()
    assert [type(contact).__name__ for contact in made.contacts] == [*["SphereOnHalfSpace3D"] * 2, "SphereOnSphere3D"]
    made.save(tmp_path / "model.json")
    again = Model.load(tmp_path / "model.json")
    assert again == made and isinstance(again.groups[0].shapes[0], Plate3D)
    result = simulate(again, 0.4, rtol=1e-9, atol=1e-11)
    fall = HEIGHT - RADIUS - 0.5 * THICKNESS
    hits = [event for event in result.events if event.kind == "impact"]
    assert [event.t for event in hits] == pytest.approx([np.sqrt(2.0 * fall / G)] * 2, rel=1e-7)
    assert [event.impulse for event in hits] == pytest.approx([1.5 * np.sqrt(2.0 * fall * G)] * 2, rel=1e-7)


def test_it_is_drawn() -> None:
    """As the triangles that it says, on the ground."""
    scene = animate(simulate(model(1), 0.1)).scene
    low, high = np.array([-0.5, -0.5, -0.5 * THICKNESS]), np.array([0.5, 0.5, 0.5 * THICKNESS])
    spans = [(np.min(s.mesh.vertices, axis=0), np.max(s.mesh.vertices, axis=0)) for s in scene.solids]
    assert any(np.allclose(a, low) and np.allclose(b, high) for a, b in spans)
