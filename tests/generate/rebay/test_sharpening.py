"""The sharpest triangles: patches out and back, each change on them, and what finishing reaches with them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from benchmarks.regions import comb, rhombus, two_holes
from unstruct import Arc, Domain, simplex
from unstruct.assess.check import check
from unstruct.connect.insertion.halfedges import end_of, start_of
from unstruct.connect.planar.complex import PlanarComplex
from unstruct.generate.boundary.constrained import planar_complex
from unstruct.generate.boundary.kept import kept_pieces
from unstruct.generate.rebay import patch as patches
from unstruct.generate.rebay import sharpest, sharpness
from unstruct.generate.rebay.finishing import figures
from unstruct.generate.rebay.run import VoronoiSegmentRun, rule_of
from unstruct.generate.rebay.sharpening import SPARE_VERTICES, sharpen_worst
from unstruct.generate.rebay.voronoi_segment import voronoi_segment

NO_SPOTS = np.empty((0, 1, 3))
TEST_KINDS = sorted(set(KINDS) - {"angles", "thin", "wide exponents"})


def run_of(domain: Domain, size: float) -> VoronoiSegmentRun:
    """A run whose points are inserted, not finished, with room for more."""
    kept = kept_pieces(True, len(domain.facets), len(domain.pieces), domain.held())
    rule = rule_of(1.35, "center", "first", None, True)
    run = VoronoiSegmentRun(domain, planar_complex(domain, size), size, None, rule, kept, False)
    run.insert(None, None)
    run.reserve(run.complex.size + SPARE_VERTICES)
    return run


def vertices_of(c: PlanarComplex, given: int) -> patches.Vertices:
    n = len(c.xy)
    still = np.arange(n) < given
    still[c.ends[: c.segments].ravel()] = True
    nothing, zeros = np.full(n, -1, dtype=np.int32), np.zeros(n, dtype=np.int32)
    return patches.Vertices(
        still, nothing.copy(), nothing.copy(), zeros, zeros.copy(), np.zeros(n, dtype=bool)
    )


def consistent(patch: patches.Patch, stars: patches.Stars) -> float:
    """Twins, marks and orientations of a patch agree; its area."""
    area = 0.0
    for t in range(patch.counters[0]):
        if patch.live[t] < 0:
            continue
        a, b, c = stars.xy[stars.vertex[3 * t : 3 * t + 3]]
        double = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        assert double > 0
        area += double / 2
        for e in range(3 * t, 3 * t + 3):
            o, k = stars.twin[e], stars.mark[e]
            if k >= 0:
                assert o == -1 and stars.where[k] == e
                continue
            assert stars.twin[o] == e and patch.live[o // 3] == 0
            assert start_of(stars.vertex, e) == end_of(stars.vertex, np.int64(o))
    return area


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(TEST_KINDS), st.integers(0, 10**6), st.integers(0, 10**6))
def test_every_change_of_a_patch(kind: str, seed: int, number: int) -> None:
    """Out of the triangulation, changed, moved, made legal, and back: the mesh stays constrained Delaunay."""
    domain = random_region(seed, kind)
    size = float(0.15 * np.ptp(domain.bounds, axis=0).max())
    run = run_of(domain, size)
    c = run.complex
    cells = np.flatnonzero(c.kept())
    chosen = int(cells[number % len(cells)])
    place = np.full(len(c.region), -1, dtype=np.int32)
    vertices = vertices_of(c, run.first)
    first, stars = patches.patch_of()
    work, work_stars = patches.patch_of()
    patches.gather(c.plane(), vertices, place, chosen, first, stars)
    assert (place == -1).all() and (vertices.name == -1).all() and first.slots[0] == chosen
    area = consistent(first, stars)
    first.size[:] = (size * c.factor) ** 2
    made = 0
    for change in range(sharpest.CHANGES):
        patches.same(first, stars, work, work_stars)
        if not sharpest.change_patch(work, work_stars, change, True):
            continue
        made += 1
        assert consistent(work, work_stars) == pytest.approx(area)
        sharpness.make_legal(work, work_stars)
        before = sharpness.judge_patch(work, work_stars, 1.0)[0]
        sharpness.settle_patch(work, work_stars, NO_SPOTS, True, np.inf)
        sharpness.make_legal(work, work_stars)
        assert consistent(work, work_stars) == pytest.approx(area)
        assert 0 <= before <= 0.75 and 0 < sharpness.judge_patch(work, work_stars, 1.0)[0] <= 1.0
        last = change
    assert made
    patches.same(first, stars, work, work_stars)
    sharpest.change_patch(work, work_stars, last, True)
    sharpness.make_legal(work, work_stars)
    patches.put_back(c.plane(), work, work_stars, vertices, NO_SPOTS)
    assert check(run.result(), domain=domain)
    assert not c.broken


def test_a_patch_out_and_back_changes_nothing() -> None:
    run = run_of(random_region(3, TEST_KINDS[0]), 0.3)
    c = run.complex
    before = run.result()
    work, stars = patches.patch_of()
    place = np.full(len(c.region), -1, dtype=np.int32)
    vertices = vertices_of(c, run.first)
    for seed in np.flatnonzero(c.kept())[::7]:
        patches.gather(c.plane(), vertices, place, int(seed), work, stars)
        patches.put_back(c.plane(), work, stars, vertices, NO_SPOTS)
    after = run.result()
    np.testing.assert_array_equal(before.simplices, after.simplices)
    np.testing.assert_array_equal(before.points, after.points)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(TEST_KINDS), st.integers(0, 10**6), st.sampled_from([0.06, 0.12]), st.booleans())
def test_the_minimum_angle_never_decreases(kind: str, seed: int, fraction: float, grow: bool) -> None:
    domain = random_region(seed, kind)
    run = run_of(domain, float(fraction * np.ptp(domain.bounds, axis=0).max()))
    before, size = figures(run.complex), run.complex.size
    sharpen_worst(domain, run.complex, run.front(), run.first, run.kept, grow)
    after = figures(run.complex)
    assert after["minimum angle"] >= before["minimum angle"] - 1e-9
    assert grow or run.complex.size == size
    assert check(run.result(), domain=domain, delaunay="constrained")


# --- what finishing reaches ------------------------------------------------------------------------


def domain_of(outline: object) -> Domain:
    (ring,), discs = outline.polygons, outline.discs  # type: ignore[attr-defined]
    domain = Domain.polygon(ring)
    for x, y, r in discs:
        domain = domain.with_holes(Domain.disc((x, y), r))
    return domain


@pytest.mark.parametrize(
    ("outline", "angle"),
    [
        (comb(3, 0.04), 41.0),  # 37.6 without; the angle of Gmsh 6 was 41.3
        (comb(4, 0.05), 41.0),  # 36.9; 39.1
        (comb(5, 0.03), 42.5),  # 39.6; 43.75
        (comb(2, 0.0922), 39.0),  # 35.0; 36.7
        (rhombus(69.2, 0.1392), 43.0),  # 41.3; 43.9
        (rhombus(50, 0.1), 42.5),
        (two_holes(0.0185, 0.0279), 37.0),  # 31.7; 37.7
    ],
)
def test_combs_rhombi_and_gaps(outline: object, angle: float) -> None:
    domain = domain_of(outline)
    mesh = voronoi_segment(domain, outline.edge)  # type: ignore[attr-defined]
    assert mesh.quality("min_angle").min() >= angle
    assert mesh.complete and mesh.counts["patches"] > 0
    assert check(mesh, domain=domain, delaunay="constrained")


@pytest.mark.parametrize("degrees", [20.0, 24.0, 29.8, 40.0])
def test_no_triangle_is_sharper_than_the_apex(degrees: float) -> None:
    for edge in (0.05, 0.1):
        mesh = voronoi_segment(domain_of(rhombus(degrees, edge)), edge)
        assert mesh.quality("min_angle").min() >= degrees - 1e-9


@pytest.mark.parametrize("gap", [0.014, 0.02, 0.03, 0.05])
def test_edges_in_a_gap_have_the_wanted_length(gap: float) -> None:
    """Also where the gap is narrower than the size: the vertices on both sides slide past each other."""
    domain = domain_of(two_holes(gap, 0.02))
    mesh = voronoi_segment(domain, 0.02)
    ends = mesh.points[mesh.edges]
    middle, length = ends.mean(axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    inside = (np.abs(middle[:, 0] - 0.5) < 0.06) & (np.abs(middle[:, 1] - 0.5) < 0.08)
    assert (np.abs(np.log2(length[inside] / 0.02)) <= 0.5).mean() >= 0.97
    assert mesh.quality("min_angle").min() >= 35.0
    assert check(mesh, domain=domain, delaunay="constrained")


def on_the_boundary(mesh) -> np.ndarray:
    return mesh.points[np.unique(mesh.segments)]


def test_vertices_slide_on_their_pieces() -> None:
    """They stay on their arcs, in order; and where points of the boundary are held, nothing slides."""
    points = [(-1, 0), (1, 0), (1, 1), (-1, 1), (0.2, 0.07), (0.4, 0.07), (0.4, 0.27), (0.2, 0.27)]
    arc = Arc.through((0.2, 0.07), (0.3, 0.03), (0.4, 0.07))
    ring = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    domain = Domain(points, ring, curves={4: arc})
    size = 0.06
    mesh, held = (voronoi_segment(domain, size, split_boundary=split) for split in (True, False))
    raw = voronoi_segment(domain, size, finish=False)
    slid = np.setdiff1d(on_the_boundary(mesh)[:, 0], on_the_boundary(raw)[:, 0])
    assert len(slid)
    np.testing.assert_array_equal(
        np.sort(on_the_boundary(held), axis=0), np.sort(on_the_boundary(raw), axis=0)
    )
    for each in (mesh, held):
        assert check(each, domain=domain, delaunay="constrained")
        on_arc = each.points[np.unique(each.segments[each.piece == 4])]
        np.testing.assert_allclose(np.hypot(*(on_arc - arc.center).T), arc.radius, rtol=1e-14)
    assert simplex.quality("min_angle", mesh.points[mesh.simplices]).min() >= 25
