"""Edges across edges: the contacts of two convex shapes have their distance as least gap, with exact derivatives."""

import numpy as np
import pytest
from contact_points import check_in_space
from solids import hull_distance, placed, random_shape
from test_contact_tangents3d import GRIP, HARD, HUNT, PEAK
from test_mesh_contact3d import states
from test_tangents import Point
from tlismni.core import (
    Box3D,
    Capsule3D,
    ConsistencyError,
    ContactGroup3D,
    ConvexPolyhedron3D,
    EdgesOnEdges3D,
    KelvinVoigt,
    Marker3D,
    Model,
    ModelError,
    RigidBody3D,
    RotationVector,
    compile_model,
    contacts_between,
)
from tlismni.core.contacts.edge_parts import edge_sorts, edges_of
from tlismni.core.contacts.overlap3d import apart

TETRAHEDRON = ConvexPolyhedron3D(marker=Marker3D(body="b"), vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])


def bodies(**of_b):
    return [
        RigidBody3D(name="a", mass=1.3, inertia=(0.4, 0.5, 0.7)),
        RigidBody3D(name="b", **{"mass": 0.7, "inertia": (0.3, 0.2, 0.4), "position": (0.0, 0.0, 3.0)} | of_b),
    ]


def random_turn(rng):
    euler = rng.normal(size=4)
    return euler / np.linalg.norm(euler)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "kinds", [("box", "box"), ("box", "hull"), ("hull", "hull"), ("capsule", "box"), ("hull", "capsule")]
)
def test_the_least_gap_is_the_distance(kinds):
    """Of shapes anywhere, from far apart to a tenth of their radii, by least squares; none is missed, none is false."""
    rng, none = np.random.default_rng(len("".join(kinds))), 0
    for _ in range(4):
        a, b = (
            random_shape(rng, body, kind, 10.0 ** rng.uniform(-4.0, -2.0))
            for body, kind in zip("ab", kinds, strict=True)
        )
        point = Point(Model(bodies=bodies(), contacts=contacts_between("c", [a], [b], law=HARD)))
        rows, radii = [contact.row for contact in point.workspace.assembly.contacts], a.rounding() + b.rounding()
        q, none = point.workspace.assembly.q0.copy(), np.zeros(point.n)
        for _ in range(12):
            q[3:7], q[10:] = random_turn(rng), random_turn(rng)
            way, wanted, low, high = rng.normal(size=3), radii * 10.0 ** rng.uniform(-1.0, 1.5), 0.0, 3.0
            fixed = placed(a, (0.0, 0.0, 0.0), q[3:7])
            while high - low > 1e-12:
                q[7:10] = 0.5 * (low + high) * way
                middle, far = 0.5 * (low + high), hull_distance(fixed, placed(b, q[7:10], q[10:])) > wanted
                low, high = (low, middle) if far else (middle, high)
            gap = point.at(0.0, q, none, none, np.zeros(point.m))[1][rows].min()
            true = hull_distance(fixed, placed(b, q[7:10], q[10:])) - radii
            assert gap == pytest.approx(true, abs=1e-9 * radii + 1e-12)


def test_edges_of_one_face_are_of_different_sorts():
    prism = [(np.cos(k * np.pi / 3.0), np.sin(k * np.pi / 3.0), z) for k in range(6) for z in (-0.5, 0.5)]
    hexagonal = ConvexPolyhedron3D(marker=Marker3D(body="b"), vertices=[tuple(map(float, v)) for v in prism])
    cube = Box3D(marker=Marker3D(body="a"), size=(1.0, 2.0, 3.0))
    for shape, edges, sorts in ((TETRAHEDRON, 6, 3), (cube, 12, 4), (hexagonal, 18, 6)):
        found, places = edges_of(shape), shape.places()
        assert len(found) == edges and len(edge_sorts(shape)) == sorts
        assert sorted(k for sort in edge_sorts(shape) for k in sort) == list(range(edges))
        for sort in edge_sorts(shape):
            for i in sort:
                for k in sort:
                    # no plane through both edges has all corners on one side
                    p, way, other = places[found[i][0]], np.subtract(*places[list(found[i])]), places[list(found[k])]
                    normal = np.cross(way, other[0] - p)
                    if i != k and np.linalg.norm(normal) > 1e-9 and abs(normal @ (other[1] - p)) < 1e-9:
                        heights = (places - p) @ normal
                        assert heights.min() < -1e-9 and heights.max() > 1e-9


@pytest.mark.parametrize("kind", ["box", "hull"])
def test_planes_between_shapes_tell_whether_they_overlap(kind):
    rng = np.random.default_rng(3)
    for _ in range(40):
        a, b = random_shape(rng, "a", kind), random_shape(rng, "b", "hull")
        places = [placed(a, (0.0, 0.0, 0.0), random_turn(rng)), placed(b, rng.uniform(-0.3, 0.3, 3), random_turn(rng))]
        found, true = apart(a, b, *places), hull_distance(*places)
        assert (found > 0.0) == (true > 1e-9) and found <= true + 1e-12


