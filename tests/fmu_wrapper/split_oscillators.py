"""Two masses on springs, split in two at the spring between them, and the exact maps of the coupled steps.

    m1 x1'' + c1 x1' + (k1 + K) x1 = K x2,    m2 x2'' + c2 x2' + (k2 + K) x2 = K x1

Each half is linear with a held input, so that one step of it is a matrix exponential, and one step of a master
algorithm is a matrix too.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import block_diag, expm
from tlismni.core import CoordinateLoad, LinearSystem, Model
from tlismni.core.model.channels import Input
from tlismni.core.model.signals import InputSignal
from tlismni.fmu_wrapper.master import Connection, MasterSettings, of_source, run

COUPLING = 40.0
START = np.array([0.1, 0.0, -0.05, 0.0])
"""x1, x1', x2, x2'."""
EXACT = {"method": "irk", "rtol": 1e-11, "atol": 1e-13}


@dataclass(frozen=True)
class Oscillators:
    """Masses (kg), springs to the ground (N/m), dampers (N s/m), and the spring between them (N/m)."""

    masses: tuple[float, float] = (1.0, 0.5)
    springs: tuple[float, float] = (30.0, 20.0)
    dampers: tuple[float, float] = (0.0, 0.0)
    coupling: float = COUPLING
    solver: dict = field(default_factory=lambda: dict(EXACT))

    def model(self, k: int) -> Model:
        return Model(
            name=f"half_{k}",
            bodies=[
                LinearSystem(
                    name="mass", coordinates=("x",), mass=((self.masses[k],),), damping=((self.dampers[k],),),
                    stiffness=((self.springs[k] + self.coupling,),), position=(START[2 * k],),
                )
            ],
            forces=[CoordinateLoad(name="load", body="mass", coordinate="x", load=InputSignal(channel="force"))],
            inputs=[Input(name="force", unit="N")],
        )  # fmt: skip

    def instances(self, fmi="3.0"):
        return [of_source("ab"[k], self.model(k), fmi, **self.solver) for k in range(2)]

    def run(self, algorithm, step, t_end, fmi="3.0", record=("*.mass.x", "*.mass.d_x"), **settings):
        connected = MasterSettings(algorithm=algorithm, step=step, t_end=t_end, **settings)
        return run(self.instances(fmi), connections(self.coupling), connected, record)

    @property
    def halves(self):
        return [
            np.array([[0.0, 1.0], [-(k + self.coupling) / m, -c / m]])
            for m, k, c in zip(self.masses, self.springs, self.dampers, strict=True)
        ]

    def monolithic(self, t):
        """The exact state at t."""
        a = block_diag(*self.halves)
        a[1, 2], a[3, 0] = self.coupling / self.masses[0], self.coupling / self.masses[1]
        return expm(a * t) @ START

    def map(self, algorithm, h, weight=0.5):
        """The state after a step of h, as a matrix; `weight` of the step's end in the inputs of iterated algorithms."""
        own, by_input = self.parts(h)
        if algorithm == "jacobi":
            return own + by_input
        if algorithm == "gauss-seidel":  # the second half takes x1 at the end of the step
            late = np.vstack([np.zeros((2, 4)), by_input[2:]])
            return np.linalg.solve(np.eye(4) - late, own + by_input - late)
        return np.linalg.solve(np.eye(4) - weight * by_input, own + (1.0 - weight) * by_input)

    def own(self, h):
        """The state after a step of h without coupling, as a matrix."""
        return self.parts(h)[0]

    def parts(self, h):
        """The state after a step of h, from the state at its start and from the displacements that are held."""
        own, by_input = np.zeros((4, 4)), np.zeros((4, 4))
        for k, (a, m) in enumerate(zip(self.halves, self.masses, strict=True)):
            held = np.zeros((3, 3))
            held[:2, :2], held[1, 2] = a, 1.0 / m
            step = expm(held * h)
            own[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = step[:2, :2]
            by_input[2 * k : 2 * k + 2, 2 - 2 * k] = self.coupling * step[:2, 2]
        return own, by_input

    def radius(self, algorithm, h, weight=0.5):
        """Growth of the least stable motion in a step."""
        return float(np.max(np.abs(np.linalg.eigvals(self.map(algorithm, h, weight)))))


def connections(coupling=COUPLING):
    return [
        Connection(source="a.mass.x", target="b.force", factor=coupling, unit="N/m"),
        Connection(source="b.mass.x", target="a.force", factor=coupling, unit="N/m"),
    ]


def state(result, k=-1):
    return np.array([result[f"{i}.mass.{q}"][k] for i in "ab" for q in ("x", "d_x")])
