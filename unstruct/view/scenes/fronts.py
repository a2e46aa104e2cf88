"""The advancing front as frames: the front edge, the triangle ahead, the ideal point, and what was chosen."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.domain_mesh import DomainMesh
from ...plain.advancing_front import Step
from ...plain.front_delaunay import Cell
from ..draw import frames as fr

__all__ = ["candidate_frames", "empty_circle_frames", "front_frames", "front_length", "fronts_of"]

WHY = {
    "new point": "the ideal point is far enough from all others: it is inserted",
    "small enough": "the triangle ahead is small enough",
    "empty circle": "the ideal point is not in the circle of the triangle ahead: its apex is taken",
    "near apex": "the ideal point is too near to the apex of the triangle ahead: the apex is taken",
    "angle": "the angle is small: the front is closed there",
    "closed": "two edges or more are at the front: this gap is closed at once",
    "forced": "no point was possible: the triangle ahead is taken as it is",
}


def fronts_of(mesh: DomainMesh) -> Iterator[np.ndarray]:
    """The front before each step of a raw mesh, and after the last: directed edges (k, 2).

    What is not meshed is on the left of each edge. The front changes by the symmetric difference with the
    sides of the new triangle.

    Parameters
    ----------
    mesh : DomainMesh
        A result of `unstruct.advancing_front` with ``finish=False``.
    """
    for front in _replay(mesh):
        yield np.array(list(front), dtype=np.int64).reshape(-1, 2)


def _replay(mesh: DomainMesh) -> Iterator[dict[tuple[int, int], None]]:
    """The front before each step and after the last, as one dictionary that changes."""
    sides = [[(a, b), (b, c), (c, a)] for a, b, c in mesh.simplices.tolist()]
    inside = {side for three in sides for side in three}
    both = [(a, b) for a, b in mesh.segments.tolist()] + [(b, a) for a, b in mesh.segments.tolist()]
    front = dict.fromkeys(edge for edge in both if edge in inside)
    for three in sides:
        yield front
        for a, b in three:
            if (a, b) in front:
                del front[a, b]
            else:
                front[b, a] = None
    yield front


def front_length(mesh: DomainMesh) -> np.ndarray:
    """The number of edges of the front before each step, and after the last."""
    return np.array([len(front) for front in _replay(mesh)])


def front_frames(
    mesh: DomainMesh, steps: Sequence[int] | None = None, *, names: bool = True
) -> list[fr.Frame]:
    """A frame for each step of an advancing front, and one of the finished mesh.

    Parameters
    ----------
    mesh : DomainMesh
        A result of `unstruct.advancing_front` with ``finish=False, history=True``.
    steps : sequence of int, optional
        The steps to show; all by default.
    names : bool
        Whether vertices have their numbers.

    Returns
    -------
    list of dict

    Raises
    ------
    InputError
        If the mesh has no record of its steps.
    """
    record = mesh.steps
    if record is None or "apex" not in record or not _in_order(mesh, record):
        raise InputError("front_frames needs advancing_front(..., finish=False, history=True)")
    wanted = set(range(mesh.size)) if steps is None else {range(mesh.size)[i] for i in steps}
    frames = []
    for i, front in enumerate(fronts_of(mesh)):
        if i in wanted:
            frames.append(_step(mesh, record, i, front, names))
    whole = [fr.polygons("accepted", mesh.points[mesh.simplices]), *_vertices(mesh, mesh.size, names)]
    frames.append(fr.frame("the front is empty", *whole, number=f"{mesh.size} triangles"))
    frames[0]["view"] = fr.bounds([frames[-1]], 0.06)
    return frames


def _so_far(made: int, left: int) -> str:
    """How many triangles there are, and how long the front is."""
    return f"{made} triangle{'s' * (made != 1)}, {left} edges of the front"


def _in_order(mesh: DomainMesh, record: dict[str, Any]) -> bool:
    """Whether the cells of a mesh are those of its record, in the same order."""
    made = np.column_stack([record["edge"], record["apex"]])
    same = made.shape == mesh.simplices.shape
    return same and bool((np.sort(made, axis=1) == np.sort(mesh.simplices, axis=1)).all())


def _vertices(mesh: DomainMesh, count: int, names: bool) -> list[fr.Item]:
    """The vertices of the boundary and of the first ``count`` cells."""
    used = np.unique(np.concatenate([mesh.segments.ravel(), mesh.simplices[:count].ravel()]))
    items = [fr.dots("vertex", mesh.points[used])]
    return [*items, fr.labels("vertex", mesh.points[used], used)] if names else items


def _step(mesh: DomainMesh, record: dict[str, Any], i: int, front: np.ndarray, names: bool) -> fr.Frame:
    """One step: what was there, the edge, the triangle ahead or the new one, and the reason."""
    x, reason = mesh.points, str(record["reason"][i])
    edge, apex, ideal = record["edge"][i], int(record["apex"][i]), record["ideal"][i]
    made = x[[*edge, apex]]
    items = [
        fr.polygons("accepted", x[mesh.simplices[:i]]),
        fr.segments("front", x[front]),
        fr.polygons("highlight", [made]),
    ]
    if reason != "new point":
        items.append(fr.circles("circumcircle", [circumcenter(made)], [circumradius(made)]))
    items += [fr.segments("inserted", [x[edge]]), *_vertices(mesh, i, names)]
    if np.isfinite(ideal).all():
        items.append(fr.dots("inserted" if reason == "new point" else "bad", [ideal]))
    text = f"edge {edge[0]} {edge[1]}: {WHY[reason]}"
    return fr.frame(text, *items, number=_so_far(i, len(front)))


# --- the classical front, from its plain version ----------------------------------------------------


def candidate_frames(points: Any, first: Iterable[Sequence[int]], steps: Iterable[Step]) -> list[fr.Frame]:
    """A frame for each step of the plain classical front: the circle, the candidates, and their verdicts.

    Parameters
    ----------
    points : (n, 2) array_like
        The vertices before the first step.
    first : pairs of int
        The edges of the front before the first step.
    steps : iterable of Step
        From `unstruct.plain.advancing_front.advancing_front`.

    Returns
    -------
    list of dict
        The caption has the candidates in the order in which they are tried, with the test that each one
        failed; they are crossed out in the picture. The star is a new point that is taken.
    """
    have = [tuple(map(float, p)) for p in points]
    front = [tuple(map(int, edge)) for edge in first]
    cells: list[list[int]] = []
    frames = []
    for step in steps:
        frames.append(_tried(have, front, cells, step))
        if step.chosen == len(have):
            have.append((float(step.ideal[0]), float(step.ideal[1])))
        cells.append([*step.edge, step.chosen])
        front = list(step.front)
    last = [fr.polygons("accepted", [[have[v] for v in cell] for cell in cells]), *fr.numbered(have)]
    frames.append(fr.frame("the front is empty", *last, number=f"{len(cells)} triangles"))
    frames[0]["view"] = fr.bounds([frames[-1]], 0.06)
    return frames


def _tried(have: list[Any], front: list[Any], cells: list[list[int]], step: Step) -> fr.Frame:
    """One step of the classical front."""
    x = np.array(have)
    middle = x[list(step.edge)].mean(axis=0)
    places = [step.ideal if one.vertex is None else have[one.vertex] for one in step.candidates]
    failed = [place for place, one in zip(places, step.candidates) if one.verdict]
    taken = step.ideal if step.chosen == len(have) else have[step.chosen]
    items = [
        fr.polygons("accepted", [x[cell] for cell in cells]),
        fr.segments("front", [x[list(edge)] for edge in front]),
        fr.polygons("highlight", [[*x[list(step.edge)], taken]]),
        fr.circles("circumcircle", [middle], [step.radius]),
        fr.segments("inserted", [x[list(step.edge)]]),
        *fr.numbered(have),
        fr.dots("bad", failed),
    ]
    if step.chosen == len(have):
        items.append(fr.dots("inserted", [taken]))
    why, wide = [], _where_it_widens(step)
    for (later, verdict), group in groupby(
        enumerate(step.candidates), key=lambda one: (one[0] >= wide, one[1].verdict)
    ):
        some = list(group)
        names = ", ".join("X" if one.vertex is None else str(one.vertex) for _, one in some)
        widens = "in a wider search " if later and some[0][0] == wide else ""
        why.append(f"{widens}{names} {verdict or 'is taken'}")
    text = f"edge {step.edge[0]} {step.edge[1]}: {'; '.join(why)}"
    return fr.frame(text, *items, number=_so_far(len(cells), len(front)))


def _where_it_widens(step: Step) -> int:
    """The first candidate of the wider search: one that was tried before, or is outside of the circle."""
    seen: set[int | None] = set()
    for k, one in enumerate(step.candidates):
        if one.vertex in seen or (one.vertex is not None and one.distance > step.radius):
            return k
        seen.add(one.vertex)
    return len(step.candidates)


def empty_circle_frames(points: Any, first: Iterable[Sequence[int]], steps: Iterable[Cell]) -> list[fr.Frame]:
    """A frame for each step of the plain front by empty circles: the edge, its apex, the circle.

    Parameters
    ----------
    points : (n, 2) array_like
    first : pairs of int
        The edges of the front before the first step.
    steps : iterable of Cell
        From `unstruct.plain.front_delaunay.front_delaunay`.

    Returns
    -------
    list of dict
        Crosses are vertices in the circle that are hidden from the edge.
    """
    x = np.array([tuple(map(float, p)) for p in points])
    front = [tuple(map(int, edge)) for edge in first]
    cells: list[list[int]] = []
    frames = []
    for step in steps:
        made = [*step.edge, step.apex]
        items = [
            fr.polygons("accepted", [x[cell] for cell in cells]),
            fr.segments("front", [x[list(edge)] for edge in front]),
            fr.polygons("highlight", [x[made]]),
            fr.circles("circumcircle", [circumcenter(x[made])], [circumradius(x[made])]),
            fr.segments("inserted", [x[list(step.edge)]]),
            *fr.numbered(x),
            fr.dots("bad", x[list(step.hidden)]),
        ]
        text = f"edge {step.edge[0]} {step.edge[1]}: apex {step.apex}"
        text += f"; {', '.join(map(str, step.hidden))} hidden" if step.hidden else ""
        text += f"; {', '.join(map(str, step.cocircular))} on the circle, too" if step.cocircular else ""
        number = _so_far(len(cells), len(front))
        frames.append(fr.frame(text, *items, number=number))
        cells.append(made)
        front = list(step.front)
    last = [fr.polygons("accepted", [x[cell] for cell in cells]), *fr.numbered(x)]
    frames.append(fr.frame("the front is empty", *last, number=f"{len(cells)} triangles"))
    frames[0]["view"] = fr.bounds([frames[-1]], 0.06)
    return frames