def crossing(law, friction=None, sort=None):
    """Edges of two boxes with round edges that cross at 1.1 rad, both bodies anywhere."""
    tilt = Marker3D(body="a", point=(0.1, -0.2, 0.05), attitude=RotationVector(vector=(np.pi / 4.0, 0.0, 0.0)))
    over = Marker3D(body="b", point=(-0.05, 0.1, 0.15), attitude=RotationVector(vector=(np.pi / 4.0, 0.2, 0.1)))
    a, b = (Box3D(marker=marker, size=(2.0, 0.9, 0.8), edge_radius=0.2) for marker in (tilt, over))
    start = {"position": (0.05, 0.02, 1.05), "attitude": RotationVector(vector=(0.1, 0.0, 1.1))}
    made = contacts_between("c", [a], [b], law=law, friction=friction)
    model = Model(bodies=bodies(**start), contacts=made)
    point = Point(model)
    none = np.zeros(point.n)
    gaps = point.at(0.0, point.workspace.assembly.q0, none, none, np.zeros(point.m))[1]
    rows = [contact.row for contact in point.workspace.assembly.contacts]
    nearest = made[int(np.argmin(gaps[rows]))]
    assert isinstance(nearest, EdgesOnEdges3D)
    return Model(bodies=bodies(**start), contacts=[nearest])


def test_tangents_and_levels():
    check_in_space(crossing(HARD), crossing(HUNT, PEAK), crossing(HARD, GRIP), states)


def test_the_gap_goes_on_falling_where_edges_have_crossed():
    """Straight through zero of the distance of the edges themselves, at any speed."""
    model = crossing(HARD)
    point = Point(model)
    q, none = point.workspace.assembly.q0.copy(), np.zeros(point.n)
    v = none.copy()
    v[9] = -1.0
    row, start, found = point.workspace.assembly.contacts[0].row, q[9], []
    depths = np.linspace(-0.75, -0.2, 46)
    for depth in depths:
        q[9] = start + depth
        _, gap, rate, _ = point.at(0.0, q, v, none, np.zeros(point.m))
        found.append((gap[row], rate[row]))
    gaps, rates = np.array(found).T
    # radii of 0.2 each: at -0.4 the edges meet
    assert gaps.min() < -0.5 and gaps.max() > -0.1
    slopes = np.diff(gaps) / np.diff(depths)
    assert np.ptp(slopes) < 1e-9 and rates == pytest.approx(-slopes[0], abs=1e-9)


# ---- what is refused, and files -------------------------------------------------------------------------------------


def on(body, **more):
    return Box3D(marker=Marker3D(body=body), size=(1.0, 0.2, 0.2), **more)


def test_what_cannot_be_is_refused():
    other = TETRAHEDRON.model_copy(update={"marker": Marker3D(body="a")})
    with pytest.raises(ModelError, match=r"the polyhedra on 'a' and 'b' have sharp edges.*give one of them a `radius`"):
        contacts_between("c", [other], [TETRAHEDRON], law=HARD)
    with pytest.raises(ModelError, match=r"sharp shapes, which a KelvinVoigt lets sink.*edge_radius"):
        contacts_between("c", [on("a")], [on("b")], law=KelvinVoigt(stiffness=1e4, damping=1.0))
    assert contacts_between("c", [on("a", edge_radius=0.01)], [on("b")], law=KelvinVoigt(stiffness=1e4, damping=1.0))
    with pytest.raises(ModelError, match="contact 'e' is of sharp edges"):
        EdgesOnEdges3D(name="e", a=on("a"), b=on("b"), law=HARD)
    with pytest.raises(ModelError, match=r"edges of sort 4 of a Box3D that has 4 sorts"):
        EdgesOnEdges3D(name="e", a=on("a", edge_radius=0.01), b=on("b"), sort_a=4, law=HARD)
    with pytest.raises(ModelError, match=r"leaves no face of a box whose smallest edge is 0.2 m"):
        on("a", edge_radius=0.1)


def test_planks_that_go_through_each_other_at_the_start_are_refused():
    """None of their corners is in the other one."""
    group = ContactGroup3D(name="c", boxes=[on("a"), on("b")], law=HARD)
    across = {"position": (0.0, 0.0, 0.19), "attitude": RotationVector(vector=(0.0, 0.0, 1.5))}
    with pytest.raises(ModelError, match="the Box3D on 'a' and the Box3D on 'b' overlap at the start"):
        Model(bodies=bodies(**across), groups=[group]).assemble()
    compiled = compile_model(Model(bodies=bodies(**across | {"position": (0.0, 0.0, 0.2)}), groups=[group]))
    compiled.simulation()
    for height in (0.19, 0.1, 0.02):
        with pytest.raises(ConsistencyError, match="starts with the shapes overlapping"):
            compiled.simulation(start={"b.z": height})


def test_groups_and_files_hold_them(tmp_path):
    capsule = Capsule3D(marker=Marker3D(body="a", point=(0.0, 3.0, 0.0)), length=0.3, radius=0.1)
    hull = TETRAHEDRON.model_copy(update={"radius": 0.01})
    group = ContactGroup3D(name="g", boxes=[on("a", edge_radius=0.01)], polyhedra=[hull], capsules=[capsule], law=HARD)
    model = Model(bodies=bodies(), groups=[group])
    # corners of both, and sorts of edges: a box and a tetrahedron, a tetrahedron and a capsule
    assert len(model.contacts) == (8 + 4 + 4 * 3) + (4 + 2 + 3)
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    plain = Model(bodies=model.bodies, contacts=model.contacts)
    assert Model.model_validate_json(plain.model_dump_json()) == plain
    assert sum(isinstance(contact, EdgesOnEdges3D) for contact in plain.contacts) == 15
