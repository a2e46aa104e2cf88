"""Options that are passed on: functions show them by name, in `help` and when the tab key completes them."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, signature
from typing import Any, TypeVar

__all__ = ["like", "named"]

F = TypeVar("F", bound=Callable[..., Any])


def named(options: type, **defaults: Any) -> Callable[[F], F]:
    """A decorator: the signature shows the keys of a `TypedDict` instead of ``**options``.

    Parameters
    ----------
    options : type
        The `TypedDict` of which the function says ``**options: Unpack[...]``.
    **defaults
        What a missing key means, to be shown; None unless it is given here.
    """

    def shown(function: F) -> F:
        found = signature(function)
        kept = [p for p in found.parameters.values() if p.kind is not Parameter.VAR_KEYWORD]
        kept += [
            Parameter(
                key,
                Parameter.KEYWORD_ONLY,
                default=defaults.get(key),
                annotation=getattr(kind, "__forward_arg__", kind),
            )
            for key, kind in options.__annotations__.items()
            if key[0] != "_"
        ]
        function.__signature__ = found.replace(parameters=kept)  # type: ignore[attr-defined]
        return function

    return shown


def like(model: Callable[..., Any]) -> Callable[[F], F]:
    """A decorator: a method that passes everything on has the docstring and the signature of ``model``."""

    def shown(function: F) -> F:
        function.__doc__ = model.__doc__
        function.__signature__ = signature(model)  # type: ignore[attr-defined]
        return function

    return shown
