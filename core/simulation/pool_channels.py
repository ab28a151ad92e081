"""Channels of groups whose contacts are pooled: sums over them."""

from collections.abc import Sequence

from ..assembly.assembly import ContactInfo
from ..assembly.contact_pool import ContactPool
from ..assembly.sample_layout import SampleLayout
from ..model.channels import Channel
from .channel_formulas import Sum


def pool_channels(
    contacts: Sequence[ContactInfo], pool: ContactPool, layout: SampleLayout
) -> list[tuple[Channel, Sum]]:  # fmt: skip
    """Three channels a group."""
    found = []
    for name, group in zip(pool.names, pool.groups, strict=True):
        first = int(group["first_slot"])
        slots = pool.contacts[first : first + int(group["slots"])].tolist()
        forces = [layout.force + k for k in slots]
        impulses = [layout.work[f"{contacts[k].name}.impulse"] for k in slots]
        impulses += [layout.impulse_jump + k for k in slots]
        losses = [layout.work[f"{contacts[k].name}.dissipation"] for k in slots]
        losses += [layout.loss_jump + k for k in slots]
        for what, unit, text, columns in (
            ("normal_force", "N", "sum of its normal forces", forces),
            ("impulse", "N s", "sum of its normal impulses since the start", impulses),
            ("dissipation", "J", "energy lost in its contacts since the start", losses),
        ):
            found.append((Channel(f"{name}.{what}", unit, text), Sum(tuple(columns))))
    return found
