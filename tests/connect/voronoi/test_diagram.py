"""Voronoi diagrams against SciPy (generic input), rational arithmetic (everything else), and themselves."""

import os
import subprocess
import sys
from fractions import Fraction
from itertools import combinations, pairwise, product

import numpy as np
import pytest
import scipy.spatial
from fixtures import (
    FLAT,
    HARD_2D,
    HARD_3D,
    LEDGER,
    cross_polytope,
    cube,
    duplicates,
    lattice2,
    lattice3,
    uniform,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import (
    DegenerateInputError,
    Domain,
    InputError,
    Mesh,
    MeshError,
    UnstructError,
    Voronoi,
    constrained_delaunay,
    delaunay,
    voronoi,
)
from unstruct.connect.voronoi.dual import find_ridges, general_ridges
from unstruct.plain.predicates import in_sphere, orient
from unstruct.plain.voronoi import area, corners, dirichlet, exact_sites, neighbors

grid2 = st.lists(st.tuples(*[st.integers(0, 5)] * 2), min_size=4, max_size=13)
grid3 = st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=5, max_size=11)
some = settings(max_examples=80, deadline=None)
few = settings(max_examples=35, deadline=None)


def spans(points):
    """Whether the points are not all in one hyperplane."""
    rows = np.array(points, dtype=float)
    return np.linalg.matrix_rank(rows - rows[0]) == rows.shape[1]


def by_pair(diagram):
    """Ridges as a dictionary: pair of sites -> set of vertices."""
    pairs = map(frozenset, diagram.ridge_points.tolist())
    return dict(zip(pairs, map(frozenset, diagram.ridge_vertices), strict=True))


def exact_center(corners):
    """Circumcenter by Gauss elimination in rational numbers."""
    p0, *others = [[Fraction(x) for x in p] for p in np.asarray(corners).tolist()]
    rows = [[x - y for x, y in zip(p, p0)] for p in others]
    rows = [[*row, sum(x * x for x in row) / 2] for row in rows]
    for i in range(len(rows)):
        k = next(k for k in range(i, len(rows)) if rows[k][i])
        rows[i], rows[k] = rows[k], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(len(rows)):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i])]
    return tuple(x + row[-1] for x, row in zip(p0, rows))


def verify(diagram):
    """All that can be said exactly of a diagram in the plane or in space."""
    points, mesh = diagram.points, diagram.mesh
    kept = sorted(set(range(len(points))) - set(diagram.duplicates[:, 0].tolist()))
    bodies = {}
    for simplex, vertex in zip(mesh.simplices.tolist(), diagram.simplex_vertex.tolist()):
        bodies.setdefault(vertex, set()).update(simplex)
        for q in kept:  # the sites of a vertex are all those on its sphere, and none is inside
            sign = in_sphere(points[simplex], points[q])
            assert sign <= 0, f"site {q} inside the sphere of {simplex}"
            if sign == 0:
                bodies[vertex].add(-1 - q)
    assert sorted(bodies) == list(range(len(diagram.vertices)))
    for vertex, body in bodies.items():
        assert {v for v in body if v >= 0} == {-1 - v for v in body if v < 0}, f"vertex {vertex} is split"
    check_regions(diagram, bodies)
    check_ridges(diagram, bodies)
    check_rays(diagram)


def check_regions(diagram, bodies):
    regions, d = diagram.regions, diagram.points.shape[1]
    around = [{g for g, body in bodies.items() if v in body} for v in range(len(diagram.points))]
    assert len(regions) == len(set(map(tuple, diagram.points.tolist())))
    for v, r in enumerate(diagram.point_region.tolist()):
        kept = dict(diagram.duplicates.tolist()).get(v, v)
        assert set(regions[r]) - {-1} == around[kept]
        assert len(set(regions[r])) == len(regions[r]), "a vertex twice"
        assert (-1 in regions[r]) == diagram.unbounded[r]
        if d == 2:
            check_ring(diagram, v, regions[r], bodies)


