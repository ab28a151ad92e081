"""Runs without Python (`core/native`): the same bits, states, and what is refused."""

import re
from pathlib import Path

import numpy as np
import pytest
from tlismni.core import Simulation, SimulationError
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.native import NativeError, image_of
from tlismni.core.native import layout as layouts
from tlismni.models import load

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
NATIVE = Path(layouts.__file__).parent


def build(name, t_end=None, **parameters):
    from tlismni.core.native.in_process import NativeModel, NativeRun

    scenario = load(name, **parameters)
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    image = image_of(scenario.model, t_end or scenario.t_end, **settings)
    return NativeRun(NativeModel(image, LIBRARY)), Simulation(scenario.model, **settings), image


def jumping_model():
    """A pendulum with a marker at its end, pushed from 0.2 to 0.6 s, above a floor."""
    from tlismni.core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
    from tlismni.core.elements import AppliedForce2D, Revolute2D, RigidBody2D
    from tlismni.core.laws import NewtonImpact
    from tlismni.core.model.markers import Marker2D
    from tlismni.core.model.outputs import MarkerOutput2D
    from tlismni.core.model.signals import Step
    from tlismni.core.multibody_model import Model

    end = Marker2D(body="bar", point=(0.5, 0.0), angle=0.3)
    return Model(
        name="pushed",
        bodies=[RigidBody2D(name="bar", mass=1.0, inertia=0.1, position=(0.5, 0.0))],
        joints=[Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="bar", point=(-0.5, 0.0)))],
        forces=[
            AppliedForce2D(name="push", marker=end, force_y=Step(time=0.2, after=25.0)),
            AppliedForce2D(name="pull", marker=end, force_y=Step(time=0.6, after=-25.0)),
        ],
        contacts=[
            DiskOnHalfPlane2D(name="floor", plane=HalfPlane2D(marker=Marker2D(point=(0.0, -0.4))),
                              disk=Disk2D(marker=end, radius=0.05), law=NewtonImpact(restitution=0.5))
        ],
        outputs=[MarkerOutput2D(name="tip", marker=end), MarkerOutput2D(name="nail", marker=Marker2D())],
    )  # fmt: skip


@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    "name, t_end",
    [
        ("bouncing_ball", 3.0), ("chain", 0.5), ("pendulum", 3.0), ("rocking_block", 1.0), ("stick_slip", 2.0),
        ("woodpecker", 0.3), ("slider_crank_stop", 0.5), ("mass_on_rod", 5e-4), ("cable_ground", 0.2),
        ("sphere_beam", 6e-4), ("split_whole", 0.1), ("newtons_cradle", 0.9), ("arm_stop", 1.0), ("heavy_top", 0.2),
        ("rolling_disk", 1.0), ("spatial_cradle", 0.9), ("spatial_slider_crank_stop", 1.0), ("spinning_sphere", 0.75),
    ],
)  # fmt: skip
def test_the_same_bits_at_other_times(name, t_end):
    """Not at those of the proof."""
    run, sim, _ = build(name, t_end)
    inputs = [x.start for x in sim.system.inputs]
    for t in np.sort(np.random.default_rng(3).uniform(0.0, t_end, 40)):
        found = run.step(float(t), inputs)
        sim.advance(float(t))
        assert found.tobytes() == sim.values().tobytes(), t
    assert (run.events, run.steps) == (len(sim.events), sim.stats["steps"])
    assert run.model.names(1) == tuple(channel.name for channel in sim.channels)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name, t_end",
    [
        ("bouncing_ball", 3.0), ("pendulum_stop", 1.0), ("slider_crank_stop", 0.5), ("woodpecker", 0.3),
        ("cable_ground", 0.1), ("sphere_beam", 6e-4), ("spatial_slider_crank_stop", 0.5), ("rolling_disk", 0.3),
        ("stick_slip", 1.0), ("heavy_top", 0.2),
    ],
)  # fmt: skip
def test_few_channels_have_the_bits_of_all(name, t_end):
    """Each channel alone, some together, and none: the same bits as among all, and the same run from there on."""
    from tlismni.core.native.in_process import NativeRun

    whole, sim, _ = build(name, t_end)
    part = NativeRun(whole.model)
    inputs, count = [x.start for x in sim.system.inputs], len(sim.channels)
    random = np.random.default_rng(5)
    choices = [[k] for k in random.permutation(count).tolist()]
    choices += [random.choice(count, int(random.integers(0, 4)), replace=False).tolist() for _ in range(20)]
    times = np.sort(random.uniform(0.0, t_end, len(choices)))
    for t, wanted in zip(times.tolist(), choices, strict=True):
        part.want(wanted)
        found, expected = part.step(t, inputs), whole.step(t, inputs)
        assert found[wanted].tobytes() == expected[wanted].tobytes(), (t, [sim.channels[k].name for k in wanted])
    assert (part.events, part.steps) == (whole.events, whole.steps)
    part.want(range(count))
    assert part.look().tobytes() == whole.look().tobytes()


