"""Contact pools: pairs of a group take a contact while they are near, and the motion is that of a contact for each."""

import itertools

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    ContactGroup3D,
    CoulombFriction,
    HalfSpace3D,
    HuntCrossley,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Simulation,
    Sphere3D,
    simulate,
    simulate_many,
)
from tlismni.core.errors import ModelError, SimulationError, UnknownNameError
from tlismni.core.simulation.impulse_step_warnings import warn_of_overlap
from tlismni.core.simulation.state import State

NEWTON = {"law": NewtonImpact(restitution=0.4), "friction": CoulombFriction(coefficient=0.3)}
HERTZ = {"law": HuntCrossley(stiffness=1e7, restitution=0.6)}


def rain(count: int, most: int | None, unit: float = 1.0, **more: object) -> Model:
    """Spheres of different size that fall between a floor and two walls, three in a layer; lengths in m/unit."""
    rng = np.random.default_rng(7)
    radii = rng.uniform(0.03, 0.05, count) * unit
    bodies, spheres = [], []
    for k, radius in enumerate(radii.tolist()):
        place = (np.array([0.06 + 0.11 * (k % 3), 0.07, 0.06 + 0.12 * (k // 3)]) + rng.uniform(-0.005, 0.005, 3)) * unit
        mass = 2000.0 * (radius / unit) ** 3
        moment = 0.4 * mass * radius**2
        speed = tuple((np.array([-0.3, 0.1 * (k % 2), -0.5]) * unit).tolist())
        bodies.append(
            RigidBody3D(name=f"s{k}", mass=mass, inertia=(moment,) * 3, position=tuple(place.tolist()), velocity=speed)
        )
        spheres.append(Sphere3D(marker=Marker3D(body=f"s{k}"), radius=radius))
    walls = [HalfSpace3D(marker=Marker3D(attitude=Axes(z=z))) for z in ((0, 0, 1), (1, 0, 0), (0, 1, 0))]
    group = ContactGroup3D(name="rain", spheres=spheres, half_spaces=walls, most_contacts=most, **{**NEWTON, **more})
    return Model(gravity=(0.0, 0.0, -9.81 * unit), bodies=bodies, groups=[group])


def positions(result: object, count: int) -> np.ndarray:
    """(N, count, 3)."""
    return np.stack([np.stack([result[f"s{k}.{x}"] for x in "xyz"], axis=1) for k in range(count)], axis=1)  # type: ignore[index]


@pytest.mark.parametrize(
    ("method", "options"), [("moreau", {"step": 1e-3}), ("ebdf", {}), ("irk", {}), ("bdf", {})], ids=str
)
def test_the_motion_is_that_of_a_contact_for_each_pair(method: str, options: dict[str, float]) -> None:
    # until impacts accumulate, whose rules ask for the scales of rows
    times = np.linspace(0.0, 0.07, 8).tolist()
    single, pooled = (simulate(rain(9, most), 0.07, method, t_eval=times, **options) for most in (None, 40))
    assert [(e.kind, e.contact) for e in pooled.events] == [(e.kind, e.contact) for e in single.events]
    assert len(single.events) >= 10
    assert np.max(np.abs(positions(pooled, 9) - positions(single, 9))) < 1e-8


def test_force_laws_are_pooled_too() -> None:
    times = np.linspace(0.0, 0.1, 11).tolist()
    single, pooled = (
        simulate(rain(6, most, friction=None, **HERTZ), 0.1, t_eval=times, rtol=1e-9) for most in (None, 30)
    )
    assert [(e.kind, e.contact) for e in pooled.events] == [(e.kind, e.contact) for e in single.events]
    assert {e.kind for e in single.events} >= {"close", "open"}
    assert np.max(np.abs(positions(pooled, 6) - positions(single, 6))) < 1e-8


def test_slots_are_used_again() -> None:
    """More pairs touch in a run than there is room for at once."""
    result = simulate(rain(15, 40), 0.8, "moreau", step=1e-3)
    struck = {event.contact for event in result.events if event.kind == "impact"}
    assert len(struck) > 40
    centres, radii = positions(result, 15), np.array([s.radius for s in rain(15, 40).groups[0].spheres])
    for i, j in itertools.combinations(range(15), 2):
        apart = np.linalg.norm(centres[:, i] - centres[:, j], axis=1) - radii[i] - radii[j]
        assert np.min(apart) > -1e-4
    assert np.min(centres - radii[:, None]) > -1e-4
    assert np.max(np.abs(result["energy.balance"])) < 1e-3 * result["energy.impact_loss"][-1]


def test_channels_are_sums_of_the_group() -> None:
    single, pooled = (simulate(rain(6, most), 0.08, "moreau", step=1e-3) for most in (None, 20))
    names = [c for c in pooled.channels if c.startswith("rain")]
    assert names == ["rain.normal_force", "rain.impulse", "rain.dissipation"]
    for what in ("normal_force", "impulse", "dissipation"):
        every = sum(single[c][-1] for c in single.channels if c.startswith("rain") and c.endswith(f".{what}"))
        assert pooled[f"rain.{what}"][-1] == pytest.approx(every, rel=1e-6)
    assert pooled["rain.dissipation"][-1] > 0.1


@pytest.mark.parametrize(("method", "options"), [("moreau", {"step": 1e-3}), ("ebdf", {})], ids=str)
def test_a_state_is_restored_with_the_pairs_of_its_slots(method: str, options: dict[str, float]) -> None:
    """Into the run that went on, and as bytes into a new one; what has been bound since is bound anew."""
    run = Simulation(rain(9, 40), method, **options)
    run.advance(0.12)
    state, text = run.state(), run.state().to_bytes()
    values = run.values()
    run.advance(0.3)
    goal = run.values()
    run.restore(state)
    assert np.array_equal(run.values(), values)
    run.advance(0.3)
    assert np.max(np.abs(run.values() - goal)) < 1e-9 * np.max(np.abs(goal))
    fresh = Simulation(rain(9, 40), method, **options)
    fresh.restore(State.from_bytes(text))
    assert np.array_equal(fresh.values(), values)
    fresh.advance(0.3)
    assert np.max(np.abs(fresh.values() - goal)) < 1e-9 * np.max(np.abs(goal))


def test_units_do_not_matter() -> None:
    metres, millimetres = (simulate(rain(6, 20, unit), 0.3, "moreau", step=1e-3) for unit in (1.0, 1e3))
    assert [e.contact for e in metres.events] == [e.contact for e in millimetres.events]
    assert np.max(np.abs(positions(metres, 6)[-1] - 1e-3 * positions(millimetres, 6)[-1])) < 1e-9


def test_too_little_room_is_said_and_nothing_is_lost() -> None:
    with pytest.raises(SimulationError, match="most_contacts of group 'rain' is 8") as caught:
        simulate(rain(9, 8), 0.5, "moreau", step=1e-3)
    assert caught.value.partial.t[-1] > 0.0
    with pytest.raises(SimulationError, match="most_contacts of group 'rain' is 1"):
        simulate(rain(9, 1), 0.5)


def test_bodies_that_do_not_touch_take_no_contact() -> None:
    model = rain(2, 8, except_bodies=[("s0", "s1"), ("s1", "s1")])
    fields = {name: getattr(model, name) for name in ("gravity", "groups")}
    one, other = model.bodies
    close = [one, other.model_copy(update={"position": one.position, "velocity": one.velocity})]
    result = simulate(Model(bodies=close, **fields), 0.3)
    assert all("s0_s1" not in event.contact for event in result.events)
    assert result["rain.normal_force"][-1] >= 0.0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"half_spaces": [HalfSpace3D(marker=Marker3D(body="s0"))]}, "half-space on 's0'"),
        ({"pass_through": [("Sphere3D", "HalfSpace3D")]}, "pass_through"),
        ({"spheres": [Sphere3D(marker=Marker3D(body="s0"), radius=0.0)]}, "radius above 0"),
        ({"most_contacts": 0}, "most_contacts"),
    ],
)
def test_what_has_no_pool_is_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises(ModelError, match=said):
        model = rain(3, 8)
        group = ContactGroup3D(**{**dict(model.groups[0]), **change})
        Model(bodies=model.bodies, groups=[group])


