"""The cache on disk of compiled kernels: valid as long as no code that a kernel can reach has changed.

numba's own cache checks one file only. After an edit of ``predicates.py``, a kernel in another file would
silently run old machine code; and after an edit of a comment, everything would be compiled again. Here the
stamp of a kernel is a hash of what it does: its code and options, those of all kernels that it can call,
and the constants that any of these uses by name. It is computed from the functions in memory, at the first
call, not from files, which may have been edited after they were imported.
"""

from __future__ import annotations

import hashlib
import sys
import time
from pickle import UnpicklingError
from types import ModuleType
from typing import Any, TextIO

import numpy as np

from . import inside_numba
from .inside_libraries import KeptCode
from .inside_numba import Dispatcher, FunctionCache, IndexDataCacheFile, rtsys

__all__ = ["KernelCache", "stamp"]

CONSTANT = (bool, int, float, complex, str, bytes, type(None), np.generic)
FORM = 5  # of compiled kernels: how they call each other; code of another form must not be read
LONG = 1.0  # seconds of compilation after which it is announced
ANNOUNCEMENT = (
    "unstruct: compiling, once for this machine; this may take a minute "
    "(python -m unstruct.compile does all of it at once)"
)


# ---------------------------------------------------------------------- what a kernel does


def stamp(dispatcher: Any) -> str:
    """A hash of all that the machine code of a kernel depends on."""
    parts: dict[int, tuple[str, ...]] = {}
    _reach(dispatcher, parts)
    return hashlib.sha256(repr((FORM, sorted(parts.values()))).encode()).hexdigest()


def _reach(dispatcher: Any, parts: dict[int, tuple[str, ...]]) -> None:
    """Add the description of a kernel, and those of all that it can call."""
    if id(dispatcher) in parts:
        return
    try:
        parts[id(dispatcher)], callees = dispatcher.description
    except AttributeError:
        dispatcher.description = parts[id(dispatcher)], callees = _description(dispatcher)
    for callee in callees:
        _reach(callee, parts)


def _description(dispatcher: Any) -> tuple[tuple[str, ...], list[Any]]:
    """Code, options and constants of one kernel as text, and the kernels that it names."""
    function = dispatcher.py_func
    code = function.__code__
    constants, callees = [], []
    for name in code.co_names:
        value = function.__globals__.get(name)
        within = [getattr(value, part, None) for part in code.co_names] if _is_module(value) else []
        for found in (value, *within):
            if isinstance(found, Dispatcher):
                callees.append(found)
            elif _constant(found):
                constants.append((name, _text(found)))
    literals = [c for c in code.co_consts if c != function.__doc__]
    text = [code.co_code.hex(), literals, code.co_names, code.co_varnames, function.__defaults__, constants]
    options = sorted(dispatcher.targetoptions.items())
    return (function.__module__, function.__qualname__, repr(text), repr(options)), callees


def _is_module(value: Any) -> bool:
    """Whether it is a module of kernels, from which a kernel may take some by ``module.name``."""
    return isinstance(value, ModuleType) and value.__name__.split(".")[0] not in ("numpy", "math", "numba")


def _constant(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(map(_constant, value))
    return isinstance(value, (*CONSTANT, np.ndarray))


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    return repr(value)


# ---------------------------------------------------------------------- the cache


class KernelCache:
    """The cache of one kernel, opened when it is first needed.

    ``kind`` distinguishes forms of the same function that are compiled differently; ``content`` is what is
    written, by default the machine code.
    """

    def __init__(self, dispatcher: Any, kind: str = "", content: Any = KeptCode):
        self.dispatcher, self.kind, self.content = dispatcher, kind, content
        self._opened: Any = None

    def _open(self) -> Any:
        if self._opened is None:
            self._opened = _Cache(self.dispatcher, self.kind, self.content)
        return self._opened

    @property
    def cache_path(self) -> Any:
        """The folder of the files."""
        return self._open().cache_path

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The compiled kernel from the disk, or None."""
        found = self._open().load_overload(signature, context)
        if found is None:
            _announce(sys.stderr)
        return found

    def save_overload(self, signature: Any, result: Any) -> None:
        """Write the compiled kernel to the disk."""
        self._open().save_overload(signature, result)


class _Files(IndexDataCacheFile):
    """numba's index of a kernel's files; one that names a class that this version no longer has is empty."""

    def _load_index(self) -> dict:
        try:
            return super()._load_index()
        except (AttributeError, ImportError, UnpicklingError, EOFError):
            return {}


class _Cache(FunctionCache):
    """numba's cache, with a key that includes the names of the fields of records."""

    def __init__(self, dispatcher: Any, kind: str, content: Any):
        function = dispatcher.py_func
        self._impl_class = content
        super().__init__(function)
        name = f"{function.__module__}.{function.__qualname__}{kind}".replace("<", "").replace(">", "")
        version = "py{}{}".format(*sys.version_info[:2])
        self._cache_file = _Files(self.cache_path, f"{name}.{version}", stamp(dispatcher))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        # numba would first register all of its own functions, which only the compiler needs, and which
        # takes half as long as all else at the start of a program; compiled code needs the memory system
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors(), inside_numba.undisturbed():
            return self._load_overload(sig, target_context)

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        kinds = (getattr(kind, "instance_class", None) for kind in getattr(sig, "args", sig))
        return *super()._index_key(sig, codegen), tuple(getattr(kind, "_fields", ()) for kind in kinds)


# ---------------------------------------------------------------------- a word to those who wait

_since: list[float] = []  # when the first compilation of this process began


def _announce(stream: TextIO | None) -> None:
    """Say once, in a terminal, that compilation lasts. Notebooks, pipes and tests stay as they are."""
    if not _since:
        _since.append(time.monotonic())
    elif len(_since) == 1 and time.monotonic() - _since[0] > LONG and stream is not None and stream.isatty():
        _since.append(0.0)
        print(ANNOUNCEMENT, file=stream)
