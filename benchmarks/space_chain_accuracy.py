"""CPU time for an error of 1e-6 m or others: the chain of N rods on ball joints in space, ours beside others.

Run: python benchmarks/space_chain_accuracy.py [--links 1 10] [--goals 1e-3 1e-6] [--limit 60]. Wants exudyn, mujoco
and pinocchio (`pip install mujoco pin`); what is not installed is left out. One core, in turns:

* ours: each method, over tolerances; "default" is what runs if nothing is said but the tolerances;
* exudyn: generalized-alpha of fixed step (spectral radius 0.9) in its fastest setting, halved until it will do;
* MuJoCo: its RK4 of fixed step, halved likewise; the loop over the steps is in C;
* Pinocchio: articulated bodies (`aba`) under scipy's DOP853, quaternions as coordinates; the loop is in Python.

The last two have minimal coordinates: 7 N numbers without constraints, where ours and exudyn's are 14 N and 4 N rows.
The error is the largest of the far ends of all rods at the end. That of the free end alone says nothing of long chains:
it falls as a free body does until what happens at the pivot has come there. The exact places are our `irk`'s; our
`adams` and DOP853 on Pinocchio's confirm them.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np
from chain_speed import pin_to_one_core
from space_chain_speed import LENGTH, MASS, RADIUS, spatial_chain
from tlismni.core import Simulation
from tlismni.core.model.attitude import rotation_matrix

T_END = {1: 2.0, 10: 2.0, 100: 0.5, 1000: 0.5}
EXACT = {1: 1e-12, 10: 1e-12, 100: 1e-12, 1000: 1e-10}
"""Tolerance of what counts as exact: places of 1000 m carry a rounding of 1e-13 m, and rods of 1 m turn by that."""
TOLERANCES = [10.0 ** (-0.5 * k) for k in range(2, 25)]
METHODS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("default", "auto", {}),
    ("ebdf", "ebdf", {}),
    ("ebdf, auto", "ebdf", {"k": "auto"}),
    ("mebdf, auto", "mebdf", {"k": "auto"}),
    ("bdf, auto", "bdf", {"order": "auto"}),
    ("adams, order 4", "adams", {"order": 4}),
    ("adams, order 6", "adams", {"order": 6}),
    ("adams, order 8", "adams", {"order": 8}),
    ("irk, radau3", "irk", {}),
    ("irk, gauss2", "irk", {"tableau": "gauss2"}),
    ("irk, gauss3", "irk", {"tableau": "gauss3"}),
    ("irk, sdirk4", "irk", {"tableau": "sdirk4"}),
    ("newmark", "newmark", {}),
    ("hht", "hht", {}),
)
Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Found:
    """What it takes: CPU time, s; the error there, m; with which setting. `told` if it is not run but follows from the
    order."""

    seconds: float
    error: float
    setting: str
    told: bool = False


def far_ends(q: Array) -> Array:
    """Places of the far ends of all rods (N, 3), m."""
    along = np.array([0.5 * LENGTH, 0.0, 0.0])
    return np.array([rod[:3] + rotation_matrix(rod[3:]) @ along for rod in q.reshape(-1, 7)])


def apart(ends: Array, exact: Array) -> float:
    """The largest distance, m; infinite where a run has come to no number."""
    distance = float(np.max(np.linalg.norm(ends - exact, axis=1)))
    return distance if np.isfinite(distance) else float("inf")


def cheapest(runs: Iterator[tuple[float, Array, str]], exact: Array, goal: float) -> Found | None:
    """The first of ever finer runs that is good enough."""
    for seconds, end, setting in runs:
        error = apart(end, exact)
        if error <= goal:
            return Found(seconds, error, setting)
    return None


def halved(
    run: Callable[[int], tuple[float, Array]], exact: Array, order: int, limit: float, goal: float, steps: int = 16
) -> Found | None:
    """Fixed steps, twice as many each time until they will do; what would take more than `limit` s is told by the
    order, where runs have come near enough for that."""
    while True:
        seconds, end = run(steps)
        error = apart(end, exact)
        if error <= goal:
            return Found(seconds, error, f"{steps} steps")
        factor = (error / goal) ** (1.0 / order)
        if seconds * factor > limit and seconds > 0.02 * limit and error < 0.1:
            return Found(seconds * factor, goal, f"about {steps * factor:.0f} steps", told=True)
        if seconds > limit:
            return None
        steps *= 2


def run_ours(model: Any, t_end: float, method: str, rtol: float, options: dict[str, Any]) -> tuple[float, Array]:
    """CPU time of the run alone, s, and the far ends."""
    simulation = Simulation(model, method, rtol, 0.01 * rtol, record=False, **options)
    began = process_time()
    simulation.run_to(t_end)
    return process_time() - began, far_ends(simulation.sample()[simulation.table.layout.q])


def ours(links: int, t_end: float, exact: Array, limit: float, goal: float) -> list[tuple[str, Found | None]]:
    """Each method at the loosest tolerance that will do, best of three; None where none does within the limit."""
    model, found = spatial_chain(links), []
    for name, method, options in METHODS:

        def run(rtol: float, method: str = method, options: dict[str, Any] = options) -> tuple[float, Array]:
            return run_ours(model, t_end, method, rtol, options)

        def runs(run: Callable[[float], tuple[float, Array]] = run) -> Iterator[tuple[float, Array, str]]:
            for k, rtol in enumerate(TOLERANCES):
                seconds, ends = run(rtol)
                yield seconds, ends, str(k)
                if seconds > limit:
                    return

        run(1e-3)  # compiled code is loaded once, outside the timing
        best = cheapest(runs(), exact, goal)
        if best is not None:
            rtol = TOLERANCES[int(best.setting)]
            seconds = min(best.seconds, *(run(rtol)[0] for _ in range(2)))
            best = Found(seconds, best.error, f"rtol {rtol:.1g}")
        found.append((f"ours, {name}", best))
    return found


def exudyn(links: int, t_end: float, exact: Array, limit: float, goal: float) -> Found | None:
    """The fastest of its settings."""
    from exudyn_chain import run_model, settings_for

    model, trial = spatial_chain(links), 500
    times = {s.name: (run_model(model, t_end, t_end / trial, s.settings)[0], s.settings) for s in settings_for(links)}
    name = min(times, key=lambda each: times[each][0])

    def run(steps: int) -> tuple[float, Array]:
        seconds, q = run_model(model, t_end, t_end / steps, times[name][1])
        return seconds, far_ends(q)

    # where steps are too long, exudyn halves them itself, and takes far longer than its order tells
    found = halved(run, exact, 2, limit, goal, steps=16 if links < 1000 else 1024)
    return found and Found(found.seconds, found.error, f"{found.setting}, {name}", found.told)


def _inertia() -> tuple[float, float]:
    return 0.5 * MASS * RADIUS**2, MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0


def mujoco(links: int, t_end: float, exact: Array, limit: float, goal: float) -> Found | None:
    """RK4."""
    import mujoco as mj

    axial, across = _inertia()
    body = (
        f'<body pos="{{x}} 0 0"><joint type="ball"/><inertial mass="{MASS}" pos="{0.5 * LENGTH} 0 0" '
        f'diaginertia="{axial} {across} {across}"/>'
    )
    chain = "".join(body.format(x=0.0 if k == 0 else LENGTH) for k in range(links)) + "</body>" * links
    text = '<mujoco><option integrator="RK4" gravity="0 0 -9.81"/><worldbody>' + chain + "</worldbody></mujoco>"
    try:
        model = mj.MjModel.from_xml_string(text)
    except ValueError as error:
        print("MuJoCo:", *str(error).split(), flush=True)  # its files nest less deep than 1000 bodies
        return None

    def run(steps: int) -> tuple[float, Array]:
        data = mj.MjData(model)
        model.opt.timestep = t_end / steps
        data.qvel[2] = 0.5 / links
        began = process_time()
        mj.mj_step(model, data, steps)
        seconds = process_time() - began
        mj.mj_forward(model, data)
        return seconds, data.xpos[1:] + LENGTH * data.xmat[1:, ::3]

    run(10)
    return halved(run, exact, 4, limit, goal)


class Pinocchio:
    """Quaternions (x, y, z, w) and angular velocities of each ball joint."""

    def __init__(self, links: int) -> None:
        import pinocchio as pin

        self.pin, self.links = pin, links
        axial, across = _inertia()
        inertia = pin.Inertia(MASS, np.array([0.5 * LENGTH, 0.0, 0.0]), np.diag([axial, across, across]))
        self.model, parent = pin.Model(), 0
        self.model.gravity.linear = np.array([0.0, 0.0, -9.81])
        for k in range(links):
            place = pin.SE3(np.eye(3), np.array([0.0 if k == 0 else LENGTH, 0.0, 0.0]))
            parent = self.model.addJoint(parent, pin.JointModelSpherical(), place, f"ball{k}")
            self.model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        self.data, self.torque = self.model.createData(), np.zeros(3 * links)

    def rate(self, t: float, y: Array) -> Array:
        """y'."""
        n = self.links
        u = y[: 4 * n].reshape(n, 4)
        unit = u / np.sqrt(np.einsum("ij,ij->i", u, u))[:, None]
        w = y[4 * n :].reshape(n, 3)
        out = np.empty_like(y)
        turned = out[: 4 * n].reshape(n, 4)
        turned[:, :3] = 0.5 * (u[:, 3:] * w + np.cross(u[:, :3], w))
        turned[:, 3] = -0.5 * np.einsum("ij,ij->i", u[:, :3], w)
        out[4 * n :] = self.pin.aba(self.model, self.data, unit.ravel(), y[4 * n :], self.torque)
        return out

    def run(self, t_end: float, rtol: float) -> tuple[float, Array]:
        """CPU time, s, and the far ends."""
        from scipy.integrate import solve_ivp

        n = self.links
        y = np.concatenate([np.tile([0.0, 0.0, 0.0, 1.0], n), np.zeros(3 * n)])
        y[4 * n + 2] = 0.5 / n
        began = process_time()
        solved = solve_ivp(self.rate, (0.0, t_end), y, method="DOP853", rtol=rtol, atol=0.01 * rtol, t_eval=[t_end])
        seconds = process_time() - began
        u = solved.y[: 4 * n, -1].reshape(n, 4)
        self.pin.forwardKinematics(self.model, self.data, (u / np.linalg.norm(u, axis=1)[:, None]).ravel())
        along = np.array([LENGTH, 0.0, 0.0])
        return seconds, np.array([self.data.oMi[k + 1].act(along) for k in range(n)])


