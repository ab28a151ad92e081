"""Recording in two processes, for two processors: most of the time that a library takes is Python code of numba.

What both need is recorded twice under one name, and is one in the module. Both parts take about the same time; which
functions are in which depends on no machine, so that the library does not either.
"""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from time import process_time
from typing import Any

from .entries import Entry, entries, forms
from .module import link
from .record import compile_for, recording, texts_of

_FIRST = (
    "events", "time_loop", "event_detection", "simulation", "recovery", "methods", "stage", "analysis", "assembly",
)  # fmt: skip
"""Packages of the core whose functions are the first part: what runs and decides. The other: what is evaluated."""
_OF_FORMS = 1
"""The part with the kernels that are made from formulas."""


@dataclass(frozen=True)
class Part:
    """What one process has recorded."""

    bitcode: bytes
    symbols: dict[str, str]
    """Names that functions have in the library, by LLVM's."""
    keys: dict[str, str]
    """LLVM's names, by what the functions are asked for."""
    forms: dict[str, Any]
    """What the library says of kernels that are made from formulas."""
    seconds: float
    """Of the processor."""


@contextmanager
def recorded(only: Sequence[str]) -> Iterator[Iterator[Part]]:
    """Everything whose name contains one of `only`, in parts, which are made meanwhile."""
    workers = min(2, os.cpu_count() or 1)
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        yield pool.map(partial(_record, tuple(only)), (0, 1))


def _part_of(entry: Entry) -> int:
    inside = entry.name.removeprefix("tlismni.core.").split(".")[0]
    return 0 if inside in _FIRST else 1


def _record(only: Sequence[str], part: int) -> Part:
    symbols: dict[str, str] = {}
    keys: dict[str, str] = {}
    with recording(part):
        found = [x for x in entries() if any(text in x.name for text in only)]
        compilations = []
        for number, entry in enumerate(found):
            if _part_of(entry) != part:
                continue
            made = compile_for(entry.function, entry.signature)
            plain = entry.name.removeprefix("tlismni.core.").split(":")[0].replace(".", "_")
            name = made.fndesc.llvm_func_name
            symbols.setdefault(name, f"tlismni_{plain}_{number}")
            keys[entry.key(made.signature.return_type)] = name
            compilations.append(made)
        texts = texts_of(compilations)
    return Part(link(texts).as_bitcode(), symbols, keys, form_tables() if part == _OF_FORMS else {}, process_time())


def form_tables() -> dict[str, Any]:
    """Rows and patterns of kernels that are made from formulas, by their names."""
    return {
        name: {"rows": form.constraint_rows, "tangent": form.tangent_pattern, "jacobian": form.jacobian_pattern}
        for name, form in forms().items()
    }