def check_ring(diagram, v, ring, bodies):
    """Counterclockwise, and neighbors in the ring have an edge from the site in common."""
    start = int(ring[0] == -1)
    finite = ring[start:]
    for a, b in list(pairwise(finite)) + ([] if start else [(finite[-1], finite[0])]):
        common = bodies[a] & bodies[b] & set(range(len(diagram.points)))
        kept = dict(diagram.duplicates.tolist()).get(v, v)
        (other,) = common - {kept}
        third = next(w for w in bodies[b] if w >= 0 and w not in common)
        assert orient(diagram.points[[kept, other, third]]) > 0, "clockwise"


def check_ridges(diagram, bodies):
    d, m = diagram.points.shape[1], len(diagram.mesh.simplices)
    mesh, group = diagram.mesh, diagram.simplex_vertex
    general = general_ridges(diagram.points, mesh.simplices, mesh.neighbors, group)
    assert len(general.ray_facets) == len(diagram.ray_vertices)
    rings = np.split(general.vertices, general.start[1:-1])
    assert by_pair(diagram) == {frozenset(p): frozenset(r) for p, r in zip(general.points.tolist(), rings)}
    for ring, rays in zip(diagram.ridge_vertices, diagram.ridge_rays, strict=True):
        assert -1 not in ring[1:]
        assert len(rays) == (0 if ring[0] >= 0 else d - 1)
        if rays:
            assert [diagram.ray_vertices[r] for r in rays] == [ring[1], ring[-1]][: d - 1]
        cyclic = list(zip(ring, ring[1:] + ring[:1])) if d == 3 else []
        for a, b in cyclic:
            if a >= 0 and b >= 0 and a != b:
                assert len({v for v in bodies[a] & bodies[b] if v >= 0}) >= 3, "no common edge"
    assert m == len(group)


def check_rays(diagram):
    """Along a ray the same sites stay nearest: it is normal to the hull, and no site lies ahead of them."""
    points, scale = diagram.points, np.abs(diagram.points).max()
    for a, direction in zip(diagram.ray_vertices.tolist(), diagram.ray_directions):
        assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-14)
        height = (points / scale) @ direction
        sites = diagram.mesh.simplices[diagram.simplex_vertex == a]
        assert (height[sites] > height.max() - 1e-13).sum(axis=1).max() >= points.shape[1]


@pytest.mark.parametrize("name", HARD_2D)
def test_hard_inputs_in_the_plane(name):
    points = HARD_2D[name][:60]
    verify(voronoi(points if spans(points / np.abs(points).max()) else HARD_2D[name]))


@pytest.mark.parametrize("name", HARD_3D)
def test_hard_inputs_in_space(name):
    verify(voronoi(HARD_3D[name][:48] if name in ("uniform", "clustered") else HARD_3D[name]))


@few
@given(grid3)
def test_any_grid_in_space(points):
    if spans(points):
        verify(voronoi(np.array(points, dtype=float)))


@pytest.mark.parametrize("d, n", [(2, 400), (3, 150), (4, 40)])
def test_generic_input_against_scipy(d, n):
    points = uniform(n, d, seed=5)
    ours, theirs = voronoi(points), scipy.spatial.Voronoi(points)
    assert len(ours.vertices) == len(theirs.vertices)
    place = scipy.spatial.cKDTree(ours.vertices)
    away, match = place.query(theirs.vertices)
    assert (away <= 1e-9 * (1 + np.abs(theirs.vertices).max(axis=1))).all()
    assert len(set(match.tolist())) == len(match)
    number = [*match.tolist(), -1]
    expected = {
        frozenset(p): frozenset(number[v] for v in ring)
        for p, ring in zip(theirs.ridge_points.tolist(), theirs.ridge_vertices)
    }
    left_out = by_pair(ours).items() - expected.items()
    assert expected.items() < by_pair(ours).items() if d > 2 else not left_out
    assert all(-1 in ring and len(ring) < d for _, ring in left_out), "more than SciPy leaves out"
    for v in range(n):
        expected = {number[g] for g in theirs.regions[theirs.point_region[v]]}
        assert set(ours.regions[ours.point_region[v]]) == expected
    cyclic = dict(zip(map(frozenset, ours.ridge_points.tolist()), ours.ridge_vertices))
    for p, ring in zip(theirs.ridge_points.tolist(), theirs.ridge_vertices):
        if d == 3 and -1 not in ring:  # SciPy orders the facets in space as well
            mine = cyclic[frozenset(p)]
            k = mine.index(number[ring[0]])
            turned = mine[k:] + mine[:k]
            assert [number[v] for v in ring] in (turned, turned[:1] + turned[:0:-1])


