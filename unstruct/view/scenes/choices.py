"""Checks of the values of controls; the error messages list the allowed values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from ...base.errors import InputError

__all__ = ["preset_named", "within"]

Value = TypeVar("Value")


def preset_named(known: Mapping[str, Value], name: str) -> Value:
    """The preset of this name.

    Raises
    ------
    InputError
        If there is none; the message lists the names of all presets.
    """
    if name not in known:
        raise InputError(f"no preset {name!r}; use one of {', '.join(known)}")
    return known[name]


def within(name: str, value: float, low: float, high: float) -> None:
    """Raise an error for a value below ``low`` or above ``high``, or for NaN.

    Raises
    ------
    InputError
    """
    if not low <= value <= high:
        raise InputError(f"{name} = {value} must lie between {low} and {high}")
