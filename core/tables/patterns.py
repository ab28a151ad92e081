"""Structures by the contacts that are closed, engaged and sticking: those of a run, and those that runs share."""

from collections.abc import Iterator

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

    def get(self, assembly: Assembly, key: Key, present: Structure | None) -> tuple[Structure, bool]:
        """The structure of `key`: kept, or built; and whether it is a new one. The `present` one, whose memory compiled
        code works on, is not given up."""
        if present is not None:
            self.at(present.record.address)
        found = self._own.pop(key, None)
        structure = found or self._new(assembly, key)
        while len(self._own) >= MOST_STRUCTURES:
            del self._own[next(iter(self._own))]
        self._own[key] = structure
        return structure, found is None

    def at(self, address: int) -> Structure:
        """The structure whose record is at `address`, which is the last to be given up now."""
        key, structure = next((key, x) for key, x in self._own.items() if x.record.address == address)
        self._own[key] = self._own.pop(key)
        return structure

    def __iter__(self) -> Iterator[Structure]:
        return iter(self._own.values())

    def with_dropped(self, rows: frozenset[int]) -> list[Structure]:
        """Those in which these redundant rows are left out."""
        return [structure for key, structure in self._own.items() if key[3] == rows]

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
