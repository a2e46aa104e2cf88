"""How kernels call ``min``, ``max``, ``int`` and ``np.empty``: a part of `inside_numba`.

For each combination of types numba compiles a function of its own around one instruction or one
allocation, which the kernel then copies: a tenth of the time that the first call of a mesher takes. Here the
same instructions are written into the kernel at once, by the same parts of numba.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

import numpy as np

try:
    from numba.core import types
    from numba.core.typing.templates import signature
    from numba.extending import lower_builtin
except (ImportError, AttributeError):  # another numba, or none
    types = None  # type: ignore[assignment]

__all__ = ["direct"]

_parts: dict[str, Any] = {}  # of numba, which loads them when it compiles for the first time


def direct(function: Any) -> Callable | None:
    """What gives key and signature of a call, from a context and the types of the arguments; or None."""
    if types is None or not _found():
        return None
    try:
        return _OWN.get(function)
    except TypeError:  # it has no hash
        return None


def _found() -> bool:
    """Whether this numba has all the parts."""
    if not _parts:
        from numba.cpython import builtins
        from numba.np import arrayobj

        _parts["do_minmax"] = getattr(builtins, "do_minmax", None)
        for name in ("ty_parse_dtype", "_parse_shape", "_empty_nd_impl"):
            _parts[name] = getattr(arrayobj, name, None)
    return None not in _parts.values()


def _numbers(args: tuple) -> bool:
    return all(isinstance(kind, (types.Integer, types.Float)) for kind in args)


def _extreme(key: Any) -> Callable:
    """The least or the greatest of several numbers."""

    def typed(context: Any, args: tuple, kws: Any) -> Any:
        kinds = tuple(map(types.unliteral, args))
        if kws or len(kinds) < 2 or not _numbers(kinds):
            return None
        result = context.unify_types(*kinds)
        return None if result is None else (key, signature(result, *kinds))

    return typed


def _whole(context: Any, args: tuple, kws: Any) -> Any:
    """``int`` of a number with a fraction, which is cut off."""
    kinds = tuple(map(types.unliteral, args))
    if kws or len(kinds) != 1 or not isinstance(kinds[0], types.Float):
        return None
    return _lower_whole, signature(types.intp, *kinds)


def _array(context: Any, args: tuple, kws: Any) -> Any:
    """``np.empty(shape, dtype=kind)`` of numbers."""
    kinds = (*map(types.unliteral, args), *kws.values())
    if len(kinds) != 2 or list(kws) not in ([], ["dtype"]) or not isinstance(kinds[1], types.NumberClass):
        return None
    shape = (kinds[0],) if isinstance(kinds[0], types.Integer) else kinds[0]
    if isinstance(shape, types.UniTuple):
        shape = (shape.dtype,) * shape.count
    if not isinstance(shape, tuple) or any(kind not in (types.int64, types.intp) for kind in shape):
        return None
    result = types.Array(_parts["ty_parse_dtype"](kinds[1]), len(shape), "C")
    return _lower_array, signature(result, *kinds).replace(pysig=SHAPE_AND_KIND)


if types is not None:
    SHAPE_AND_KIND = Signature(
        [Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in ("shape", "dtype")]
    )

    def _lower_least(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _parts["do_minmax"](context, builder, list(sig.args), args, operator.lt)

    def _lower_greatest(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _parts["do_minmax"](context, builder, list(sig.args), args, operator.gt)

    def _lower_whole(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.cast(builder, args[0], sig.args[0], sig.return_type)

    def _lower_array(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        shape = _parts["_parse_shape"](context, builder, sig.args[0], args[0])
        return _parts["_empty_nd_impl"](context, builder, sig.return_type, shape)._getvalue()

    for _lower in (_lower_least, _lower_greatest, _lower_whole, _lower_array):
        lower_builtin(_lower, types.VarArg(types.Any))(_lower)

    _OWN: dict[Any, Callable] = {
        min: _extreme(_lower_least),
        max: _extreme(_lower_greatest),
        int: _whole,
        np.empty: _array,
    }
