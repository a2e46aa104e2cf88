"""Dictionaries by name whose entries are checked when they are put in, also after they were made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Self, TypeVar

import numpy as np

from .arguments import as_mapping
from .errors import InputError

__all__ = ["CheckedDict", "as_name", "by_name"]

V = TypeVar("V")
Check = Callable[[str, Any, Mapping[str, V]], V]


class CheckedDict(dict[str, V]):
    """A dict by name: each value passes a check, so that no later use meets a wrong one.

    Parameters
    ----------
    entries : mapping of str to value
        Which are checked already.
    what : str
        The name of the dictionary, for errors.
    check : function (name, value, others) -> value
        Returns the value in its right type, or raises an error; ``others`` has what is there already. Of a
        module, so that it can be pickled.
    """

    def __init__(self, entries: Mapping[str, V], what: str, check: Check[V]):
        super().__init__(entries)
        self.what, self.check = what, check

    def __setitem__(self, name: Any, value: Any) -> None:
        name = as_name(name, self.what)
        super().__setitem__(name, self.check(name, value, self))

    def setdefault(self, name: Any, value: Any = None) -> V:
        """As of a dict; a value that is put in is checked."""
        if name not in self:
            self[name] = value
        return self[as_name(name, self.what)]

    def update(self, *others: Any, **named: Any) -> None:
        """As of a dict; nothing is put in unless all values are right."""
        super().update(by_name(dict(*others, **named), self.what, self.check, self))

    def __ior__(self, other: Any) -> Self:  # type: ignore[override,misc]
        self.update(other)
        return self

    def of(self, entries: Mapping[str, V]) -> CheckedDict[V]:
        """Other entries, checked already, under the same check."""
        return CheckedDict(entries, self.what, self.check)

    def copy(self) -> CheckedDict[V]:
        """Another dictionary of the same entries, under the same check."""
        return self.of(self)

    __copy__ = copy

    def __reduce__(self) -> tuple[Any, ...]:
        return CheckedDict, (dict(self), self.what, self.check)


def as_name(name: Any, what: str) -> str:
    """A name as text: whole numbers become texts, and anything else is an error that names ``what``."""
    if isinstance(name, int | np.integer) and not isinstance(name, bool):
        return str(int(name))
    if not isinstance(name, str):
        raise InputError(
            f"{what} has the name {name!r}, a {type(name).__name__}; names are texts, or whole numbers, "
            "which become texts"
        )
    if any("\ud800" <= letter <= "\udfff" for letter in name):
        raise InputError(f"{what} has the name {name!r}, which has half a character: it cannot be written")
    return str(name)


def by_name(values: Any, what: str, check: Check[V], others: Mapping[str, V] | None = None) -> dict[str, V]:
    """Checked values by names that are texts, all different; ``others`` are those that are there already.

    Raises
    ------
    InputError
        If this is no mapping, for names that are no texts or become equal, and what ``check`` raises.
    """
    found: dict[str, V] = {}
    known = dict(others or {})
    for key, value in as_mapping(values, what).items():
        name = as_name(key, what)
        if name in found:
            raise InputError(f"{what} has the name {name!r} twice, as a number and as a text: rename one")
        found[name] = known[name] = check(name, value, known)
    return found
