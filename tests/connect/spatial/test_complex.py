"""SpatialComplex: recovery, release and flood, judged by exact signs and by volumes in rational numbers."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
import solids
from hypothesis import given, settings
from hypothesis import strategies as st
from recovered import judge

from unstruct import InputError, MeshError
from unstruct.connect.spatial.complex import SpatialComplex, SpatialMesh
from unstruct.plain.predicates import orient
from unstruct.plain.refilling import faces_of, walls_of

MODELS = {
    "torus": solids.torus(40, 16),
    "cube": solids.cube(5),
    "star": solids.twisted_star(6, 5, 0.5),
}


def volume(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def six_volumes(points: np.ndarray, triangles: np.ndarray) -> Fraction:
    """Six times the volume that triangles enclose, exactly."""
    rows = [[[Fraction(float(x)) for x in points[v]] for v in t] for t in triangles]
    return sum((volume(*t) for t in rows), Fraction(0))


def cell_volumes(mesh: SpatialMesh) -> Fraction:
    total = Fraction(0)
    for cell in mesh.simplices:
        p = [[Fraction(float(x)) for x in mesh.points[v]] for v in cell]
        total += volume(*([x - y for x, y in zip(q, p[0], strict=True)] for q in p[1:]))
    return total


@pytest.mark.parametrize("name", MODELS)
def test_surfaces_are_kept(name: str) -> None:
    points, triangles = MODELS[name]
    c = SpatialComplex(points)
    found = c.recover(triangles)
    assert found.exact
    judge(c, triangles, found)
    assert c.flood() == 1
    mesh = c.inside()
    assert len(mesh.faces) == len(triangles) and sorted(mesh.triangle) == list(range(len(triangles)))
    assert (np.sort(mesh.vertex[mesh.faces], axis=1) == np.sort(triangles[mesh.triangle], axis=1)).all()
    assert cell_volumes(mesh) == abs(six_volumes(points, triangles))
    given_ones = mesh.vertex < len(points)
    assert np.array_equal(mesh.points[given_ones], points[mesh.vertex[given_ones]])


@pytest.mark.parametrize("name", ["schoenhardt", "six_points"])
def test_polyhedra_without_tetrahedra(name: str) -> None:
    """They need a point; it is moved off the surface, which is then there triangle for triangle."""
    points, triangles = getattr(solids, name)()
    for corners in combinations(range(6), 4):  # the exact counterexample: no four vertices are inside
        edges = {frozenset(e) for t in triangles.tolist() for e in combinations(t, 2)}
        assert any(frozenset(e) not in edges for e in combinations(corners, 2))
    c = SpatialComplex(points)
    found = c.recover(triangles)
    assert found.exact and len(found.inner) == 1 and found.crossings.sum() > 0
    judge(c, triangles, found)
    assert c.flood() == 1
    mesh = c.inside()
    assert len(mesh.simplices) == 8 and cell_volumes(mesh) == abs(six_volumes(points, triangles))


@pytest.mark.parametrize("budget", [0, 1, 3, None])
@pytest.mark.parametrize(("n", "gap"), [(3, 0.0625), (4, 0.01), (4, 0.25)])
def test_lines_of_a_saddle(n: int, gap: float, budget: int | None) -> None:
    """No triangles are at them, so that the record alone tells which parts are to be recovered."""
    points, segments = solids.saddle_lines(n, gap)
    cube, triangles = solids.cube(1)
    low, high = points.min(axis=0) - 1, points.max(axis=0) + 1
    c = SpatialComplex(np.concatenate([low + cube * (high - low), points]))
    segments = segments + len(cube)
    found = c.recover(triangles, segments, restarts=1, budget=budget)
    assert found.complete == (budget is None)
    c.validate()
    edges = {pair for cell in c.cells().tolist() for pair in combinations(sorted(cell), 2)}
    between: list[int] = []
    for a, b in segments.tolist():
        chain = found.chains.get((a, b), [a, b])
        there = all((min(ends), max(ends)) in edges for ends in pairwise(chain))
        assert chain[0] == a and chain[-1] == b
        assert there == ([a, b] not in found.segments.tolist())
        between += chain[1:-1]
    assert sorted(between) == sorted(found.steiner.tolist())


def test_no_budget_is_an_incomplete_result() -> None:
    points, triangles = solids.schoenhardt()
    c = SpatialComplex(points)
    found = c.recover(triangles, budget=0)
    assert not found.complete and len(found.segments) and len(found.triangles)
    judge(c, triangles, found)
    assert c.flood() == 1  # decided cell by cell
    assert len(c.inside().simplices) > 0


def test_the_same_seed_gives_the_same_complex() -> None:
    points, triangles = MODELS["star"]
    results = []
    for _ in range(2):
        c = SpatialComplex(points)
        c.recover(triangles, seed=3)
        results.append((c.cells(), c.points()))
    assert all(np.array_equal(x, y) for x, y in zip(*results, strict=True))


def test_nested_shells_and_inner_triangles() -> None:
    """A cavity is outside, what is in it is inside again, and an inner triangle parts nothing."""
    points, triangles = solids.cube(1)
    nested = np.concatenate([(points - 0.5) * s for s in (8, 4, 2)])
    facets = np.concatenate([triangles + 8 * k for k in range(3)])
    inner = np.array([[24, 25, 26]])
    c = SpatialComplex(np.concatenate([nested, [[3, 3, 3], [3, 3, 3.5], [3, 3.5, 3]]]))
    found = c.recover(np.concatenate([facets, inner]))
    assert found.exact
    assert c.flood(len(facets)) == 2
    mesh = c.inside()
    assert cell_volumes(mesh) == 6 * (512 - 64 + 8)
    assert len(mesh.faces) == len(facets) + 1 and set(mesh.region) == {0, 1}


CLOUD = st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=5, max_size=10, unique=True)


def placed(points: list[tuple[int, int, int]]) -> set[tuple[int, ...]]:
    """The triangulation that comes of joining one point after the other to the walls that it sees."""
    rest = list(range(len(points)))
    first = next((q for q in combinations(rest, 4) if orient([points[v] for v in q]) != 0), None)
    if first is None:
        return set()
    a, b, c, d = first
    cells = {first if orient([points[v] for v in first]) > 0 else (a, b, d, c)}
    for p in sorted(set(rest) - set(first), key=lambda v: points[v]):
        for wall in walls_of(cells):
            cell = (*wall, p)
            if orient([points[v] for v in cell]) < 0:
                x, y, z = wall
                cells.add((x, z, y, p))
    return cells


@settings(deadline=None, max_examples=40)
@given(CLOUD, st.integers(0, 2**32))
def test_parts_of_other_triangulations(points: list[tuple[int, int, int]], choice: int) -> None:
    """Triangles of another triangulation of lattice points, by chance: no further points are needed."""
    cells = [cell for i, cell in enumerate(sorted(placed(points))) if choice >> (i % 32) & 1]
    used = {v for cell in cells for v in cell}
    if any(len(faces_of(cell)) < 4 for cell in cells) or not cells:
        return
    lonely = [v for v in range(len(points)) if v not in used]
    kept = np.array([row for v, row in enumerate(points) if v not in lonely], dtype=float)
    place = {v: k for k, v in enumerate(v for v in range(len(points)) if v not in lonely)}
    facets = np.array([[place[v] for v in face] for face in walls_of(cells)])
    c = SpatialComplex(kept)
    found = c.recover(facets)
    judge(c, facets, found)
    assert found.complete
    c.flood()
    assert cell_volumes(c.inside()) == abs(six_volumes(kept, facets))


def test_bad_input() -> None:
    with pytest.raises(InputError, match="points 1 and 2 are equal"):
        SpatialComplex([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]])
    with pytest.raises(InputError, match="needs 3"):
        SpatialComplex([[0, 0], [1, 0]])
    c = SpatialComplex([[0, 0, 0], [1, 0, 0], [0, 1, 0]])  # in a plane: the box spans the space
    assert c.recover([[0, 1, 2]]).exact
    t = int(np.flatnonzero(c.used())[0])
    c.vertex[4 * t : 4 * t + 2] = c.vertex[4 * t : 4 * t + 2][::-1].copy()
    with pytest.raises(MeshError, match="not positive"):
        c.validate()
    c.vertex[4 * t : 4 * t + 2] = c.vertex[4 * t : 4 * t + 2][::-1].copy()
    c.across[4 * t + 1] = c.across[4 * t]
    with pytest.raises(MeshError, match=r"other side|different faces|hull"):
        c.validate()


def test_what_is_beyond_the_vertices_does_not_matter() -> None:
    """The arrays are longer than they need be, and what is there was taken for coordinates."""
    points, triangles = MODELS["cube"]
    cells = SpatialComplex(points)
    cells.recover(triangles)
    cells.reserve(3 * cells.size, cells.slots)
    cells.xyz[cells.size :] = [np.nan, np.inf, 1e308]
    with np.errstate(all="raise"):
        cells.validate()
