"""Where things stand in a recorded sample, and the bodies' coordinates as channels."""

from ..model.channels import Channel
from .assembly import Assembly


class SampleLayout:
    """Where things stand in a sample (see `sample.py`)."""

    def __init__(self, assembly: Assembly) -> None:
        n, m, c = assembly.n, assembly.m, len(assembly.contacts)
        self.q, self.v, self.a = slice(1, 1 + n), slice(1 + n, 1 + 2 * n), slice(1 + 2 * n, 1 + 3 * n)
        at = 1 + 3 * n
        self.multipliers = slice(at, at + m)
        at += m
        (
            self.force, self.gap, self.gap_rate, self.mode, self.impulse_jump, self.loss_jump,
            self.friction, self.sliding,
        ) = (at + k * c for k in range(8))  # fmt: skip
        at += 8 * c
        self.kinetic, self.potential, self.strain = at, at + 1, at + 2
        self.work = {name: at + 3 + k for k, name in enumerate(assembly.work_names)}
        at += 3 + len(assembly.work_names)
        self.residuals = (at, at + 1, at + 2)
        self.slot_pairs = slice(at + 3, at + 3 + assembly.n_slots)


def body_coordinate_channels(assembly: Assembly, layout: SampleLayout) -> list[tuple[Channel, int]]:
    """Position, velocity and acceleration of every body coordinate, with their columns in a sample."""
    columns = []
    for body, coordinate, index in assembly.body_columns:
        for level, (name, what, part) in enumerate((
            (coordinate.name, "", layout.q),
            (coordinate.rate, "rate of ", layout.v),
            (coordinate.acceleration, "second rate of ", layout.a),
        )):  # fmt: skip
            channel = Channel(f"{body}.{name}", coordinate.unit_of(level), f"{what}{coordinate.name} of {body}")
            columns.append((channel, part.start + index))
    return columns
