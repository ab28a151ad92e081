"""The case as a slave of pythonfmu3 (FMI 3.0)."""

from case import Stepper
from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability


class ChainFmi3(Fmi3Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.stepper = Stepper()
        self.time = self.torque = self.angle = self.rate = 0.0
        continuous = Fmi3Variability.continuous
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=continuous))
        self.register_variable(Float64("torque", causality=Fmi3Causality.input))
        self.register_variable(Float64("angle", causality=Fmi3Causality.output))
        self.register_variable(Float64("rate", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        self.angle, self.rate = self.stepper.step(self.torque, current_time + step_size)
        return True
