"""Instances of fmpy whose messages come to the right listener, and to none that is gone.

fmpy passes messages of FMI 2.0 through a function of C, which fills in what a message leaves to its arguments. That
function knows one listener in the whole process, the one given last: messages of all FMUs go there, and after its end
to freed memory (fmpy 0.3.32; a crash). So one listener stays for ever, and finds the instance's own by the environment
that an FMU hands back.
"""

import contextlib
import ctypes
import itertools
import weakref
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from ..platforms import fmi2_platform

Listener = Callable[[str], None]
"""Called with a message."""

_listeners: dict[int, Listener] = {}
_numbers = itertools.count(1)


def instantiate(unzipped: str, description: Any, listen: Listener) -> Any:
    """fmpy's co-simulation slave of an unzipped FMU, instantiated; `listen` hears its messages as long as it lives."""
    from fmpy import sharedLibraryExtension
    from fmpy.fmi2 import FMU2Slave
    from fmpy.simulation import instantiate_fmu

    if description.fmiVersion != "2.0":

        def logger(environment: Any, status: int, category: bytes, message: bytes) -> None:
            listen(message.decode(errors="replace"))

        return instantiate_fmu(unzipped, description, "CoSimulation", logger=logger)
    number, identifier = next(_numbers), description.coSimulation.modelIdentifier
    # fmpy looks where FMI 2.0 says for x86-64, on all machines (0.3.32)
    binary = Path(unzipped, "binaries", fmi2_platform(), f"{identifier}{sharedLibraryExtension}").resolve()
    found = {"libraryPath": str(binary)} if binary.is_file() else {}
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier, **found)
    _listeners[number] = listen
    weakref.finalize(fmu, _listeners.pop, number, None)
    fmu.instantiate(callbacks=_callbacks(number))
    return fmu


def _callbacks(number: int) -> Any:
    """The callbacks of the instance with this number."""
    from fmpy import calloc, free
    from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE, fmi2CallbackFreeMemoryTYPE, fmi2CallbackFunctions

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _dispatcher()
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = number
    with contextlib.suppress(ImportError, OSError):  # without it messages come as they are
        from fmpy.logging import addLoggerProxy

        addLoggerProxy(ctypes.byref(callbacks))
    return callbacks


@cache
def _dispatcher() -> Any:
    """The one listener of the process, which is never freed."""
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE

    return fmi2CallbackLoggerTYPE(_dispatch)


def _dispatch(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    listen = _listeners.get(environment or 0)
    if listen is not None:
        listen(message.decode(errors="replace"))
