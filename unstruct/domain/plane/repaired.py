"""A planar outline after its repair: the arrays of a `Domain`, and the account of what was done."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...base.arrays import counted_off, frozen
from ...geometry.curves import CurveLike
from ...geometry.outline import Outline
from .arc_meetings import arc_meetings
from .faults import find_faults
from .repair import Repair, Repairer

__all__ = ["PARTS", "Repaired", "repaired"]


PARTS = ("points", "facets", "inner", "curves", "markers", "regions")


class Repaired(NamedTuple):
    """The result of ``resolve=True``: the attributes of a `Domain` of the same names."""

    points: np.ndarray
    facets: Any
    inner: Any
    curves: dict[int, CurveLike]
    markers: dict[str, np.ndarray]
    origin: np.ndarray
    piece_origin: np.ndarray
    repairs: list[Repair]


def repaired(outline: Outline) -> Repaired:
    """Repair an outline as far as possible: see `Domain`, ``resolve``. Nothing is done where all is well."""
    # A copy, because an outline keeps what it has computed of its pieces, and these are going to change.
    outline = Outline(*(getattr(outline, name) for name in PARTS))
    if not find_faults(outline) and not _arcs_meet(outline):
        many, n = len(outline.pieces), len(outline.points)
        whole = outline.points, outline.facets, outline.inner, outline.curves, outline.markers
        return Repaired(*whole, counted_off(n), counted_off(many), [])
    mended = Repairer(outline)
    mended.run()
    order = np.argsort(~mended.facet, kind="stable")
    many = int(mended.facet.sum())
    rows, label, curve = mended.ends[order].astype(np.int32), mended.label[order], mended.curve[order]
    named: dict[str, list[np.ndarray]] = {name: [] for name in outline.markers}
    sequence = np.argsort(label, kind="stable")
    for part in np.split(sequence, np.nonzero(np.diff(label[sequence]))[0] + 1) if len(sequence) else ():
        for name in mended.sets[label[part[0]]]:
            named[name].append(part)
    return Repaired(
        frozen(mended.points),
        frozen(rows[:many]),
        frozen(rows[many:]),
        {int(i): mended.curves[curve[i]] for i in np.nonzero(curve >= 0)[0]},
        {name: _joined(parts) for name, parts in named.items()},
        frozen(mended.origin.astype(np.int32)),
        frozen(mended.piece[order].astype(np.int32)),
        mended.repairs,
    )


def _arcs_meet(outline: Outline) -> bool:
    return bool(outline.curves) and bool(arc_meetings(outline.points, outline.pieces, outline.curves))


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return frozen(np.sort(np.concatenate([*parts, np.empty(0, dtype=np.int32)])).astype(np.int32))
