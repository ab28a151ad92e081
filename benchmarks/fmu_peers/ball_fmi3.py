"""A bouncing ball as a slave of pythonfmu3, of as little Python as it takes: explicit steps of a millisecond, bounces
at the end of the step in which they happen, as in `ball.c`."""

from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability

STEP, GRAVITY, RESTITUTION = 1e-3, 9.81, 0.8


class BallFmi3(Fmi3Slave):
    """Height (m) and velocity (m/s)."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time, self.height, self.velocity = 0.0, 1.0, 0.0
        continuous = Fmi3Variability.continuous
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=continuous))
        self.register_variable(Float64("height", causality=Fmi3Causality.output))
        self.register_variable(Float64("velocity", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        while self.time + 0.5 * STEP < current_time + step_size:
            self.time += STEP
            self.height += STEP * self.velocity
            self.velocity -= STEP * GRAVITY
            if self.height < 0.0 and self.velocity < 0.0:
                self.height = 0.0
                self.velocity *= -RESTITUTION
        return True
