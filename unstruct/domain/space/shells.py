"""A body minus other bodies inside of it: all shells in one domain, whose inside is even-odd."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError

__all__ = ["emptied"]


def emptied(make: Callable[..., Any], parts: dict[str, Any], domains: Sequence[Any], *, resolve: bool) -> Any:
    """The first body minus the others.

    Parameters
    ----------
    make : function
        Makes a domain of parts and options.
    parts : dict
        The arguments of a `Domain` of all bodies together.
    domains : sequence of Domain

    Raises
    ------
    InputError
        For a body that is not inside of the first one, or is inside of another one.
    """
    domain = make({name: given for name, given in parts.items() if name != "curves"}, {"resolve": resolve})
    for i, other in enumerate(domains[1:]):
        shell = other.triangulated
        middles = shell.points[shell.triangles].mean(axis=1)
        beyond = ~domains[0].contains(middles)
        where, what = beyond, "lies outside the domain"
        for j, another in enumerate(domains[1:]):
            if not beyond.any() and j != i and _touch(other.bounds, another.bounds):
                where, what = another.contains(middles), f"lies inside others[{j}]"
                if where.any():
                    break
        if where.any():
            x, y, z = middles[int(np.argmax(where))].tolist()
            raise InputError(
                f"others[{i}] {what} near ({x:.6g}, {y:.6g}, {z:.6g}); correct it, or give all shells as "
                "facets of one Domain, whose inside is even-odd"
            )
    return domain


def _touch(one: np.ndarray, two: np.ndarray) -> bool:
    """Whether two boxes have common points."""
    return bool((one[0] <= two[1]).all() and (two[0] <= one[1]).all())
