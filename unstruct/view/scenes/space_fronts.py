"""The classical front in space as frames: the face, the sphere of the search, what was tried and chosen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from ...plain.advancing_front_space import Choice
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import bodies, space_frame

__all__ = ["front_items3", "space_front_frames"]

IN_WORDS = {"put aside": " in a wider search", "all vertices": " of all vertices"}
WINDOW_MARGIN = 0.1
MADE_SHRINK = 0.5  # cells that were made before, with room between them


def front_items3(points: Any, faces: Iterable[Sequence[int]], *, names: bool = True) -> list[dict[str, Any]]:
    """The faces of a front with their edges and the numbers of their vertices, as items of a scene.

    Parameters
    ----------
    points : (n, 3) array_like
    faces : triples of int
    names : bool
        Whether to write the numbers.
    """
    places = np.asarray(points, dtype=float)
    rows = [tuple(int(v) for v in face) for face in faces]
    edges = sorted({(min(p), max(p)) for a, b, c in rows for p in ((a, b), (b, c), (c, a))})
    items = [
        item3("polygons", "front", rows, places, opacity=0.35),
        item3("segments", "edge", edges, places),
    ]
    used = sorted({v for face in rows for v in face})
    return [*items, item3("labels", "vertex", places[used], text=used)] if names and used else items


def space_front_frames(
    points: Any,
    first: Iterable[Sequence[int]],
    steps: Iterable[Choice],
    *,
    azimuth: float = -60.0,
    elevation: float = 20.0,
) -> list[fr.Frame]:
    """A frame for each step of the plain classical front in space, and one of what is there in the end.

    Parameters
    ----------
    points : (n, 3) array_like
        The vertices before the first step.
    first : triples of int
        The faces of the front before the first step.
    steps : iterable of Choice
        From `unstruct.plain.advancing_front_space.advancing_front_in_space`.
    azimuth, elevation : float
        The direction from which all frames are seen, in degrees.

    Returns
    -------
    list of dict
        The caption has the candidates in the order in which they are tried, with the test that each one
        failed; they are crossed out in the picture. The star is a new point that is taken, the circle the
        sphere of the search about the barycenter of the face.
    """
    seen: dict[str, Any] = {"azimuth": azimuth, "elevation": elevation}
    have = [tuple(float(x) for x in p) for p in points]
    front = [tuple(int(v) for v in face) for face in first]
    start = np.array(have)
    cells: list[list[int]] = []
    frames = []
    for step in steps:
        frames.append(_tried(have, front, cells, step, seen))
        if step.chosen == len(have) and step.ideal is not None:
            have.append((float(step.ideal[0]), float(step.ideal[1]), float(step.ideal[2])))
        cells.append([*step.face, step.chosen])
        front = list(step.front)
    places = np.array(have)
    last = [bodies("accepted", cells, places, shrink=MADE_SHRINK, opacity=0.9), *front_items3(places, front)]
    if not front:
        last.append(item3("labels", "vertex", places, text=range(len(places))))
    ending = f"the front is stuck, with {len(front)} faces" if front else "the front is empty"
    frames.append(space_frame(last, ending, number=_so_far(cells, front), **seen))
    dots = space_frame([item3("points", "vertex", start)], **seen)
    frames[0]["view"] = fr.bounds([dots], WINDOW_MARGIN)
    return frames


def _so_far(cells: Sequence[Any], front: Sequence[Any]) -> str:
    """How many cells there are, and how many faces the front has."""
    return f"{len(cells)} cell{'s' * (len(cells) != 1)}, {len(front)} faces of the front"


def _tried(
    have: list[Any], front: list[Any], cells: list[list[int]], step: Choice, seen: dict[str, Any]
) -> fr.Frame:
    """One step."""
    places = np.array([*have, step.ideal if step.ideal is not None else have[0]], dtype=float)
    face, new = list(step.face), step.chosen == len(have)
    at = [len(have) if one.vertex is None else one.vertex for one in step.candidates if one.verdict]
    middle = places[face].mean(axis=0)
    walls, *lines = front_items3(places, front)
    items = [
        bodies("accepted", cells, places, shrink=MADE_SHRINK, opacity=0.2),  # faint: the one cell is seen
        walls | {"opacity": 0.12},
        *lines,
        bodies("highlight", [[*face, step.chosen]], places, shrink=1.0, opacity=0.8),
        item3("polygons", "inserted", [face], places, opacity=0.9),
        item3("points", "bad", places[at]),
    ]
    if step.radius > 0:
        items.append(item3("spheres", "circumcircle", [[*middle.tolist(), step.radius]]))
    if new:
        items.append(item3("points", "inserted", places[[len(have)]]))
    why = []
    for verdict, group in groupby(step.candidates, key=lambda one: one.verdict):
        names = ", ".join("X" if one.vertex is None else str(one.vertex) for one in group)
        taken = f"{names} is taken{IN_WORDS.get(step.reason, '')}"
        why.append(f"{names} {verdict}" if verdict else taken)
    caption = f"face {' '.join(map(str, face))}: {'; '.join(why)}"
    return space_frame(items, caption, number=_so_far(cells, front), **seen)
