"""A run as a file: all its memory, with addresses as places, so that a program without Python can go on from it."""

import ctypes
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.slots import Slots
from ..compiled.library import LIBRARY, Library
from ..simulation.exchange import possible
from ..source_digests import c_digest
from .errors import NativeError
from .layout import IMAGE_HEAD, MAGIC, VERSION, arrays_in_places, called_symbols, numbers_of
from .parameters import Parameter
from .reach import Found, begin_of, check_words, held_by, holds_reals, like_addresses, reached, without_parts, words_of
from .scratch import own_of, scratch_of

_ALIGNED = 64


def own_library() -> Library:
    """The library of this process. Raises NativeError where there is none."""
    if LIBRARY is None:
        raise NativeError(
            "a run without Python needs the library of machine code, and this process has none: make it with "
            "`python -m tlismni.core.aot`, or use a wheel that carries it"
        )
    function = getattr(ctypes.CDLL(str(LIBRARY.path)), "tlismni_c_digest", None)
    if function is not None:
        function.restype = ctypes.c_char_p
    found = function().decode() if function is not None else "none"
    if found != c_digest():
        raise NativeError(
            f"the C code in the library of machine code, '{LIBRARY.path}', is of other sources ({found}) than these "
            f"({c_digest()}): make it anew with `python -m tlismni.core.aot`"
        )
    return LIBRARY


def _points(x: NDArray[Any], found: Found, addresses: Mapping[int, str]) -> bool:
    """Whether an array is a record of addresses, or has any."""
    if holds_reals(x) or x.dtype.itemsize % 8:
        return False
    words = words_of(x)
    if x.dtype.names is not None or bool(np.any(found.owner(words) >= 0)):
        return True
    return not addresses.keys().isdisjoint(words.tolist())


def refuse_motions(sim: Any) -> None:
    """Raise NativeError for a run whose steps are not made in one crossing."""
    if not possible(sim) or sim.crossing is None:
        raise NativeError(
            "the motion of a driver is an input, and what a run does when that jumps is Python's as yet: let an input "
            "be a force, or use the FMU that runs with Python"
        )


TABLES, NUMBERS, BUILT, ROOM = range(4)
"""What arrays are: records and addresses; what decides; what is built of that; room without content."""


