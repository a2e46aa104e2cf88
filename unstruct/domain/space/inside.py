"""Inside and outside of a body, its volume, its bounding box, and the seeds of its regions; all exact."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from ...base.errors import InputError
from ...geometry.inside_shell import enclosed_volume, even_odd_in_space, front_inside
from ...geometry.outline import Outline
from ...geometry.triangle_pairs import points_on_edges, points_on_triangles
from .cutting import Shell
from .faults import first_copies

__all__ = [
    "bounds",
    "check_seeds",
    "check_seeds_off_pieces",
    "contains",
    "outward",
    "turned_facets",
    "volume",
]


def contains(outline: Outline, shell: Shell, rows: np.ndarray) -> np.ndarray:
    """Whether points (k, 3) lie inside, by the even-odd rule, or on a facet: see `Domain.contains`."""
    odd, on = even_odd_in_space(shell.points, shell.bounding, rows)
    return odd | on


def outward(shell: Shell) -> np.ndarray:
    """The triangles of facets, turned so that their normals point out of the body: (t, 3) int32."""
    rows = shell.bounding
    return np.where(front_inside(shell.points, rows)[:, None], rows[:, ::-1], rows)


def turned_facets(shell: Shell) -> np.ndarray:
    """The facets whose normals point into the body: (k,) int64."""
    piece = shell.piece[shell.piece < shell.facets]
    return np.unique(piece[front_inside(shell.points, shell.bounding)]).astype(np.int64)


def volume(outline: Outline, shell: Shell) -> float:
    """The volume inside, correctly rounded: see `Domain.volume`."""
    return enclosed_volume(shell.points, outward(shell))


def bounds(outline: Outline, shell: Shell) -> np.ndarray:
    """The corners of the bounding box of all points."""
    return np.stack([outline.points.min(axis=0), outline.points.max(axis=0)])


# ---------------------------------------------------------------------- seeds


def _stacked(outline: Outline) -> tuple[np.ndarray, list[str]]:
    """All seeds, and what each of them is called in messages."""
    names = [f"regions[{name!r}][{i}]" for name, seeds in outline.regions.items() for i in range(len(seeds))]
    return np.concatenate([np.empty((0, 3)), *outline.regions.values()]), names


def _refuse(name: str, seed: np.ndarray, where: str) -> NoReturn:
    raise InputError(f"{name} = {seed.tolist()} lies {where}; move it into a part of the body")


def check_seeds_off_pieces(outline: Outline, shell: Shell) -> None:
    """Raise if a seed of a region lies on a piece or a vertex."""
    seeds, names = _stacked(outline)
    n = len(outline.points)
    points = np.concatenate([outline.points, seeds])
    rows = np.arange(n, len(points))
    found: dict[int, str] = {}
    same = first_copies(points)[n:]
    for row in np.flatnonzero(same < n).tolist():
        found[row] = f"point {same[row]}"
    if len(shell.triangles):
        for v, t, _ in zip(*map(np.ndarray.tolist, points_on_triangles(points, rows, shell.triangles))):
            found.setdefault(v - n, outline.name(int(shell.piece[t])))
    if len(shell.segments):
        for v, s in zip(*map(np.ndarray.tolist, points_on_edges(points, rows, shell.segments))):
            found.setdefault(v - n, outline.name(int(shell.segment_piece[s])))
    if found:
        row = min(found)
        _refuse(names[row], seeds[row], f"on {found[row]}")


def check_seeds(outline: Outline, shell: Shell) -> None:
    """Raise if a seed of a region lies outside."""
    if not outline.regions or len(outline.facets) == 0:
        return
    seeds, names = _stacked(outline)
    outside = ~contains(outline, shell, seeds)
    if outside.any():
        row = int(np.argmax(outside))
        _refuse(names[row], seeds[row], "outside the body (even-odd)")
