"""Contacts of which nothing bounds how far their gaps go within a step: said once, at the start of a run."""

import logging

from ..assembly.assembly import Assembly
from ..contacts.geometry_kinds import NOT_BOUND

logger = logging.getLogger(__name__)
MOST_NAMES = 5


def warn_of_unbounded(assembly: Assembly) -> None:
    """Log a warning that names the contacts whose gap is a formula or a kernel of the user's."""
    names = [contact.name for contact in assembly.contacts if contact.kind in NOT_BOUND]
    if not names:
        return
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    logger.warning(
        "contacts %s%s have gaps of their own, and nothing bounds how far these can go within a step: between the ends "
        "of a step they are estimated, and a short touch can be missed. If a shape is thinner than its way in a step, "
        "give `max_step` less than its thickness over its speed, or use the library's shapes, of which none is missed",
        ", ".join(f"'{name}'" for name in names[:MOST_NAMES]), more,
    )  # fmt: skip