class _Segment:
    """Arrays one after the other, by what they are."""

    def __init__(self, arrays: Sequence[NDArray[Any]], kind: Callable[[NDArray[Any]], int], built: int = 0) -> None:
        """`built` : bytes that have content of what is built."""
        kinds = {id(x): kind(x) for x in arrays}
        in_order = sorted(arrays, key=lambda x: kinds[id(x)])
        self.arrays = [x for x in in_order if kinds[id(x)] != ROOM]
        self.start: dict[int, int] = {}
        ends = [0, 0, 0, 0]
        for x in in_order:
            self.start[x.ctypes.data] = ends[ROOM]
            end = ends[ROOM] + -(-x.nbytes // _ALIGNED) * _ALIGNED
            ends[kinds[id(x)] :] = [end] * (ROOM + 1 - kinds[id(x)])
        self.tables, self.decisive, self.copied, self.size = ends
        self.copied = min(self.copied, self.decisive + -(-built // _ALIGNED) * _ALIGNED)
        self.data = np.zeros(self.copied, dtype=np.uint8)
        for x in self.arrays:
            begin = self.start[x.ctypes.data]
            content = x.reshape(-1).view(np.uint8)
            self.data[begin : begin + x.nbytes] = content[: self.copied - begin]


def native_image(sim: Any, most_steps: int, parameters: Sequence[Parameter] = (), begins: bool = False) -> bytes:
    """The image of a simulation of a Model: it goes on from the present point.

    Parameters
    ----------
    most_steps : of the solver between two times that are asked for; more are an error of the run.
    parameters : of the present memory of the simulation (`parameters.py`).
    begins : a run may begin anew, with other parameters or at another time.

    Raises
    ------
    NativeError : if the model needs Python when it runs; it says for what.
    """
    library = own_library()
    refuse_motions(sim)
    times = sim.crossing.times
    times[:5] = sim.t, sim.t, *sim.input_times, sim.table.initial_energy
    sim.crossing.wanted[:] = sim.workspace.arrays["inputs"][: len(sim.crossing.wanted), 0]
    arrays = list(held_by(sim))
    held, empty = without_parts(arrays), frozenset(x.ctypes.data for x in arrays if not x.nbytes)
    found = reached((sim.crossing._record.table, sim.beginning.record.table), held)
    own = without_parts(own_of(sim))
    scratch = without_parts(scratch_of(sim))
    set_by_others = [begin_of(word.array) for p in parameters for word in p.words]
    is_own = (own.owner(found.begin) >= 0) | np.isin(found.begin, set_by_others)
    is_own[found.owner(sim.beginning.record.arrays["turned"][:, 0])] = True
    values = np.array([p.value for p in parameters])
    symbols = called_symbols(library)
    addresses: dict[int, str] = {}
    for key, symbol in library.entries.items():
        address = library.address(*key.rsplit(" ", 1))
        if address is not None:
            addresses[address] = symbol
    pool = without_parts([sim.workspace.slots.pool])

    def kind_of(x: NDArray[Any]) -> int:
        begin = np.array([begin_of(x)])
        if scratch.owner(begin)[0] >= 0:
            return ROOM
        if pool.owner(begin)[0] >= 0:
            return BUILT
        return TABLES if _points(x, found, addresses) else NUMBERS

    own_arrays = {id(x) for x, own in zip(found.arrays, is_own, strict=True) if own}
    shared = _Segment([x for x in found.in_order() if id(x) not in own_arrays], lambda x: TABLES)
    of_run = [x for x in found.in_order() if id(x) in own_arrays]
    mine = _Segment([*of_run, values] if len(values) else of_run, kind_of, _first_place(sim.workspace.slots))
    lists: dict[tuple[int, int], list[NDArray[np.int64]]] = {}
    for of, segment in ((0, shared), (1, mine)):
        for x in segment.arrays:
            for to, at in _relocate(x, segment, found, is_own, (shared, mine), addresses, symbols, empty):
                lists.setdefault((of, to), []).append(at)
    if (0, 1) in lists:
        raise NativeError("memory that all runs share points into that of one: it cannot be written as an image")
    names = [
        *sim.assembly.input_names, *(c.name for c in sim.table.channels), *(c.name for c in sim.assembly.contacts),
        *(p.name for p in parameters),
    ]  # fmt: skip
    places = [_place(x, found, mine) for x in arrays_in_places(sim, values)]
    order = ((0, 0), (0, 2), (1, 1), (1, 0), (1, 2))
    relocations = [np.concatenate(lists.get(key, [np.zeros(0, dtype=np.int64)])) for key in order]
    numbers = numbers_of(sim, most_steps, begins)
    return _file(library, numbers, places, relocations, symbols, names, (shared, mine), parameters)


def _first_place(slots: Slots) -> int:
    """Bytes of the first place for a structure, the only one that is built. Raises NativeError if others are."""
    if np.any(slots.structures["built"][1:]) or not slots.structures["built"][0]:
        raise NativeError("of the structures of a run that is written down the first one alone is built")
    return slots.pool.nbytes // len(slots.structures)


def _place(x: NDArray[Any], found: Found, mine: _Segment) -> int:
    """Where an array stands in a run's memory; 0 for one without content."""
    if not x.nbytes:
        return 0
    address = x.ctypes.data
    if address in mine.start:
        return mine.start[address]
    (number,) = found.owner(np.array([address]))
    begin = int(found.begin[number])
    if number < 0 or begin not in mine.start:
        raise NativeError("an array that the C code reads is not in the run's own memory")
    return mine.start[begin] + address - begin


def _relocate(
    x: NDArray[Any], segment: _Segment, found: Found, is_own: NDArray[np.bool_], segments: tuple[_Segment, _Segment],
    addresses: dict[int, str], symbols: list[str], empty: frozenset[int],
) -> list[tuple[int, NDArray[np.int64]]]:  # fmt: skip
    """Write places in place of addresses; gives what they point to (0 shared, 1 own, 2 functions), and where."""
    words = words_of(x)
    if not len(words):
        return []
    first = segment.start[x.ctypes.data] // 8
    copy = segment.data.view(np.int64)[first : first + len(words)]
    owner = found.owner(words)
    result = []
    for to in (0, 1):
        at = np.flatnonzero((owner >= 0) & (is_own[owner] == bool(to)))
        if len(at):
            starts = np.array([segments[to].start[found.arrays[k].ctypes.data] for k in owner[at]], dtype=np.int64)
            copy[at] = words[at] - found.begin[owner[at]] + starts
            result.append((to, first + at))
    large = np.flatnonzero((owner < 0) & like_addresses(words))
    functions = np.array([k for k in large.tolist() if int(words[k]) in addresses], dtype=np.int64)
    for k in functions.tolist():
        name = addresses[int(words[k])]
        if name not in symbols:
            symbols.append(name)
        copy[k] = symbols.index(name)
    if len(functions):
        result.append((2, first + functions))
    rest = np.setdiff1d(large, functions)
    if not holds_reals(x):
        check_words(words[rest], empty)
        copy[rest] = 0  # addresses of arrays without content
    return result


def _file(
    library: Library, numbers: bytes, places: list[int], relocations: list[NDArray[np.int64]], symbols: list[str],
    names: list[str], segments: tuple[_Segment, _Segment], parameters: Sequence[Parameter],
) -> bytes:  # fmt: skip
    shared, own = segments
    heads, words, coefficients, exclusions = _parameter_parts(parameters, own)
    function_text = _padded(b"".join(name.encode() + b"\0" for name in symbols))
    text = _padded(b"".join(name.encode() + b"\0" for name in names))
    body = b"".join(
        (
            numbers,
            struct.pack(f"<{len(places)}q", *places),
            *(x.astype("<i8").tobytes() for x in relocations),
            b"".join(heads), b"".join(words), struct.pack(f"<{len(coefficients)}d", *coefficients),
            struct.pack(f"<{len(exclusions)}q", *exclusions),
            function_text, text, shared.data.tobytes(), own.data.tobytes(),
        )
    )  # fmt: skip
    head = {
        "version": VERSION, "size": 0, "checksum": zlib.crc32(body),
        "shared": len(shared.data), "tables": own.tables, "decisive": own.decisive, "copied": own.copied,
        "own": own.size,
        "parameters": len(heads), "words": len(words), "coefficients": len(coefficients),
        "exclusions": len(exclusions) // 2,
        "functions": len(symbols), "function_text": len(function_text), "texts": len(names), "text_size": len(text),
        **dict(zip(IMAGE_HEAD[-5:], map(len, relocations), strict=True)),
    }  # fmt: skip
    start = MAGIC + library.digest.encode().ljust(32, b"\0")[:32] + c_digest().encode()
    head["size"] = len(start) + 8 * len(IMAGE_HEAD) + len(body)
    return start + struct.pack(f"<{len(IMAGE_HEAD)}q", *(head[name] for name in IMAGE_HEAD)) + body


def _parameter_parts(
    parameters: Sequence[Parameter], own: _Segment
) -> tuple[list[bytes], list[bytes], list[float], list[int]]:
    """What `parameters.c` reads: of each parameter its words' first number and count, whether runs begin anew with it,
    value and limits; of each word its place, form, mode, first coefficient and their count, and constant; the
    coefficients; pairs that exclude each other."""
    heads: list[bytes] = []
    words: list[bytes] = []
    coefficients: list[float] = []
    for p in parameters:
        heads.append(struct.pack("<3q3d", len(words), len(p.words), int(p.begins), p.value, p.least, p.largest))
        placed = sorted(((own.start[begin_of(word.array)] + word.offset, word) for word in p.words), key=lambda x: x[0])
        for place, (_, _, form, mode) in placed:
            series = form.series
            words.append(struct.pack("<5qd", place, form.code, mode, len(coefficients), len(series), form.constant))
            coefficients += series
    names = {p.name: k for k, p in enumerate(parameters)}
    exclusions = [
        x for k, p in enumerate(parameters) for name in sorted(p.excludes & set(names)) for x in (k, names[name])
    ]
    return heads, words, coefficients, exclusions


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % 8)
