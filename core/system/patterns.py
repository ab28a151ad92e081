"""Structures by the contacts that are closed, engaged and sticking: those of a run, and those that runs share."""

from .assembly import Assembly
from .structure import Structure, build_structure

MOST_STRUCTURES = 32
"""Kept, for as many sets of closed contacts: with a contact at every node there are endless many."""

Key = tuple[frozenset[int], ...]
"""Contacts closed, engaged, sticking; rows dropped."""


class Patterns:
    """The structures of one run."""

    def __init__(self, shared: dict[Key, Structure] | None = None) -> None:
        self._own: dict[Key, Structure] = {}
        self._shared = shared

    def __len__(self) -> int:
        return len(self._own)

    @property
    def shares(self) -> bool:
        """Whether copies of the run share what any of them meets."""
        return self._shared is not None

    def share(self, structure: Structure) -> None:
        """Let copies share it from now on; `structure` is the present one."""
        self._shared = {}
        structure.share()

    def of_copy(self, key: Key, structure: Structure) -> "Patterns":
        """Those of a copy of the run, with its present structure."""
        new = Patterns(self._shared)
        new._own[key] = structure
        return new

    def get(self, assembly: Assembly, key: Key) -> Structure:
        """The structure of `key`: kept, or built."""
        structure = self._own.pop(key, None) or self._new(assembly, key)
        while len(self._own) >= MOST_STRUCTURES:
            del self._own[next(iter(self._own))]
        self._own[key] = structure
        return structure

    def _new(self, assembly: Assembly, key: Key) -> Structure:
        if self._shared is None:
            return build_structure(assembly, *key)
        known = self._shared.get(key)
        if known is None:
            known = build_structure(assembly, *key)
            known.share()
            if len(self._shared) < MOST_STRUCTURES:
                self._shared[key] = known
        return known.fresh()
