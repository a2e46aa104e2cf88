"""The quick test of whether triangles are embedded, beside all meetings of edges and triangles; flat rows."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from unstruct.geometry import embedded as quick
from unstruct.geometry.embedded import embedded, flat_rows, meeting_pairs
from unstruct.geometry.triangle_pairs import clear_view, edges_of, meetings_in_space, unit_points

NUDGE = 2.0**-52


def slow(points: np.ndarray, triangles: np.ndarray) -> bool:
    """Whether no edge of a triangle meets a triangle outside of common vertices."""
    return len(meetings_in_space(points, triangles, edges_of(triangles)).edge) == 0


def slow_pairs(points: np.ndarray, triangles: np.ndarray) -> set[frozenset[int]]:
    """The pairs of triangles of which an edge of one meets the other."""
    edges = edges_of(triangles)
    met = meetings_in_space(points, triangles, edges)
    found = set()
    for e, t in zip(edges[met.edge].tolist(), met.triangle.tolist()):
        found |= {frozenset((s, t)) for s in np.flatnonzero(np.isin(triangles, e).sum(axis=1) == 2).tolist()}
    return found


def pairs_are_right(points: np.ndarray, triangles: np.ndarray) -> bool:
    pairs = meeting_pairs(points, triangles)
    once = {frozenset(pair) for pair in pairs.tolist()}
    return len(once) == len(pairs) and once == slow_pairs(points, triangles)


def ball(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A grid on a sphere, triangles outward."""
    i, j = np.meshgrid(np.arange(1, n), np.arange(2 * n), indexing="ij")
    a, b = np.pi * i.ravel() / n, np.pi * (j.ravel() + 0.5 * i.ravel()) / n
    points = np.column_stack([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)])
    at = np.arange(len(points)).reshape(n - 1, 2 * n)
    rows = []
    for i in range(n - 2):
        for j in range(2 * n):
            k = (j + 1) % (2 * n)
            rows += [(at[i, j], at[i + 1, j], at[i, k]), (at[i, k], at[i + 1, j], at[i + 1, k])]
    top, bottom = len(points), len(points) + 1
    rows += [(top, at[0, j], at[0, (j + 1) % (2 * n)]) for j in range(2 * n)]
    rows += [(bottom, at[-1, (j + 1) % (2 * n)], at[-1, j]) for j in range(2 * n)]
    return np.vstack([points, [[0, 0, 1], [0, 0, -1]]]), np.array(rows, dtype=np.int32)


