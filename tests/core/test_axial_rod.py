"""The rod's elements: rigid motion, patch test, mass, eigenfrequencies, damping, and its massless ends."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    AxialRod,
    Constant,
    CoordinateContact,
    CoordinateDriver,
    CoordinateLoad,
    CoordinateTerm,
    KelvinVoigt,
    Marker2D,
    MaterialPoint2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Simulation,
    Step,
    axial_force,
    deformed_shape,
    simulate,
)
from tlismni.core.assembly.evaluate import evaluate_residuals, evaluate_tangent
from tlismni.core.assembly.workspace import Workspace
from tlismni.core.flexible import rod_fields

STEEL = {"length": 2.0, "axial_stiffness": 6.0e3, "mass_per_length": 1.5}


def rod(elements: int = 8, **fields) -> AxialRod:
    return AxialRod(name="rod", elements=elements, **{**STEEL, **fields})


def matrices(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """(M, K) (n, n)."""
    workspace = Workspace(model.assemble())
    structure, n = workspace.structure, workspace.assembly.n
    dense = []
    for c_q in (0.0, 1.0):
        evaluate_tangent(workspace.record, c_q, 0.0)
        here = (structure.rows < n) & (structure.cols < n)
        matrix = np.zeros((n, n))
        matrix[structure.rows[here], structure.cols[here]] = workspace.arrays["values"][: structure.nnz][here]
        dense.append(matrix)
    return dense[0], dense[1] - dense[0]


def residual(model: Model, q: np.ndarray) -> np.ndarray:
    workspace = Workspace(model.assemble())
    workspace.arrays["q"][: len(q)] = q
    evaluate_residuals(workspace.record)
    return workspace.arrays["r"][: len(q)]


VARIANTS = [
    {"mass_matrix": mass, "massless_ends": ends}
    for mass in ("consistent", "lumped")
    for ends in ((), ("right",), ("left",), ("left", "right"))
]


@pytest.mark.parametrize("variant", VARIANTS)
def test_mass_and_centre_of_mass_are_those_of_the_rod(variant) -> None:
    """But for the last element at a massless end, whose mass is at its inner node."""
    body = rod(**variant)
    shift = {"left": 1.0, "right": -1.0}
    moved = sum(shift[end] for end in body.massless_ends) * (3.0 / 8.0) * 0.5 * (2.0 / 8.0)
    mass, stiffness = matrices(Model(bodies=[body]))
    ones = np.ones(9)
    assert ones @ mass @ ones == pytest.approx(3.0, rel=1e-14)
    assert ones @ mass @ body.nodes == pytest.approx(3.0 * 1.0 + moved, rel=1e-14)
    assert np.max(np.abs(stiffness @ ones)) < 1e-10
    positive = np.linalg.eigvalsh(mass) > 1e-12
    assert np.sum(~positive) == len(body.massless_ends) and np.all(np.linalg.eigvalsh(mass) > -1e-14)
    for end in body.massless_ends:
        assert not np.any(mass[0 if end == "left" else -1])


@pytest.mark.parametrize("variant", VARIANTS)
def test_rigid_motion_has_no_strain(variant) -> None:
    result = simulate(Model(bodies=[rod(position=0.3, velocity=0.7, **variant)]), 1.0, "newmark", step=0.05)
    assert np.max(result["energy.strain"]) < 1e-20
    assert np.max(np.abs(result.q - (0.3 + 0.7 * result.t[:, None] + np.linspace(0.0, 2.0, 9)))) < 1e-13


def test_patch_test() -> None:
    strain = 0.01
    found = residual(Model(bodies=[rod()]), (1.0 + strain) * rod().nodes)
    expected = np.zeros(9)
    expected[[0, -1]] = -6.0e3 * strain, 6.0e3 * strain
    assert np.max(np.abs(found - expected)) < 1e-10


def test_a_hanging_rod_is_stretched_by_its_weight() -> None:
    """u = rho A g (L s - s^2 / 2) / EA; at the nodes linear elements are exact."""
    n = 40
    clamp = CoordinateDriver(name="clamp", body="rod", coordinate="x0", motion=Polynomial(coefficients=(0.0,)))
    model = Model(gravity=(9.81, 0.0), bodies=[rod(n)], joints=[clamp])
    q = rod(n).nodes + 1.5 * 9.81 / 6.0e3 * (2.0 * rod(n).nodes - 0.5 * rod(n).nodes ** 2)
    found = residual(model, q)
    assert np.max(np.abs(found[1:])) < 1e-9
    assert found[0] == pytest.approx(-1.5 * 9.81 * 2.0, rel=1e-10)


@pytest.mark.parametrize("mass_matrix, sign", [("consistent", 1.0), ("lumped", -1.0)])
def test_eigenfrequencies_converge_with_order_two(mass_matrix: str, sign: float) -> None:
    """Free-free: omega_k = k pi c / L; the error is +-(k pi / N)^2 / 24 of it."""
    wave = math.sqrt(6.0e3 / 1.5)
    for n in (16, 32):
        mass, stiffness = matrices(Model(bodies=[rod(n, mass_matrix=mass_matrix)]))
        found = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)[1:4])
        k = np.arange(1.0, 4.0)
        exact = k * math.pi * wave / 2.0
        assert np.allclose((found / exact - 1.0) / (k * math.pi / n) ** 2, sign / 24.0, rtol=0.05)


def test_viscous_stress_is_proportional_to_the_stiffness_and_takes_the_energy_that_is_missing() -> None:
    body = rod(16, damping_time=2e-4, velocity=0.5)
    model = Model(bodies=[body], contacts=[wall(node="x16")])
    for c_v in (1.0, 3.0):
        workspace = Workspace(model.assemble())
        values = []
        for c in ((0.0, 0.0), (0.0, c_v), (c_v * 2e-4, 0.0)):
            evaluate_tangent(workspace.record, *c)
            values.append(workspace.arrays["values"].copy())
        assert np.allclose(values[1] - values[0], values[2] - values[0], rtol=1e-12, atol=1e-12)
    balance, lost = [], 0.0
    for part in (0.1, 0.05):
        h = part * body.length / 16 / body.wave_speed
        result = simulate(model, 0.3, "newmark", step=h)
        balance.append(np.max(np.abs(result["energy.balance"])))
        lost = result["energy.dissipation"][-1]
    assert lost > 1e-3 and balance[1] < 0.3 * balance[0] < 1e-3 * lost


def wall(name: str = "wall", node: str = "x8", **fields) -> CoordinateContact:
    term = CoordinateTerm(body="rod", coordinate=node, factor=-1.0)
    return CoordinateContact(
        **{"name": name, "offset": 2.1, "terms": (term,), "law": NewtonImpact(restitution=0.0), **fields}
    )


@pytest.mark.parametrize(
    "build, text",
    [
        (lambda: rod(1, massless_ends=("left",)), "use elements >= 2"),
        (lambda: rod(massless_ends=("left", "left")), "names an end twice"),
        (
            lambda: Model(
                bodies=[rod(massless_ends=("right",))], contacts=[wall(law=NewtonImpact(restitution=0.5))]
            ).assemble(),
            "takes no impulse",
        ),
        (
            lambda: Model(
                bodies=[rod(massless_ends=("right",))], contacts=[wall(law=KelvinVoigt(stiffness=1.0, damping=0.0))]
            ).assemble(),
            "takes no impulse",
        ),
        (
            lambda: Model(
                bodies=[rod(massless_ends=("left", "right"))],
                contacts=[
                    wall(
                        terms=(
                            CoordinateTerm(body="rod", coordinate="x8"),
                            CoordinateTerm(body="rod", coordinate="x0", factor=-1.0),
                        ),
                        offset=0.0,
                    )
                ],
            ).assemble(),
            "two massless ends",
        ),
    ],
)
def test_what_massless_ends_cannot_do_is_refused(build, text: str) -> None:
    with pytest.raises(ModelError, match=text):
        build()


def test_a_rod_bounces_between_two_walls_without_losing_energy() -> None:
    """Both ends massless: each impact is undone by the waves, but for what stays in them; the energy stays."""
    left = CoordinateContact(
        name="left", terms=(CoordinateTerm(body="rod", coordinate="x0"),), offset=0.1, law=NewtonImpact(restitution=0.0)
    )
    body = rod(20, massless_ends=("left", "right"), velocity=1.0)
    h = 0.2 * 0.1 / body.wave_speed
    result = simulate(Model(bodies=[body], contacts=[wall(node="x20"), left]), 0.8, "newmark", step=h)
    assert {e.contact for e in result.events if e.kind == "close"} == {"wall", "left"}
    assert np.max(np.abs(result["energy.balance"])) < 1e-9 and result["energy.impact_loss"][-1] == 0.0
    assert np.min(result["wall.gap"]) > -1e-12 and np.min(result["left.gap"]) > -1e-12


def test_another_body_strikes_while_a_massless_end_is_closed() -> None:
    """The held end is a joint to that impact: momentum goes into the rod's free end only."""
    body = rod(10, massless_ends=("right",), mass_matrix="lumped", velocity=0.5, position=0.1)
    ball = PointMass2D(name="ball", mass=2.0, position=(-0.05, 0.0), velocity=(4.0, 0.0))
    strike = CoordinateContact(
        name="strike", law=NewtonImpact(restitution=0.0),
        terms=(CoordinateTerm(body="rod", coordinate="x0"), CoordinateTerm(body="ball", coordinate="x", factor=-1.0)),
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0), bodies=[body, ball], contacts=[wall(node="x10", offset=2.1001), strike])
    result = simulate(model, 0.06, "newmark", step=0.2 * 0.2 / body.wave_speed)
    (first, *_) = (e for e in result.events if e.kind == "impact")
    assert first.contact == "strike" and result["wall.in_contact"][np.searchsorted(result.t, first.t)] == 1.0
    # effective mass of node 0 (half an element's mass) against the ball's: e = 0
    node, approach = 0.5 * 1.5 * 0.2, first.approach_speed
    assert first.impulse == pytest.approx(approach * node * 2.0 / (node + 2.0), rel=1e-9)
    assert np.max(np.abs(result["energy.balance"])) < 1e-8