def test_a_model_goes_through_json() -> None:
    model = rain(4, 12)
    again = Model.from_json(model.to_json())
    assert again == model
    assert len(again.contacts) == 12


def test_a_table_lists_the_contacts_of_a_sample() -> None:
    """Points and normals by the shapes, forces that hold the weight together; the order is that of the pairs."""
    result = simulate(rain(6, 24), 2.5, "moreau", step=1e-3)
    rows = result.contact_table("rain")
    model = rain(6, 24)
    centres = dict(zip([body.name for body in model.bodies], positions(result, 6)[-1], strict=True))
    radii = {sphere.marker.body: sphere.radius for sphere in model.groups[0].spheres}
    weight = sum(body.mass for body in model.bodies) * 9.81
    assert rows["normal_force"].sum() == pytest.approx(result["rain.normal_force"][-1], rel=1e-12)
    # what rolls may press in every other step
    assert np.mean(result["rain.normal_force"][-200:]) == pytest.approx(weight, rel=0.02)
    for row in rows:
        _, one, other, *_ = row["contact"].split("_")
        assert row["normal_force"] > 0.0
        assert np.linalg.norm(row["normal"]) == pytest.approx(1.0, abs=1e-12)
        body, outward = (one, -1.0) if other == "ground" else (one, 1.0)
        surface = centres[body] + outward * radii[body] * row["normal"]
        off = row["gap"] if other == "ground" else 0.0
        assert np.linalg.norm(row["point"] - surface) <= abs(off) + 1e-12
    with pytest.raises(UnknownNameError, match="'rain'"):
        result.contact_table("snow")


