"""Constrained Delaunay triangulation: every segment there, circles as empty as the segments allow."""

from __future__ import annotations

import numpy as np
import pytest
from fixtures import lattice2
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region
from segments import bare, cells_of, coastline, noncrossing, square

from unstruct import DegenerateInputError, InputError, MeshError, check, constrained_delaunay, delaunay
from unstruct.assess.check import Report
from unstruct.assess.spheres import check_spheres
from unstruct.connect.planar import inserting
from unstruct.connect.planar import segments as kernels
from unstruct.connect.planar.flood import mark_regions
from unstruct.domain.domain import Domain
from unstruct.generate.boundary.constrained import complex_of, planar_complex
from unstruct.mesh.embedding import boundary_is_convex
from unstruct.plain import constrained as plain
from unstruct.plain.predicates import orient


def hull_mesh(points, segments):
    return bare(points, segments).mesh(facets=0, origin=np.arange(len(points), dtype=np.int32))


def well(mesh, **options):
    report = check(mesh, delaunay="constrained", **options)
    assert report, str(report)


def same_up_to_ties(points, cells, others, fixed):
    """Exchanging triangulations of cocircular groups, and no more, leads from one to the other."""
    from unstruct.plain.predicates import in_sphere

    closed = {frozenset(map(int, edge)) for edge in fixed}

    def groups(cells):
        apex = {edge: w for cell in cells for edge, w in plain.corners(cell)}
        return {
            frozenset(edge)
            for edge, w in apex.items()
            if frozenset(edge) in closed
            or edge[::-1] not in apex
            or in_sphere([points[edge[0]], points[edge[1]], points[w]], points[apex[edge[::-1]]]) != 0
        }

    return groups(cells) == groups(others)


grids = st.integers(2, 6).flatmap(
    lambda n: st.lists(st.tuples(st.integers(0, n), st.integers(0, n)), min_size=4, max_size=12, unique=True)
)


@given(grids, st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), min_size=1, max_size=8))
@settings(max_examples=150, deadline=None)
def test_integer_grids_against_the_plain_version_and_the_definition(points, pairs):
    pairs = [(a, b) for a, b in pairs if a != b and max(a, b) < len(points)]
    assume(pairs)
    assume(any(orient([points[0], points[1], p]) for p in points[2:]))
    segments = noncrossing(points, pairs)
    mesh = hull_mesh(points, segments)
    well(mesh, brute=True)
    cells, parts = plain.constrained_delaunay(points, segments)
    fixed = {frozenset(map(int, edge)) for edge in mesh.segments}
    assert fixed == {frozenset(edge) for edge in parts}
    ours = cells_of(mesh.simplices)
    assert plain.is_constrained_delaunay(points, ours, parts)
    assert plain.is_constrained_delaunay(points, cells, parts)
    assert same_up_to_ties(points, ours, cells, parts)