@some
@given(grid2)
def test_grids_against_half_planes(points):
    if not spans(points):
        return
    sites = list(dict.fromkeys(points))
    cells = dirichlet(sites)
    diagram = voronoi(np.array(sites, dtype=float))
    assert {frozenset(p) for p in diagram.ridge_points.tolist()} == neighbors(cells)
    exact = sorted(corners(cells))
    assert np.allclose(sorted(diagram.vertices.tolist()), np.array(exact, dtype=float), rtol=0, atol=1e-12)
    for cell, region in zip(cells, diagram.regions, strict=True):
        assert (-1 in region) == any(beyond is None for _, beyond in cell)
        ring = [
            start
            for k, (start, beyond) in enumerate(cell)
            if beyond is not None and cell[k - 1][1] is not None
        ]
        mine = diagram.vertices[[v for v in region if v >= 0]]
        turns = [np.roll(np.array(ring, dtype=float), k, axis=0) for k in range(len(ring))]
        assert any(np.allclose(mine, turn, rtol=0, atol=1e-12) for turn in turns)
        if -1 not in region:
            inside = float(area(cell))
            assert diagram.areas()[cells.index(cell)] == pytest.approx(inside, rel=1e-13)


@some
@given(grid2, st.lists(st.tuples(*[st.integers(-3, 8)] * 2), min_size=3, max_size=3))
def test_clipped_cells_against_half_planes(points, window):
    if not spans(points) or orient(window) == 0:
        return
    if orient(window) < 0:
        window = window[::-1]
    sites = list(dict.fromkeys(points))
    diagram = voronoi(np.array(sites, dtype=float))
    exact = [area(cell) for cell in dirichlet(sites, window)]
    assert np.allclose(diagram.areas(clip=window), np.array(exact, dtype=float), rtol=0, atol=1e-13)
    assert sum(exact) == area(tuple((p, None) for p in exact_sites(window)))


def on_hull(points):
    """Which sites lie on the boundary of the hull: on a hyperplane through d sites with none beyond."""
    n, d = points.shape
    found = np.zeros(n, dtype=bool)
    for some_sites in combinations(range(n), d):
        signs = [orient(points[[*some_sites, q]]) for q in range(n)]
        if any(signs) and (min(signs) >= 0 or max(signs) <= 0):
            found |= np.array(signs) == 0
    return found


@few
@given(grid2)
def test_unbounded_means_on_the_hull(points):
    points = np.array(points, dtype=float)
    if spans(points):
        diagram = voronoi(points)
        assert (diagram.unbounded[diagram.point_region] == on_hull(points)).all()


@settings(max_examples=12, deadline=None)
@given(st.lists(st.tuples(*[st.integers(0, 2)] * 3), min_size=5, max_size=9))
def test_unbounded_means_on_the_hull_in_space(points):
    points = np.array(points, dtype=float)
    if spans(points):
        diagram = voronoi(points)
        assert (diagram.unbounded[diagram.point_region] == on_hull(points)).all()


def test_square_has_one_vertex_of_degree_four():
    diagram = voronoi(LEDGER["unit_square"])
    assert diagram.vertices.tolist() == [[0.5, 0.5]]
    assert len(diagram.mesh.simplices) == 2 and len(diagram.ridge_points) == 4
    assert frozenset((0, 2)) not in by_pair(diagram) and frozenset((1, 3)) not in by_pair(diagram)


