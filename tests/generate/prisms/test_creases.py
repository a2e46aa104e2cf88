"""Which edges are sharp convex creases, and how rays stand along them."""

from __future__ import annotations

import numpy as np

from unstruct import Domain, Mesh, examples
from unstruct.generate.prisms.creases import chains_of, creases_of, fans_of, no_fans, usable
from unstruct.generate.prisms.records import Walls
from unstruct.generate.prisms.stars import Stars, stars_of
from unstruct.generate.prisms.walls import base_of


def walls_of(surface: Domain | Mesh, side: str = "outside") -> tuple[Walls, Stars]:
    walls = base_of(surface, None, side).walls
    return walls, stars_of(walls.triangles, len(walls.points))


def lens(count: int, thickness: float) -> Mesh:
    """Two cones on one circle: a closed crease without corners."""
    angle = 2 * np.pi * np.arange(count) / count
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([rim, [[0, 0, thickness], [0, 0, -thickness]]])
    k = np.arange(count)
    over = np.column_stack([k, (k + 1) % count, np.full(count, count)])
    under = np.column_stack([(k + 1) % count, k, np.full(count, count + 1)])
    return Mesh(points, np.concatenate([over, under]))


def test_a_closed_crease_has_one_strip() -> None:
    walls, stars = walls_of(lens(12, 0.1))
    creases = creases_of(walls, stars)
    assert len(creases.ends) == 12 and creases.steps.tolist() == [4] * 12
    kept, crease = usable(walls, stars, creases, np.ones(12, dtype=bool))
    assert kept.all() and len(np.unique(crease)) == len(np.unique(chains_of(creases))) == 1
    fans = fans_of(walls, stars, creases, kept, crease)
    assert fans.sheets == 14 + 12 and len(fans.base) == 14 + 12 * 4 and len(fans.quads) == 48
    assert np.array_equal(fans.base[fans.columns], walls.triangles) and not len(fans.corners)
    assert np.array_equal(fans.base[fans.quads[:, 0]], fans.base[fans.quads[:, 1]])
    # All caps together are closed: every edge twice, once in each direction.
    every = np.concatenate([fans.columns, fans.caps])
    ends = np.concatenate([every[:, [0, 1]], every[:, [1, 2]], every[:, [2, 0]]])
    assert {tuple(e) for e in ends.tolist()} == {tuple(e) for e in ends[:, ::-1].tolist()}
    assert len(np.unique(ends, axis=0)) == len(ends)


def test_corners_of_a_cube_have_polygons() -> None:
    walls, stars = walls_of(Domain.box((0, 0, 0), (1, 1, 1)))
    creases = creases_of(walls, stars)
    kept, crease = usable(walls, stars, creases, np.ones(len(creases.ends), dtype=bool))
    fans = fans_of(walls, stars, creases, kept, crease)
    # 24 rays of sheets, 24 between two; four triangles at each corner.
    assert kept.sum() == 12 and fans.sheets == 24 and len(fans.base) == 24 + 24
    assert len(fans.quads) == 24 and len(fans.corners) == 32
    every = np.concatenate([fans.columns, fans.caps])
    ends = np.concatenate([every[:, [0, 1]], every[:, [1, 2]], every[:, [2, 0]]])
    assert {tuple(e) for e in ends.tolist()} == {tuple(e) for e in ends[:, ::-1].tolist()}


def test_concave_edges_are_none() -> None:
    walls, stars = walls_of(Domain.box((0, 0, 0), (1, 1, 1)), "inside")
    assert not len(creases_of(walls, stars).ends)
    fans = no_fans(walls)
    assert fans.columns is walls.triangles and not len(fans.caps)


def test_a_crease_that_ends_within_a_wall_is_left_out() -> None:
    """The leading edge of a coarse wing is a crease near its tips only, and the trailing edge all along."""
    walls, stars = walls_of(examples.wing(0.1))
    creases = creases_of(walls, stars)
    kept, crease = usable(walls, stars, creases, np.ones(len(creases.ends), dtype=bool))
    degree = np.bincount(creases.ends.ravel(), minlength=len(walls.points))
    assert 0 < kept.sum() < len(kept) and (degree == 1).any()
    assert (np.bincount(creases.ends[kept].ravel()) != 1).all()
    assert len(np.unique(crease[kept])) < len(np.unique(chains_of(creases)))


def test_a_crease_may_end_in_a_plane() -> None:
    """A tube of three sides, open at both ends: each crease of two edges has rims at both."""
    angle = 2 * np.pi * np.arange(3) / 3
    points = np.array([(np.cos(a), y, np.sin(a)) for y in (0.0, 1.0, 2.0) for a in angle])
    rows = []
    for j in range(2):
        for i in range(3):
            a, b = 3 * j + i, 3 * j + (i + 1) % 3
            rows += [(a, a + 3, b + 3), (a, b + 3, b)]
    walls, stars = walls_of(Mesh(points, np.array(rows)))
    creases = creases_of(walls, stars)
    kept, crease = usable(walls, stars, creases, np.ones(len(creases.ends), dtype=bool))
    assert kept.sum() == 6 and len(np.unique(crease)) == 3 and creases.steps.tolist() == [3] * 6
    fans = fans_of(walls, stars, creases, kept, crease)
    assert len(fans.rims) == 3 * 2 * 3 and len(fans.quads) == 6 * 3
    assert np.array_equal(fans.base[fans.rims[:, 0]], fans.base[fans.rims[:, 1]])
    ending = np.zeros(len(walls.points), dtype=bool)
    assert not usable(walls, stars, creases, kept, ending)[0].any()
