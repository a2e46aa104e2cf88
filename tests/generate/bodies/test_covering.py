"""What is left of the edges of facets of which something covers a part."""

from __future__ import annotations

import numpy as np

from unstruct import Domain
from unstruct.generate.bodies.covering import Cover, covered
from unstruct.generate.bodies.dividing import divided_around
from unstruct.generate.bodies.patches import patches_of
from unstruct.sizing.field import as_size

BOX = Domain.box((0, 0, 0), (2, 1, 1))


def half_of_top() -> tuple[Cover, int]:
    """The half of the upper side with x < 1: its outline has two vertices on sides of the box."""
    x = BOX.points
    top = next(i for i in range(6) if (x[BOX.facets[i], 2] == 1).all())
    number = {tuple(row): k for k, row in enumerate(x.tolist())}
    a, b, c, d = (number[p] for p in ((0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (2.0, 0.0, 1.0), (2.0, 1.0, 1.0)))
    more = np.array([[1.0, 0.0, 1.0], [1.0, 1.0, 1.0]])
    edges = np.array([[a, 8], [8, 9], [9, b], [b, a]])
    side = np.sort(np.array([[a, c], [b, d]]), axis=1)
    kept = np.sort(edges, axis=1)
    return Cover(more, edges, np.full(4, top), side, np.array([8, 9]), kept), top


def test_sides_get_their_vertices() -> None:
    cover, top = half_of_top()
    patches, changed = covered(patches_of(BOX), cover)
    assert len(patches.sides) == 24 + 4  # two sides of two pieces each
    assert changed.sum() == 3
    pairs = {tuple(sorted(row)) for row in patches.sides[patches.piece[patches.patch] == top].tolist()}
    assert {tuple(row) for row in cover.kept.tolist()} - pairs == {(8, 9)}


def test_edges_of_both_cancel() -> None:
    cover, top = half_of_top()
    patches, _ = covered(patches_of(BOX), cover)
    rows, of, within = cover.taken_from(patches.sides, patches.patch, patches.within, patches)
    assert (np.diff(of) >= 0).all()
    assert not within.any()
    mine = rows[patches.piece[of] == top]
    assert len(mine) == 4
    assert (np.bincount(mine.ravel())[[8, 9]] == 2).all()


def test_the_rest_is_divided_and_ends_at_the_cover() -> None:
    cover, top = half_of_top()
    made = divided_around(BOX, as_size(0.3), False, cover)
    x = made.points[made.facets]
    area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1) / 2
    found = np.bincount(made.parent, area, minlength=6)
    assert np.isclose(found[top], 1.0)
    assert np.isclose(found.sum(), 10.0 - 1.0)
    assert (x[made.parent == top][..., 0] >= 1.0).all()
    ends = np.sort(made.facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, count = np.unique(ends, axis=0, return_counts=True)
    edges = np.unique(ends, axis=0)[count == 1]  # the surface is open along the cover, whose edges stay
    assert {tuple(row) for row in edges.tolist()} == {tuple(row) for row in cover.kept.tolist()}


def test_what_is_covered_as_a_whole_is_gone() -> None:
    top = half_of_top()[1]
    ring = np.asarray(BOX.facets[top]).astype(np.int64)
    edges = np.column_stack([ring, np.roll(ring, -1)])
    none = np.empty((0, 2), dtype=np.int64)
    cover = Cover(np.empty((0, 3)), edges, np.full(4, top), none, none[:, 0], np.sort(edges, axis=1))
    made = divided_around(BOX, as_size(5.0), False, cover)
    assert top not in made.parent
    assert len(np.unique(made.parent)) == 5