@pytest.mark.parametrize("d", [2, 3, 4, 5])
def test_lattice_has_one_vertex_a_cube(d):
    diagram = voronoi(np.array(list(product(range(3 if d < 5 else 2), repeat=d)), dtype=float))
    side = 2 if d < 5 else 1
    expected = np.array(list(product(np.arange(side) + 0.5, repeat=d)))
    assert np.array_equal(np.array(sorted(diagram.vertices.tolist())), expected)
    steps = np.abs(np.diff(diagram.points[diagram.ridge_points], axis=1)).sum(axis=(1, 2))
    assert (steps == 1).all() and len(steps) == d * side * (side + 1) ** (d - 1)
    assert len(diagram.ray_vertices) == 2 * d * side ** (d - 1)


def test_cross_polytope():
    """The center of the tie is a site: 2^d vertices, and the inner cell is the cube of side 1."""
    for d in (2, 3, 4):
        diagram = voronoi(cross_polytope(d))
        assert np.array_equal(np.array(sorted(diagram.vertices.tolist())), cube(d) - 0.5)
        if d < 4:
            assert diagram.areas()[-1] == 1


def test_line():
    diagram = voronoi([[3.0], [0.0], [1.0], [10.0]])
    assert sorted(diagram.vertices.ravel().tolist()) == [0.5, 2.0, 6.5]
    assert diagram.areas().tolist() == [4.5, np.inf, 1.5, np.inf]
    assert sorted(map(sorted, diagram.ridge_points.tolist())) == [[0, 2], [0, 3], [1, 2]]
    assert sorted(diagram.ray_directions.ravel().tolist()) == [-1, 1]


@pytest.mark.parametrize("name", FLAT)
def test_flat_sites_raise_with_the_dimension(name):
    """But for sites in the plane, whose cells are strips."""
    points, dimension = FLAT[name]
    if points.shape[1] == 2:
        diagram = voronoi(points)
        count = len(set(map(tuple, points.tolist())))
        assert len(diagram.regions) == count and len(diagram.ridge_points) == count - 1
        assert diagram.unbounded.all() and (diagram.areas() == np.inf).all()
        return
    with pytest.raises(DegenerateInputError) as error:
        voronoi(points)
    assert error.value.dimension == dimension


@pytest.mark.parametrize(
    "bad", [[], [[0, 0, 0]], [[0, 0], [1, 0], [0, np.nan]], [1, 2, 3], [["a", "b"]], None]
)
def test_bad_input_raises_the_typed_error(bad):
    with pytest.raises(UnstructError):
        voronoi(bad)


def test_a_surface_mesh_has_no_diagram():
    import unstruct

    flat = unstruct.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(InputError, match="3 vertices in 3 dimensions"):
        Voronoi(flat)


@pytest.mark.parametrize("d", [2, 3])
def test_duplicates_share_a_region(d):
    points = duplicates(d)
    diagram = voronoi(points)
    assert len(diagram.regions) == len(points) - 4
    for copy, kept in diagram.duplicates.tolist():
        assert diagram.point_region[copy] == diagram.point_region[kept]
        assert np.array_equal(points[copy], points[kept])
    alone = voronoi(np.unique(points + 0.0, axis=0))
    assert np.allclose(np.sort(diagram.areas()), np.sort(alone.areas()))
    assert not np.isin(diagram.ridge_points, diagram.duplicates[:, 0]).any()


# --- numbers ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [n for n in HARD_2D if n not in ("tiny", "huge")] + list(HARD_3D))
def test_vertices_are_accurate(name):
    points = (HARD_2D | HARD_3D)[name][:60]
    if name in HARD_2D:
        points = HARD_2D[name]
    diagram = voronoi(points)
    for simplex, vertex in zip(diagram.mesh.simplices[:80], diagram.simplex_vertex[:80]):
        center = exact_center(points[simplex])
        away = max(abs(x - y) for x, y in zip(center, points[simplex[0]].tolist()))
        for x, y in zip(center, diagram.vertices[vertex].tolist()):
            assert abs(x - Fraction(y)) <= 2e-12 * away + 2.0**-52 * abs(x), (name, simplex)


def test_vertex_beyond_the_range_of_doubles():
    points = np.array([[0, 0], [1e300, 0], [5e299, 1e-300]])
    diagram = voronoi(points)
    assert diagram.vertices[0, 1] == -np.inf and len(diagram.ridge_points) == 3


