"""Bodies reduced from a mesh: mass, frequencies, statics of interfaces, what is refused."""

import numpy as np
import pytest
from scipy.linalg import eigh, solve
from scipy.sparse import save_npz
from tlismni.core import (
    AppliedForce3D,
    Constant,
    Fixed3D,
    InterfaceFrame3D,
    Marker3D,
    Model,
    ModelError,
    Revolute3D,
    simulate,
)
from tlismni.core.flexible import FiniteElements, finite_elements, read_finite_elements, reduced_body

skfem = pytest.importorskip("skfem")

STEEL = {"density": 7800.0, "youngs_modulus": 2.1e11, "poisson_ratio": 0.3}
SIZE = (1.0, 0.05, 0.03)


def bar(*pieces, **options):
    mesh = skfem.MeshHex.init_tensor(*(np.linspace(0.0, x, n + 1) for x, n in zip(SIZE, pieces, strict=True)))
    return finite_elements(mesh, **STEEL, **options)


@pytest.fixture(scope="module")
def coarse():
    return bar(6, 1, 1)


def ends(solid):
    return {"root": solid.on_plane("x", 0.0), "tip": solid.on_plane("x", SIZE[0])}


def frequencies(body):
    """Hz; stiffness and mass of modes of the free body are diagonal."""
    mass = np.einsum("klii->kl", np.array(body.modal_second_moment))
    np.testing.assert_allclose(mass, np.diag(np.diag(mass)), rtol=0, atol=1e-8 * mass.max())
    return np.sqrt(np.diag(body.stiffness) / np.diag(mass)) / (2.0 * np.pi)


def euler_bernoulli():
    """First bending frequency of the free bar, Hz."""
    length, _, height = SIZE
    return 4.7300407**2 / (2.0 * np.pi * length**2) * height * np.sqrt(2.1e11 / 7800.0 / 12.0)


