"""Circumcenter insertion, step by step, with and without a boundary; the frames show R, l and mu.

The first points of a run determine the state, so every frame is computed from points alone. See chapter 2.6a.
"""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import Any

import numpy as np

from ...base.errors import IncompleteWarning
from ...connect.insertion.delaunay import delaunay
from ...generate.centers.circumcenters import circumcenter_insertion
from ...generate.centers.periodic import periodic_delaunay
from ...generate.centers.torus import periodic_circumcenters
from ...geometry.simplex import circumcenter, circumradius, edge_lengths, quality
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["CENTERS", "circumcenter_history", "circumcenter_state"]

TRIANGLE = [[0.0, 2.0], [3.0, 3.0], [1.0, 0.0]]
CENTERS: dict[str, dict[str, Any]] = {
    "no boundary (opposite sides glued)": {
        "torus": True,
        "points": [
            [0.03, 0.12], [0.06, 0.45], [0.12, 0.68], [0.18, 0.96],
            [0.27, 0.07], [0.3, 0.42], [0.38, 0.54], [0.45, 0.86],
            [0.63, 0.08], [0.64, 0.43], [0.61, 0.56], [0.63, 0.96],
            [0.95, 0.2], [0.78, 0.35], [0.76, 0.53], [0.82, 0.89],
        ],
        "steps": 13,
    },
    "nasty: a triangle, its edges kept": {"points": TRIANGLE, "steps": 6, "split": False},
    "the same triangle, its edges split": {"points": TRIANGLE, "steps": 12, "split": True},
    "a square, its edges kept": {
        "points": [[0, 0], [3, 0], [6, 0], [6, 3], [6, 6], [3, 6], [0, 6], [0, 3], [1, 1], [4.5, 2], [2, 4]],
        "steps": 12,
        "split": False,
    },
}  # fmt: skip


@lru_cache(maxsize=8)
def _run(preset: str) -> tuple[np.ndarray, int]:
    """All points of the run, and how many of them are given at the start."""
    given = preset_named(CENTERS, preset)
    points = np.array(given["points"], dtype=float)
    if "torus" in given:
        return np.array(periodic_circumcenters(points, budget=given["steps"]).points), len(points)
    with warnings.catch_warnings():  # the run is stopped early on purpose
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = circumcenter_insertion(points, budget=given["steps"], split_boundary=given["split"])
    return np.array(mesh.points), len(points)


def circumcenter_history(preset: str = next(iter(CENTERS))) -> list[fr.Frame]:
    """All frames of one of the runs in `CENTERS`: each state, its maximal triangle, and the next point."""
    points, first = _run(preset)
    return [circumcenter_state(k, preset) for k in range(len(points) - first + 1)]


def circumcenter_state(step: int, preset: str = next(iter(CENTERS))) -> fr.Frame:
    """The triangulation after some insertions, its maximal triangle, and the place of the next point.

    Parameters
    ----------
    step : int
        How many points have been inserted.
    preset : str
        A key of `CENTERS`.

    Returns
    -------
    dict
        A frame; its number shows the largest circumradius R, the shortest edge l and the largest R / r.
    """
    points, first = _run(preset)
    within("step", step, 0, len(points) - first)
    torus = "torus" in CENTERS[preset]
    corners, walls = _state(points[: first + step], torus)
    before = circumradius(_state(points[: first + step - 1], torus)[0]).max() if step else np.inf
    radii, centers = circumradius(corners), circumcenter(corners)
    worst = int(radii.argmax())
    items = [fr.polygons("cell", _copies(corners) if torus else corners)]
    items.append(fr.polygons("highlight", [corners[worst]]))
    items.append(fr.circles("circumcircle", [centers[worst]], [radii[worst]]))
    items.append(fr.segments("layer" if torus else "constrained", walls))
    items.append(
        fr.dots(
            "vertex", np.unique(_copies(corners).reshape(-1, 2), axis=0) if torus else points[: first + step]
        )
    )
    if first + step < len(points):
        place = points[first + step]
        if torus:  # show the copy that belongs to the highlighted triangle
            place = centers[worst]
        items.append(fr.dots("inserted", place))
    low, high = points.min(axis=0), points.max(axis=0)
    pad = 0.04 * float((high - low).max())
    view = [-0.1, 1.1, -0.1, 1.1] if torus else [low[0] - pad, high[0] + pad, low[1] - pad, high[1] + pad]
    shortest, mu = edge_lengths(corners).min(), quality("radius_ratio", corners).max()
    number = f"R = {radii[worst]:.3g}, l = {shortest:.3g}, μ = {mu:.3g}"
    split = CENTERS[preset].get("split", False)
    caption = _caption(points, first + step, centers[worst], radii[worst] / before, torus, split)
    return fr.frame(caption, *items, number=number, view=view)


def _caption(points: np.ndarray, n: int, center: np.ndarray, growth: float, torus: bool, split: bool) -> str:
    """A caption: whether R has risen, and whether the next point is the center of the maximal triangle."""
    risen = "R has risen! " if growth > 1 + 1e-9 else ""
    if n == len(points):
        return risen + "And so on"
    if torus or np.allclose(points[n], center):
        return risen + "Next: the center of the largest circle"
    if split:
        return risen + "Next: its center is too near an edge, so halve that edge"
    return risen + "Its center is outside; next: the center of another triangle"


def _state(points: np.ndarray, torus: bool) -> tuple[np.ndarray, np.ndarray]:
    """Corners of all triangles, and the boundary; for the torus, the square whose sides are glued."""
    if torus:
        ring = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
        return periodic_delaunay(points).corners, np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    mesh = delaunay(points)
    return mesh.corners, mesh.points[mesh.boundary]


def _copies(corners: np.ndarray) -> np.ndarray:
    """All copies of the triangles of the torus that are visible in the picture."""
    moves = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], dtype=float)
    every = (corners[None] + moves[:, None, None]).reshape(-1, 3, 2)
    return every[((every.max(axis=1) > -0.1) & (every.min(axis=1) < 1.1)).all(axis=1)]