@given(st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_near_degenerate_points(seed):
    rng = np.random.default_rng(seed)
    points = np.round(rng.random((14, 2)) * 4) / 4
    points += rng.integers(-3, 4, points.shape) * 2.0**-52  # next to a lattice, in the last bits
    points = np.unique(points, axis=0)
    assume(len(points) > 5 and len(np.unique(points[:, 0])) > 2)
    pairs = [tuple(rng.choice(len(points), 2, replace=False)) for _ in range(10)]
    segments = noncrossing(points, pairs)
    mesh = hull_mesh(points, segments)
    well(mesh, brute=True)
    assert plain.is_constrained_delaunay(points.tolist(), cells_of(mesh.simplices), mesh.segments.tolist())


@given(st.integers(0, 10**6), st.integers(3, 40))
@settings(max_examples=30, deadline=None)
def test_one_long_segment_through_a_cloud(seed, n):
    rng = np.random.default_rng(seed)
    points = np.concatenate([[[-1.0, 0.5], [2.0, 0.5]], rng.random((n, 2))])
    mesh = hull_mesh(points, [(0, 1)])
    well(mesh)
    cells, _ = plain.constrained_delaunay(points.tolist(), [(0, 1)])
    assert cells_of(mesh.simplices) == cells, "generic points: no ties"


def fan(k=12):
    """A vertex joined to all others, with a segment between each two neighbors among them."""
    angle = np.linspace(0.1, 3.0, k)
    points = np.concatenate(
        [[[0.0, 0.0]], np.column_stack([np.cos(angle), np.sin(angle)]) * (1 + angle)[:, None]]
    )
    return points, [(0, i) for i in range(1, k + 1)] + [(i, i + 1) for i in range(1, k)]


def comb(k=20):
    """Long thin teeth, each crossed by no other, whose Delaunay edges run across them."""
    x = np.arange(k, dtype=float)
    points = np.concatenate([np.column_stack([x, 0 * x]), np.column_stack([x + 0.25, 0 * x + 300.0])])
    return points, [(i, i + k) for i in range(k)]


def dangling():
    """A segment below two vertices whose edge has triangles across the segment on both of its sides."""
    points = [(-200, 0), (200, 0), (0, 3), (0, 2), (0, 1), (-1, -4), (1, -4)]
    return np.array(points, float), [(3, 4), (0, 1)]


def parabola(k=40):
    """All on one side of a long segment, all visible: chains as long as can be."""
    x = np.linspace(-1, 1, k)
    return np.concatenate([[[-3.0, -1e-3], [3.0, -1e-3], [0.0, -2.0]], np.column_stack([x, x * x])]), [(0, 1)]


@pytest.mark.parametrize("case", [fan, comb, dangling, parabola])
def test_named_cases(case):
    points, segments = case()
    mesh = hull_mesh(points, segments)
    well(mesh, brute=True)
    assert len(mesh.segments) == len(segments)
    assert plain.is_constrained_delaunay(points.tolist(), cells_of(mesh.simplices), mesh.segments.tolist())
    cells, parts = plain.constrained_delaunay(points.tolist(), segments)
    assert same_up_to_ties(points.tolist(), cells_of(mesh.simplices), cells, parts)


def test_a_dangling_edge_is_met_twice():
    points, segments = dangling()
    cells, parts = plain.constrained_delaunay(points.tolist(), segments[:1])
    (passage,) = plain.insert_segment(points.tolist(), cells, parts, 0, 1)
    assert passage.above == (0, 2, 3, 4, 3, 2, 1)


def test_vertices_on_a_segment_split_it():
    points = lattice2(6, 5)
    at = {tuple(p): i for i, p in enumerate(points.tolist())}
    complex_ = bare(points, [(at[5, 4], at[1, 0]), (at[0, 2], at[5, 2])])
    parts = [points[pair].tolist() for pair in complex_.ends]
    assert parts[:4] == [[[5 - k, 4 - k], [4 - k, 3 - k]] for k in range(4)]
    assert parts[4:] == [[[k, 2], [k + 1, 2]] for k in range(5)]
    assert complex_.piece.tolist() == [0] * 4 + [1] * 5
    np.testing.assert_allclose(complex_.span[:4], [[k / 4, (k + 1) / 4] for k in range(4)])
    half = complex_.where
    np.testing.assert_array_equal(complex_.mark[half], np.arange(9))
    np.testing.assert_array_equal(complex_.mark[complex_.twin[half]], np.arange(9))
    after = np.where(half % 3 == 2, half - 2, half + 1)
    np.testing.assert_array_equal(complex_.vertex[after], complex_.ends[:, 0])
    well(complex_.mesh(facets=0))


def test_crossing_at_a_vertex_is_no_crossing():
    points = [(-1, 0), (1, 0), (0, -1), (0, 1), (0, 0)]
    assert len(bare(points, [(0, 1), (2, 3)]).ends) == 4


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        ([(0, 2), (1, 3)], r"crosses.*vertices 0 and 2|vertices 1 and 3.*crosses"),
        ([(0, 1), (1, 0)], "overlaps"),
        ([(4, 5), (4, 6)], "overlaps"),
        ([(3, 3)], "leads nowhere"),
    ],
)
def test_segments_that_cannot_be(segments, words):
    points = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 1), (2, 1), (3, 1)]
    with pytest.raises(InputError, match=words):
        bare(points, segments)


def test_the_order_of_segments_matters_in_ties_only():
    rng = np.random.default_rng(5)
    points = rng.random((300, 2))
    segments = noncrossing(points, [tuple(rng.choice(300, 2, replace=False)) for _ in range(60)])
    assert len(segments) > 15
    one = cells_of(hull_mesh(points, segments).simplices)
    assert one == cells_of(hull_mesh(points, segments[::-1]).simplices)
    assert one != cells_of(delaunay(points).simplices)


