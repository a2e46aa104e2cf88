"""How kernels are compiled: by numba, at the first call, cached on disk; without numba they are plain Python.

Four things make the first call cheap. First, numba copies the code of a kernel into each kernel that calls
it, with that of its own callees: what is deep below, such as the exact stage of the predicates, would be
optimized dozens of times. A `kernel` is compiled only once; its callers jump to its address. (A `lean`
kernel is copied, as numba does it, because this is faster where it is called once per point.) Second, for
each kernel numba also compiles code that takes Python's objects apart, which is most of the work if a
record has forty arrays. Kernels that are called by kernels do without. Third, no machine code is made of
kernels that are only copied. Fourth, Python's garbage collector waits meanwhile, and numba is asked only once
what an operator does with numbers (`inside_numba`).
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable
from copy import copy
from importlib import import_module
from typing import Any, NamedTuple

from . import inside_numba
from .inside_libraries import CopiedCode, KeptCode
from .inside_numba import one_type
from .kernel_cache import KernelCache, stamp

try:
    import numba
    from llvmlite import binding
except ImportError:  # the kernels then run as plain Python
    numba = None  # type: ignore[assignment]

__all__ = ["apart", "inline", "inline_with_arrays", "kernel", "lean", "lending"]


def kernel(function: Callable) -> Any:
    """Compile a module-level function on first call, and cache the machine code on disk."""
    # Both options are set explicitly because numba lets an option that is not set be inherited from the first
    # caller. The whole exact stage would then be copied to every place where a predicate is inlined, and it
    # could not create arrays if a `lean` function called it first.
    return _compiled(function, True, forceinline=False, _nrt=True)


def lean(function: Callable) -> Any:
    """Like `kernel`, without reference counting; for functions that create no arrays and are called often.

    numba counts the references to each array at each call, atomically, unless its optimizer sees that this is
    not needed. In kernels that call each other once per point, the counting took two thirds of the time.
    """
    return _compiled(function, False, forceinline=False, _nrt=False)


def apart(function: Callable) -> Any:
    """Like `lean`, but compiled once, as a `kernel`; for what is long, and called seldom or by many."""
    return _compiled(function, True, forceinline=False, _nrt=False)


def inline(function: Callable) -> Any:
    """Compile a small helper, inlined by LLVM into every kernel that calls it; as `lean`, without arrays.

    If the option were not set, the first kernel to call it would decide whether references are counted.
    """
    return _compiled(function, False, forceinline=True, _nrt=False)


def inline_with_arrays(function: Callable) -> Any:
    """Like `inline`, for a helper that creates arrays."""
    return _compiled(function, False, forceinline=True, _nrt=True)


def lending(function: Callable) -> Any:
    """Like `inline`, for a helper that returns arrays of its arguments; its callers count no references."""
    found = inline(function)
    found.lends = True
    return found


def _compiled(function: Callable, apart: bool, **options: Any) -> Any:
    """The kernel under these options; the function itself where there is no numba.

    Kernels touch the arrays that they are given and nothing else. So Python's lock is let go while one runs,
    and threads may mesh different domains at once; no two of them may work on the arrays of one mesh.
    """
    if numba is None:
        return function
    if not inside_numba.KNOWN:
        return numba.njit(nogil=True)(function)
    options |= {"nogil": True, "no_cfunc_wrapper": True, "pipeline_class": inside_numba.ShortPipeline}
    outer = numba.njit(**options)(function)
    if not hasattr(outer, "_cache"):  # with NUMBA_DISABLE_JIT
        return outer
    outer._cache = KernelCache(outer)
    inner = _Inner(outer, apart, options)
    outer.get_call_template = inner.get_call_template
    outer.get_overload = inner.get_overload
    outer.inner = inner
    return outer


class _Inner:
    """The form of a kernel that other kernels call; its compiler is made when the first of them needs it."""

    def __init__(self, outer: Any, apart: bool, options: dict[str, Any]):
        self.outer, self.apart, self.options = outer, apart, options
        self._compiler: Any = None

    def compiler(self) -> Any:
        if self._compiler is None:
            options: Any = self.options | {"no_cpython_wrapper": True}
            if not self.apart:
                options["pipeline_class"] = inside_numba.CopiedPipeline
            found = numba.njit(**options)(self.outer.py_func)
            found._cache = KernelCache(self.outer, "-inner", KeptCode if self.apart else CopiedCode)
            self._insert, found.add_overload = found.add_overload, self.add_overload
            self._compiler = found
        return self._compiler

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """What numba asks when it compiles a call: the types of the result."""
        kws = {name: one_type(kind) for name, kind in kws.items()}
        return self.compiler().get_call_template(tuple(map(one_type, args)), kws)

    def get_overload(self, sig: Any) -> Any:
        """What numba asks next: the compiled function."""
        return self.compiler().get_overload(sig)

    def add_overload(self, result: Any) -> None:
        """Take a compiled form, from the compiler or from the disk; give it an address if it stays apart."""
        lends = self.options["_nrt"] or getattr(self.outer, "lends", False)
        if not lends and "array(" in str(result.signature.return_type):  # the caller would count one too few
            raise TypeError(f"{self.outer.py_func.__name__} returns an array: make it a kernel")
        # numba forgets the references of what it has read from the disk, but these are needed if it is copied
        result.library._reload_init.update(result.reload_init)
        if self.apart and self._can_be_found():
            args = result.signature.args
            name = self._symbol(args)
            address = result.library.get_pointer_to_function(result.fndesc.llvm_func_name)
            binding.add_symbol(name, address)
            context, alias = self._compiler.targetctx, copy(result.fndesc)
            alias.mangled_name = name
            function = self.outer.py_func
            reference = _Reference(function.__module__, function.__name__, args)
            context.remove_user_function(result.entry_point)
            context.insert_user_function(result.entry_point, alias, [_Library(reference)])
        self._insert(result)

    def _can_be_found(self) -> bool:
        """Whether another process can find the kernel by its name."""
        function = self.outer.py_func
        module = sys.modules.get(function.__module__)
        return (
            getattr(module, function.__qualname__, None) is self.outer and function.__module__ != "__main__"
        )

    def _symbol(self, args: Any) -> str:
        """The name of the machine code for these types of arguments: the same in each process."""
        return "unstruct." + hashlib.sha256(f"{stamp(self.outer)} {args}".encode()).hexdigest()


class _Reference(NamedTuple):
    """A kernel that must have an address before the machine code of its caller is read from the disk."""

    module: str
    name: str
    args: tuple

    def __call__(self) -> None:
        getattr(import_module(self.module), self.name).inner.compiler().compile(self.args)


class _Library:
    """What numba links into the caller of a kernel that stays apart: no code, only the reference."""

    def __init__(self, reference: _Reference):
        self._reload_init = {reference}

    def _ensure_finalized(self) -> None:
        pass

    def _get_module_for_linking(self) -> Any:
        return binding.parse_assembly("")