def grid(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A cube with n x n squares a side, all cut along a diagonal."""
    number: dict[tuple, int] = {}
    rows = []
    for axis in range(3):
        for end in (0, n):
            for i, j in np.ndindex(n, n):
                square = []
                for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    x = [0, 0, 0]
                    x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3] = end, i + u, j + v
                    square.append(number.setdefault(tuple(x), len(number)))
                a, b, c, d = square if end else square[::-1]
                rows += [(a, b, c), (a, c, d)]
    return np.array(list(number), dtype=float), np.array(rows, dtype=np.int32)


@st.composite
def few(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """Different triangles on few points: of a small grid, beside one by a bit, or of wide exponents."""
    many = draw(st.integers(4, 9))
    kind = draw(st.sampled_from(["grid", "bits", "wide"]))
    numbers = st.sampled_from([0.0, 1.0, -1.0, 2.0**-30, 2.0**-60, 3 * 2.0**-200, 1 - NUDGE, 1 + NUDGE])
    if kind != "wide":
        numbers = st.integers(0, 3)
    rows = draw(st.lists(st.tuples(numbers, numbers, numbers), min_size=many, max_size=many, unique=True))
    points = np.array(rows, dtype=float)
    if kind == "bits":
        bits = draw(st.lists(st.sampled_from([-1, 0, 0, 1]), min_size=3 * many, max_size=3 * many))
        points = (points + 1) * (1 + NUDGE * np.array(bits).reshape(-1, 3))
    chosen = draw(
        st.lists(st.sampled_from([*combinations(range(many), 3)]), min_size=2, max_size=8, unique=True)
    )
    turned = draw(st.lists(st.permutations(range(3)), min_size=len(chosen), max_size=len(chosen)))
    triangles = np.array([[row[k] for k in order] for row, order in zip(chosen, turned)], dtype=np.int32)
    xyz = unit_points(points)
    return points, triangles[[clear_view(xyz, *row) >= 0 for row in triangles]]


@settings(max_examples=150)
@given(few())
def test_any_triangles(case: tuple[np.ndarray, np.ndarray]) -> None:
    points, triangles = case
    if len(triangles):
        assert embedded(points, triangles) == slow(points, triangles)
        if len(np.unique(np.sort(triangles, axis=1), axis=0)) == len(triangles):
            assert pairs_are_right(points, triangles)


@st.composite
def fans(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """Triangles around one vertex, which may turn around it twice, fold back, or be open; all directions."""
    many = draw(st.integers(3, 9))
    turns = draw(st.integers(1, 2))
    angle = 2 * np.pi * turns * np.arange(many) / many
    height = np.array(draw(st.lists(st.sampled_from([0.0, 0.3, -0.3, 2.0]), min_size=many, max_size=many)))
    rim = np.column_stack([np.cos(angle), np.sin(angle), height])
    swap = draw(st.lists(st.integers(0, many - 1), min_size=2, max_size=2))
    if draw(st.booleans()):
        rim[swap] = rim[swap[::-1]]
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    if turns == 2 or draw(st.booleans()):
        rim += 1e-3 * rng.standard_normal(rim.shape)
    points = np.vstack([[[0.0, 0.0, 0.0]], rim])
    rows = np.array([(0, 1 + i, 1 + (i + 1) % many) for i in range(many)], dtype=np.int32)
    rows = rows[: many - draw(st.integers(0, 1))]
    if draw(st.booleans()):
        rows[0] = rows[0, ::-1]
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0] if draw(st.booleans()) else np.eye(3)
    return points @ turn.T, rows


@settings(max_examples=150)
@given(fans())
def test_triangles_around_a_vertex(case: tuple[np.ndarray, np.ndarray]) -> None:
    points, rows = case
    if len(np.unique(points, axis=0)) == len(points) and len(flat_rows(points, rows)) == 0:
        assert embedded(points, rows) == slow(points, rows)


@settings(max_examples=40)
@given(
    st.sampled_from(["ball", "grid"]),
    st.integers(0, 10**6),
    st.sampled_from([0.0, 0.02, 0.3, 1.0]),
    st.booleans(),
)
@example("ball", 0, 0.0, True)
def test_surfaces_with_some_vertices_moved(name: str, seed: int, far: float, turned: bool) -> None:
    points, triangles = ball(6) if name == "ball" else grid(3)
    rng = np.random.default_rng(seed)
    moved = rng.integers(len(points), size=3)
    points = points.copy()
    points[moved] += far * rng.standard_normal((3, 3))
    if turned:  # the direction of triangles must not matter
        back = rng.random(len(triangles)) < 0.2
        triangles = np.where(back[:, None], triangles[:, ::-1], triangles)
    triangles = np.ascontiguousarray(rng.permutation(triangles))
    if len(flat_rows(points, triangles)) == 0:
        assert embedded(points, triangles) == slow(points, triangles)
        assert pairs_are_right(points, triangles)


def test_good_surfaces_need_hardly_any_exact_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    decided = []

    def none_meet(xyz: np.ndarray, rows: np.ndarray, pairs: np.ndarray, *_: object) -> int:
        decided.append(len(pairs))
        return 0

    monkeypatch.setattr(quick, "_meet", none_meet)
    assert embedded(*ball(12)) and embedded(*grid(6))
    assert decided[0] == 0 and decided[1] < 60


def test_two_bodies_that_cross_and_that_do_not() -> None:
    points, triangles = ball(6)
    for shift, free in ((0.3, False), (1.7, False), (2.1, True)):
        both = np.vstack([points, points + np.array([shift, 0.01, 0.02])])
        rows = np.vstack([triangles, triangles + np.int32(len(points))])
        assert embedded(both, rows) == slow(both, rows) == free


def test_too_many_doubtful_pairs_are_left_to_others() -> None:
    """Every triangle crosses every other one; and a book of thin pages is embedded, but not found so."""
    angle = np.pi * np.arange(40) / 40
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(40)])
    points = np.vstack([[[0, 0, -1.0], [0, 0, 1.0]], points])
    pages = np.array([(0, 1, 2 + i) for i in range(40)], dtype=np.int32)
    assert slow(points, pages)
    assert not embedded(points, pages)  # 780 pairs
    assert pairs_are_right(points, pages)


def test_near_pairs_within_leaves_alone() -> None:
    """Found by cut cubes of an octree: more of these than there was room for were written beyond its end."""
    sheets = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.1]]]) + 0.0
    sheets = sheets + 1e-3 * np.array([0.0, 0.0, 1.0]) * np.arange(4)[:, None, None]  # all their boxes meet
    away = 100.0 * np.arange(quick.NEAR_PAIRS // 2)[:, None, None, None] * np.array([1.0, 0.0, 0.0])
    x = (sheets + away).reshape(-1, 3)
    rows = np.arange(len(x), dtype=np.int32).reshape(-1, 3)
    assert embedded(x, rows)
    x[-1, 2] = 0.0
    assert not embedded(x, rows)


def test_flat_rows() -> None:
    points = np.array([[0.1, 0.1, 0.1], [0.3, 0.3, 0.3], [0.2, 0.2, 0.2], [0.7, 0.7, 0.7], [0, 0, 1]])
    rows = np.array([(0, 1, 4), (0, 1, 3), (0, 2, 4), (0, 2, 1)], dtype=np.int32)
    exact = [
        t
        for t, row in enumerate(rows)
        if len(np.unique(points[row] @ np.ones(3))) and clear_view(points, *row) < 0
    ]
    assert flat_rows(points, rows).tolist() == exact == [1, 3]
    assert len(flat_rows(points, rows[:0])) == 0
