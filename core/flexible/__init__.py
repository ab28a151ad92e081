"""Flexible bodies made from others: reduction, and the partition into a contact region and the rest."""

from .partition import local_impulse, partition_rod
from .reduction import Reduction, craig_bampton

__all__ = ["Reduction", "craig_bampton", "local_impulse", "partition_rod"]