# ---------------------------------------------------------------------- domains


def even_odd(*squares):
    """Squares in each other: by the even-odd rule of `Domain` they bound rings and islands in turn."""
    corners = np.concatenate([square(*one) for one in squares])
    first = 4 * np.arange(len(squares))[:, None]
    ring = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    return Domain(corners, (first[:, :, None] + ring).reshape(-1, 2))


def test_nested_holes_and_islands():
    domain = even_odd((0, 9), (1, 8), (2, 7), (3, 6))
    mesh = constrained_delaunay(domain)
    well(mesh, domain=domain)
    assert mesh.volume == domain.area == 81 - 49 + 25 - 9
    assert len(np.unique(mesh.markers["region"])) == 2
    np.testing.assert_array_equal(mesh.points, domain.points[mesh.origin])


def test_inner_segments_make_parts_but_never_holes():
    points = [*square(0, 9), *square(3, 6), (8, 8)]
    domain = Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5), (5, 6), (6, 7), (7, 4), (2, 8)])
    mesh = constrained_delaunay(domain)
    well(mesh)
    assert mesh.volume == 81
    region = mesh.markers["region"]
    assert set(region) == {0, 1}
    assert mesh.select(region == 1).volume == 9
    assert len(mesh.markers["inner"]) == 5 and len(mesh.markers["facets"]) == 4


def test_vertices_in_holes_are_accounted_for():
    domain = Domain(
        [*square(0, 9), *square(3, 6), (4, 4), (1, 1), (20, 20)],
        [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)],
    )
    mesh = constrained_delaunay(domain)
    well(mesh)
    assert mesh.origin.tolist() == [*range(8), 9], "8 lies in the hole and 10 beyond"
    whole = constrained_delaunay(domain, hull=True)
    well(whole)
    assert whole.origin.tolist() == [*range(11)]
    assert whole.volume == pytest.approx(delaunay(domain.points).volume)


def test_named_regions_and_markers():
    points = [*square(0, 9), (0, 5), (9, 5)]
    domain = Domain(
        points,
        [(0, 1), (1, 5), (5, 2), (2, 3), (3, 4), (4, 0)],
        inner=[(4, 5)],
        regions={"oil": [(1, 1)], "water": [(1, 8)]},
        markers={"sides": [1, 2, 4, 5], "interface": [6]},
    )
    mesh = constrained_delaunay(domain)
    well(mesh)
    names, region = list(domain.regions), mesh.markers["region"]
    assert mesh.select(region == names.index("oil")).volume == 45
    assert mesh.select(region == names.index("water")).volume == 36
    assert len(mesh.markers["sides"]) == 4 and mesh.markers["interface"].tolist() == [[4, 5]]


def test_one_name_for_two_parts_and_a_part_without_a_name():
    points = [(x, y) for y in (0, 1) for x in range(4)]
    domain = Domain(
        points,
        [(0, 1), (1, 2), (2, 3), (3, 7), (7, 6), (6, 5), (5, 4), (4, 0)],
        inner=[(1, 5), (2, 6)],
        regions={"ends": [(0.5, 0.5), (2.5, 0.5)]},
    )
    mesh = constrained_delaunay(domain)
    assert mesh.select(mesh.markers["region"] == 0).volume == 2
    assert mesh.select(mesh.markers["region"] == 1).volume == 1


@pytest.mark.parametrize(
    ("seeds", "words"),
    [
        ({"a": [(1, 1)], "b": [(2, 1)]}, "the same part"),
        ({"a": [(4, 2)]}, "on a segment"),
        ({"a": [(30, 2)]}, "outside"),
    ],
)
def test_seeds_that_cannot_be(seeds, words):
    points = [*square(0, 8), (4, 0), (4, 8)]
    segments = [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)] + [(4, 5)] * (words == "on a segment")
    complex_ = bare(points, segments, facets=6)
    seeds = {name: np.array(rows, float) for name, rows in seeds.items()}
    with pytest.raises(InputError, match=words):
        mark_regions(complex_, 6, seeds, False)


def test_facets_that_do_not_close():
    with pytest.raises(InputError, match="do not close"):
        bare(square(0, 8), [(0, 1), (1, 2), (2, 3)], facets=3)


