"""The case that all contenders of fmu_cost.py step: a chain of ten links with a torque as input."""

import os
import site

if "PEER_SITE" in os.environ:  # in a native host Python does not know the environment of the benchmark
    site.addsitedir(os.environ["PEER_SITE"])

from tlismni.core import AppliedTorque2D, Input, InputSignal, Model, Simulation
from tlismni.models import load

SOLVER = {"method": "ebdf", "rtol": 1e-6}
STEP = 1e-3
"""Communication step, s."""
OUTPUTS = ("link1.angle", "link1.angular_velocity")


def chain(links: int = 10) -> Model:
    """The catalogue's chain, with a torque on its first link as input `torque`."""
    model = load("chain", links=links).model
    drive = AppliedTorque2D(name="drive", body=model.bodies[0].name, torque=InputSignal(channel="torque"))
    return Model(**{**dict(model), "forces": (*model.forces, drive), "inputs": (Input(name="torque", unit="N.m"),)})


class Stepper:
    """The solver without any FMI: what the slaves of others wrap, and what the overheads are measured against."""

    def __init__(self) -> None:
        self.simulation = Simulation(chain(), **SOLVER)
        names = [c.name for c in self.simulation.channels]
        self.columns = [names.index(name) for name in OUTPUTS]

    def step(self, torque: float, t: float) -> list[float]:
        """The outputs at `t`, s, after a step with this torque, N m."""
        self.simulation.set_inputs({"torque": torque})
        self.simulation.advance(t)
        return self.simulation.values()[self.columns].tolist()

    def exchange(self, torque: float, t: float) -> list[float]:
        """The same in one call."""
        values = self.simulation.exchange([torque], t)
        return (self.simulation.values() if values is None else values)[self.columns].tolist()
