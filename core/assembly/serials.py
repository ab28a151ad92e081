"""What building structures and partitions has in common."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec


@internal
def next_serial(b: Any) -> int:
    """A number that no other structure or partition has."""
    b.serial += 1
    return int(b.serial)


@internal
def same_numbers(one: int, other: int, count: int) -> bool:
    """Whether the integers at two addresses are the same."""
    a, b = ivec(one, count), ivec(other, count)
    for k in range(count):
        if a[k] != b[k]:
            return False
    return True
