"""From the triangles that a front has made, in the order in which they were made, to a `DomainMesh`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...connect.planar.extraction import named_sets
from ...domain.domain import Domain
from ...geometry.edge_vectors import local_edges
from ...geometry.ordering import radix_argsort
from ...mesh.domain_mesh import DomainMesh

__all__ = ["Made", "Subsegments", "domain_mesh_of", "neighbors_of", "quality_figures"]


@dataclass(frozen=True)
class Made:
    """What a front has made.

    Attributes
    ----------
    points : (n, 2) float64
        First the points of the sampled domain, then further ones.
    triangles : (m, 3) int32
        In the order in which they were made: the edge of the front, counterclockwise, then the apex.
    region : (m,) int32
        The number of the region of each.
    regions : dict of str to int
        The numbers of the regions that have a name.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    region: NDArray[np.int32]
    regions: dict[str, int]


@kernel
def _link(order, keys, neighbors):
    """Enter the neighbors: ``order`` sorts the sides by the keys of their two vertices."""
    for i in range(len(order) - 1):
        e, o = order[i], order[i + 1]
        if keys[e] == keys[o]:
            neighbors[e // 3, e % 3] = o // 3
            neighbors[o // 3, o % 3] = e // 3


@kernel
def _side_keys(triangles, n, keys):
    """The key of the side opposite each corner."""
    for t in range(len(triangles)):
        for k in range(3):
            u, v = np.int64(triangles[t, (k + 1) % 3]), np.int64(triangles[t, (k + 2) % 3])
            keys[3 * t + k] = min(u, v) * n + max(u, v)


def neighbors_of(triangles: NDArray[np.int32], n: int) -> NDArray[np.int32]:
    """The triangle opposite each corner, -1 for none, where no side belongs to three of them; O(m)."""
    keys = np.empty(3 * len(triangles), dtype=np.int64)
    _side_keys(triangles, n, keys)
    found = np.full(triangles.shape, -1, dtype=np.int32)
    if len(keys):
        _link(radix_argsort(keys.copy(), max(int(n) * int(n), 2).bit_length()), keys, found)
    return found


Subsegments = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]  # ends, piece, span


def domain_mesh_of(domain: Domain, subsegments: Subsegments, made: Made, **account: Any) -> DomainMesh:
    """The triangles as they were made, with the names of the domain.

    Parameters
    ----------
    domain : Domain
    subsegments : tuple of ndarray
        Ends, pieces and spans of its subsegments, none of which a vertex divides.
    made : Made
    **account
        ``unrefined``, ``reasons``, ``counts``, ``figures``, ``steps`` of the `DomainMesh`. Columns of
        ``steps`` named "edge", "apex", "vertex" and "near" contain vertices.

    Returns
    -------
    DomainMesh
        Its triangle i is the one that was made as number i. Vertices without triangles are left out.
    """
    n = len(made.points)
    used = np.zeros(n, dtype=bool)
    used[made.triangles.ravel()] = True
    place = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
    cells = place[made.triangles]
    origin = np.full(n, -1, dtype=np.int32)
    origin[: len(domain.points)] = np.arange(len(domain.points))
    ends, piece, span = subsegments
    inside = _sides_of(ends, made.triangles, n)
    ends, piece, span = place[ends[inside]], piece[inside].copy(), span[inside].copy()
    facets = len(domain.facets)
    named = named_sets(ends, piece, int((piece < facets).sum()), facets, domain.markers)
    named["region"] = made.region
    if account.get("steps") is not None:
        steps, named_place = dict(account["steps"]), np.append(place, -1)
        for column in ("edge", "apex", "vertex", "near"):
            if column in steps:
                steps[column] = named_place[steps[column]]
        account["steps"] = steps
    return DomainMesh.of_triangles(
        made.points[used], origin[used], (cells, neighbors_of(cells, max(int(used.sum()), 1))), named,
        (ends, piece, span), regions=made.regions, **account,
    )  # fmt: skip


def _sides_of(ends: NDArray[np.int32], triangles: NDArray[np.int32], n: int) -> NDArray[np.bool_]:
    """Which subsegments are sides of triangles."""
    keys = np.empty(3 * len(triangles), dtype=np.int64)
    _side_keys(triangles, n, keys)
    low, high = np.sort(ends, axis=1).T.astype(np.int64)
    return np.isin(low * n + high, keys)


def quality_figures(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> dict[str, float]:
    """Number of triangles, minimum angle in degrees, minimum and mean 2 r / R; NaN where there are none."""
    edges, _ = local_edges(points[triangles])  # each triangle by its own scale
    u, v = edges.transpose(1, 0, 2)
    p, q, r = (np.hypot(*side.T) for side in (u, v - u, v))
    with np.errstate(invalid="ignore", divide="ignore", under="ignore"):
        ratio = (q + r - p) * (r + p - q) * (p + q - r) / (p * q * r)
        twice = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        # The smallest angle is the one opposite the shortest side.
        short = np.minimum(p, np.minimum(q, r))
        sine = twice * short / (p * q * r)
    return {
        "triangles": float(len(triangles)),
        "minimum angle": float(
            np.degrees(np.arcsin(np.clip(np.nan_to_num(sine), 0.0, 0.75**0.5))).min(initial=90.0)
        ),
        "minimum 2r/R": float(np.nan_to_num(ratio).min(initial=1.0)),
        "mean 2r/R": float(np.nan_to_num(ratio).mean()) if len(ratio) else 0.0,
    }