def test_inputs_change_as_in_python():
    """Some of them make the closed contact let go at once, or slide."""
    run, sim, _ = build("slider_crank_stop", 1.0)
    (name,) = run.model.names(0)
    random = np.random.default_rng(4)
    for k in range(1, 60):
        value = float(random.uniform(-30.0, 30.0)) if k % 3 == 0 else run._inputs[0]
        found = run.step(0.02 * k, [value])
        sim.set_inputs({name: value})
        sim.advance(0.02 * k)
        assert found.tobytes() == sim.values().tobytes(), k
    assert run.events == len(sim.events) > 5


@pytest.mark.parametrize("seed", range(6))
def test_inputs_that_lead_elsewhere(seed):
    """Positions and contacts that the run without inputs never meets were looked at too."""
    random = np.random.default_rng(seed)
    run, sim, _ = build("pendulum_stop")
    t, torque = 0.0, 0.0
    for _ in range(80):
        t += float(random.uniform(0.002, 0.1))
        if random.random() < 0.5:
            torque = float(random.uniform(-60.0, 60.0))
        found = run.step(t, [torque])
        sim.set_inputs({"torque": torque})
        sim.advance(t)
        assert found.tobytes() == sim.values().tobytes(), t
    assert run.events == len(sim.events)


def test_markers_and_forces_that_jump():
    """Channels of markers, and a force that begins and ends at given times."""
    from tlismni.core.native.in_process import NativeModel, NativeRun

    model = jumping_model()
    sim = Simulation(model)
    run = NativeRun(NativeModel(image_of(model, 1.5), LIBRARY))
    for t in np.random.default_rng(6).uniform(0.0, 1.5, 30).cumsum() / 16.0:
        found = run.step(float(t))
        sim.advance(float(t))
        assert found.tobytes() == sim.values().tobytes(), t
    assert run.model.names(1).count("tip.ax") == 1 and sim.t > 0.8


def test_events_one_by_one():
    run, sim, _ = build("woodpecker", 0.5)
    seen = 0
    while run.step_to_event(0.5):
        assert sim.advance_to_event(0.5) and run.t == sim.t
        assert run.look().tobytes() == sim.values().tobytes()
        while True:
            again = run.happen()
            assert again == sim.handle_event()
            seen += 1
            if not again:
                break
        assert run.look().tobytes() == sim.values().tobytes()
    assert not sim.advance_to_event(0.5)
    assert run.t == sim.t == 0.5 and seen > 20


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name, t_end", [("woodpecker", 0.5), ("chain", 1.0), ("pendulum", 6.0)])
def test_going_back_and_to_other_runs(name, t_end):
    from tlismni.core.native.in_process import NativeRun

    run, *_ = build(name, t_end)
    other = NativeRun(run.model)
    times = np.linspace(0.0, t_end, 21)[1:].tolist()
    rows, kept, packed = [], [], []
    for t in times:
        kept.append(run.save())
        packed.append(run.pack())
        rows.append(run.step(t).tobytes())
    for first in (15, 3, 11):
        run.restore(kept[first])
        other.unpack(packed[first])
        for t, wanted in zip(times[first:], rows[first:], strict=True):
            assert run.step(t).tobytes() == other.step(t).tobytes() == wanted
        assert run.pack() == other.pack()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name, t_end, parameter, value", [
    ("pendulum_stop", 1.0, "mass", 0.3), ("slider_crank_stop", 0.5, "crank_mass", 0.5), ("chain", 0.5, "gravity", 3.7),
])  # fmt: skip
def test_going_back_to_a_start_with_other_parameters(name, t_end, parameter, value):
    """Matrices of one start, whose units are others, do not serve a state of another."""
    from tlismni.core.native.export import image_and_parameters
    from tlismni.core.native.in_process import NativeModel, NativeRun
    from tlismni.core.native.parameters import Setting

    scenario = load(name)
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    setting = Setting(parameter, scenario.parameters[parameter], 1e-3, 1e3, lambda values: load(name, **values).model)
    image, found, _ = image_and_parameters(scenario.model, t_end, [setting], **settings)
    assert [p.begins for p in found] == [True]
    model = NativeModel(image, LIBRARY)
    run, inputs = NativeRun(model), [0.0] * len(model.names(0))
    times, random = np.linspace(0.0, t_end, 9)[1:].tolist(), np.random.default_rng(2)

    def way(other):
        states, rows = [], []
        if other:
            run.set_parameter(0, value)
        run.look()
        for t in times:
            states.append((run.save(), run.pack()))
            rows.append(run.step(t, inputs).tobytes())
        return states, rows

    ways = []
    for other in (False, True, False):
        ways.append(way(other))
        run.restart()
    assert ways[0][1] == ways[2][1] != ways[1][1]
    for _ in range(12):
        (states, rows), first = ways[int(random.integers(3))], int(random.integers(len(times)))
        if random.random() < 0.3:
            run.unpack(states[first][1])
        else:
            run.restore(states[first][0])
        for t, wanted in list(zip(times, rows, strict=True))[first : first + int(random.integers(1, 9))]:
            assert run.step(t, inputs).tobytes() == wanted


