"""Cells of columns: all cases of rays that rise or have stopped, and that neighbors fit."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct import Mesh, check
from unstruct.generate.prisms.cells import cells_of
from unstruct.mesh.cells import incident_facets

TWO = np.array([(0, 1, 2), (1, 0, 3)], dtype=np.int32)  # two columns over a common edge
PLACES = np.array([(0.0, 0.0), (0.0, 1.0), (-1.0, 0.5), (1.0, 0.5)])


def numbers(levels: tuple[int, ...], most: int) -> np.ndarray:
    return (np.minimum(np.arange(most + 1)[:, None], levels) * len(levels) + np.arange(len(levels))).astype(
        np.int32
    )


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("rises", list(product((0, 1), repeat=3)))
def test_every_case_of_one_column(rises: tuple[int, ...], turn: int) -> None:
    column = np.roll([0, 1, 2], turn)[None].astype(np.int32)
    found = cells_of(column, numbers(rises, 1))
    points = np.column_stack([np.tile(PLACES[:3], (2, 1)), np.repeat([0.0, 1.0], 3)])
    kind = {0: "", 1: "tetra", 2: "pyramid", 3: "wedge"}[sum(rises)]
    assert list(found.kinds) == [kind] * bool(kind) and (found.layer == 0).all() and (found.column == 0).all()
    if kind:
        assert (Mesh(points, None, cells=found.kinds).jacobian_signs() == 1).all()
        # Its faces: the base, the cap, and over each edge a quadrilateral, a triangle or none.
        rows, _, _ = incident_facets({kind: found.kinds[kind]})
        found = {frozenset(row[row >= 0].tolist()) for row in rows}
        wanted = {frozenset(column[0].tolist()), frozenset(numbers(rises, 1)[-1][column[0]].tolist())}
        for i, j in ((0, 1), (1, 2), (2, 0)):
            side = {i, j, 3 * rises[i] + i, 3 * rises[j] + j}
            wanted |= {frozenset(side)} if len(side) > 2 else set()
        assert found == wanted


def test_every_pair_of_columns_fits() -> None:
    """All levels 0 to 3 of two columns: the mesh is closed between base, cap and sides, and positive."""
    for levels in product(range(4), repeat=4):
        number = numbers(levels, 3)
        cells = cells_of(TWO, number).kinds
        if not cells:
            continue
        every = np.concatenate([rows.ravel() for rows in cells.values()])
        points = np.column_stack([np.tile(PLACES, (4, 1)), np.repeat(np.arange(4.0), 4)])
        used = np.unique(every)
        place = np.full(len(points), -1)
        place[used] = np.arange(len(used))
        mesh = Mesh(points[used], None, cells={kind: place[rows] for kind, rows in cells.items()})
        # Where one column has no cells at the common edge, or only an edge in common, there may be pinches.
        problems = {p.kind for p in check(mesh).problems}
        assert not problems - {"pinched edge", "pinched vertex", "link"}, levels
        if max(levels) - min(levels) <= 1 and min(levels) > 0:
            assert not problems, levels
        rows, _, group = incident_facets(mesh.cells)
        once = np.bincount(group)[group] == 1
        boundary = {frozenset(used[row[row >= 0]].tolist()) for row in rows[once]}
        between = [s for s in boundary if s <= {v for k in range(4) for v in (4 * k, 4 * k + 1)}]
        assert not between, levels  # nothing is open over the common edge
        quads = [s for s in boundary if len(s) == 4]
        assert all(len({v % 4 for v in s}) == 2 for s in quads)  # quadrilaterals only at outer sides
        for column, three in enumerate(number[-1][TWO].tolist()):
            bare = [v // 4 == 0 for v in three]
            assert all(bare) or frozenset(three) in boundary, (levels, column)