def test_every_tenth_step_is_recorded_with_what_happens_at_contacts_and_the_end() -> None:
    body = rod(10, velocity=1.0)
    model, h = Model(bodies=[body], contacts=[wall(node="x10")]), 0.2 * 0.2 / body.wave_speed
    every, some = (simulate(model, 0.2, "newmark", step=h, record=record) for record in (True, 10))
    at = {t: k for k, t in enumerate(every.t)}
    assert len(every) / 12 < len(some) < len(every) / 8 and some.t[-1] == every.t[-1]
    assert {e.t for e in some.events} <= set(some.t) and some.events == every.events
    for k, t in enumerate(some.t):
        if np.sum(every.t == t) == 1:
            assert np.array_equal(some.q[k], every.q[at[t]])
    with pytest.raises(ModelError, match="number of steps between"):
        simulate(model, 0.2, "newmark", step=h, record=-2)


def test_fields_along_the_rod() -> None:
    """A wave of compression of length c t at the wall's end: stress E v/c behind its front, none before it."""
    body = rod(80, velocity=0.5, mass_matrix="lumped", damping_time=1e-5)
    h = 0.2 * body.length / 80 / body.wave_speed
    touch = 0.1 / 0.5
    result = simulate(
        Model(bodies=[body], contacts=[wall(node="x80")]), touch + 1.0 / body.wave_speed, "newmark", step=h
    )
    fields = rod_fields(result, body)
    theory = -body.axial_stiffness * 0.5 / body.wave_speed
    assert fields.axial_force.shape == (len(result), 80) and fields.position.shape == (len(result), 81)
    behind, before = fields.middle > 1.3, fields.middle < 0.7
    assert np.allclose(fields.axial_force[-1, behind], theory, rtol=0.1)
    assert np.max(np.abs(fields.axial_force[-1, before])) < 0.02 * abs(theory)
    assert np.allclose(fields.velocity[-1, 60:], 0.0, atol=0.06) and np.allclose(
        fields.velocity[-1, :20], 0.5, atol=0.01
    )
    assert fields.displacement[-1, 0] == pytest.approx(0.5 * result.t[-1], rel=1e-6)
    assert np.allclose(fields.stress(1e-3), 1e3 * fields.axial_force)
    assert len(rod_fields(result, body, 50).t) < 0.2 * len(result)
    with pytest.raises(ModelError, match="no channels of a rod"):
        rod_fields(result, rod(81))
    with pytest.raises(ModelError, match="must be positive"):
        fields.stress(0.0)


