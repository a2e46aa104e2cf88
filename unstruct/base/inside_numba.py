"""What kernels use of numba's inside, which numba may change: all of it stands here.

Where a version of numba lacks one of these parts, `KNOWN` is False, and kernels are compiled as numba does by
itself. They give the same results, but are compiled again in each process, since numba's own cache does not
see edits in other files.
"""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, ClassVar

from .inside_builtins import direct
from .inside_libraries import CopiedLibrary, Library

__all__ = [
    "KNOWN",
    "CopiedPipeline",
    "Record",
    "ShortPipeline",
    "one_type",
    "undisturbed",
]

try:
    from llvmlite import binding
    from numba.core import types
    from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
    from numba.core.codegen import CPUCodegen, JITCodeLibrary
    from numba.core.compiler import CompilerBase, DefaultPassBuilder, Flags
    from numba.core.compiler_machinery import PassManager
    from numba.core.cpu import CPUContext, CPUTargetOptions
    from numba.core.datamodel.models import OpaqueModel, TupleModel
    from numba.core.dispatcher import Dispatcher
    from numba.core.runtime import rtsys
    from numba.core.typeconv import Conversion
    from numba.core.typing.context import Context
    from numba.extending import lower_cast, register_model
except (ImportError, AttributeError):  # another numba, or none: then the kernels run as plain Python
    FunctionCache = IndexDataCacheFile = Dispatcher = object  # type: ignore[assignment, misc]
    rtsys = types = None  # type: ignore[assignment]
    INNER_PARTS: dict[Any, str] = {object: "a part that is missing"}
else:
    INNER_PARTS = {
        Dispatcher: "get_call_template get_overload add_overload compile",
        FunctionCache: "_load_overload save_overload _index_key _guard_against_spurious_io_errors",
        IndexDataCacheFile: "_load_index load save",
        Context: "resolve_function_type _lookup_global load_additional_registries",
        CPUContext: "load_additional_registries install_registry insert_user_function remove_user_function "
        "get_abi_sizeof get_executable",
        CPUTargetOptions: "nogil forceinline _nrt no_cpython_wrapper no_cfunc_wrapper",
        CompilerBase: "define_pipelines compile_extra",
        CompileResultCacheImpl: "reduce rebuild check_cachable",
        CPUCodegen: "_function_pass_manager",
        JITCodeLibrary: "codegen enable_object_caching get_pointer_to_function _finalize_final_module "
        "_finalize_dynamic_globals _verify_declare_only_symbols _get_module_for_linking _optimize_functions "
        "serialize_using_object_code _set_compiled_object",
        DefaultPassBuilder: "define_nopython_pipeline",
        PassManager: "finalize _ENFORCING",
        TupleModel: "as_argument from_argument get_argument_type get_value_type",
        types.NamedTuple: "can_convert_to can_convert_from",
        types.Function: "key get_call_type get_impl_key",
        Flags: "_values copy no_cpython_wrapper no_cfunc_wrapper",
        type(rtsys): "initialize",
    }

KNOWN = all(hasattr(part, name) for part, names in INNER_PARTS.items() for name in names.split())

# Passes for what no kernel contains: closures, generators, loops over tuples, ``with``, parallel loops.
NOT_NEEDED = {
    "AnnotateTypes",
    "DumpParforDiagnostics",
    "FindLiterallyCalls",
    "InlineClosureLikes",
    "InlineInlinables",
    "LiteralPropagationSubPipelinePass",
    "LiteralUnroll",
    "MakeFunctionToJitFunction",
    "NoPythonSupportedFeatureValidation",
    "RewriteDynamicRaises",
    "WithLifting",
}

