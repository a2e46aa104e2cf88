"""Doors: functions of a higher layer, named in a lower one and imported only when they are called.

A mesh can draw itself, but the drawing package is built on the mesh package. A door names the function of the
higher layer without importing it; the import happens at the first call. There are few doors, and a test
opens each of them.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

__all__ = ["door"]


def door(target: str) -> Callable[..., Any]:
    """A function that stands for another one, which is imported when it is called.

    Parameters
    ----------
    target : str
        Module and name, written as in entry points: "unstruct.view:plot".

    Returns
    -------
    function
        It passes all its arguments on and returns the result. ``target`` is kept as an attribute.
    """
    module, _, name = target.partition(":")

    def enter(*args: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(*args, **options)

    enter.__name__ = enter.__qualname__ = name
    enter.__doc__ = f"`{module}.{name}`, imported at the first call."
    enter.target = target  # type: ignore[attr-defined]
    return enter
