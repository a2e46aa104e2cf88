"""Every change of triangles and quadrilaterals, judged in rational numbers: cells, boundary, area."""

from __future__ import annotations

import numpy as np
import pytest
from quad_cells import consistent, judged, of_triangles, rows_of, same_boundary

from unstruct.generate.quads.cleaning import clean
from unstruct.generate.quads.dividing import divide
from unstruct.generate.quads.linked import across, are_neighbors, linked, middle_of
from unstruct.generate.quads.relaxing import relax_everywhere
from unstruct.generate.quads.walking import walk

SEEDS = range(12)


def triangles(m):
    return sum(len(row) == 3 for row in rows_of(m.cells))


@pytest.mark.parametrize("seed", SEEDS)
def test_neighbors_and_what_is_across(seed):
    m = of_triangles(30, seed)
    consistent(m)
    edges = {}
    for t, row in enumerate(m.cells):
        row = [int(v) for v in row if v >= 0]
        edges |= {(row[k], row[(k + 1) % len(row)]): t for k in range(len(row))}
    for (a, b), t in edges.items():
        assert across(m, t, a, b) == edges.get((b, a), -1)
    for v in range(len(m.xy)):
        for w in range(v):
            assert are_neighbors(m, v, w) == ((v, w) in edges or (w, v) in edges)
    assert sum(middle_of(m, a, b) >= 0 for a, b in edges) == 16


@pytest.mark.parametrize("seed", SEEDS)
def test_walking(seed):
    m = of_triangles(40, seed, pair=seed % 3 > 0)
    before, many = judged(m.xy, m.cells), triangles(m)
    met = walk(m, 0.3)
    consistent(m)
    same_boundary(before, judged(m.xy, m.cells))
    assert triangles(m) == many - 2 * met
    assert met > 0 or many < 2 or seed % 3 > 0


@pytest.mark.parametrize("seed", SEEDS)
def test_cleaning(seed):
    m = of_triangles(60, seed)
    before, many, counts = judged(m.xy, m.cells), len(rows_of(m.cells)), np.zeros(3, dtype=np.int64)

    def irregular():
        return sum((m.degree[v] - m.ideal[v]) ** 2 for v in range(len(m.xy)) if m.degree[v] > 0)

    old = irregular()
    clean(m, 0.3, 5, counts)
    consistent(m)
    same_boundary(before, judged(m.xy, m.cells))
    assert len(rows_of(m.cells)) == many - counts[0] - counts[1]
    assert irregular() < old if counts[1] + counts[2] else irregular() == old


def test_changes_of_every_kind_happen():
    total = np.zeros(3, dtype=np.int64)
    for seed in range(30):
        m = of_triangles(60, seed)
        walk(m, 0.2)
        clean(m, 0.1, 5, total)
    assert total[1] > 20 and total[2] > 20


@pytest.mark.parametrize("seed", SEEDS)
def test_dividing(seed):
    m = of_triangles(25, seed)
    before, many = judged(m.xy, m.cells), triangles(m)
    gone = divide(m, 0.15)
    consistent(m)
    boundary, area = judged(m.xy, m.cells)
    assert area == before[1]  # sides are straight, and their middles exact
    assert triangles(m) == many - gone
    new = sorted(set(np.ravel(list(boundary)).tolist()) - set(np.ravel(list(before[0])).tolist()))
    assert len(new) == gone == len(boundary) - len(before[0])
    for w in new:
        (a,), (b,) = ([x for x, y in boundary if y == w], [y for x, y in boundary if x == w])
        assert (a, b) in before[0]
        assert np.array_equal(m.xy[w], 0.5 * (m.xy[a] + m.xy[b]))


@pytest.mark.parametrize("seed", SEEDS)
def test_relaxing(seed):
    m = of_triangles(60, seed)
    before, held = judged(m.xy, m.cells), m.xy[~m.free].copy()
    cells = m.cells.copy()

    def cost():
        total = 0.0
        for row in rows_of(m.cells):
            for k in range(len(row)):
                b, u, w = m.xy[row[k]], m.xy[row[(k + 1) % len(row)]], m.xy[row[k - 1]]
                u, w = u - b, w - b
                area, uu, ww = u[0] * w[1] - u[1] * w[0], u @ u, w @ w
                if len(row) == 4:
                    total += 0.05 * (uu + ww) / area + 0.9 * uu * ww / area**2
                else:
                    total += 0.35 * (uu + ww - u @ w) / (2 * np.sqrt(0.75) * area)
        return total

    old = cost()
    assert relax_everywhere(m, 30) > 0
    assert cost() < old
    assert np.array_equal(m.cells, cells) and np.array_equal(m.xy[~m.free], held)
    same_boundary(before, judged(m.xy, m.cells))
    now, step = cost(), 1e-4  # no single vertex has a place nearby that is much better
    for v in np.flatnonzero(m.free):
        here = m.xy[v].copy()
        for away in ((step, 0), (-step, 0), (0, step), (0, -step)):
            m.xy[v] = here + away
            assert cost() > now * (1 - 1e-3)
        m.xy[v] = here


def test_a_square_and_its_middle():
    """Four cells about a vertex that is off the middle: it goes there."""
    xy = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1.6, 0.5], [2, 1], [0, 2], [1, 2], [2, 2.0]])
    cells = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
    fixed = np.ones(9, dtype=bool)
    fixed[4] = False
    none = np.empty((0, 2), dtype=np.int64)
    m = linked(xy, cells, fixed, none, np.empty(0, dtype=np.int64))
    relax_everywhere(m, 20)
    assert np.allclose(xy[4], 1, atol=1e-4)


def test_a_vertex_of_very_many_cells():
    """A wheel of 20,000 triangles: what is done at its hub takes time like their number, not its square."""
    import unstruct

    n = 20_000
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    around = np.arange(n)
    rows = np.column_stack([np.full(n, n), around, (around + 1) % n])
    mesh = unstruct.recombine(unstruct.Mesh(np.concatenate([rim, [[0.0, 0.0]]]), rows))
    assert unstruct.check(mesh)