@pytest.mark.parametrize("name", ["bouncing_ball", "chain", "slider_crank_stop"])
def test_a_state_has_no_structures(name):
    """It is about as large as Python's, and a small part of the memory that a run works in."""
    run, sim, image = build(name, 0.1)
    parts = sim.state().arrays
    assert len(run.save()) < 3 * sum(x.nbytes for x in parts.values()) + 4096 and 4 * len(run.save()) < len(image)


def test_packed_states_that_are_none():
    run, *_ = build("bouncing_ball", 1.0)
    stranger, *_ = build("bouncing_ball", 1.0, restitution=0.5)
    before, packed = run.save(), run.pack()
    broken = bytearray(packed)
    broken[len(packed) // 2] ^= 1
    for bad in (b"", packed[:-1], packed + b"\0", bytes(broken), stranger.pack()):
        with pytest.raises(SimulationError, match="no packed state of this image"):
            run.unpack(bad)
    assert run.save() == before


def test_images_that_are_none():
    from tlismni.core.native.in_process import NativeModel

    _, _, image = build("bouncing_ball", 1.0)
    broken = bytearray(image)
    broken[-9] ^= 1
    other = image[:8] + b"0" * 32 + image[40:]
    for bad, text in ((b"", "no image"), (image[:100], "no image|damaged"), (image[:-8], "damaged"),
                      (bytes(broken), "damaged"), (other, "another version")):  # fmt: skip
        with pytest.raises(NativeError, match=text):
            NativeModel(bytes(bad), LIBRARY)


@pytest.mark.parametrize(
    "name, text",
    [
        ("split_wall", "motion of a driver"),
        ("four_bar", "singular position"),
    ],
)
def test_what_takes_python_is_refused(name, text):
    with pytest.raises(NativeError, match=text):
        build(name)


def test_wrong_times_and_inputs_and_too_many_steps():
    run, *_ = build("slider_crank_stop", 0.3)
    run.step(0.1, [0.0])
    before = run.save()
    for t, inputs, text in (
        (0.05, [0.0], "before the present"), (np.nan, [0.0], "not finite"), (0.2, [np.inf], "input is not finite"),
    ):  # fmt: skip
        with pytest.raises(SimulationError, match=text):
            run.step(t, inputs)
        run._inputs[:] = 0.0
        assert run.save() == before
    run.limit_steps(2)
    with pytest.raises(SimulationError, match="more steps"):
        run.step(0.3, [0.0])
    with pytest.raises(SimulationError, match="has failed before"):
        run.step(0.3, [0.0])
    run.restore(before)
    run.limit_steps(0)
    run.step(0.3, [0.0])


def test_numbers_of_c_are_those_of_python():
    from tlismni.core.events import records as events
    from tlismni.core.simulation import begin_record, exchange, exchange_record
    from tlismni.core.state import run_records as records
    from tlismni.core.state import workspace_records as system

    text = (NATIVE / "codes.h").read_text()
    found = {}
    for block in re.findall(r"enum \{(.*?)\}", text, re.S):
        last = -1
        for item in filter(None, (x.strip() for x in block.split(","))):
            name, _, value = (part.strip() for part in item.partition("="))
            last = int(value) if value else last + 1
            found[name] = last
    other_names = {"FULL": "EVENTS_FULL", "SETTLE_IT": "SETTLE", "EVENT_FAILED": "FAILED", "WAS_READ": "READ",
                   "NOT_SETTLED": "DECLINED", "REMEDY_DONE": "DONE"}  # fmt: skip
    checked = 0
    for module, names in (
        (exchange, ("NOW", "ASKED_TIME", "LAST_CHANGE", "INTERVAL", "ARRIVED", "WAS_READ")),
        (records, ("UNANSWERED", "NOT_DONE", "REMEDY_DONE", "OTHER_ROWS", "EVENT_SIZE", "GAINS", "REACHED",
                   "EVENT", "FULL", "CHUNK", "STEP_TOO_SMALL", "REPARTITION", "NEAR_SINGULAR", "VIOLATED", "UNLOCATED",
                   "DUE", "SETTLE_IT", "JAM", "WANTED", "EVENT_FAILED", "DIVIDES", "GOES_BY_IMPULSES", "LAST_RESORT",
                   "FALL_BACK", "UNREPAIRED")),
        (system, ("OUTER_DIVERGED", "INNER_DIVERGED", "SINGULAR", "REANALYZE", "NOT_FINITE", "OUTER_SLOW")),
        (begin_record, ("T0",)),
        (exchange_record, ("FIRST_RATE", "SECOND_RATE", "RATES_SINCE", "RATES_SIZE")),
        (events, ("SETTLED", "NOT_SETTLED", "WANTS_ROOM", "WANT_MEMORY")),
    ):  # fmt: skip
        for name in names:
            assert found[name] == getattr(module, other_names.get(name, name)), name
            checked += 1
    for name, dtype in (("Goals", records.GOALS), ("Counts", records.COUNTS), ("Counters", system.COUNTERS)):
        kind, body = re.search(r"typedef struct \{\s*(\w+) ([^{}]*?);\s*\} " + name + ";", text).groups()
        assert tuple(re.split(r",\s*", body)) == dtype.names
        assert {dtype[field] for field in dtype.names} == {np.dtype({"double": float, "int64_t": np.int64}[kind])}
    head = re.search(r"typedef struct \{(.*?)\} Head;", (NATIVE / "image.h").read_text(), re.S)[1]
    assert tuple(re.findall(r"\b(?!int64_t)[a-z_]+\b", head)) == layouts.IMAGE_HEAD
    for name, fields in (("Numbers", layouts.NUMBERS), ("Places", layouts.PLACES)):
        body = re.findall(r"typedef struct \{([^{}]*?)\} " + name + ";", (NATIVE / "image.h").read_text())[0]
        assert tuple(re.findall(r"\b(?!int64_t|double)[a-z_0-9]+\b", body)) == fields
    called = re.search(r"enum \{ (EXCHANGE.*?), CALLED \};", (NATIVE / "image.h").read_text(), re.S)[1]
    names = [name.strip().lower() for name in called.split(",")]
    assert len(names) == len(layouts.CALLED)
    assert all(python.startswith(c) for c, python in zip(names, layouts.CALLED, strict=True))
    assert checked > 30


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name, t", [("woodpecker", 0.21), ("slider_crank_stop", 0.05), ("chain", 0.3), ("stick_slip", 1.1)]
)
def test_states_are_equal_exactly_if_their_futures_are(name, t):
    """Whatever was looked at, counted or built on the way; where inputs or times differ, states do."""
    from tlismni.core.native.in_process import NativeRun

    run, *_ = build(name, 2.0 * t)
    inputs = [0.0] * len(run.model.names(0))
    other, third = NativeRun(run.model), NativeRun(run.model)
    for part in (0.3, 0.7, 1.0):
        run.step(part * t, inputs)
        other.step(part * t, inputs)
        run.look()
        assert run.deciding_bytes() == other.deciding_bytes()
    third.step(1.5 * t, inputs)
    third.look()
    steps = third.steps
    third.unpack(run.pack())
    assert third.deciding_bytes() == run.deciding_bytes() and third.steps == run.steps != steps
    for x in (run, other, third):
        x.step(1.2 * t, inputs)
    assert run.deciding_bytes() == other.deciding_bytes() == third.deciding_bytes()
    other.step(1.2 * t + 1e-4, inputs)
    assert run.deciding_bytes() != other.deciding_bytes()
    if inputs:
        third.step(1.2 * t, [1.0])
        assert run.deciding_bytes() != third.deciding_bytes()
