"""Stuffing of random values: the bounds of the theorem, against the plain version."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers import value_tables
from tests.helpers.value_tables import KINDS, Table, assert_sound
from unstruct import InputError, check, isosurface_stuffing
from unstruct.generate.stuffing.filling import background_of, filled_background
from unstruct.generate.stuffing.laying import laid_in_level_set
from unstruct.generate.stuffing.sampling import LevelSet
from unstruct.plain import stuffing as plain
from unstruct.sizing.field import as_size


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 5), kind=st.sampled_from(KINDS))
def test_any_values_keep_the_bounds(seed: int, n: int, kind: str) -> None:
    table = Table(seed, n, kind)
    try:
        mesh = isosurface_stuffing(table, 1.0, tolerance=None)
    except InputError as error:  # nothing is inside, or all that is has moved onto the surface
        assert "thinner than a cell" in str(error)
        return
    least, most = value_tables.dihedral_range(mesh)
    assert 10.7 <= least
    assert most <= 164.8
    assert_sound(mesh)
    kinds = {problem.kind for problem in check(mesh).problems}
    assert kinds <= {"pinched vertex", "pinched edge", "vertex link"}
    assert (mesh.counts["pinched"] > 0) >= bool(kinds)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_as_the_plain_version(seed: int, kind: str) -> None:
    table = Table(seed, 4, kind)
    body = LevelSet(table, table.box)
    laid = laid_in_level_set(body, as_size(1.0), False, None, (10**6, False))
    background = background_of(laid.grid, laid.vertices, laid.sign)
    fast = filled_background(background, laid.shares)

    place = np.rint(2 * laid.vertices[0]).astype(int)
    rank = {tuple(row): i for i, row in enumerate(place.tolist())}
    around = [range(-2, 2 * 4 + 3)] * 3
    vertices = [(i, j, k) for i in around[0] for j in around[1] for k in around[2] if i % 2 == j % 2 == k % 2]
    inside = np.array([all(0 <= c <= 8 for c in v) for v in vertices])
    values = np.full(len(vertices), -1.0)
    values[inside] = table(np.array(vertices)[inside] / 2)
    value = dict(zip(vertices, values.tolist(), strict=True))
    cells, where = plain.stuff(value, (-1,) * 3, (5,) * 3, lambda v: rank.get(v, -1))

    expected = {frozenset(tuple(np.round(np.array(where[v]) / 2, 9) + 0.0) for v in cell) for cell in cells}
    found = {frozenset(tuple(row) for row in np.round(x, 9) + 0.0) for x in fast.points[fast.cells].tolist()}
    assert len(cells) == len(fast.cells)
    assert found == expected


def test_a_moved_vertex_takes_all_its_cut_points() -> None:
    table = Table(0, 2, "equal")
    table.corners[...] = -1.0
    table.centers[...] = -1.0
    table.centers[0, 0, 0] = 1.0
    mesh = isosurface_stuffing(table, 1.0, tolerance=None)
    assert mesh.counts["moved"] == 0
    assert mesh.counts["cut points"] == 14
    assert mesh.size == 24
    table.centers[0, 0, 0] = 1e-9  # so near that the vertex inside moves: nothing is left of the body
    with pytest.raises(InputError, match="thinner than a cell"):
        isosurface_stuffing(table, 1.0, tolerance=None)
