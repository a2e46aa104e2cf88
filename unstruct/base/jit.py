"""How kernels are compiled: numba, lazily, cached on disk; plain Python where numba is missing.

numba's own cache looks at one file only, so that after an edit of ``predicates.py`` a kernel in
another file would silently run old machine code. Here the stamp of a kernel covers its own file, the
files of all the kernels that it can call, and the numbers that all these take from elsewhere by name.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pickle import UnpicklingError
from typing import Any

try:
    import numba
    from numba.core.dispatcher import Dispatcher
    from numba.core.registry import cpu_target
except ImportError:  # the kernels then run as plain Python
    numba = None  # type: ignore[assignment]

__all__ = ["inline", "kernel", "lean"]

if numba is not None and not getattr(numba.config, "DISABLE_JIT", False):
    # numba learns its own functions before the first compiled call: now, and not within somebody's first call
    cpu_target.typing_context.refresh()
    cpu_target.target_context.refresh()


def kernel(function: Callable) -> Any:
    """Compile a module-level function on first call, and cache the machine code on disk."""
    # said outright: numba lets an option that is not set be inherited from whoever calls it first, and then
    # the whole exact stage would be copied into every place where an inlined predicate stands, or could make
    # no arrays where a `lean` function asked for it first
    return _compiled(function, forceinline=False, _nrt=True)


def lean(function: Callable) -> Any:
    """As `kernel`, for functions that make no arrays and are called often: no references are counted.

    numba counts a reference to each array at each call, atomically, unless its optimizer sees that this is in
    vain; in kernels that call each other once a point this took two thirds of the time.
    """
    return _compiled(function, forceinline=False, _nrt=False)


def inline(function: Callable) -> Any:
    """Compile a small helper, inlined by LLVM into every kernel that calls it."""
    return _compiled(function, forceinline=True)


def _compiled(function: Callable, **options: Any) -> Any:
    """The kernel under these options; the function itself where there is no numba.

    Kernels touch the arrays that they are given and nothing else. So Python's lock is let go while one runs,
    and threads may mesh different domains at once; no two of them may work on the arrays of one mesh.
    """
    if numba is None:
        return function
    return _stamped(numba.njit(cache=True, nogil=True, **options)(function))


def _stamped(dispatcher: Any) -> Any:
    """Let the cache of ``dispatcher`` depend on the files of all kernels reachable from it."""
    index = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if index is not None:  # None with NUMBA_DISABLE_JIT
        reachable: dict[int, Any] = {}
        _reach(dispatcher, reachable)
        files = {d.py_func.__code__.co_filename for d in reachable.values()}
        numbers = set().union(*(_numbers(d.py_func) for d in reachable.values()))
        index._source_stamp = (*sorted(_file_stamp(f) for f in files), *sorted(numbers))
        index._load_index = partial(_entries, index._load_index)
    return dispatcher


def _entries(load: Callable[[], dict]) -> dict:
    """The entries of a cache on disk, none where it names a class that this version no longer has."""
    try:
        return load()
    except (AttributeError, ImportError, UnpicklingError):
        return {}


def _reach(dispatcher: Any, reachable: dict[int, Any]) -> None:
    """Add the kernel and all those that it can call."""
    reachable[id(dispatcher)] = dispatcher
    for value in list(dispatcher.py_func.__globals__.values()):
        if isinstance(value, Dispatcher) and id(value) not in reachable:
            _reach(value, reachable)


def _numbers(function: Any) -> set[tuple[str, str]]:
    """The constants that a function reads, with their values: they may come from files without kernels."""
    read = ((name, function.__globals__.get(name)) for name in function.__code__.co_names)
    return {(name, repr(value)) for name, value in read if isinstance(value, (int, float))}


def _file_stamp(path: str) -> tuple[str, int, int]:
    status = os.stat(path)
    return path, status.st_mtime_ns, status.st_size
