"""What layers leave of a body: its facets, and polygons cut anew along the sides of layers."""

from __future__ import annotations

import numpy as np

from unstruct import Domain
from unstruct.generate.prisms.growing import grown_layers
from unstruct.generate.prisms.remainder import border_edges, remainder, side_pieces
from unstruct.generate.prisms.walls import base_of


def grown_in_tube(share: float):
    tube = Domain.extruded(Domain.polygon([(-1, -1), (1, -1), (1, 1), (-1, 1)]), 2.0, size=1.0)
    ends = [int(tube.markers[name][0]) for name in ("bottom", "top")]
    walls = base_of(tube, np.setdiff1d(np.arange(len(tube.facets)), ends), "inside").walls
    n = len(walls.points)
    places = walls.points * (1.0 - np.array([0.0, share / 2, share])[:, None, None] * [1.0, 1.0, 0.0])
    return tube, ends, grown_layers(walls, np.arange(n), np.full(n, 2), places, walls.triangles)


def test_the_rest_of_a_square_tube() -> None:
    """Each end is the square within the layers: the volume is known."""
    tube, ends, grown = grown_in_tube(0.25)
    rest = remainder(tube, grown)
    assert rest.domain.volume == tube.volume * 0.75**2
    assert rest.piece[:2].tolist() == ends and (rest.piece[rest.cap] == -1).all()
    assert [rest.name(i, tube) for i in (0, 2)] == [tube.name(ends[0]), "a triangle of the cap"]
    assert len(rest.vertex) == len(np.unique(grown.cap))
    assert (rest.vertex >= len(tube.points)).all()  # all corners of the ends are tops of rays


def test_sides_are_in_the_planes_of_the_ends() -> None:
    tube, ends, grown = grown_in_tube(0.25)
    edges = border_edges(grown.base)
    tops = border_edges(grown.cap)
    quads = np.column_stack([edges, tops[:, ::-1]])
    found = side_pieces(tube, grown, quads, grown.piece)
    z = grown.points[edges[:, 0], 2]
    assert (found == np.where(z == 0.0, *ends)).all()
