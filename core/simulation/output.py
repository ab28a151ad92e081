"""Channels: named columns computed from recorded samples."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly, ContactInfo
from ..assembly.sample_layout import SampleLayout
from ..compiled.image import twin
from ..errors import UnknownNameError
from ..model.channels import Channel, Enumeration
from ..model.derived import CHANNELS, FIRST_CHANNEL, FIRST_PLACE, NOT_KNOWN, PLACES, Derived, DerivedTable, Places
from ..model.units import conjugate, per_second, times_second
from ..state.modes import ACTIVE, CLOSED, MODE_NAMES
from .channel_formulas import InContact, OneOf, Sum
from .contact_table import contact_table
from .exchange_record import ENERGIES, FORCES, MOTION, OF_GROUPS
from .pool_channels import pool_channels

CONTACT_STATE = Enumeration("ContactState", tuple(MODE_NAMES[mode] for mode in sorted(MODE_NAMES)))

LEVELS = ("position", "velocity", "acceleration")
"""At which constraints are met."""


class ChannelTable:
    """The output channels of a system and how to compute them."""

    def __init__(self, system: Any, assembly: Assembly) -> None:
        self.layout = layout = SampleLayout(assembly)
        self._pool = assembly.pool
        self.initial_energy = 0.0
        self._formulas: list[tuple[Channel, int | Sum | InContact | OneOf]] = []
        for channel, at in system.coordinate_channels(assembly, layout):
            self._formulas.append((channel, at))
        self._derived = self._tables_of(assembly.derived)
        number = 0
        for group in assembly.derived:
            first = number
            for channel, rate in zip(group.channels, group.rate_of, strict=True):
                self._formulas.append((channel, OneOf(number, NOT_KNOWN if rate == NOT_KNOWN else first + rate)))
                number += 1
        for row, channel in assembly.multiplier_channels.items():
            self._formulas.append((channel, layout.multipliers.start + row))
        for k, contact in enumerate(assembly.contacts):
            if contact.pooled:
                continue
            self._add_contact(k, contact)
            for index, name in contact.bristles:
                along = f" along the first marker's {name[-1]} axis" if len(contact.bristles) > 1 else ""
                text = f"deflection of the friction's bristles{along}"
                channel = Channel(f"{contact.name}.{name}", contact.units[1], text)
                self._formulas.append((channel, layout.v.start + index))
        if assembly.pool is not None:
            self._formulas += pool_channels(assembly.contacts, assembly.pool, layout)
        self._add_energies(assembly)
        for column, level, unit in zip(layout.residuals, LEVELS, ("m", "m/s", "m/s2"), strict=True):
            text = f"largest constraint violation at {level} level"
            self._formulas.append((Channel(f"residual.{level}", unit, text), column))
        self.channels = tuple(channel for channel, _ in self._formulas)
        self.index = {channel.name: k for k, channel in enumerate(self.channels)}
        self.balance = self.index["energy.balance"]
        self._prepare_values()

    def moved(self, assembly: Assembly) -> "ChannelTable":
        """The table of another run, of an assembly that differs in its numbers only."""
        new = twin(self)
        new._derived, new._pool = self._tables_of(assembly.derived), assembly.pool
        return new

    def _tables_of(self, groups: Sequence[Derived]) -> DerivedTable:
        layout = self.layout
        q, v, a, multipliers = (part.start for part in (layout.q, layout.v, layout.a, layout.multipliers))
        return DerivedTable(groups, Places(q, v, a, multipliers, layout.work.__getitem__))

    def _prepare_values(self) -> None:
        """The formulas as index arrays, for one sample at a time."""
        plain = [(k, f) for k, (_, f) in enumerate(self._formulas) if isinstance(f, int)]
        flags = [(k, f.column) for k, (_, f) in enumerate(self._formulas) if isinstance(f, InContact)]
        derived = [(k, f.rate) for k, (_, f) in enumerate(self._formulas) if isinstance(f, OneOf)]
        self._derived_at, self._derived_rate = _pairs(derived)
        sums = [(k, f) for k, (_, f) in enumerate(self._formulas) if isinstance(f, Sum)]
        terms = [
            *((k, column, f.factor) for k, f in sums for column in f.columns),
            *((k, column, -f.factor) for k, f in sums for column in f.less),
        ]
        # a place for every channel, so that one `take` fills all; sums and flags are put in after it
        self._places = np.zeros(len(self._formulas), dtype=np.intp)
        self._places[[k for k, _ in plain]] = [column for _, column in plain]
        self._flags = _pairs(flags)
        self._summed = np.array([k for k, _ in sums], dtype=np.intp)
        number = {k: i for i, (k, _) in enumerate(sums)}
        self._terms = _pairs([(number[k], column) for k, column, _ in terms])
        self._signs = np.array([sign for *_, sign in terms])
        self._kinds: dict[str, NDArray[np.int64]] = {}

    def index_arrays(self) -> dict[str, NDArray[np.int64] | NDArray[np.float64]]:
        """The formulas of all channels, by the names that `exchange` has."""
        (number, column), (flags, flag_columns) = self._terms, self._flags
        found = {
            "places": self._places, "summed": self._summed, "number": number, "column": column, "flags": flags,
            "flag_columns": flag_columns,
        }  # fmt: skip
        derived = self._derived
        return {
            **{name: x.astype(np.int64) for name, x in found.items()}, "signs": self._signs.astype(np.float64),
            "derived": derived.heads, "derived_places": derived.places, "derived_numbers": derived.numbers,
            "derived_rates": self._derived_rate.astype(np.int64),
            "residual_channels": np.array([self.index[f"residual.{level}"] for level in LEVELS], dtype=np.int64),
            **(self._kinds or self._find_kinds()),
        }  # fmt: skip

    def _find_kinds(self) -> dict[str, NDArray[np.int64]]:
        """What each channel takes (`exchange_record.py`): found once for all runs that share the table's columns."""
        heads, places = self._derived.heads, self._derived.places
        forced, group_of = [0, 1, 0], [OF_GROUPS] * self._derived.size
        for k, head in enumerate(heads.tolist()):
            columns = places[head[FIRST_PLACE] : head[FIRST_PLACE] + head[PLACES]].tolist()
            forced.append(int(any(self._kind_of(column) != MOTION for column in columns)))
            group_of[head[FIRST_CHANNEL] : head[FIRST_CHANNEL] + head[CHANNELS]] = [OF_GROUPS + k] * head[CHANNELS]

        def kind(formula: Any) -> int:
            if isinstance(formula, OneOf):
                return group_of[formula.number]
            if isinstance(formula, Sum):
                return max((self._kind_of(column) for column in (*formula.columns, *formula.less)), default=MOTION)
            return self._kind_of(formula.column if isinstance(formula, InContact) else formula)

        kinds = [kind(formula) for _, formula in self._formulas]
        self._kinds |= {"kinds": np.array(kinds, dtype=np.int64), "forced": np.array(forced, dtype=np.int64)}
        return self._kinds

    def _kind_of(self, column: int) -> int:
        """What a column of a sample takes."""
        layout, contacts = self.layout, self.layout.gap - self.layout.force
        forces = (
            range(layout.a.start, layout.multipliers.stop), range(layout.force, layout.force + contacts),
            range(layout.friction, layout.friction + contacts), (layout.residuals[2],),
        )  # fmt: skip
        if any(column in part for part in forces):
            return FORCES
        return ENERGIES if layout.kinetic <= column <= layout.strain else MOTION

    @property
    def first_derived(self) -> int:
        """Number of the first derived channel; the others follow it."""
        return int(self._derived_at[0]) if len(self._derived_at) else 0

    def _add_contact(self, k: int, contact: ContactInfo) -> None:
        layout, name, (gap, slide) = self.layout, contact.name, contact.units
        if contact.companion < 0:
            return  # what it has is shown with the contact before it
        force, impulse = conjugate(gap), layout.work[f"{name}.impulse"]
        lost = Sum((layout.work[f"{name}.dissipation"], layout.loss_jump + k))
        dissipation = Channel(f"{name}.dissipation", "J", "energy lost in the contact since the start")
        state = Channel(f"{name}.mode", "1", f"contact state: {MODE_NAMES}", "integer", CONTACT_STATE)
        if not contact.has_shapes:
            friction = f"{name}.{'friction_torque' if slide == 'rad' else 'friction_force'}"
            against = "on body b, against the sliding velocity"
            if contact.companion > 0:
                against = "on body b: size"
                columns = layout.force + k, layout.force + k + 1, layout.friction + k + 1
                for axis, column in zip("xyz", columns, strict=True):
                    said = f"on body b, {axis} component along the axes of space"
                    channel = Channel(f"{friction}_{axis}", conjugate(slide), said)
                    self._formulas.append((channel, Sum((column,), factor=contact.size)))
            self._formulas += [
                (dissipation, lost),
                (state, layout.mode + k),
                (
                    Channel(friction, conjugate(slide), against),
                    Sum((layout.friction + k,), factor=contact.size),
                ),
                (
                    Channel(f"{name}.sliding_velocity", per_second(slide), "of body b on body a"),
                    Sum((layout.sliding + k,), factor=1.0 / contact.size),
                ),
            ]
            return
        self._formulas += [
            (Channel(f"{name}.gap", gap, "gap, negative where the shapes overlap"), layout.gap + k),
            (Channel(f"{name}.gap_rate", per_second(gap), "rate of the gap"), layout.gap_rate + k),
            (Channel(f"{name}.normal_force", force, "normal force, compression positive"), layout.force + k),
            (
                Channel(f"{name}.impulse", times_second(force), "normal impulse since the start, impacts included"),
                Sum((impulse, layout.impulse_jump + k)),
            ),
            (dissipation, lost),
            (
                Channel(f"{name}.in_contact", "1", "true while the contact carries force", "boolean"),
                InContact(layout.mode + k),
            ),
            (state, layout.mode + k),
        ]
        if contact.slide_row >= 0:
            self._formulas += [
                (
                    Channel(
                        f"{name}.friction_force", conjugate(slide), "along the tangent, against the sliding velocity"
                    ),
                    layout.friction + k,
                ),
                (
                    Channel(f"{name}.sliding_velocity", per_second(slide), "of the second shape on the first"),
                    layout.sliding + k,
                ),
            ]

    def contact_table(self, sample: NDArray[np.float64], group: str) -> NDArray[Any]:
        """The contacts of a group that carry force in a sample. Raises UnknownNameError for a group without a pool."""
        names = () if self._pool is None else self._pool.names
        if self._pool is None or group not in names:
            raise UnknownNameError(
                f"no group '{group}' has `most_contacts`: those that have are {list(names)}; contacts of other groups "
                "have channels of their own"
            )
        return contact_table(sample, self.layout, self._pool, names.index(group))

    def _add_energies(self, assembly: Assembly) -> None:
        layout, contacts = self.layout, len(assembly.contacts)
        loss = tuple(range(layout.loss_jump, layout.loss_jump + contacts))
        dissipated = tuple(c for name, c in layout.work.items() if name == "dampers" or name.endswith(".dissipation"))
        put_in = tuple(c for name, c in layout.work.items() if name == "input")
        stored = (layout.kinetic, layout.potential, layout.strain)
        balance = "stored + dissipated + lost - put in - initial: zero but for errors"
        for name, description, formula in (
            ("kinetic", "kinetic energy", layout.kinetic),
            ("potential", "potential energy of the weights", layout.potential),
            ("strain", "energy of springs and of contact forces", layout.strain),
            ("input_work", "work of applied loads and drivers since the start", Sum(put_in)),
            ("dissipation", "work of dampers and contact damping since the start", Sum(dissipated)),
            ("impact_loss", "energy lost at impacts and releases since the start", Sum(loss)),
            ("balance", balance, Sum((*stored, *dissipated, *loss), put_in)),
        ):
            self._formulas.append((Channel(f"energy.{name}", "J", description), formula))

    @property
    def parts(self) -> dict[str, slice]:
        """Where q, v, a and the multipliers stand in a sample."""
        layout = self.layout
        return {"q": layout.q, "v": layout.v, "a": layout.a, "multipliers": layout.multipliers}

    def plain_columns(self) -> dict[str, int]:
        """Channels that stand in a sample as they are, with their columns."""
        return {channel.name: formula for channel, formula in self._formulas if isinstance(formula, int)}

    def column(self, samples: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """One channel over all samples (N,). Raises KeyError for an unknown name."""
        k = self.index[name]
        formula = self._formulas[k][1]
        if isinstance(formula, int):
            return samples[:, formula]
        if isinstance(formula, OneOf):
            return self._derived(samples)[:, formula.number]
        found = formula(samples)
        return found - self.initial_energy if k == self.balance else found

    def values(self, sample: NDArray[np.float64]) -> NDArray[np.float64]:
        """All channels (channels,) of one sample, the same bits as `column` gives."""
        out: NDArray[np.float64] = sample.take(self._places)
        # bincount adds the terms of each channel in their order
        number, column = self._terms
        out[self._summed] = np.bincount(number, self._signs * sample.take(column), len(self._summed))
        out[self.balance] -= self.initial_energy
        channel, column = self._flags
        if len(channel):
            mode = sample.take(column)
            out[channel] = (mode == CLOSED) | (mode == ACTIVE)
        self.put_derived(sample, out)
        return out

    def put_derived(self, sample: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Put the derived channels among those of one sample."""
        if self._derived.size:
            values[self._derived_at] = self._derived(sample[None, :])[0]

    def total_energy(self, sample: NDArray[np.float64]) -> float:
        """Stored energy in one sample, J."""
        layout = self.layout
        return float(sample[layout.kinetic] + sample[layout.potential] + sample[layout.strain])


def _pairs(pairs: Sequence[tuple[int, int]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Channels and columns of (channel, column) pairs as index arrays."""
    table = np.array(pairs, dtype=np.intp).reshape(-1, 2)
    return table[:, 0].copy(), table[:, 1].copy()