@pytest.mark.parametrize("name", HARD_2D)
def test_clipped_cells_fill_the_window(name):
    points = HARD_2D[name]
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, np.abs(high - low).max()
    diagram = voronoi(points)
    angles = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    hexagon = middle + half * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for window, size in [
        ((middle - half, middle + half), 4 * half * half),
        (hexagon[::-1], 3.5 * np.sin(2 * np.pi / 7) * half * half),
        ((middle, middle + 2 * half), 4 * half * half),
    ]:
        areas, cells = diagram.areas(clip=window), diagram.clip(window)
        assert areas.sum() == pytest.approx(size, rel=1e-7 if name == "offset_1e8" else 1e-12)
        assert (areas >= 0).all() and len(cells) == len(areas) == len(diagram.regions)
        assert all((len(c) == 0) == (a == 0) for c, a in zip(cells, areas) if a == 0 or len(c) == 0)


def test_corners_of_clipped_cells_are_equidistant():
    points = uniform(300, 2, seed=9)
    diagram = voronoi(points)
    tree = scipy.spatial.cKDTree(points)
    for site, cell in zip(points, diagram.clip([[0.1, 0.1], [0.9, 0.2], [0.7, 0.95], [0.2, 0.8]])):
        if len(cell):
            assert np.allclose(tree.query(cell)[0], np.linalg.norm(cell - site, axis=1), atol=1e-13)
            ahead = np.roll(cell, -1, axis=0) - cell
            assert (
                ahead[:, 0] * np.roll(ahead[:, 1], -1) - ahead[:, 1] * np.roll(ahead[:, 0], -1) > -1e-13
            ).all()


def test_areas_do_not_feel_a_far_offset():
    """Spacing 2^-20 at 2^30: every inner cell has exactly the area 2^-40."""
    points = 2.0**30 + 2.0**-20 * lattice2(8, 8)
    diagram = voronoi(points)
    areas = diagram.areas()
    assert (areas[~diagram.unbounded] == 2.0**-40).all() and (~diagram.unbounded).sum() == 36
    assert diagram.areas(clip=(points[0], points[-1])).sum() == 49 * 2.0**-40
    assert len(diagram.vertices) == 49
    solid = voronoi(2.0**30 + 2.0**-20 * lattice3(4, 4, 4))
    assert (solid.areas()[~solid.unbounded] == 2.0**-60).all()


def test_areas_of_tiny_and_huge_lattices():
    for name, unit in (("tiny", -500), ("huge", 500)):
        diagram = voronoi(HARD_2D[name])
        inner = diagram.areas()[~diagram.unbounded]
        assert (inner == np.ldexp(1.0, 2 * unit)).all() and len(inner) == 4  # 2^-1000 and 2^1000


def test_volumes_against_hulls_of_vertices():
    diagram = voronoi(uniform(120, 3, seed=2))
    volumes = diagram.areas()
    for region, volume in zip(diagram.regions, volumes):
        if -1 in region:
            assert volume == np.inf
        else:
            assert volume == pytest.approx(
                scipy.spatial.ConvexHull(diagram.vertices[region]).volume, rel=1e-9
            )
    assert np.isfinite(volumes).sum() > 30


def test_many_cornered_window_and_many_sites():
    """A window with 500 corners and 2000 sites: the work is cut into parts."""
    angles = np.linspace(0, 2 * np.pi, 500, endpoint=False)
    window = 0.5 + 0.45 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    diagram = voronoi(uniform(2000, 2))
    polygon = 250 * 0.45**2 * np.sin(2 * np.pi / 500)
    assert diagram.areas(clip=window).sum() == pytest.approx(polygon, rel=1e-13)
    assert sum(len(c) > 0 for c in diagram.clip(window)) < 2000


