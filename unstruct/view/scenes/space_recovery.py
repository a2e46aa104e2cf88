"""The recovery of an edge in space, step by step, as frames for the player and for strips."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ...connect.spatial.signs import DISJOINT, meets
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import bodies, space_frame

__all__ = ["edge_recovery_frames", "missing_edge_items"]


def edge_recovery_frames(
    points: Sequence[Sequence[Any]],
    states: Sequence[Iterable[Sequence[int]]],
    a: int,
    b: int,
    *,
    azimuth: float = -60.0,
    elevation: float = 18.0,
) -> list[fr.Frame]:
    """Three frames for each refill: the faces in the way, the cavity, and the cells that fill it afterwards.

    Parameters
    ----------
    points : n points of three numbers
    states : sets of cells, as rows of vertices, before and after each refill
    a, b : the vertices of the edge that is recovered
    azimuth, elevation : float
        The direction from which all frames are seen, in degrees.
    """
    places = np.array([[float(x) for x in p] for p in points])
    seen = {"azimuth": azimuth, "elevation": elevation}
    sets = [{tuple(int(v) for v in cell) for cell in state} for state in states]
    shown = sorted({v for cell in sets[0] for v in cell} | {a, b})
    front = [
        item3("segments", "inserted", [(a, b)], places),
        item3("labels", "vertex", places[shown], text=shown),
    ]
    made = []
    for before, after in pairwise(sets):
        wires = [*_wires(places, before)]
        way, rest = _in_the_way(places, before, a, b), _in_the_way(places, after, a, b)
        cavity = bodies("cavity", sorted(before - after), places, shrink=1.0, opacity=0.45)
        refill = bodies("accepted", sorted(after - before), places, opacity=0.5)
        marked = [_faces(places, way), *front]
        texts = "what is in the way", f"a cavity of {len(before - after)} cells"
        made += [
            space_frame([*wires, *marked], texts[0], number=_count(way), **seen),
            space_frame([*wires, cavity, *marked], texts[1], number=_count(way), **seen),
            space_frame(
                [*_wires(places, after), refill, _faces(places, rest), *front],
                f"filled by {len(after - before)} others",
                number=_count(rest),
                **seen,
            ),
        ]
    return made


def missing_edge_items(
    points: Sequence[Sequence[Any]], cells: Iterable[Sequence[int]], a: int, b: int, *, names: bool = True
) -> list[dict[str, Any]]:
    """All edges of the cells, the segment ab, and the faces in its way, as items for a picture.

    Parameters
    ----------
    points : n points of three numbers
    cells : rows of four vertices
    a, b : the vertices of the edge that is missing
    names : bool
        Whether to write the numbers of the vertices.
    """
    places = np.array([[float(x) for x in p] for p in points])
    now = [tuple(int(v) for v in cell) for cell in cells]
    items = [*_wires(places, now), _faces(places, _in_the_way(places, now, a, b))]
    items.append(item3("segments", "inserted", [(a, b)], places))
    if names:
        used = sorted({v for cell in now for v in cell})
        items.append(item3("labels", "vertex", places[used], text=used))
    return items


def _count(faces: Sequence[Any]) -> str:
    return f"{len(faces)} face{'' if len(faces) == 1 else 's'} in the way"


def _in_the_way(places: np.ndarray, cells: Iterable[Sequence[int]], a: int, b: int) -> list[tuple[int, ...]]:
    """The faces of cells that the open segment meets, each once, by exact signs."""
    faces = sorted({face for cell in cells for face in combinations(sorted(cell), 3)})
    return [face for face in faces if meets(places, a, b, *face) != DISJOINT]


def _faces(places: np.ndarray, faces: Sequence[Sequence[int]]) -> dict[str, Any]:
    return item3("polygons", "highlight", faces, places, opacity=0.75)


def _wires(places: np.ndarray, cells: Iterable[Sequence[int]]) -> list[dict[str, Any]]:
    """All edges of the cells, and their vertices."""
    edges = sorted({pair for cell in cells for pair in combinations(sorted(cell), 2)})
    used = sorted({v for pair in edges for v in pair})
    return [item3("segments", "edge", edges, places, opacity=0.6), item3("points", "vertex", places[used])]
