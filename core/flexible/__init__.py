"""Flexible bodies: reduction, the partition into a contact region and the rest, and what goes on along a body."""

from .partition import local_impulse, partition_rod
from .reduction import Reduction, craig_bampton
from .rod_fields import RodFields, rod_fields

__all__ = ["Reduction", "RodFields", "craig_bampton", "local_impulse", "partition_rod", "rod_fields"]
