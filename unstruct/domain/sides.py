"""The functions of a `Domain` that depend on its dimension."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn

import numpy as np

from ..base.arrays import frozen
from ..base.errors import InputError
from ..geometry.outline import Outline
from ..geometry.polygons import Polygons
from .arguments import as_segments
from .plane import faults, inside, seeds
from .plane.repaired import Repaired, repaired
from .plane.simplify import Simplified, simplified
from .space import faults as space_faults
from .space import inside as space_inside
from .space.merging import simplified_in_space
from .space.repaired import repaired_in_space
from .space.rows import as_polygons
from .space.welding import with_hint

__all__ = ["SIDES", "Side"]


class Side(NamedTuple):
    """The functions for one dimension. ``coarse`` makes what most others take: `Sampled` or `Shell`."""

    rows: Callable[[Any, Any], tuple[Any, Any]]
    repaired: Callable[[Outline], Repaired]
    find_faults: Callable[[Outline], list[faults.Fault]]
    check_ends: Callable[[Outline], None]
    check_seeds_off_pieces: Callable[[Outline, Any], None]
    check_seeds: Callable[[Outline, Any], None]
    coarse: Callable[[Outline], Any]
    sized: Callable[[Outline, Any, float], Any]
    contains: Callable[[Outline, Any, np.ndarray], np.ndarray]
    measure: Callable[[Outline, Any], float]
    bounds: Callable[[Outline, Any], np.ndarray]
    simplified: Callable[[Outline, Any, Any, Any], Simplified]


NO_PIECES = frozen(np.empty((0, 2), dtype=np.int32))


def _segments(facets: Any, inner: Any) -> tuple[np.ndarray, np.ndarray]:
    return as_segments(facets, "facets"), NO_PIECES if inner is None else as_segments(inner, "inner")


def _polygons(facets: Any, inner: Any) -> tuple[Any, Polygons]:
    """Facets as rows of an array if all are triangles, else as polygons; inner pieces."""
    found = as_polygons(facets, "facets", 3)
    whole = found.triangles
    others = as_polygons([] if inner is None else inner, "inner", 2)
    return (found if whole is None else whole), others


def _planar_only(*_: Any) -> NoReturn:
    raise InputError("this is for planar domains; the domain has three coordinates")


def _space_faults(outline: Outline) -> list[faults.Fault]:
    return with_hint(outline, space_faults.find_faults(outline))


def _check_curves(outline: Outline) -> None:
    """Raise if a curve misses its ends, or if a loose vertex lies on it."""
    faults.check_ends(outline)
    seeds.check_loose_off_curves(outline)


IN_PLANE = Side(
    _segments,
    repaired,
    faults.find_faults,
    _check_curves,
    lambda outline, _: seeds.check_seeds_off_pieces(outline),
    seeds.check_seeds,
    seeds.coarse,
    seeds.sized,
    inside.contains,
    inside.area,
    inside.bounds,
    simplified,
)
IN_SPACE = Side(
    _polygons,
    repaired_in_space,
    _space_faults,
    _planar_only,
    space_inside.check_seeds_off_pieces,
    space_inside.check_seeds,
    space_faults.shell_of,
    _planar_only,
    space_inside.contains,
    space_inside.volume,
    space_inside.bounds,
    simplified_in_space,
)
SIDES = {2: IN_PLANE, 3: IN_SPACE}