def pinocchio(links: int) -> Pinocchio | None:
    """None where it is not installed, or cannot make its data."""
    if not find_spec("pinocchio"):
        return None
    try:
        return Pinocchio(links)
    except MemoryError:
        print(f"Pinocchio: no memory for the data of {links} links", flush=True)
        return None


def show(name: str, found: Found | None) -> None:
    """A line."""
    if found is None:
        print(f"  {name:22} not within the limit", flush=True)
        return
    told = "about" if found.told else f"{found.error:.1e} m"
    print(f"  {name:22} {1e3 * found.seconds:10.2f} ms  {told:>10}  {found.setting}", flush=True)


def run_case(links: int, limit: float, goals: list[float]) -> None:
    """A block of lines."""
    t_end, rtol = T_END[links], EXACT[links]
    model = spatial_chain(links)
    _, exact = run_ours(model, t_end, "irk", rtol, {})
    confirmed = {"adams": run_ours(model, t_end, "adams", rtol, {"order": 8})[1]}
    peer = pinocchio(links)
    if peer is not None:
        confirmed["DOP853"] = peer.run(t_end, rtol)[1]
    told = ", ".join(f"{name} {apart(ends, exact):.1e} m" for name, ends in confirmed.items())
    print(f"{links} links, {t_end} s, exact to: {told}", flush=True)
    for goal in goals:
        print(f" error {goal:g} m", flush=True)
        for name, found in ours(links, t_end, exact, limit, goal):
            show(name, found)
        if find_spec("exudyn"):
            show("exudyn", exudyn(links, t_end, exact, limit, goal))
        if peer is not None:
            runs = ((*peer.run(t_end, each), f"rtol {each:.1g}") for each in TOLERANCES)
            show("Pinocchio, DOP853", cheapest(runs, exact, goal))
        if find_spec("mujoco"):
            show("MuJoCo, RK4", mujoco(links, t_end, exact, limit, goal))


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--links", type=int, nargs="*", default=list(T_END), choices=list(T_END))
    parser.add_argument("--goals", type=float, nargs="*", default=[1e-6], help="errors, m")
    parser.add_argument("--limit", type=float, default=60.0, help="s, of a run of fixed steps")
    parser.add_argument("--core", type=int, help="number of the core to run on")
    options = parser.parse_args()
    pin_to_one_core(options.core)
    for links in options.links:
        run_case(links, options.limit, options.goals)


if __name__ == "__main__":
    main()
