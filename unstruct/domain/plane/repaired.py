"""A planar outline after its repair: the arrays of a `Domain`, and the account of what was done."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...base.arrays import frozen
from ...geometry.curves import CurveLike
from ...geometry.outline import Outline
from .repair import Repair, Repairer

__all__ = ["Repaired", "repaired"]


class Repaired(NamedTuple):
    """The result of ``resolve=True``: the attributes of a `Domain` of the same names."""

    points: np.ndarray
    facets: np.ndarray
    inner: np.ndarray
    curves: dict[int, CurveLike]
    markers: dict[str, np.ndarray]
    origin: np.ndarray
    piece_origin: np.ndarray
    repairs: list[Repair]


def repaired(outline: Outline) -> Repaired:
    """Repair an outline as far as possible: see `Domain`, ``resolve``."""
    mended = Repairer(outline.points, outline.facets, outline.inner, outline.curves, outline.markers)
    mended.run()
    pieces = [p for p in mended.pieces if p.facet] + [p for p in mended.pieces if not p.facet]
    many = sum(p.facet for p in pieces)
    rows = np.array([(p.a, p.b) for p in pieces], dtype=np.int32).reshape(-1, 2)
    named = {
        name: np.array([i for i, p in enumerate(pieces) if name in p.names], dtype=np.int32)
        for name in outline.markers
    }
    return Repaired(
        frozen(mended.points),
        frozen(rows[:many]),
        frozen(rows[many:]),
        {i: p.curve for i, p in enumerate(pieces) if p.curve is not None},
        {name: frozen(numbers) for name, numbers in named.items()},
        frozen(mended.origin.astype(np.int32)),
        frozen(np.array([p.origin for p in pieces], dtype=np.int32)),
        mended.repairs,
    )