def test_material_points_and_section_loads() -> None:
    """A point on the rod moves with its element, a force on it acts on its nodes; beyond the rod there is none."""
    body = rod(8, velocity=0.3)
    point = MaterialPoint2D(name="p", body="rod", point=(1.15, 0.0))
    push = AppliedForce2D(name="push", marker=Marker2D(body="p"), force_x=Constant(value=3.0))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body, point], forces=[push]), 0.05, "newmark", step=2.5e-4)
    mixed = 0.4 * result["rod.x4"] + 0.6 * result["rod.x5"]
    assert np.max(np.abs(result["p.x"] - mixed)) < 1e-12 and np.max(np.abs(result["p.y"])) < 1e-12
    momentum = result.v[:, :9] @ np.append(0.5, np.append(np.ones(7), 0.5)) * 1.5 * 0.25
    assert np.max(np.abs(momentum - 3.0 * 0.3 - 3.0 * result.t)) < 1e-9
    assert np.max(np.abs(result["energy.balance"])) < 1e-6
    places = np.array([0.05, 1.15, 2.0])
    force, fields = axial_force(result, body, places), rod_fields(result, body)
    assert np.array_equal(force, fields.axial_force[:, [0, 4, 7]])
    assert np.allclose(deformed_shape(result, body, [1.15])[:, 0, 0], result["p.x"], atol=1e-12)
    fine = rod(100)  # a node is a node in spite of rounding: 0.29 * 100 is less than 29
    assert 0.58 / 2.0 * 100 < 29.0 and fine.material_point((0.58, 0.0)).local[0] == "x29"
    assert all(fine.material_point((k * 0.02, 0.0)).local[0] == f"x{k}" for k in range(100))
    assert fine.material_point((0.59, 0.0)).shape[0] == pytest.approx([0.5, 0.5])
    for wrong, text in (((2.1, 0.0), "outside"), ((1.0, 0.1), "off the axis")):
        with pytest.raises(ModelError, match=text):
            body.material_point(wrong)


