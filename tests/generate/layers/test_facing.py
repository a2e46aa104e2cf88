"""Edges that face each other, in kernels, beside the same with arrays."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.layers.facing import FACING, beside, mark_crowded, mark_long

GAP, ROOM = 0.56, 0.6


Place = np.ndarray


def nearest(a: Place, b: Place, c: Place, d: Place) -> tuple[float, float, float]:
    """The nearest places on segments ab and cd that do not cross, and their distance."""
    found = []
    for p, first, last, own, at in (
        (c, a, b, 0, 0.0),
        (d, a, b, 0, 1.0),
        (a, c, d, 1, 0.0),
        (b, c, d, 1, 1.0),
    ):
        t = float(np.clip((p - first) @ (last - first) / ((last - first) @ (last - first)), 0, 1))
        away = float(np.hypot(*(p - first - t * (last - first))))
        found.append((away, (t, at) if own == 0 else (at, t)))
    away, (t, s) = min(found, key=lambda one: one[0])
    return t, s, away


def left(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.array([a[1] - b[1], b[0] - a[0]])


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_long_and_crowded_edges(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = rng.integers(0, 6, (10, 2)) + rng.choice([0.0, 0.01]) * rng.random((10, 2))
    x = np.unique(x, axis=0)
    edges = np.array([(i, i + 1) for i in range(len(x) - 1)], dtype=np.int64)
    edges = edges[rng.permutation(len(edges))]
    corners = edges.astype(np.int32)
    sides = int(rng.integers(1, len(edges) + 1))
    i, j = (k.ravel() for k in np.meshgrid(np.arange(sides), np.arange(len(edges)), indexing="ij"))
    length = np.hypot(*(x[edges[:, 1]] - x[edges[:, 0]]).T)
    long, crowded = np.zeros(sides, dtype=bool), np.zeros(len(edges), dtype=bool)
    mark_long(x, edges, corners, (i, j), length, GAP, long)
    mark_crowded(x, edges, (i, j), length, ROOM, sides, crowded)
    want_long, want_crowded = np.zeros(sides, dtype=bool), np.zeros(len(edges), dtype=bool)
    for p, q in zip(i.tolist(), j.tolist()):
        if set(edges[p]) & set(edges[q]):
            continue
        (a, b), (c, d) = x[edges[p]], x[edges[q]]
        t, s, away = nearest(a, b, c, d)
        u = c + s * (d - c) - (a + t * (b - a))
        if u @ left(a, b) > 0 and (q >= sides or u @ left(c, d) < 0) and length[p] > GAP * away:
            want_long[p] = True
        u = (c + d) / 2 - (a + b) / 2
        far = FACING * np.hypot(*u)
        faces = u @ left(a, b) > far * length[p] and (q >= sides or u @ left(c, d) < -far * length[q])
        if faces and away < ROOM * length[p]:
            want_crowded[[p, q]] = True
    assert (long == want_long).all() and (crowded == want_crowded).all()


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.sampled_from([0.1, 0.6, 2.0]))
def test_no_near_edge_is_missed(seed: int, many: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    x = rng.random((30, 2))
    edges = rng.integers(0, 30, (60, 2))
    pairs, length = beside(x, edges, many, factor)
    found = set(zip(*(array.tolist() for array in pairs)))
    assert np.allclose(length, np.linalg.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1), rtol=1e-15)
    for i in range(many):
        box = np.sort(x[edges[i]], axis=0) + np.array([[-1.0], [1.0]]) * factor * length[i]
        for j in range(len(edges)):
            other = np.sort(x[edges[j]], axis=0)
            assert ((i, j) in found) == bool((other[0] <= box[1]).all() and (other[1] >= box[0]).all())
