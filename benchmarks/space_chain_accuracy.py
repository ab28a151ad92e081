"""CPU time for an error of 1e-6 m: the chain of N rods on ball joints in space, ours with error control beside others.

Run: python benchmarks/space_chain_accuracy.py [--links 1 10] [--limit 60]. Wants exudyn, mujoco and pinocchio (`pip
install mujoco pin`); what is not installed is left out. One core, in turns:

* ours: each method that is good at smooth motion, over tolerances;
* exudyn: generalized-alpha of fixed step (spectral radius 0.9) in its fastest setting, halved until it will do;
* MuJoCo: its RK4 of fixed step, halved likewise; the loop over the steps is in C;
* Pinocchio: articulated bodies (`aba`) under scipy's DOP853, quaternions as coordinates; the loop is in Python.

The last two have minimal coordinates: 7 N numbers without constraints, where ours and exudyn's are 14 N and 4 N rows.
The error is that of the free end at the end; the exact place is our `irk`'s at 1e-12, which DOP853 on Pinocchio's
confirms.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np
from chain_speed import pin_to_one_core
from space_chain_speed import LENGTH, MASS, RADIUS, spatial_chain, tip
from tlismni.core import Simulation

GOAL = 1e-6
T_END = {1: 2.0, 10: 2.0, 100: 0.5}
METHODS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("adams", {"order": 8}),
    ("ebdf", {"k": "auto"}),
    ("bdf", {"order": "auto"}),
    ("irk", {}),
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


def cheapest(runs: Iterator[tuple[float, Array, str]], exact: Array) -> Found | None:
    """The first of ever finer runs that is good enough."""
    for seconds, end, setting in runs:
        error = float(np.linalg.norm(end - exact))
        if error <= GOAL:
            return Found(seconds, error, setting)
    return None


def halved(run: Callable[[int], tuple[float, Array]], exact: Array, order: int, limit: float) -> Found:
    """Fixed steps, twice as many each time until they will do; what would take more than `limit` s is told by the
    order."""
    steps = 16
    while True:
        seconds, end = run(steps)
        error = float(np.linalg.norm(end - exact))
        if error <= GOAL:
            return Found(seconds, error, f"{steps} steps")
        factor = (error / GOAL) ** (1.0 / order)
        if seconds * factor > limit and seconds > 0.02 * limit and error < 0.1:
            return Found(seconds * factor, GOAL, f"about {steps * factor:.0f} steps", told=True)
        steps *= 2


def ours(links: int, t_end: float, exact: Array) -> list[tuple[str, Found]]:
    """Each method at the loosest tolerance that will do, best of three."""
    model, found = spatial_chain(links), []
    for method, options in METHODS:

        def run(rtol: float, method: str = method, options: dict[str, Any] = options) -> tuple[float, Array]:
            simulation = Simulation(model, method, rtol, 0.01 * rtol, record=False, **options)
            began = process_time()
            simulation.run_to(t_end)
            return process_time() - began, tip(simulation.sample()[simulation.table.layout.q])

        run(1e-3)  # compiled code is loaded once, outside the timing
        tolerances = [10.0 ** (-0.5 * k) for k in range(6, 25)]
        best = cheapest(((*run(rtol), f"rtol {rtol:.1g}") for rtol in tolerances), exact)
        if best is not None:
            rtol = float(best.setting.split()[1])
            rtol = min(tolerances, key=lambda each, rtol=rtol: abs(np.log(each / rtol)))
            seconds = min(run(rtol)[0] for _ in range(3))
            found.append((f"ours, {method}", Found(seconds, best.error, best.setting)))
    return found


def exudyn(links: int, t_end: float, exact: Array, limit: float) -> Found:
    """The fastest of its settings."""
    from exudyn_chain import run_model, settings_for

    model, trial = spatial_chain(links), 500
    times = {s.name: (run_model(model, t_end, t_end / trial, s.settings)[0], s.settings) for s in settings_for(links)}
    name = min(times, key=lambda each: times[each][0])

    def run(steps: int) -> tuple[float, Array]:
        seconds, q = run_model(model, t_end, t_end / steps, times[name][1])
        return seconds, tip(q)

    found = halved(run, exact, 2, limit)
    return Found(found.seconds, found.error, f"{found.setting}, {name}", found.told)


def _inertia() -> tuple[float, float]:
    return 0.5 * MASS * RADIUS**2, MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0


def mujoco(links: int, t_end: float, exact: Array, limit: float) -> Found:
    """RK4."""
    import mujoco as mj

    axial, across = _inertia()
    body = (
        f'<body pos="{{x}} 0 0"><joint type="ball"/><inertial mass="{MASS}" pos="{0.5 * LENGTH} 0 0" '
        f'diaginertia="{axial} {across} {across}"/>'
    )
    chain = "".join(body.format(x=0.0 if k == 0 else LENGTH) for k in range(links)) + "</body>" * links
    text = '<mujoco><option integrator="RK4" gravity="0 0 -9.81"/><worldbody>' + chain + "</worldbody></mujoco>"
    model = mj.MjModel.from_xml_string(text)

    def run(steps: int) -> tuple[float, Array]:
        data = mj.MjData(model)
        model.opt.timestep = t_end / steps
        data.qvel[2] = 0.5 / links
        began = process_time()
        mj.mj_step(model, data, steps)
        seconds = process_time() - began
        mj.mj_forward(model, data)
        return seconds, data.xpos[-1] + data.xmat[-1].reshape(3, 3) @ np.array([LENGTH, 0.0, 0.0])

    run(10)
    return halved(run, exact, 4, limit)


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
        """CPU time, s, and the free end."""
        from scipy.integrate import solve_ivp

        n = self.links
        y = np.concatenate([np.tile([0.0, 0.0, 0.0, 1.0], n), np.zeros(3 * n)])
        y[4 * n + 2] = 0.5 / n
        began = process_time()
        solved = solve_ivp(self.rate, (0.0, t_end), y, method="DOP853", rtol=rtol, atol=0.01 * rtol, t_eval=[t_end])
        seconds = process_time() - began
        u = solved.y[: 4 * n, -1].reshape(n, 4)
        self.pin.forwardKinematics(self.model, self.data, (u / np.linalg.norm(u, axis=1)[:, None]).ravel())
        return seconds, self.data.oMi[n].act(np.array([LENGTH, 0.0, 0.0]))


def run_case(links: int, limit: float) -> None:
    """A block of lines."""
    t_end = T_END[links]
    simulation = Simulation(spatial_chain(links), "irk", 1e-12, 1e-14, record=False)
    simulation.run_to(t_end)
    exact = tip(simulation.sample()[simulation.table.layout.q])
    rows = ours(links, t_end, exact)
    if find_spec("exudyn"):
        rows.append(("exudyn", exudyn(links, t_end, exact, limit)))
    if find_spec("mujoco"):
        rows.append(("MuJoCo, RK4", mujoco(links, t_end, exact, limit)))
    if find_spec("pinocchio"):
        peer = Pinocchio(links)
        _, confirmed = peer.run(t_end, 1e-12)
        print(f"{links} links, {t_end} s: exact to {np.linalg.norm(confirmed - exact):.1e} m", flush=True)
        tolerances = [10.0 ** (-0.5 * k) for k in range(6, 25)]
        found = cheapest(((*peer.run(t_end, rtol), f"rtol {rtol:.1g}") for rtol in tolerances), exact)
        if found is not None:
            rows.append(("Pinocchio, DOP853", found))
    for name, found in rows:
        told = "about" if found.told else f"{found.error:.1e} m"
        print(f"  {name:20} {1e3 * found.seconds:10.2f} ms  {told:>10}  {found.setting}", flush=True)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--links", type=int, nargs="*", default=list(T_END), choices=list(T_END))
    parser.add_argument("--limit", type=float, default=60.0, help="s, of a run of fixed steps")
    parser.add_argument("--core", type=int, help="number of the core to run on")
    options = parser.parse_args()
    pin_to_one_core(options.core)
    for links in options.links:
        run_case(links, options.limit)


if __name__ == "__main__":
    main()
