"""The advancing front as frames: the front edge, the triangle ahead, the ideal point, and what was chosen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.domain_mesh import DomainMesh
from ..draw import frames as fr

__all__ = ["front_frames", "front_length", "fronts_of"]

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
    cells = mesh.simplices.tolist()
    sides = [[(a, b), (b, c), (c, a)] for a, b, c in cells]
    inside = {side for three in sides for side in three}
    both = [(a, b) for a, b in mesh.segments.tolist()] + [(b, a) for a, b in mesh.segments.tolist()]
    front = dict.fromkeys(edge for edge in both if edge in inside)
    for three in sides:
        yield np.array(list(front), dtype=np.int64).reshape(-1, 2)
        for a, b in three:
            if (a, b) in front:
                del front[a, b]
            else:
                front[b, a] = None
    yield np.array(list(front), dtype=np.int64).reshape(-1, 2)


def front_length(mesh: DomainMesh) -> np.ndarray:
    """The number of edges of the front before each step, and after the last."""
    return np.array([len(front) for front in fronts_of(mesh)])


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
    return fr.frame(text, *items, number=f"{i} triangles, {len(front)} edges of the front")