def test_runs_with_other_numbers_are_those_of_their_own_models() -> None:
    """Radii, masses and laws of a batch, bit for bit; the balls of the broad phase and the tables of slots follow."""
    model, values = rain(6, 24), [0.02, 0.045, 0.05]
    columns = {"rain.spheres.2.radius": values, "rain.law.restitution": [0.2, 0.5, 0.8], "s1.mass": [0.1, 0.2, 0.3]}
    runs = simulate_many(model, columns, 0.15, method="moreau", step=1e-3)
    for k in range(3):
        own = model.with_parameters({name: column[k] for name, column in columns.items()})
        single = simulate(own, 0.15, "moreau", step=1e-3)
        for name in ("s2.z", "s4.x", "rain.impulse"):
            assert runs[name][k] == single[name][-1]
    assert len(set(runs["s2.z"].tolist())) == 3


def test_several_groups_and_several_spheres_on_a_body() -> None:
    """Dumbbells off their bodies' centres in two pools, beside a contact that is in none."""
    times = np.linspace(0.0, 0.3, 7).tolist()

    def model(most: int | None) -> Model:
        bodies, spheres = [], []
        for k in range(4):
            bodies.append(
                RigidBody3D(
                    name=f"d{k}", mass=1.0, inertia=(0.01, 0.02, 0.025), position=(0.25 * k, 0.02 * k, 0.15 + 0.05 * k),
                    velocity=(0.6 - 0.5 * k, 0.0, -1.0), angular_velocity=(0.0, 3.0 + k, 1.0),
                )
            )  # fmt: skip
            for end in (-1.0, 1.0):
                marker = Marker3D(body=f"d{k}", point=(0.07 * end, 0.01, 0.0))
                spheres.append(Sphere3D(marker=marker, radius=0.04 + 0.005 * (k % 2)))
        floor = HalfSpace3D(marker=Marker3D(attitude=Axes(z=(0.0, 0.1, 1.0))))
        groups = [
            ContactGroup3D(name="low", spheres=spheres, half_spaces=[floor], most_contacts=most, **NEWTON),
            ContactGroup3D(name="one", spheres=[Sphere3D(marker=Marker3D(body="d0"), radius=0.02)],
                           half_spaces=[HalfSpace3D(marker=Marker3D(point=(-0.3, 0, 0), attitude=Axes(z=(1, 0, 0))))],
                           most_contacts=most and 2, **NEWTON),
            ContactGroup3D(name="alone", spheres=[Sphere3D(marker=Marker3D(body="d3"), radius=0.02)],
                           half_spaces=[HalfSpace3D(marker=Marker3D(point=(2, 0, 0), attitude=Axes(z=(-1, 0, 0))))],
                           **NEWTON),
        ]  # fmt: skip
        return Model(gravity=(0.0, 0.0, -9.81), bodies=bodies, groups=groups)

    single, pooled = (simulate(model(most), 0.3, "moreau", step=1e-3, t_eval=times) for most in (None, 24))
    first = [(e.t, e.kind, e.contact) for e in single.events][:6]
    assert [(e.t, e.kind, e.contact) for e in pooled.events][:6] == first
    assert {"low_d0_d1_3", "low_d1_d2_3"} < {contact for *_, contact in first}
    for k in range(4):
        for name in (f"d{k}.x", f"d{k}.z"):
            assert np.max(np.abs(pooled[name][:3] - single[name][:3])) < 1e-12


def test_deep_overlaps_are_said(caplog: pytest.LogCaptureFixture) -> None:
    """A column of spheres that falls by more than their radius in a step; not with steps that fit."""
    bodies, spheres = [], []
    for k in range(8):
        bodies.append(
            RigidBody3D(name=f"s{k}", mass=0.1, inertia=(6e-5,) * 3, position=(0.0, 0.0, 0.05 + 0.09 * k),
                        velocity=(0.0, 0.0, -10.0))
        )  # fmt: skip
        spheres.append(Sphere3D(marker=Marker3D(body=f"s{k}"), radius=0.04))
    group = ContactGroup3D(name="pile", spheres=spheres, half_spaces=[HalfSpace3D(marker=Marker3D())], **NEWTON)
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=bodies, groups=[group])
    simulate(model, 0.1, "moreau", step=5e-3)
    said = [record.message for record in caplog.records if "overlap" in record.message]
    assert len(said) == 1
    assert "'pile_s0_s1' overlap by 0.0301 m" in said[0]
    caplog.clear()
    simulate(model, 0.1, "moreau", step=1e-4)
    assert not caplog.records


def test_a_deep_overlap_in_a_pool_has_the_name_of_its_pair(caplog: pytest.LogCaptureFixture) -> None:
    run = Simulation(rain(6, 24), "moreau", step=1e-3)
    run.advance(0.1)
    sample, layout, pool = run.sample(), run.table.layout, run.assembly.pool
    assert pool is not None
    slot = int(np.flatnonzero(sample[layout.slot_pairs])[-1])
    sample[layout.gap + pool.contacts[slot]] = -0.03
    warn_of_overlap(sample[None, :], run.assembly, layout)
    assert pool.name_of(int(sample[layout.slot_pairs][slot])) in caplog.text