if KNOWN:
    NARROW_TYPES = (types.int8, types.int16, types.int32)

    class Record(types.NamedTuple):
        """The type of a record (a ``NamedTuple``) as an argument of a kernel that a kernel calls.

        numba passes each field by itself, and of each array its seven parts. A record of forty arrays has
        some 300 of them, which every call took apart and put together again: half of the code of a run of
        refinement before it was optimized. Here a record is one argument, with a short name.
        """

        def __init__(self, kinds: Any, made: Any):
            super().__init__(kinds, made)
            self.name = f"{made.__name__}.{hashlib.sha256(self.name.encode()).hexdigest()[:12]}"

        def can_convert_from(self, typingctx: Any, other: Any) -> Any:
            return Conversion.safe if _the_same(self, other) else None

        def can_convert_to(self, typingctx: Any, other: Any) -> Any:
            return Conversion.safe if _the_same(self, other) else None

    def _the_same(record: Any, other: Any) -> bool:
        return type(other) is types.NamedTuple and other.key == record.key

    @register_model(Record)
    class _RecordModel(TupleModel):
        def get_argument_type(self) -> Any:
            return self.get_value_type()

        def as_argument(self, builder: Any, value: Any) -> Any:
            return value

        def from_argument(self, builder: Any, value: Any) -> Any:
            return value

    @lower_cast(types.NamedTuple, Record)
    @lower_cast(Record, types.NamedTuple)
    def _unchanged(context: Any, builder: Any, before: Any, after: Any, value: Any) -> Any:
        return value

    class ShortPipeline(CompilerBase):
        """numba's compiler without the passes that kernels do not need, a tenth of the time."""

        library_class = Library

        def __init__(self, typingctx: Any, targetctx: Any, *rest: Any):
            super().__init__(typingctx, targetctx, *rest)
            self.contexts = typingctx, targetctx

        def compile_extra(self, function: Any) -> Any:
            """Compile a kernel."""
            state = self.state
            state.typingctx = state.targetctx.typing_context = _types_of(state.typingctx)
            state.targetctx.get_abi_sizeof = _SizeOf(state.targetctx)
            state.flags = _Options(state.flags)
            with _without_collector(), _all_registered(*self.contexts), _no_word_of_locks():
                return super().compile_extra(function)

        def define_pipelines(self) -> list[Any]:
            """The passes, and the library that takes the code."""
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.passes[:] = [p for p in passes.passes if p[0].__name__ not in NOT_NEEDED]
            passes.finalize()
            # numba would look for unused variables and blocks after each pass, and again before it lowers
            passes._ENFORCING = False
            codegen = self.state.targetctx.codegen()
            self.state.library = self.library_class(codegen, self.state.func_id.func_qualname)
            self.state.library.enable_object_caching()
            return [passes]

    class CopiedPipeline(ShortPipeline):
        """The compiler of kernels that are copied into their callers."""

        library_class = CopiedLibrary

    class _Options(Flags):
        """The options of a kernel, by which numba looks up what it has compiled of its own functions."""

        same = hash(Flags())  # numba's hash is of the names of the options

        def __eq__(self, other: object) -> Any:
            same_values = isinstance(other, Flags) and self._values == other._values
            return same_values or super().__eq__(other)

        def __hash__(self) -> int:
            return self.same

        def copy(self) -> Any:
            """For numba's functions, which never have what a kernel has for Python."""
            found = super().copy()
            found.no_cpython_wrapper = found.no_cfunc_wrapper = True
            return found

    class _Types(Context):
        """numba's context of types, with operators that remember what they are for numbers and arrays."""

        def __init__(self, whole: Any):
            self.__dict__.update(whole.__dict__)
            self.operators: dict[Any, Any] = {}

        def _lookup_global(self, value: Any) -> Any:
            found = super()._lookup_global(value)
            if type(found) is types.Function and getattr(value, "__module__", "") == "_operator":
                if found not in self.operators:
                    self.operators[found] = _Operator(found.key[1])
                return self.operators[found]
            if type(found) is types.Function and direct(value) is not None:
                if found not in self.operators:
                    self.operators[found] = _Direct(found.key[1], direct(value))
                return self.operators[found]
            return found

        def load_additional_registries(self) -> None:
            """numba's own context has done so."""

        def resolve_function_type(self, function: Any, args: Any, kws: Any) -> Any:
            if getattr(function, "__module__", "") == "_operator" and not kws:
                found = self._lookup_global(function)
                if type(found) is _Operator and tuple(args) in found.known:
                    return found.known[tuple(args)]
            return super().resolve_function_type(function, args, kws)

    class _Operator(types.Function):
        """The type of an operator: at each sum of numbers, numba tries to add strings, sets and more."""

        def __init__(self, templates: Any):
            super().__init__(templates)
            self.known: dict[Any, Any] = {}

        def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
            key = tuple(args)
            found = self.known.get(key)
            if found is None or kws:
                found = super().get_call_type(context, args, kws)
                # what is compiled for the purpose depends on more than the types
                ours = all(isinstance(kind, (types.Number, types.Boolean, types.Array)) for kind in key)
                if ours and not kws and found is not None and self.get_impl_key(found) is self.key[0]:
                    self.known[key] = found
            return found

    class _Direct(types.Function):
        """The type of a function that is written into the kernel, where its arguments are numbers."""

        def __init__(self, templates: Any, typed: Any):
            super().__init__(templates)
            self.typed = typed

        def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
            found = self.typed(context, args, kws)
            if found is None:
                return super().get_call_type(context, args, kws)
            keys: dict[Any, Any] = vars(self)["_impl_keys"]
            keys[found[1].args], result = found
            return result

    register_model(_Direct)(OpaqueModel)

    class _SizeOf:
        """The size of a value in memory, for which numba would have LLVM read a program each time."""

        known: ClassVar[dict[str, int]] = {}

        def __init__(self, context: Any):
            self.compute = context.get_abi_sizeof

        def __call__(self, kind: Any) -> int:
            name = str(kind)
            if name not in self.known:
                self.known[name] = self.compute(kind)
            return self.known[name]

    _known_types: dict[int, Any] = {}

    def _types_of(whole: Any) -> Any:
        """The context of types for kernels: the same for all."""
        if id(whole) not in _known_types:
            _known_types[id(whole)] = _Types(whole)
        return _known_types[id(whole)]

    @contextmanager
    def undisturbed() -> Iterator[None]:
        """While kernels are read from the disk."""
        with _without_collector(), _no_word_of_locks():
            yield

    @contextmanager
    def _without_collector() -> Iterator[None]:
        """Python's search for cycles of garbage, an eighth of the time, waits for the outermost kernel.

        numba's lock is held meanwhile, so that no two threads are in here at once.
        """
        was_on = gc.isenabled()
        try:
            gc.disable()
            yield
        finally:
            if was_on:
                gc.enable()

    @contextmanager
    def _all_registered(*contexts: Any) -> Iterator[None]:
        """numba would look for more functions of its own a thousand times, in thirty modules."""
        new = [c for c in contexts if "load_additional_registries" not in vars(c)]
        try:
            for context in new:
                context.load_additional_registries = partial(_look_again, context)
            yield
        finally:
            for context in new:
                del context.load_additional_registries

    def _look_again(context: Any) -> None:
        for registry in list(context._registries):
            context.install_registry(registry)

    @contextmanager
    def _no_word_of_locks() -> Iterator[None]:
        """numba would report each of 30,000 calls of LLVM, to each kernel that waits for a callee."""
        lock: Any = getattr(binding.ffi.lib, "_lock", None)
        listeners = getattr(lock, "_cblist", None)
        if not listeners:
            yield
            return
        try:
            lock._cblist = []
            yield
        finally:
            lock._cblist = listeners


def one_type(kind: Any) -> Any:
    """One type for all integers, for which numba would compile a kernel several times, and for a record."""
    kind = types.unliteral(kind)
    if type(kind) is types.NamedTuple:
        return Record(kind.types, kind.instance_class)
    return types.int64 if kind in NARROW_TYPES else kind
