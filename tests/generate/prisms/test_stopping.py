"""How many layers each ray has where there is no room for all: levels, reasons, and the cells of all
patterns."""

from __future__ import annotations

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from unstruct import Mesh, check
from unstruct.generate.prisms.cells import cells_of
from unstruct.generate.prisms.records import COLUMN, CROSSING_RAY, FULL, HIDDEN_RAY, STEP_RAY
from unstruct.generate.prisms.stopping import layers_below, stepped, stopped

# A vertex among six others, and the ring around these: seven columns around an inner edge have all patterns.
HEXAGON = [(np.cos(k * np.pi / 3), np.sin(k * np.pi / 3)) for k in range(6)]
WHEEL = np.array([(0, 1 + k, 1 + (k + 1) % 6) for k in range(6)], dtype=np.int32)


def edges_of(columns: np.ndarray) -> np.ndarray:
    ends = np.sort(columns[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(ends, axis=0)


def mesh_of(points: np.ndarray, columns: np.ndarray, level: np.ndarray) -> tuple[Mesh, np.ndarray]:
    """Layers of height 1 over points of a plane, and their cap as rows of the mesh."""
    most, n = max(int(level.max()), 1), len(points)
    number = (np.minimum(np.arange(most + 1)[:, None], level) * n + np.arange(n)).astype(np.int32)
    cells = cells_of(columns, number).kinds
    every = np.column_stack([np.tile(points, (most + 1, 1)), np.repeat(np.arange(most + 1.0), n)])
    used = np.unique(np.concatenate([rows.ravel() for rows in cells.values()]))
    place = np.full(len(every), -1)
    place[used] = np.arange(len(used))
    return Mesh(every[used], None, cells={k: place[rows] for k, rows in cells.items()}), place[
        number[-1][columns]
    ]


def test_every_pattern_around_a_vertex() -> None:
    """All levels 1 to 3 of a wheel, at most 1 apart along edges: valid, and the cap has triangles only."""
    points = np.array([(0.0, 0.0), *HEXAGON])
    edges = edges_of(WHEEL)
    seen = 0
    for level in product((0, 1, 2), repeat=7):
        levels = np.array(level) + 1
        if (np.abs(levels[edges[:, 0]] - levels[edges[:, 1]]) > 1).any() or level[1] > min(level[1:]):
            continue
        seen += 1
        mesh, cap = mesh_of(points, WHEEL, levels)
        assert check(mesh), level
        boundary = {frozenset(row[row >= 0].tolist()) for row in np.asarray(mesh.boundary)}
        assert all(frozenset(row) in boundary for row in cap.tolist()), level
        # What is not cap, base or a side over one of the six outer edges would be an open quadrilateral.
        sides = (
            sum(int(levels[a] + levels[b]) - abs(int(levels[a] - levels[b])) for a, b in WHEEL[:, 1:]) // 2
        )
        slopes = sum(abs(int(levels[a] - levels[b])) for a, b in WHEEL[:, 1:])
        assert len(boundary) == 12 + sides + slopes, level
    assert seen == 149


@given(st.integers(2, 7), st.data())
def test_steps_are_the_largest_that_differ_by_one(n: int, data: st.DataObject) -> None:
    pairs = [(i, j) for i in range(n) for j in range(i)]
    edges = np.array(data.draw(st.lists(st.sampled_from(pairs), min_size=1, max_size=12)))
    level = np.array(data.draw(st.lists(st.integers(0, 9), min_size=n, max_size=n)), dtype=np.int32)
    found, reason = stepped(edges, level, np.zeros(n, dtype=np.int8))
    far = np.full((n, n), 99)
    np.fill_diagonal(far, 0)
    far[edges[:, 0], edges[:, 1]] = far[edges[:, 1], edges[:, 0]] = 1
    np.fill_diagonal(far, 0)
    for k in range(n):
        far = np.minimum(far, far[:, k, None] + far[None, k])
    assert found.tolist() == (level + far).min(axis=1).tolist()
    assert (reason == np.where(found < level, STEP_RAY, FULL)).all()


def test_whole_layers_below_a_height() -> None:
    rise = np.array([[0.0, 1.0, 3.0, 7.0]])
    assert layers_below(rise, np.array([0.0, 0.99, 1.0, 3.0 * (1 - 2.0**-45), 6.9, 8.0])).tolist() == [
        0,
        0,
        1,
        2,
        2,
        3,
    ]
    rows = np.array([[0.0, 1.0, 2.0], [0.0, 2.0, 4.0]])
    assert layers_below(rows, np.array([2.0, 2.0])).tolist() == [2, 1]


def test_faults_lower_levels_until_there_is_none() -> None:
    """A path of rays: nothing may be higher than a roof over one, and no two may reach above a limit."""
    rise, n = np.arange(11.0)[None], 12
    edges = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    roof = np.full(n, 99.0)
    roof[3] = 1.5

    def bad(level: np.ndarray) -> np.ndarray:
        return np.flatnonzero(level == 10)[:2]

    def clash(level: np.ndarray) -> np.ndarray:
        return np.flatnonzero(level > roof)

    height, reason = np.full(n, 10.0), np.zeros(n, dtype=np.int8)
    height[11], reason[11] = 0.0, HIDDEN_RAY
    found = stopped(rise, edges, (height, reason), bad, clash)
    assert found.level.tolist() == [4, 3, 2, 1, 2, 3, 4, 4, 3, 2, 1, 0]
    assert (
        found.reason[3] == CROSSING_RAY
        and found.reason[11] == HIDDEN_RAY
        and (found.reason[[2, 4]] == STEP_RAY).all()
    )
    assert found.rounds == 5
    lone = stopped(rise, edges[:0], (np.full(n, 10.0), np.zeros(n, dtype=np.int8)), bad, lambda level: [])
    assert (lone.level == 7).all() and (lone.reason == COLUMN).all()