def test_mass_centre_and_inertia_of_a_bar_are_exact(coarse):
    body = reduced_body("bar", coarse, ends(coarse), modes=2)
    mass = 7800.0 * np.prod(SIZE)
    np.testing.assert_allclose(body.mass, mass, rtol=1e-12)
    np.testing.assert_allclose(body.second_moment, np.diag(mass * np.square(SIZE) / 12.0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(body.interfaces[1].point, (0.5, 0.0, 0.0), rtol=0, atol=1e-12)
    of_root = reduced_body("bar", coarse, ends(coarse), modes=2, frame="root")
    np.testing.assert_allclose(of_root.first_moment, (0.5 * mass, 0.0, 0.0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(of_root.interfaces[0].shape, 0.0, rtol=0, atol=1e-10)


def test_modes_of_the_free_body_are_those_of_the_whole_mesh(coarse):
    """Lowest of the full matrices; of bending near the slender beam's."""
    squares = eigh(coarse.stiffness.toarray(), coarse.mass.toarray(), eigvals_only=True, subset_by_index=(6, 11))
    exact = np.sqrt(squares) / (2.0 * np.pi)
    np.testing.assert_allclose(frequencies(reduced_body("bar", coarse, modes=6)), exact, rtol=1e-8)
    reduced = frequencies(reduced_body("bar", coarse, ends(coarse), modes=12))[:6]
    assert np.all(reduced > exact * (1.0 - 1e-9))  # a reduced body is never softer
    np.testing.assert_allclose(reduced, exact, rtol=0.01)
    np.testing.assert_allclose(exact[0], euler_bernoulli(), rtol=0.01)


@pytest.mark.full
def test_first_bending_frequency_of_the_fine_bar():
    body = reduced_body("bar", bar(20, 3, 2), modes=4)
    assert euler_bernoulli() == pytest.approx(160.01, abs=0.005)
    assert frequencies(body)[0] == pytest.approx(159.54, abs=0.005)


def test_statics_at_an_interface_is_that_of_the_whole_mesh(coarse):
    """Root held, a force across the rigid tip: no modes are needed."""
    places, sets = coarse.nodes, ends(coarse)
    body = reduced_body("bar", coarse, sets, modes=0, frame="root")
    tip = body.interface("tip")
    own = np.array(tip.shape) @ (0.0, 0.0, -300.0)
    moved = np.array(tip.shape).T @ solve(np.array(body.stiffness), own)
    # the whole mesh: the tip's nodes follow its six coordinates
    n = len(places)
    arms = places[sets["tip"]] - places[sets["tip"]].mean(axis=0)
    free = np.setdiff1d(np.arange(n), np.concatenate([sets["root"], sets["tip"]]))
    basis = np.zeros((3 * n, 3 * len(free) + 6))
    basis[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    for node, (x, y, z) in zip(sets["tip"], arms, strict=True):
        basis[3 * node : 3 * node + 3, -6:] = np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])
    load = np.zeros(basis.shape[1])
    load[-4] = -300.0
    exact = solve(basis.T @ coarse.stiffness.toarray() @ basis, load)
    np.testing.assert_allclose(moved, exact[-6:-3], rtol=1e-7, atol=1e-12)
    np.testing.assert_allclose(np.array(tip.rotation).T @ solve(np.array(body.stiffness), own), exact[-3:], rtol=1e-7,
                               atol=1e-12)  # fmt: skip


def test_cantilever_comes_to_rest_where_statics_says(coarse):
    """Mean axes, root welded to the ground at its interface: the frame moves, the tip's deflection is the same."""
    sets, force = ends(coarse), 300.0
    rest = {}
    for frame in ("mean", "root"):
        body = reduced_body("bar", coarse, sets, modes=0, frame=frame, damping_ratio=0.9)
        root = InterfaceFrame3D(name="r", body="bar", interface="root")
        tip = InterfaceFrame3D(name="t", body="bar", interface="tip")
        weld = Fixed3D(name="weld", a=Marker3D(point=body.interface("root").point), b=Marker3D(body="r"))
        load = AppliedForce3D(name="f", marker=Marker3D(body="t"), force_z=Constant(value=-force))
        model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body, root, tip], joints=[weld], forces=[load])
        result = simulate(model, 0.8, "hht", step=4e-4)
        rest[frame] = result["t.z"][-1] - body.interface("tip").point[2]
        np.testing.assert_allclose(result["weld.force_z"][-1], force, rtol=1e-4)
        np.testing.assert_allclose(result["weld.torque_y"][-1], -force * SIZE[0], rtol=1e-3)
    beam = -force * SIZE[0] ** 3 / (3.0 * 2.1e11 * SIZE[1] * SIZE[2] ** 3 / 12.0)
    np.testing.assert_allclose(rest["root"], beam, rtol=0.03)  # the mesh is coarse, its ends are rigid
    np.testing.assert_allclose(rest["mean"], rest["root"], rtol=1e-3)


def test_pendulum_of_a_bar_swings_as_a_physical_pendulum(coarse):
    """Small swing about a hinge at its interface: 2 pi sqrt(2 L / 3 g), softened by next to nothing."""
    body = reduced_body("bar", coarse, ends(coarse), modes=0)
    x, y, z = body.interface("root").point
    hinge = Revolute3D(
        name="hinge", a=Marker3D(point=(x, y, z), attitude={"type": "Axes", "z": (0.0, 1.0, 0.0)}),
        b=Marker3D(body="r", attitude={"type": "Axes", "z": (0.0, 1.0, 0.0)}),
    )  # fmt: skip
    model = Model(gravity=(9.81, 0.0, -0.0981), bodies=[body, InterfaceFrame3D(name="r", body="bar", interface="root")],
                  joints=[hinge])  # fmt: skip
    period = 2.0 * np.pi * np.sqrt((2.0 / 3.0 + (SIZE[2] / SIZE[0]) ** 2 / 6.0) / np.hypot(9.81, 0.0981))
    result = simulate(model, period, "hht", step=period / 1600)
    half = result["hinge.angle"][800]
    np.testing.assert_allclose(half, 0.02, rtol=2e-3)
    np.testing.assert_allclose(result["hinge.angle"][-1], 0.0, rtol=0, atol=4e-5)


def test_matrices_come_from_files_and_modes_from_elsewhere(coarse, tmp_path):
    from scipy.io import mmwrite

    np.save(tmp_path / "nodes.npy", coarse.nodes)
    save_npz(tmp_path / "mass.npz", coarse.mass)
    mmwrite(tmp_path / "stiffness.mtx", coarse.stiffness)
    read = read_finite_elements(*(tmp_path / name for name in ("nodes.npy", "mass.npz", "stiffness.mtx")))
    given = reduced_body("bar", coarse, ends(coarse), modes=2)
    np.testing.assert_allclose(
        frequencies(reduced_body("bar", read, ends(read), modes=2)), frequencies(given), rtol=1e-6
    )
    squares, shapes = eigh(coarse.stiffness.toarray(), coarse.mass.toarray(), subset_by_index=(6, 7))
    centred = FiniteElements(coarse.nodes - coarse.nodes.mean(axis=0), coarse.mass, coarse.stiffness)
    own = reduced_body("bar", centred, {"tip": centred.near((0.5, 0.0, 0.0))}, modes=shapes)
    np.testing.assert_allclose(frequencies(own), np.sqrt(squares) / (2.0 * np.pi), rtol=1e-9)


def test_what_is_refused(coarse):
    sets = ends(coarse)
    for interfaces, options, message in (
        ({"a": sets["root"], "b": sets["root"]}, {}, "a node can be in one only"),
        ({"a": sets["root"][:2]}, {}, "needs one node, or three"),
        ({"a": sets["root"][:1]}, {}, "do not hold"),
        (sets, {"frame": "middle"}, "interface of three nodes"),
        (sets, {"modes": 10**6}, "fewer than"),
        (sets, {"modes": np.zeros((4, 2))}, "3N"),
    ):
        with pytest.raises(ModelError, match=message):
            reduced_body("bar", coarse, interfaces, **options)
    turned = FiniteElements(coarse.nodes, coarse.mass.toarray() + np.eye(3 * len(coarse.nodes), k=1), coarse.stiffness)
    with pytest.raises(ModelError, match="couples"):
        reduced_body("bar", turned, sets)
    with pytest.raises(ModelError, match="N, 3"):
        reduced_body("bar", FiniteElements(coarse.nodes[1:], coarse.mass, coarse.stiffness), sets)
    with pytest.raises(ModelError, match="hexahedra or tetrahedra"):
        finite_elements(skfem.MeshTri(), **STEEL)
    with pytest.raises(ModelError, match="poisson_ratio"):
        finite_elements(skfem.MeshHex(), **{**STEEL, "poisson_ratio": 0.5})
    with pytest.raises(ModelError, match="no node has"):
        coarse.on_plane("x", 3.0)