def test_a_run_goes_on_bit_for_bit_from_a_state_stored_while_a_massless_end_is_closed() -> None:
    body = rod(10, massless_ends=("right",), velocity=1.0)
    model, h = Model(gravity=(0.0, 0.0), bodies=[body], contacts=[wall(node="x10")]), 0.2 * 0.2 / body.wave_speed
    first, again = (Simulation(model, "newmark", step=h) for _ in range(2))
    first.run_to(0.2, until=0.12)
    state = first.state()
    assert first.memory.mode[0] == 1.0
    first.run_to(0.2)
    again.restore(state)
    again.run_to(0.2)
    assert [e.kind for e in first.events] == ["close", "open"] and first.events == again.events
    assert np.array_equal(first.values(), again.values())


def test_two_massless_ends_leave_all_mass_to_the_node_between_them() -> None:
    model = Model(bodies=[rod(2, massless_ends=("left", "right"))])
    mass, _ = matrices(model)
    assert np.diag(mass) == pytest.approx([0.0, 3.0, 0.0])


def test_a_load_that_pulls_a_closed_massless_end_away_opens_it_at_once() -> None:
    """No sample shows a wall that pulls."""
    body = rod(10, massless_ends=("right",), velocity=1.0)
    pull = CoordinateLoad(
        name="pull",
        body="rod",
        coordinate="x10",
        load=Step(time=0.15, before=0.0, after=-1e4 * STEEL["axial_stiffness"]),
    )
    model = Model(gravity=(0.0, 0.0), bodies=[body], forces=[pull], contacts=[wall(node="x10")])
    result = simulate(model, 0.16, "newmark", step=0.2 * 0.2 / body.wave_speed)
    assert result.events[-1].kind == "open" and result.events[-1].t == pytest.approx(0.15)
    assert np.min(result["wall.normal_force"]) >= 0.0
