"""Which goals are edges and faces of a complex: one pass over all cells, beside sets."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import solids
from recovered import judge

from unstruct.connect.spatial import complex as spatial
from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.held import holds, new_held
from unstruct.connect.spatial.lookup import all_faces, edges_there, look_up
from unstruct.connect.spatial.refill import EDGE, FACE


def parts(c: SpatialComplex, size: int) -> set[frozenset]:
    """The edges or faces of all cells."""
    return {frozenset(part) for cell in c.cells().tolist() for part in combinations(cell, size)}


def goals_of(c: SpatialComplex, size: int, seed: int) -> np.ndarray:
    """Some rows of vertices that are parts of cells, and some that are not, in any order."""
    rng = np.random.default_rng(seed)
    there = [sorted(part) for part in parts(c, size) if max(part) < c.given]
    chosen = [there[i] for i in rng.choice(len(there), len(there) // 2, replace=False)]
    others = [rng.choice(c.given, size, replace=False).tolist() for _ in range(200)]
    rows = [rng.permutation(row).tolist() for row in {tuple(sorted(row)) for row in chosen + others}]
    return np.array(rows, dtype=np.int32)


@pytest.mark.parametrize("seed", range(3))
def test_faces_beside_sets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = SpatialComplex(rng.integers(0, 5, (60, 3))[rng.permutation(60)] + 1e-3 * rng.random((60, 3)))
    rows, faces = goals_of(c, 3, seed), parts(c, 3)
    wanted = [frozenset(row) in faces for row in rows.tolist()]
    assert 0 < sum(wanted) < len(rows)
    assert not all_faces(c.solid(), rows) and (c.mark < 0).all()
    goals = np.column_stack([rows, 7 + np.arange(len(rows))]).astype(np.int32)
    assert look_up(c.solid(), new_held(1), FACE, goals).tolist() == wanted
    c.validate()  # marks on both sides
    marked = {
        (frozenset(np.delete(cell, k).tolist()), int(c.mark[4 * t + k]))
        for t, cell in enumerate(c.vertex.reshape(-1, 4))
        for k in range(4)
        if c.mark[4 * t + k] >= 0
    }
    assert marked == {(frozenset(row), 7 + i) for i, row in enumerate(rows.tolist()) if wanted[i]}
    c.mark[:] = -1
    assert all_faces(c.solid(), np.ascontiguousarray(rows[wanted]))
    assert sorted({*c.mark.tolist()}) == list(range(-1, sum(wanted)))
    assert all_faces(c.solid(), rows[:0])


@pytest.mark.parametrize("seed", range(3))
def test_edges_beside_sets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = SpatialComplex(rng.random((60, 3)))
    rows, edges = goals_of(c, 2, seed), parts(c, 2)
    wanted = [frozenset(row) in edges for row in rows.tolist()]
    assert 0 < sum(wanted) < len(rows)
    assert edges_there(c.solid(), rows).tolist() == wanted
    held = new_held(len(rows))
    goals = np.column_stack([rows, np.zeros_like(rows)])
    assert look_up(c.solid(), held, EDGE, goals).tolist() == wanted
    assert [bool(holds(held, u, v)) for u, v in rows.tolist()] == wanted


def test_where_all_is_there_nothing_is_recovered(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("recovery was begun")

    points, triangles = solids.torus(40, 16)
    rng = np.random.default_rng(0)
    c = SpatialComplex(rng.random((50, 3)))
    faces = np.array([sorted(f) for f in parts(c, 3) if max(f) < c.given][:40], dtype=np.int32)
    edges = np.array([sorted(e) for e in parts(c, 2) if max(e) < c.given], dtype=np.int32)
    with monkeypatch.context() as patched:
        patched.setattr(spatial, "Recovery", never)
        found = c.recover(faces, edges)
        assert found.exact and found.crossings.sum() == 0
        judge(c, faces, found)
        with pytest.raises(AssertionError, match="begun"):
            SpatialComplex(points).recover(triangles)
        known = {*map(frozenset, edges.tolist())}
        lost = np.array([e for e in combinations(range(50), 2) if frozenset(e) not in known][:1])
        with pytest.raises(AssertionError, match="begun"):  # all triangles are there, but a segment is not
            c.recover(faces, lost)
