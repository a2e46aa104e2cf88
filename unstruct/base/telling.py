"""Warnings that give an account: they point to the line of the caller outside of this library."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from inspect import currentframe
from itertools import islice

__all__ = ["tell", "tell_renamed"]

LIBRARY = __name__.partition(".")[0]
MOST_TOLD = 10  # names in one warning


def tell(text: str) -> None:
    """Warn with a text."""
    level, frame = 1, currentframe()
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == LIBRARY:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, stacklevel=level)


def tell_renamed(names: Mapping[str, str], why: str) -> None:
    """Warn of names that are others in a file; those that are the same are left out."""
    changed = {name: other for name, other in names.items() if name != other}
    if changed:
        shown = ", ".join(f"{name!r} as {other!r}" for name, other in islice(changed.items(), MOST_TOLD))
        more = f", and {len(changed) - MOST_TOLD} more" if len(changed) > MOST_TOLD else ""
        tell(f"renamed: {shown}{more}; {why}")
