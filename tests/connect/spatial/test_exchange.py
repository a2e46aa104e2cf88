"""Cells are exchanged only for others whose faces fit; marks are kept, and nothing changes otherwise."""

from __future__ import annotations

import numpy as np

from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.exchange import exchange
from unstruct.predicates.batch import orient_rows

NO_FACES = np.empty((0, 4), dtype=np.int32)
NO_EVENT = np.array([0, -1, -1, -1, 0, -1], dtype=np.int32)


def _flippable(cells: SpatialComplex) -> tuple[list[int], np.ndarray, int]:
    """Two cells, the three that may take their place, and the face between the two."""
    for face in range(4 * cells.slots):
        over, t, k = int(cells.across[face]), face >> 2, face & 3
        if over < 0:
            continue
        own = cells.vertex[4 * t : 4 * t + 4].tolist()
        new = []
        for j in {0, 1, 2, 3} - {k}:
            row = own.copy()
            row[j] = int(cells.vertex[over])
            new.append(row)
        tets = np.array(new, dtype=np.int32)
        if (orient_rows(cells.xyz[: cells.size], tets) > 0).all():
            return [t, over >> 2], tets, face
    raise AssertionError("no two cells can be exchanged")


def _state(cells: SpatialComplex) -> list[np.ndarray]:
    return [
        np.array(a) for a in (cells.vertex, cells.across, cells.mark, cells.at, cells.free, cells.state[:2])
    ]


def test_two_cells_for_three_and_back() -> None:
    cells = SpatialComplex(np.random.default_rng(5).random((60, 3)))
    old, tets, face = _flippable(cells)
    before, count = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[old].copy(), len(cells.cells())
    around = np.setdiff1d(np.arange(4 * old[0], 4 * old[0] + 4), face)
    cells.mark[around[0]] = cells.mark[cells.across[around[0]]] = 7
    cells.reserve(cells.size, cells.slots + 8)
    assert exchange(cells.solid(), np.array(old, dtype=np.int32), tets, NO_FACES, NO_EVENT)
    cells.validate()
    assert len(cells.cells()) == count + 1 and (cells.mark[: 4 * cells.slots] == 7).sum() == 2
    rows = cells.vertex[: 4 * cells.slots].reshape(-1, 4)
    made = [t for t in range(cells.slots) if rows[t].tolist() in tets.tolist()]
    assert exchange(cells.solid(), np.array(made, dtype=np.int32), before, NO_FACES, NO_EVENT)
    cells.validate()
    assert len(cells.cells()) == count and (cells.mark[: 4 * cells.slots] == 7).sum() == 2


def test_what_does_not_fit_changes_nothing() -> None:
    cells = SpatialComplex(np.random.default_rng(6).random((60, 3)))
    old, tets, face = _flippable(cells)
    cells.reserve(cells.size, cells.slots + 8)
    rows, before = np.array(old, dtype=np.int32), _state(cells)
    for wrong in (tets[:2], np.concatenate([tets, tets[:1]]), tets[:0]):
        assert not exchange(cells.solid(), rows, wrong, NO_FACES, NO_EVENT)
    cells.mark[face] = cells.mark[cells.across[face]] = before[2][face] = before[2][cells.across[face]] = 3
    assert not exchange(cells.solid(), rows, tets, NO_FACES, NO_EVENT)  # the marked face would be lost
    assert all(np.array_equal(a, b) for a, b in zip(before, _state(cells), strict=True))
