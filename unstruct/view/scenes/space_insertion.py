"""Bowyer and Watson's insertion in space, step by step, as frames for the player and for strips."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from ...geometry.simplex import circumcenter, circumradius
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import bodies, space_frame

__all__ = ["space_insertion_frames"]


def space_insertion_frames(
    points: Sequence[Sequence[Any]],
    cells: Iterable[Sequence[int]],
    steps: Iterable[Any],
    *,
    names: Sequence[str] | None = None,
    azimuth: float = -60.0,
    elevation: float = 18.0,
) -> list[fr.Frame]:
    """Four frames for each insertion: the point, a sphere that contains it, the cavity, the star.

    Parameters
    ----------
    points : n points of three numbers
    cells : the cells before the first step, as rows of vertices
    steps : objects with vertex, cavity, star and cells, as those of ``unstruct.plain.bowyer_watson_space``
    names : sequence of str, optional
        What the vertices are called, in place of their numbers; the cells of each cavity are then listed.
    azimuth, elevation : float
        The direction from which all frames are seen, in degrees.
    """
    places = np.array([[float(x) for x in p] for p in points])
    seen = {"azimuth": azimuth, "elevation": elevation}
    now = {tuple(cell) for cell in cells}
    made = [space_frame(_wires(places, now), "the start", number=f"{len(now)} cells", **seen)]
    called = str if names is None else names.__getitem__
    for step in steps:
        p = places[step.vertex]
        dot = [
            item3("points", "inserted", [p]),
            item3("labels", "inserted", [p], text=[called(step.vertex)]),
        ]
        wires = _wires(places, now)
        first = list(min(step.cavity))
        center, radius = circumcenter(places[first]), float(circumradius(places[first]))
        sphere = item3("spheres", "circumcircle", [[*center, radius]])
        cavity = bodies("cavity", sorted(step.cavity), places, shrink=0.7, opacity=0.6)
        star = bodies("accepted", sorted(step.star), places, shrink=0.7, opacity=0.6)
        count, born, v = len(step.cavity), len(step.star), called(step.vertex)
        gone = "" if names is None else ": " + _listed(step.cavity, names)
        made += [
            space_frame([*wires, *dot], f"point {v}", number=f"{len(now)} cells", **seen),
            space_frame(
                [*wires, bodies("waiting", [first], places), sphere, *dot],
                f"{v} is inside the sphere of this cell",
                number=f"1 of {count} such cells",
                **seen,
            ),
            space_frame([*wires, cavity, *dot], "the cavity", number=f"{count} cells go{gone}", **seen),
            space_frame(
                [*_wires(places, step.cells), star, *dot],
                f"its faces joined to {v}",
                number=f"{born} cells come, {len(step.cells)} in all",
                **seen,
            ),
        ]
        now = set(step.cells)
    return made


def _listed(cells: Iterable[Sequence[int]], names: Sequence[str]) -> str:
    return ", ".join("".join(names[v] for v in cell) for cell in sorted(map(sorted, cells)))


def _wires(places: np.ndarray, cells: Iterable[Sequence[int]]) -> list[dict[str, Any]]:
    """All edges of the cells, and their vertices."""
    edges = sorted({pair for cell in cells for pair in combinations(sorted(cell), 2)})
    used = sorted({v for pair in edges for v in pair})
    return [item3("segments", "edge", edges, places, opacity=0.6), item3("points", "vertex", places[used])]
