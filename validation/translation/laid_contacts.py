"""Contacts that start without an approach: what our start knows of those whose damping refers to one.

exudyn takes its `minimumImpactVelocity` for the approach speed and so holds them as by glue. They become user functions
whose force is that of `docs/contact-laws.md`, from the effective mass and the settling speed of our start.
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ...core.laws import ForceLaw
from ...core.multibody_model import Model
from ...core.simulation import start
from ...core.simulation.simulation import Simulation
from ...core.state.modes import ACTIVE
from .formulas import StickingCoulomb


@dataclass(frozen=True)
class Laid:
    """A contact that presses from the start on without an approach: settling speed (m/s) and effective mass (kg)."""

    speed: float
    mass: float


def laid_contacts(model: Model) -> Mapping[str, Laid]:
    """Those of the model, by name."""
    if not any(isinstance(c.law, ForceLaw) and c.law.damps_by_approach for c in model.contacts):
        return {}
    log = logging.getLogger(start.__name__)
    level = log.level
    log.setLevel(logging.ERROR)  # our own run has said it
    try:
        sim = Simulation(model.model_copy(update={"contacts": [_known(contact) for contact in model.contacts]}))
    finally:
        log.setLevel(level)
    rows = zip(sim.assembly.contacts, sim.memory, strict=False)
    return {
        contact.name: Laid(float(row.approach_speed), float(row.laid_mass))
        for contact, row in rows
        if row.mode == ACTIVE and row.laid_mass > 0.0
    }


def _known(contact: Any) -> Any:
    """The contact without the friction of a penalty, which our solver has no formula of. Nothing slides at the start of
    a contact that is laid, and its effective mass along the normal is that without friction in any case."""
    if isinstance(contact.friction, StickingCoulomb):
        return contact.model_copy(update={"friction": None})
    return contact
