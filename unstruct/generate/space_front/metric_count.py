"""How many cells a metric asks for in a body, before any work begins.

The volume of the body in the metric, the integral of sqrt(det M), over that of a regular tetrahedron of edge
1, is the number of cells of an ideal mesh. It is known for the box of the table of the metric, leaf by leaf;
places that are spread evenly in the metric tell which share of it is in the body. Book: 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.errors import InputError
from ...domain.domain import Domain
from ...sizing.space_metric_table import SpaceMetricNodes, leaves_of, wanted_cells

__all__ = ["expected_cells", "refuse_too_many_cells"]

PLACES_SEEN = 1 << 15  # so many places tell how much of the box is in the body
FEWEST_WITHIN = 50  # of them in a body; a thinner one is judged by its surface
CELLS_OF_POINT = 6.0  # tetrahedra for each point of a large mesh, about
# The multiples of these numbers, without their integer parts, fill the unit cube evenly.
STEPS_IN_CUBE = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])


def expected_cells(domain: Domain, nodes: SpaceMetricNodes) -> float:
    """About how many tetrahedra have edges of length 1 in a metric and fill a body.

    Parameters
    ----------
    domain : Domain
        In space.
    nodes : SpaceMetricNodes
        The table of the metric over the box of the body, in its coordinates.

    Notes
    -----
    Exact where the metric is the same everywhere, else known to a few percent. O(1) places are asked for.
    """
    low, side = leaves_of(nodes)
    middle = low + side / 2
    if len(low) == 1:
        return float(domain.volume * wanted_cells(nodes, middle)[0])
    count = side.prod(axis=1) * wanted_cells(nodes, middle)
    upto = np.cumsum(count)
    number = np.arange(PLACES_SEEN)
    leaf = np.minimum(np.searchsorted(upto, (number + 0.5) / PLACES_SEEN * upto[-1]), len(low) - 1)
    x = low[leaf] + side[leaf] * np.mod(number[:, None] * STEPS_IN_CUBE, 1.0)
    within = int(domain.contains(x).sum())
    if within >= FEWEST_WITHIN:
        return float(upto[-1] * within / PLACES_SEEN)
    shell = domain.triangulated
    corners = shell.points[shell.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(domain.volume * np.average(
        wanted_cells(nodes, corners.mean(axis=1)), weights=np.sqrt(np.square(cross).sum(axis=1))
    ))  # fmt: skip


def refuse_too_many_cells(cells: float, most: int) -> None:
    """Raise an error if so many tetrahedra have more points than the budget allows.

    Raises
    ------
    InputError
        It names the count and the remedy.
    """
    points = cells / CELLS_OF_POINT
    if points > most:
        raise InputError(
            f"the metric asks for about {cells:.3g} tetrahedra, with {points:.3g} points, more than the "
            f"{most:,} of the budget: give larger lengths, or a larger budget"
        )
