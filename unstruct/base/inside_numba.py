"""What kernels use of numba's inside, which numba may change: all of it stands here.

Where a version of numba lacks one of these parts, `KNOWN` is False, and kernels are compiled as numba does by
itself. They give the same results, but are compiled again in each process, since numba's own cache does not
see edits in other files.
"""

from __future__ import annotations

import hashlib
from typing import Any

__all__ = [
    "KNOWN",
    "Record",
    "ShortPipeline",
    "one_type",
]

try:
    from numba.core import types
    from numba.core.caching import FunctionCache, IndexDataCacheFile
    from numba.core.compiler import CompilerBase, DefaultPassBuilder
    from numba.core.cpu import CPUContext, CPUTargetOptions
    from numba.core.datamodel.models import TupleModel
    from numba.core.dispatcher import Dispatcher
    from numba.core.runtime import rtsys
    from numba.core.typeconv import Conversion
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
        CPUContext: "insert_user_function remove_user_function",
        CPUTargetOptions: "nogil forceinline _nrt no_cpython_wrapper no_cfunc_wrapper",
        CompilerBase: "define_pipelines",
        DefaultPassBuilder: "define_nopython_pipeline",
        TupleModel: "as_argument from_argument get_argument_type get_value_type",
        types.NamedTuple: "can_convert_to can_convert_from",
        type(rtsys): "initialize",
    }

KNOWN = all(hasattr(part, name) for part, names in INNER_PARTS.items() for name in names.split())

# Passes for what no kernel contains: closures, generators, loops over tuples, ``with``, parallel loops.
NOT_NEEDED = {
    "AnnotateTypes",
    "DumpParforDiagnostics",
    "FindLiterallyCalls",
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

        def define_pipelines(self) -> list[Any]:
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.passes[:] = [p for p in passes.passes if p[0].__name__ not in NOT_NEEDED]
            passes.finalize()
            return [passes]


def one_type(kind: Any) -> Any:
    """One type for all integers, for which numba would compile a kernel several times, and for a record."""
    kind = types.unliteral(kind)
    if type(kind) is types.NamedTuple:
        return Record(kind.types, kind.instance_class)
    return types.int64 if kind in NARROW_TYPES else kind
