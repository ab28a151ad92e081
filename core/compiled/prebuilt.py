"""Functions whose machine code is in the library: what the decorators of `jit.py` make where there is one.

Python calls them through ctypes, compiled code by their addresses. Code that is compiled in this process, a user's
kernel say, calls them too: then numba compiles them with it, from the same source (`_numba_type_`).
"""

import logging
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any

from .crossing import Unfit, crossing
from .library import LIBRARY, known_as
from .needed import compiler_module, numba_module
from .plain_types import PlainSignature, PlainType
from .signatures import signature_text, type_text

logger = logging.getLogger(__name__)


class Prebuilt:
    """A function that was compiled ahead of time, or would be.

    Parameters
    ----------
    function : its source.
    decorator : name of the decorator of `compiler.py` that it has where there is no library.
    name : what the library calls it; its module and qualified name unless said otherwise.
    """

    def __init__(self, function: Callable[..., Any], decorator: str, name: str | None = None) -> None:
        self.py_func, self._decorator = function, decorator
        self.name = name or f"{known_as(function.__module__)}.{function.__qualname__}"
        self.__doc__, self.__name__, self.__module__ = function.__doc__, function.__name__, function.__module__
        self._call: Callable[..., Any] | None = None
        # what numba asks of whatever is called, to inline it before it looks at types
        self.targetoptions = {"inline": "always"} if decorator == "inlined" else {}

    def __repr__(self) -> str:
        return f"<compiled ahead of time: {self.name}>"

    def __call__(self, *args: Any) -> Any:
        call = self._call or self._first_call()
        try:
            return call(*args)
        except Unfit:
            # arguments of other types than those that the library has been made for
            return self.dispatcher(*args)

    def _first_call(self) -> Callable[..., Any]:
        assert LIBRARY is not None
        signatures = LIBRARY.signatures(self.name)
        if len(signatures) == 1:
            function = LIBRARY.function(self.name, signatures[0], self._decorator == "compiled_unlocked")
            self._call = crossing(function, signatures[0])
        else:
            self._call = self.dispatcher
        return self._call

    def address(self, signature: Any) -> int:
        """Machine address for a signature, plain or numba's, compiled now if the library has none."""
        assert LIBRARY is not None
        text = signature_text(signature.return_type, signature.args)
        found = LIBRARY.address(self.name, text)
        if found is not None:
            return found
        return compiler_module().address_of(self.dispatcher, for_numba(signature))

    def compile(self, signature: Any) -> None:
        """Nothing where the library has it, else what numba's function of this name does with a signature, or with the
        types of the arguments alone."""
        assert LIBRARY is not None
        known = LIBRARY.signatures(self.name)
        if hasattr(signature, "args"):
            if signature_text(signature.return_type, signature.args) not in known:
                self.dispatcher.compile(for_numba(signature))
            return
        arguments = f"({''.join(map(type_text, signature))})"
        if not any(text.endswith(arguments) for text in known):
            self.dispatcher.compile(tuple(map(for_numba, signature)))

    @cached_property
    def dispatcher(self) -> Any:
        """numba's function of the same source. Raises NumbaMissingError where numba is missing."""
        compiler = compiler_module()
        # whoever listens to `notices.py` hears of it once it really is
        logger.debug("%s is to be compiled in this process", self.name)
        return getattr(compiler, self._decorator)(self.py_func)

    @property
    def _numba_type_(self) -> Any:
        return self.dispatcher._numba_type_

    def __reduce__(self) -> str:
        return self.py_func.__qualname__


def for_numba(plain: Any) -> Any:
    """numba's type or signature for a plain one, or what is numba's already."""
    return plain.for_numba() if isinstance(plain, PlainType | PlainSignature) else plain


class Deferred:
    """An intrinsic of numba's that is made once numba needs it; compiled code calls it, Python cannot."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    @cached_property
    def intrinsic(self) -> Any:
        """numba's own. Raises NumbaMissingError where numba is missing."""
        numba_module()
        return self._make()

    @cached_property
    def _numba_type_(self) -> Any:
        numba_module()
        from numba.core.registry import cpu_target

        intrinsic = self.intrinsic
        cpu_target.typing_context.refresh()  # or it does not know what has been made since
        return cpu_target.typing_context.resolve_value_type(intrinsic)


def later(module: str, name: str) -> Deferred:
    """The intrinsic `name` of a module of this package that imports numba."""
    return Deferred(lambda: getattr(import_module(f".{module}", __package__), name))


def compiled(function: Callable[..., Any]) -> Any:
    """Decorator of compiled functions that Python calls."""
    return Prebuilt(function, "compiled")


def compiled_unlocked(function: Callable[..., Any]) -> Any:
    """The same for what takes long: other threads of Python run on meanwhile (`compiler.py` says more)."""
    return Prebuilt(function, "compiled_unlocked")


def internal(function: Callable[..., Any]) -> Any:
    """Decorator of functions that only compiled code calls, kernels and steps too."""
    return Prebuilt(function, "internal")


def inlined(function: Callable[..., Any]) -> Any:
    """Decorator of tiny helpers."""
    return Prebuilt(function, "inlined")


def address_of(function: Any, signature: Any) -> int:
    """Machine address of a function, of the library or a user's own.

    Raises
    ------
    TypeError : if it is not a compiled function, or returns something else.
    NumbaMissingError : if it has to be compiled, and numba is missing.
    """
    if isinstance(function, Prebuilt):
        return function.address(signature)
    if not hasattr(function, "get_compile_result"):
        raise TypeError(f"{function!r} must be a numba function: decorate it with @compiled")
    return compiler_module().address_of(function, for_numba(signature))


def caller(signature: Any) -> Any:
    """Intrinsic call(address, *arguments) of compiled functions of one signature."""

    return Deferred(lambda: compiler_module().caller(for_numba(signature)))


def records_view(record_type: Any) -> Any:
    """Intrinsic view(address, n): n records of `record_type` from an address on."""

    return Deferred(lambda: compiler_module().records_view(for_numba(record_type)))


def record_view(record_type: Any) -> Any:
    """Intrinsic view(address): the record of `record_type` at an address."""

    return Deferred(lambda: compiler_module().record_view(for_numba(record_type)))
