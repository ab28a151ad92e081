"""Channels: named columns computed from recorded samples."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contact.modes import ACTIVE, CLOSED, MODE_NAMES
from ..model.channels import Channel
from ..system.assembly import Assembly

Column = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_RATES = {"x": ("vx", "m/s"), "y": ("vy", "m/s"), "angle": ("angular_velocity", "rad/s")}
_ACCELERATIONS = {"x": ("ax", "m/s2"), "y": ("ay", "m/s2"), "angle": ("angular_acceleration", "rad/s2")}
_UNITS = {"x": "m", "y": "m", "angle": "rad"}


class SampleLayout:
    """Where things stand in a sample (see `sample.py`)."""

    def __init__(self, assembly: Assembly) -> None:
        n, m, c = assembly.n, assembly.m, len(assembly.contacts)
        self.q, self.v, self.a = slice(1, 1 + n), slice(1 + n, 1 + 2 * n), slice(1 + 2 * n, 1 + 3 * n)
        at = 1 + 3 * n
        self.multipliers = slice(at, at + m)
        at += m
        self.force, self.gap, self.gap_rate, self.mode, self.impulse_jump, self.loss_jump = (
            at + k * c for k in range(6)
        )
        at += 6 * c
        self.kinetic, self.potential, self.strain = at, at + 1, at + 2
        self.work = {name: at + 3 + k for k, name in enumerate(assembly.work_names)}
        at += 3 + len(assembly.work_names)
        self.residuals = (at, at + 1, at + 2)


class ChannelTable:
    """The output channels of a system and how to compute them."""

    def __init__(self, system: Any, assembly: Assembly) -> None:
        self.layout = layout = SampleLayout(assembly)
        self.initial_energy = 0.0
        self._columns: list[tuple[Channel, Column]] = []
        self._plain: list[tuple[int, int]] = []
        for channel, at in system.coordinate_channels(assembly, layout):
            self._add(channel, at)
        for k, channel in enumerate(assembly.multiplier_channels):
            self._add(channel, layout.multipliers.start + k)
        for k, contact in enumerate(assembly.contacts):
            self._add_contact(k, contact.name)
        self._add_energies(assembly)
        for column_index, level, unit in zip(
            layout.residuals, ("position", "velocity", "acceleration"), ("m", "m/s", "m/s2"), strict=True
        ):
            self._add(
                Channel(f"residual.{level}", unit, f"largest constraint violation at {level} level"), column_index
            )
        self.channels = tuple(channel for channel, _ in self._columns)
        self._plain_channels = np.array([k for k, _ in self._plain], dtype=np.intp)
        self._plain_columns = np.array([column for _, column in self._plain], dtype=np.intp)
        plain = set(self._plain_channels.tolist())
        self._computed = [k for k in range(len(self._columns)) if k not in plain]
        self.index = {channel.name: k for k, channel in enumerate(self.channels)}

    def _add(self, channel: Channel, column: int) -> None:
        """A channel that stands in the sample as it is."""
        self._plain.append((len(self._columns), column))
        self._columns.append((channel, lambda s: s[:, column]))

    def _add_contact(self, k: int, name: str) -> None:
        layout = self.layout
        impulse, dissipation = layout.work[f"{name}.impulse"], layout.work[f"{name}.dissipation"]
        self._add(Channel(f"{name}.gap", "m", "gap, negative where the shapes overlap"), layout.gap + k)
        self._add(Channel(f"{name}.gap_rate", "m/s", "rate of the gap"), layout.gap_rate + k)
        self._add(Channel(f"{name}.normal_force", "N", "normal force, compression positive"), layout.force + k)
        self._columns += [
            (
                Channel(f"{name}.impulse", "N.s", "normal impulse since the start, impacts included"),
                lambda s: s[:, impulse] + s[:, layout.impulse_jump + k],
            ),
            (
                Channel(f"{name}.dissipation", "J", "energy lost in the contact since the start"),
                lambda s: s[:, dissipation] + s[:, layout.loss_jump + k],
            ),
            (
                Channel(f"{name}.in_contact", "1", "true while the contact carries force", "boolean"),
                lambda s: (s[:, layout.mode + k] == CLOSED) | (s[:, layout.mode + k] == ACTIVE),
            ),
            (
                Channel(f"{name}.mode", "1", f"contact state: {MODE_NAMES}", "integer"),
                lambda s: s[:, layout.mode + k],
            ),
        ]

    def _add_energies(self, assembly: Assembly) -> None:
        layout, contacts = self.layout, len(assembly.contacts)
        loss = slice(layout.loss_jump, layout.loss_jump + contacts)
        dissipated = [c for name, c in layout.work.items() if name == "dampers" or name.endswith(".dissipation")]
        put_in = [c for name, c in layout.work.items() if name == "input"]
        stored = slice(layout.kinetic, layout.strain + 1)
        self._add(Channel("energy.kinetic", "J", "kinetic energy"), layout.kinetic)
        self._add(Channel("energy.potential", "J", "potential energy of the weights"), layout.potential)
        self._add(Channel("energy.strain", "J", "energy of springs and of contact forces"), layout.strain)
        self._columns += [
            (
                Channel("energy.input_work", "J", "work of applied loads and drivers since the start"),
                lambda s: s[:, put_in].sum(axis=1),
            ),
            (
                Channel("energy.dissipation", "J", "work of dampers and contact damping since the start"),
                lambda s: s[:, dissipated].sum(axis=1),
            ),
            (
                Channel("energy.impact_loss", "J", "energy lost at impacts and releases since the start"),
                lambda s: s[:, loss].sum(axis=1),
            ),
            (
                Channel("energy.balance", "J", "stored + dissipated + lost - put in - initial: zero but for errors"),
                lambda s: (
                    s[:, stored].sum(axis=1)
                    + s[:, dissipated].sum(axis=1)
                    + s[:, loss].sum(axis=1)
                    - s[:, put_in].sum(axis=1)
                    - self.initial_energy
                ),
            ),
        ]

    def column(self, samples: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """One channel over all samples (N,). Raises KeyError for an unknown name."""
        return self._columns[self.index[name]][1](samples).astype(float, copy=False)

    def values(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        """All channels over all samples (N, channels)."""
        out = np.empty((len(samples), len(self._columns)))
        out[:, self._plain_channels] = samples[:, self._plain_columns]
        for k in self._computed:
            out[:, k] = self._columns[k][1](samples)
        return out

    def total_energy(self, sample: NDArray[np.float64]) -> float:
        """Stored energy in one sample, J."""
        layout = self.layout
        return float(sample[layout.kinetic] + sample[layout.potential] + sample[layout.strain])


def planar_coordinate_channels(assembly: Assembly, layout: SampleLayout) -> list[tuple[Channel, int]]:
    """Position, velocity and acceleration of every body coordinate, with their columns in a sample."""
    columns: list[tuple[Channel, int]] = []

    def add(name: str, unit: str, description: str, at: int) -> None:
        columns.append((Channel(name, unit, description), at))

    for body, coordinate, index in assembly.body_columns:
        rate, rate_unit = _RATES[coordinate]
        acceleration, acceleration_unit = _ACCELERATIONS[coordinate]
        add(f"{body}.{coordinate}", _UNITS[coordinate], f"{coordinate} of {body}", layout.q.start + index)
        add(f"{body}.{rate}", rate_unit, f"rate of {coordinate} of {body}", layout.v.start + index)
        add(
            f"{body}.{acceleration}", acceleration_unit, f"second rate of {coordinate} of {body}",
            layout.a.start + index,
        )  # fmt: skip
    return columns