@pytest.mark.parametrize(
    "window, words",
    [
        ([[0, 0], [0, 1]], "empty"),
        ([[1, 1], [0, 0]], "empty"),
        ([[0, 0], [3, 1], [0, 1], [3, 0]], "not convex"),
        (np.array([[0, 3], [-1.8, -2.4], [2.9, 0.9], [-2.9, 0.9], [1.8, -2.4]]), "not convex"),
        ([[0, 0], [1, 1], [2, 2]], "collinear"),
        ([[0, 0], [1, np.inf], [2, 2]], "corner 1"),
        ([[0, 0, 0], [1, 1, 1]], "shape"),
        ([0, 0, 1, 1], "shape"),
        ([["a", "b"], ["c", "d"]], "real numbers"),
        ([[-1e300, -1e300], [1e300, 1e300]], "too large"),
    ],
)
def test_bad_windows(window, words):
    with pytest.raises(InputError, match=words):
        voronoi(uniform(20, 2)).clip(window)


def test_window_in_space_and_areas_in_four_dimensions():
    with pytest.raises(InputError, match="planar"):
        voronoi(uniform(20, 3)).clip([[0, 0], [1, 1]])
    with pytest.raises(InputError, match="three dimensions"):
        voronoi(uniform(20, 4)).areas()


# --- Lloyd ------------------------------------------------------------------------------------------


def test_relaxation_lowers_the_energy():
    points = uniform(300, 2, seed=4)
    result = voronoi(points).relax(12, clip=((0, 0), (1, 1)))
    assert len(result.energies) == 13 and len(result.idle) == 0
    assert (np.diff(result.energies) < 0).all() and result.energies[-1] < 0.65 * result.energies[0]
    after = result.voronoi
    assert ((after.points > 0) & (after.points < 1)).all()
    assert np.ptp(after.areas(((0, 0), (1, 1)))) < np.ptp(voronoi(points).areas(((0, 0), (1, 1))))


def test_relaxation_of_a_lattice_stands_still():
    points = lattice2(5, 5) + 0.5
    result = voronoi(points).relax(3, clip=((0, 0), (5, 5)))
    assert np.allclose(result.voronoi.points, points, rtol=0, atol=1e-14)
    assert np.allclose(result.energies, 25 / 6, rtol=1e-14)


@few
@given(grid2, st.integers(1, 3))
def test_energy_never_rises(points, iterations):
    points = np.array(points, dtype=float)
    if spans(points):
        energies = voronoi(points).relax(iterations, clip=((-1, -1), (4, 6))).energies
        assert (np.diff(energies) <= 1e-13 * energies[:-1]).all()


@pytest.mark.parametrize("iterations", [-1, 1.5, None, True, ((0, 0), (1, 1))])
def test_relaxation_counts_its_steps(iterations):
    with pytest.raises(InputError, match=r"iterations = .* must be a whole number that is not negative"):
        voronoi(uniform(9, 2)).relax(iterations)


def test_relaxation_keeps_account():
    points = np.vstack([uniform(30, 2), uniform(30, 2)[:2], [[7.0, 7.0], [8.0, 8.0]]])
    result = voronoi(points).relax(2, clip=((0, 0), (1, 1)))
    assert result.idle.tolist() == [32, 33]
    assert np.array_equal(result.voronoi.points[32:], points[32:])
    assert np.array_equal(result.voronoi.points[30:32], result.voronoi.points[:2])
    assert not np.allclose(result.voronoi.points[:30], points[:30])
    assert voronoi(points).relax(0).energies.shape == (1,)
    with pytest.raises(InputError):
        voronoi(points).relax(-1)


# --- nearest site -----------------------------------------------------------------------------------


def nearest_by_fractions(points, x):
    def square(i):
        return sum((Fraction(a) - Fraction(b)) ** 2 for a, b in zip(points[i].tolist(), x.tolist()))

    return min(range(len(points)), key=lambda i: (square(i), i))


@some
@given(grid2, st.lists(st.tuples(*[st.integers(-4, 14)] * 2), min_size=1, max_size=6))
def test_nearest_on_grids(points, queries):
    """Half-integer queries: many exact ties, decided for the first site."""
    points, queries = np.array(points, dtype=float), np.array(queries) / 2
    if spans(points):
        expected = [nearest_by_fractions(points, x) for x in queries]
        assert voronoi(points).nearest(queries).tolist() == expected