@given(st.sampled_from(sorted(KINDS)), st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_random_regions_of_every_kind(kind, seed):
    domain = random_region(seed, kind)
    mesh = constrained_delaunay(domain)
    well(mesh, domain=domain)
    well(constrained_delaunay(domain, hull=True))
    size = float(np.ptp(domain.bounds, axis=0).max()) / 8
    complex_ = planar_complex(domain, size)
    cut = domain.sampled(size)
    well(
        complex_.mesh(
            facets=len(domain.facets), origin=cut.origin, markers=domain.markers, points=cut.points
        ),
        domain=domain,
    )


def test_curves_are_chords():
    domain = Domain.disc()
    mesh = constrained_delaunay(domain)
    well(mesh)
    assert mesh.volume == pytest.approx(2 * np.sqrt(2)) and mesh.origin.tolist() == [
        0,
        1,
        2,
        3,
        -1,
        -1,
        -1,
        -1,
    ]
    fine = planar_complex(domain, 0.1)
    assert fine.segments > 50
    well(fine.mesh(facets=4))


# ---------------------------------------------------------------------- whole hull


def test_hull_without_facets():
    points = np.random.default_rng(3).random((50, 2))
    segments = noncrossing(points, [(0, 1), (2, 3), (4, 5), (6, 7), (8, 9)])
    mesh = constrained_delaunay(Domain(points, [], inner=segments), hull=True)
    well(mesh)
    np.testing.assert_array_equal(mesh.points, points)
    np.testing.assert_array_equal(np.sort(mesh.markers["inner"], axis=1), np.sort(segments, axis=1))
    assert mesh.volume == pytest.approx(delaunay(points).volume, rel=1e-14)
    assert cells_of(constrained_delaunay(Domain(points, []), hull=True).simplices) == cells_of(
        delaunay(points).simplices
    )


def test_no_facets_and_no_hull():
    with pytest.raises(InputError, match="hull=True"):
        constrained_delaunay(Domain(square(0, 1), [], inner=[(0, 1)]))


def test_points_on_a_line():
    with pytest.raises(DegenerateInputError):
        constrained_delaunay(Domain([(0, 0), (1, 1), (2, 2)], [], inner=[(0, 1)]), hull=True)


def test_equal_points_and_wide_exponents():
    with pytest.raises(InputError, match="equal"):
        bare([*square(0, 1), (1, 1)], [(0, 1)])
    with pytest.raises(InputError, match="exponents"):
        bare([*square(0, 1e200), (1e-200, 1e-200)], [(0, 1)])


@pytest.mark.parametrize("factor", [2.0**900, 2.0**-900, 3e-160])
def test_scale_does_not_matter(factor):
    points, segments = comb(8)
    assert cells_of(hull_mesh(points * factor, segments).simplices) == cells_of(
        hull_mesh(points, segments).simplices
    )


# ---------------------------------------------------------------------- large, slow, without numba


def test_a_long_coast():
    domain = Domain.polygon(coastline(100_000))
    mesh = constrained_delaunay(domain)
    assert mesh.size == 100_000 - 2 and len(mesh.markers["facets"]) == 100_000
    well(mesh)
    assert mesh.volume == pytest.approx(domain.area, rel=1e-12)


def test_long_segments_through_many_triangles():
    points = np.random.default_rng(1).random((100_000, 2))
    points[:8] = [(0, 0.1), (1, 0.2), (0, 0.4), (1, 0.4), (0, 0.7), (1, 0.6), (0, 0.9), (1, 0.9)]
    mesh = hull_mesh(points, [(0, 1), (2, 3), (4, 5), (6, 7)])
    assert len(mesh.segments) == 4
    well(mesh)


def test_a_segment_across_a_hundred_thousand_triangles_is_not_quadratic():
    n = 50_000
    rng = np.random.default_rng(2)
    y = rng.uniform(0.5, 1.0, n) * np.where(np.arange(n) % 2, 1.0, -1.0) * 1e-3
    points = np.concatenate([[[-0.1, 0.0], [1.1, 0.0]], np.column_stack([np.sort(rng.random(n)), y])])
    mesh = hull_mesh(points, [(0, 1)])  # one chain of 25 000 vertices on either side
    assert len(mesh.segments) == 1
    well(mesh)


def rows_along(n):
    """Two rows of points along a segment: each base that is filled cuts off one corner only."""
    k = (n - 2) // 2
    upper = np.column_stack([np.arange(n - 2 - k), np.ones(n - 2 - k)])
    lower = np.column_stack([np.arange(k) + 0.5, -np.ones(k)])
    return np.concatenate([[(-1.0, 0.0), (n / 2, 0.0)], upper, lower])


@pytest.mark.parametrize("make", [rows_along, lambda n: parabola(n)[0]])
def test_rows_along_a_segment_are_not_quadratic(make):
    well(hull_mesh(make(1000), [(0, 1)]))
    mesh = hull_mesh(make(100_000), [(0, 1)])
    assert len(mesh.segments) == 1
    # the general overlap test would be quadratic on fans of a hundred thousand needles
    assert boundary_is_convex(mesh), "the triangles tile the hull"
    report = Report("")
    check_spheres(mesh, report, opaque=True)
    assert report, str(report)


@given(st.integers(0, 10**6), st.sampled_from(["strewn", "grid", "rows"]))
@settings(max_examples=60, deadline=None)
def test_cutting_ears_and_swapping_gives_the_same(seed, kind):
    rng = np.random.default_rng(seed)
    points = {
        "strewn": lambda: rng.random((30, 2)),
        "grid": lambda: np.unique(rng.integers(0, 7, (30, 2)), axis=0).astype(float),
        "rows": lambda: rows_along(24),
    }[kind]()
    n = len(points)
    pairs = [(0, 1)] + [tuple(rng.choice(n, 2, replace=False).tolist()) for _ in range(15)]
    segments = noncrossing(points, pairs)
    one = hull_mesh(points, segments)
    usual, inserting.PATIENCE = inserting.PATIENCE, 0
    try:
        other = hull_mesh(points, segments)
    finally:
        inserting.PATIENCE = usual
    well(other)
    np.testing.assert_array_equal(one.segments, other.segments)
    assert same_up_to_ties(points.tolist(), cells_of(one.simplices), cells_of(other.simplices), one.segments)


def test_a_dangling_edge_among_ears(monkeypatch):
    points, segments = dangling()
    expected = cells_of(hull_mesh(points, segments).simplices)
    monkeypatch.setattr(inserting, "PATIENCE", 0)
    assert cells_of(hull_mesh(points, segments).simplices) == expected


def test_progress_and_chunks(monkeypatch, capsys):
    monkeypatch.setattr(inserting, "SEGMENTS_A_CALL", 7)
    domain = Domain.polygon(coastline(50))
    assert cells_of(constrained_delaunay(domain, progress=True).simplices)
    assert "segments" in capsys.readouterr().err


def test_without_numba(monkeypatch):
    points, segments = dangling()
    expected = cells_of(hull_mesh(points, segments).simplices)
    for name in ("insert_segments", "fill_corners"):
        monkeypatch.setattr(inserting, name, getattr(kernels, name).py_func, raising=True)
    assert cells_of(hull_mesh(points, segments).simplices) == expected


def test_a_ready_sample():
    domain = Domain.disc()
    complex_ = complex_of(domain, domain.sampled(0.5))
    assert complex_.segments == len(domain.sampled(0.5).ends)


# ---------------------------------------------------------------------- the plain version


def test_plain_definition_tells_good_from_bad():
    points = [(0, 0), (4, 0), (2, 1), (2, -1)]
    across, along = {(0, 1, 2), (0, 3, 1)}, {(0, 3, 2), (1, 2, 3)}
    assert plain.is_constrained_delaunay(points, along, [])
    assert not plain.is_constrained_delaunay(points, across, [])
    assert plain.is_constrained_delaunay(points, across, [(0, 1)])
    assert plain.is_constrained_delaunay(points, along, [(2, 3)])


def test_plain_refuses_crossings():
    with pytest.raises(MeshError, match="crosses"):
        plain.constrained_delaunay([(0, 0), (4, 0), (4, 4), (0, 4), (2, 1)], [(0, 2), (1, 3)])


def test_plain_inside():
    domain = even_odd((0, 9), (1, 8), (2, 7))
    points = [tuple(map(int, p)) for p in domain.points]
    segments = [tuple(map(int, s)) for s in domain.facets]
    cells, _ = plain.constrained_delaunay(points, segments)
    kept = {cell for cell in cells if plain.inside(points, segments, cell)}
    assert same_up_to_ties(points, kept, cells_of(constrained_delaunay(domain).simplices), segments)
