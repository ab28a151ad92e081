"""The case as a slave of pythonfmu (FMI 2.0)."""

from case import Stepper
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class ChainFmi2(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.stepper = Stepper()
        self.torque = self.angle = self.rate = 0.0
        self.register_variable(Real("torque", causality=Fmi2Causality.input))
        self.register_variable(Real("angle", causality=Fmi2Causality.output))
        self.register_variable(Real("rate", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.angle, self.rate = self.stepper.step(self.torque, current_time + step_size)
        return True
