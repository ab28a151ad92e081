"""Flexible bodies: reduction, the partition into a contact region and the rest, and what goes on along a body."""

from .finite_elements import FiniteElements, finite_elements, read_finite_elements
from .impact_substructure import local_impulse, partition_rod
from .reduced_solid import reduced_body
from .reduction import Reduction, craig_bampton
from .rod_fields import RodFields, rod_fields

__all__ = [
    "FiniteElements",
    "Reduction",
    "RodFields",
    "craig_bampton",
    "finite_elements",
    "local_impulse",
    "partition_rod",
    "read_finite_elements",
    "reduced_body",
    "rod_fields",
]
