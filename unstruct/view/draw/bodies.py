"""Bodies in space as items of a scene: facets, inner pieces, loose points, names, faults."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ...base.arrays import within
from ...domain.space.cutting import cut
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons

__all__ = ["body_parts"]

MOST_NUMBERS = 40  # with more pieces or points than this, numbers would cover the picture
Part = tuple[str, str, Any, Any, dict[str, Any]]  # kind, role, data, points, options: arguments of `item3`


def body_parts(
    domain: Outline,
    *,
    numbers: bool | None = None,
    names: bool = True,
    vertices: bool | None = None,
    faults: Iterable[Any] = (),
) -> list[Part]:
    """What is drawn of a body, as the arguments of items.

    Facets are seen through if there is something inside. Facets with holes are drawn as triangles; those
    that refer to points that do not exist are left out.
    """
    points = domain.points
    facets, inner = Polygons.of(domain.facets), Polygons.of(domain.inner)
    rows, chosen = _rows(points, facets), _rows(points, inner)
    faults = list(faults)
    loose = points[~np.isin(np.arange(len(points)), domain.pieces.ravel())]
    inside = len(inner) or domain.regions or len(loose) or faults
    parts: list[Part] = [("polygons", "cell", rows, points, {"opacity": 0.35 if inside else 1.0})]
    parts.append(("polygons", "front", [r for r in chosen if len(r) > 2], points, {"opacity": 0.6}))
    parts.append(("segments", "front", [r for r in chosen if len(r) == 2], points, {}))
    parts.append(("points", "accepted", loose, (), {}))
    if vertices:
        parts.append(("points", "vertex", points, (), {}))
    texts: list[tuple[str, np.ndarray, str]] = []
    if names:
        seeds = [(name, x) for name, rows in domain.regions.items() for x in rows]
        parts.append(("points", "voronoi", [x for _, x in seeds], (), {}))
        texts += [("voronoi", x, name) for name, x in seeds]
        for name, pieces in domain.markers.items():
            if len(pieces):
                texts.append(("inserted", _middle(domain, int(pieces[len(pieces) // 2])), name))
    few = max(len(points), len(domain.pieces)) <= MOST_NUMBERS and not domain.markers
    if few if numbers is None else numbers:
        texts += [("vertex", x, str(i)) for i, x in enumerate(points)]
        count = len(facets)
        for i in range(len(domain.pieces)):
            texts.append(("inserted", _middle(domain, i), f"f{i}" if i < count else f"i{i - count}"))
    for fault in faults:
        some = [i for i in fault.pieces if 0 <= i < len(domain.pieces)]
        bad = _rows(points, domain.pieces.select(np.array(some, dtype=np.int64)))
        parts.append(("polygons", "bad", [r for r in bad if len(r) > 2], points, {}))
        parts.append(("segments", "bad", [r for r in bad if len(r) == 2], points, {}))
        parts.append(("points", "bad", points[list(fault.vertices)], (), {}))
        if np.isfinite(fault.place).all():
            texts.append(("bad", np.array(fault.place), fault.kind))
    parts = [part for part in parts if len(part[2])]
    for role in dict.fromkeys(role for role, _, _ in texts):
        mine = [(x, text) for other, x, text in texts if other == role and np.isfinite(x).all()]
        parts.append(("labels", role, [x for x, _ in mine], (), {"text": [text for _, text in mine]}))
    return parts


def _rows(points: np.ndarray, polygons: Polygons) -> list[list[int]]:
    """The rings of polygons without holes, and the triangles of others."""
    if polygons.triangles is not None and within(polygons.triangles, len(points)):
        return polygons.triangles.tolist()
    found = []
    for i in range(len(polygons)):
        rings = polygons.rings(i)
        if not all(within(ring[:, None], len(points)) for ring in rings):
            continue
        if len(rings) == 1:
            found.append(rings[0].tolist())
        else:
            found += cut(points, Polygons.of_rings([rings]), 1)[0].triangles.tolist()
    return found


def _middle(domain: Outline, piece: int) -> np.ndarray:
    """The mean of the vertices of a piece; NaN if some do not exist."""
    rows = domain.pieces.rings(piece)[0]
    if not within(rows[:, None], len(domain.points)):
        return np.full(3, np.nan)
    return domain.points[rows].mean(axis=0)
