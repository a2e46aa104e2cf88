"""How far the feature edges of a finished mesh are from the given ones."""

from __future__ import annotations

from ...connect.surface.complex import Taken
from ...geometry.edge_vectors import lengths
from ...geometry.support import Support
from ...geometry.triangle_tree import TriangleTree

__all__ = ["curve_deviation"]

ALONG_EDGES = (0.0, 0.25, 0.5, 0.75)  # where edges are sampled


def curve_deviation(support: Support, taken: Taken) -> float:
    """The largest distance, at samples and both ways, between the feature edges of a mesh and the given ones.

    Each curve is compared with itself. In the coordinates of the surface.
    """
    if not len(taken.edges):
        return 0.0
    worst = 0.0
    ends = taken.points[taken.edges] / support.factor
    for t in ALONG_EDGES:
        x = (1.0 - t) * ends[:, 0] + t * ends[:, 1]
        away = lengths(x - support.onto_chain(x, taken.curves)[2])
        worst = max(worst, float(away.max()))
    tree = TriangleTree(ends[:, [0, 1, 1]])
    own = support.points[support.features]
    for t in ALONG_EDGES:
        x = (1.0 - t) * own[:, 0] + t * own[:, 1]
        which, weights = tree.nearest(x)
        near = (ends[which][:, [0, 1, 1]] * weights[:, :, None]).sum(axis=1)
        worst = max(worst, float(lengths(x - near).max()))
    return worst