@pytest.mark.parametrize("name", [*HARD_2D, *(n for n in HARD_3D if n not in HARD_2D)])
def test_nearest_on_hard_inputs(name):
    points = (HARD_3D | HARD_2D)[name]
    diagram = voronoi(points)
    span = np.abs(points).max()
    rng = np.random.default_rng(1)
    pairs = rng.integers(len(points), size=(12, 2))
    queries = np.vstack(
        [
            points[pairs].mean(axis=1),
            points[:4],
            span * rng.uniform(-3, 3, (4, points.shape[1])),
            1e30 * points[:2],
        ]
    )
    queries = queries[np.isfinite(queries).all(axis=1)]
    assert diagram.nearest(queries).tolist() == [nearest_by_fractions(points, x) for x in queries]


def test_nearest_shapes_and_errors():
    diagram = voronoi(lattice2())
    assert diagram.nearest([0.4, 0.4]) == 0 and isinstance(diagram.nearest([0.5, 0.5]), int)
    assert diagram.nearest(np.zeros((2, 3, 2))).shape == (2, 3)
    assert diagram.nearest(np.zeros((0, 2))).shape == (0,)
    assert diagram.nearest([1e200, -1e200]) == 25  # the corner (5, 0), among differences far below rounding
    with pytest.raises(InputError, match="shape"):
        diagram.nearest([1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="query 1"):
        diagram.nearest([[0, 0], [np.nan, 0]])


# --- the whole --------------------------------------------------------------------------------------


def test_same_input_same_output():
    points = lattice2(7, 7)
    one, two = voronoi(points), voronoi(points.copy())
    assert np.array_equal(one.vertices, two.vertices) and one.regions == two.regions
    assert one.ridge_vertices == two.ridge_vertices


def test_neighbors_and_repr():
    diagram = voronoi(LEDGER["mutual_neighbors_no_simplex"])
    assert [diagram.neighbors(r) for r in range(4)] == [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]
    assert repr(diagram) == "Voronoi(4 regions (3 unbounded) of 4 sites in 2D, 3 vertices, 6 ridges)"


def test_all_ways_find_the_same_ridges():
    for points in (lattice2(), uniform(60, 2)):
        mesh = voronoi(points).mesh
        args = points, mesh.simplices, mesh.neighbors, voronoi(points).simplex_vertex
        fast, slow = find_ridges(*args), general_ridges(*args)
        assert set(map(frozenset, fast.points.tolist())) == set(map(frozenset, slow.points.tolist()))
        assert len(fast.ray_facets) == len(slow.ray_facets)


def test_large_diagram():
    """10^5 sites: every identity that costs little. Euler: v - e + f = 1 with the point at infinity."""
    points = np.random.default_rng(8).random((100_000, 2))
    diagram = voronoi(points)
    box = ((0, 0), (1, 1))
    assert diagram.areas(box).sum() == pytest.approx(1, abs=1e-12)
    inner = ~diagram.unbounded
    whole = np.array([len(c) for c in diagram.clip(((-1e9, -1e9), (1e9, 1e9)))])[inner]
    assert (whole == [len(r) for r, keep in zip(diagram.regions, inner) if keep]).mean() > 0.9999
    assert len(diagram.vertices) - len(diagram.ridge_points) + len(points) == 1
    assert (diagram.nearest(points) == np.arange(len(points))).all()


def test_without_numba():
    """The kernels as plain Python give the same."""
    program = (
        "import numpy as np, unstruct; from itertools import product\n"
        "for d in (2, 3):\n"
        "    p = np.array(list(product(range(3), repeat=d)), float)\n"
        "    v = unstruct.voronoi(p); print(len(v.vertices), len(v.ridge_points), v.areas().min())\n"
        "    print(v.areas(((-1, -1), (3, 3))).sum() if d == 2 else sorted(map(len, v.ridge_vertices))[-1])\n"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment)
    assert done.stdout.split() == ["4", "12", "1.0", "16.0", "8", "54", "1.0", "4"], done.stderr


def test_plot():
    import matplotlib

    matplotlib.use("Agg")
    ax = voronoi(lattice2(3, 3)).plot(delaunay=True)
    assert ax.get_aspect() == 1 and ax.collections
    with pytest.raises(InputError):
        voronoi(uniform(10, 3)).plot()


# --- meshes that are given ----------------------------------------------------------------------------


def test_a_mesh_that_is_not_delaunay_is_refused_by_facet():
    """The other diagonal of a quadrilateral: its cells added up to 18.033 in a window of 18."""
    points = [(0, 0), (4, 0), (4.2, 1), (0, 1.1)]
    window = ((-1, -1), (5, 2))
    with pytest.raises(MeshError, match=r"facet \[0, 2\], between cells 0 and 1: vertex 3"):
        Voronoi(Mesh(points, [[0, 1, 2], [0, 2, 3]]))
    right = Voronoi(Mesh(points, [[0, 1, 3], [1, 2, 3]]))
    assert right.areas(clip=window).sum() == pytest.approx(18, rel=1e-15)
    assert np.array_equal(right.areas(clip=window), voronoi(points).areas(clip=window))


@few
@given(grid2, st.integers(0, 99))
def test_one_swapped_diagonal_is_found(points, seed):
    if not spans(points):
        return
    mesh = delaunay(np.array(points, dtype=float))
    assert len(Voronoi(mesh).regions) == len(set(points))
    pairs = [(t, u) for t in range(len(mesh)) for u in mesh.neighbors[t].tolist() if u > t]
    for t, u in pairs[seed % 7 :: 7]:
        (a,) = set(mesh.simplices[t].tolist()) - set(mesh.simplices[u].tolist())
        (b,) = set(mesh.simplices[u].tolist()) - set(mesh.simplices[t].tolist())
        c, d = sorted(set(mesh.simplices[t].tolist()) & set(mesh.simplices[u].tolist()))
        new = [[a, b, c], [b, a, d]]
        new = [row if orient(mesh.points[row]) > 0 else [row[1], row[0], row[2]] for row in new]
        convex = orient(mesh.points[[a, c, b]]) * orient(mesh.points[[a, d, b]]) < 0
        rest = [row for k, row in enumerate(mesh.simplices.tolist()) if k not in (t, u)]
        swapped = Mesh(mesh.points, rest + new, duplicates=mesh.duplicates) if convex else None
        if convex and in_sphere(mesh.points[mesh.simplices[t]], mesh.points[b]) < 0:
            with pytest.raises(MeshError, match="not Delaunay at facet"):
                Voronoi(swapped)
        elif convex:  # a tie: both are Delaunay
            assert len(Voronoi(swapped).vertices) == len(voronoi(points).vertices)


def test_meshes_without_the_whole_hull_are_refused():
    bend = Domain.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    square = [(0, 0), (1, 0), (1, 1), (0, 1), (3, 0), (4, 0), (4, 1)]
    cube_mesh = delaunay(cube(3))
    for mesh, words in [
        (constrained_delaunay(bend), "leave the hull"),
        (Mesh(square, [[0, 1, 2], [0, 2, 3], [4, 5, 6]]), "2 pieces"),
        (Mesh(square[:4], [[0, 2, 1], [0, 2, 3]]), "cell 0 of the mesh is flat or turned"),
        (Mesh(square[:4], [[0, 1, 2]]), "vertex 3 of the mesh is in no cell"),
        (Mesh(square[:4], [[0, 1, 2], [0, 1, 3], [0, 2, 3]]), "."),
        (Mesh(square[:3], np.empty((0, 3), dtype=np.int32)), "not on a line"),
        (Mesh(cube(3), np.empty((0, 4), dtype=np.int32)), "no cells"),
        (cube_mesh.select(np.arange(1, len(cube_mesh))), "."),
    ]:
        with pytest.raises(UnstructError, match=words):
            Voronoi(mesh)
    hull = constrained_delaunay(Domain.rectangle())
    assert Voronoi(hull).vertices.tolist() == [[0.5, 0.5]]
