"""A tetrahedron with two crossed edges, and what measures of shape say of it."""

from __future__ import annotations

import numpy as np

from ...base.arguments import positive
from ...geometry import simplex
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["cell_shape_state"]


def cell_shape_state(height: float = 1.4, width: float = 1.0, seen_from: float = -60.0) -> fr.Frame:
    """The edge AB of length 2, and the edge CD at right angles above it, over the middle of AB.

    The cell is nearly regular for the height 1.4 and the width 1, a sliver for a small height, and a wedge
    with one short edge for a small width.

    Parameters
    ----------
    height : float
        Of CD above AB; positive.
    width : float
        Half the length of CD; positive.
    seen_from : float
        The direction from which the reader looks, in degrees.

    Returns
    -------
    dict
        The cell, with 3r/R, q = 6 sqrt(2) V / L^3 (L^2: the mean square of the edges), the smallest dihedral
        angle in degrees, and the circumradius divided by the shortest edge.

    Raises
    ------
    InputError
        If the cell would be flat: for a height or width that is not positive.
    """
    height, width = positive(height, "height"), positive(width, "width")
    corners = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -width, height], [0.0, width, height]])
    lengths = simplex.edge_lengths(corners)
    q = 6 * np.sqrt(2) * abs(simplex.volume(corners)) / np.mean(lengths**2) ** 1.5
    angle = np.degrees(simplex.dihedral_angles(corners).min())
    ratio = simplex.circumradius(corners) / lengths.min()
    scene = [
        item3("cells", "bad" if q < 0.3 else "accepted", [[0, 1, 2, 3]], corners, opacity=0.75),
        item3("points", "vertex", corners),
        item3("labels", "vertex", corners * [1.12, 1.12, 1.0] + [0.0, 0.0, 0.08], text="ABCD"),
    ]
    if q >= 0.3:
        said = "a round cell" if q >= 0.7 else "neither round nor thin"
    else:
        said = "a sliver: R/l does not see it" if ratio < 1 else "a thin cell: R/l is large"
    number = (
        f"3r/R {abs(simplex.quality('3r/R', corners)):.2f}, q {q:.2f}, angle {angle:.0f}°, R/l {ratio:.2f}"
    )
    return space_frame(scene, said, number=number, azimuth=seen_from, elevation=18)
