"""Points that must not break the boundary, rows of points that guard it, and exact diametral circles."""

from fractions import Fraction

import numpy as np
import pytest
from fans import TEN, fan_domain, random_polygon
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct.assess.check import check
from unstruct.base.errors import InputError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.swapping import swap_diagonals
from unstruct.domain.domain import Domain
from unstruct.examples.running import running_region
from unstruct.generate.boundary.conforming import conforming_delaunay
from unstruct.generate.boundary.constrained import constrained_delaunay
from unstruct.generate.boundary.protection import insert_without_breaking, skeleton_points
from unstruct.geometry.simplex import circumradius
from unstruct.mesh.mesh import Mesh
from unstruct.plain import bowyer_watson as bw
from unstruct.plain import protection
from unstruct.plain.conforming import missing
from unstruct.predicates.diametral import exact_in_disc, in_disc

entries = st.one_of(
    st.integers(-4, 4).map(lambda v: v / 4),
    st.floats(-1, 1),
    st.integers(-3, 3).map(lambda v: 0.5 + v * 2.0**-53),
    st.tuples(st.integers(-3, 3), st.integers(-250, 0)).map(lambda v: v[0] / 4 * 2.0 ** v[1]),
)


@given(st.tuples(*[entries] * 6))
@settings(max_examples=300, deadline=None)
def test_diametral_circles_are_exact(values):
    ax, ay, bx, by, px, py = map(Fraction, values)
    dot = (ax - px) * (bx - px) + (ay - py) * (by - py)
    expected = (dot < 0) - (dot > 0)
    assert in_disc(*values) == exact_in_disc(*values) == expected


def is_delaunay_here(mesh):
    """Valid, every boundary edge there, and nothing to swap although none is marked."""
    assert check(mesh, delaunay="constrained")
    assert len(swap_diagonals(Mesh(mesh.points, mesh.simplices), history=True)[1]) == 0


# --- turning points away ----------------------------------------------------------------------------


@given(st.integers(0, 10**6), st.booleans())
@settings(max_examples=12, deadline=None)
def test_against_the_definition(seed, wall):
    """Each point is put to the test by definition: is a boundary edge missing once it is there?"""
    rng = np.random.default_rng(seed)
    ring = random_polygon(rng, 6, 20)
    n = len(ring)
    box = [(-30, -30), (50, -30), (50, 50), (-30, 50)]
    around = [(n + k, n + (k + 1) % 4) for k in range(4)]
    rows = [(k, (k + 1) % n) for k in range(n)]
    domain = Domain([*ring, *box], around, inner=rows) if wall else Domain.polygon(ring)
    start = conforming_delaunay(domain)
    given_ = [tuple(p) for p in rng.integers(0, 20, (12, 2)).astype(float).tolist()]
    result = insert_without_breaking(domain, given_)
    is_delaunay_here(result.mesh)
    before = [tuple(p) for p in start.points.tolist()]
    told = protection.turn_away(before, start.segments.tolist(), start.simplices.tolist(), given_)
    starved, after = set(), [tuple(p) for p in result.mesh.points.tolist()]
    cells = [tuple(cell) for cell in result.mesh.simplices.tolist()]
    for k, (point, (verdict, edges)) in enumerate(zip(given_, told, strict=True)):
        assert (result.vertex[k] >= 0) == (verdict == "in")
        if verdict == "in":
            assert after[result.vertex[k]] == point
            continue
        row = result.rejected.tolist().index(k)
        assert {"outside": "outside", "equal": "equals", "breaks": "would break"}[verdict] in result.why[row]
        if verdict == "breaks":
            named = result.mesh.points[result.mesh.segments[result.edge[row]]].tolist()
            assert sorted(named) in [sorted([list(before[u]), list(before[v])]) for u, v in edges]
            starved |= protection.replaced(after, result.mesh.segments.tolist(), cells, point)
    assert len(result.rejected) == (result.vertex < 0).sum() == result.mesh.counts["rejected"]
    assert starved == {cells[i] for i in result.mesh.unrefined}


def test_what_is_starved():
    """A coarse side rejects all points of a half disc; the triangle on it stays, and is named."""
    domain = Domain.rectangle((0, 0), (8, 4))
    points = np.array([(4.0, 0.5), (4.0, 0.0), (4.0, 2.5), (9.0, 1.0), (0.0, 0.0), (4.0, 2.5)])
    # a hull edge has nothing beyond it that could break: only points on it do
    result = insert_without_breaking(domain, points)
    assert result.why.tolist() == ["it would break facet 0", "it lies outside of the domain",
                                   "it equals vertex 0", "it equals vertex 5"]  # fmt: skip
    box = [(-10, -10), (18, -10), (18, 18), (-10, 18), (0, 4), (8, 4)]
    wall = Domain(box, [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5)])
    tips = [(4.0, 11.0), (4.0, -3.0)]  # both circles reach 16/7 across
    result = insert_without_breaking(wall, [*tips, (4.0, 5.0), (4.0, 3.5), (1.0, 5.5)])
    assert result.rejected.tolist() == [2, 3] and not result.mesh.complete
    assert {tuple(result.mesh.segments[e]) for e in result.edge} == {(4, 5)}
    assert len(result.mesh.unrefined) >= 2 and result.largest > 3
    assert result.largest == circumradius(result.mesh.corners[result.mesh.unrefined]).max()
    content = insert_without_breaking(wall, [*tips, (4.0, 5.0)], size=20.0)
    assert content.mesh.complete and content.largest == 0 and len(content.rejected) == 1


def test_many_points_in_the_lake():
    domain = Domain(*running_region(0.2))
    rng = np.random.default_rng(5)
    points = rng.random((4000, 2)) * [3, 2]
    result = insert_without_breaking(domain, points, size=0.05)
    is_delaunay_here(result.mesh)
    assert 0 < result.mesh.counts["starved"] and "would break" in " ".join(result.why)
    np.testing.assert_allclose(result.mesh.volume, domain.area)
    again = insert_without_breaking(domain, points, size=0.05)
    assert np.array_equal(again.vertex, result.vertex)
    went = result.vertex >= 0
    np.testing.assert_array_equal(result.mesh.points[result.vertex[went]], points[went])


def test_bad_points():
    domain = Domain.rectangle()
    with pytest.raises(InputError, match=r"points\[1\]"):
        insert_without_breaking(domain, [(0.5, 0.5), (np.nan, 0)])
    with pytest.raises(InputError, match="coordinates"):
        insert_without_breaking(domain, [(0.5, 0.5, 0.5)])
    with pytest.raises(InputError, match="gap"):
        skeleton_points(domain, gap=2)
    with pytest.raises(InputError, match="gap must be a number"):
        skeleton_points(domain, gap="small")
    for method in (skeleton_points, lambda region: insert_without_breaking(region, [(0.5, 0.5)])):
        with pytest.raises(InputError, match="domain must be a Domain, not NoneType"):
            method(None)
    empty = insert_without_breaking(domain, np.empty((0, 2)))
    assert len(empty.vertex) == 0 and empty.mesh.complete


# --- skeletons ----------------------------------------------------------------------------------------


def discs_are_empty(mesh):
    for u, v in mesh.points[mesh.segments]:
        dot = ((u - mesh.points) * (v - mesh.points)).sum(axis=1)
        assert (dot > -1e-12 * np.abs(mesh.points).max() ** 2).all()


@given(st.integers(0, 10**6), st.sampled_from([None, 3.0, 8.0]))
@settings(max_examples=25, deadline=None)
def test_skeletons_of_polygons(seed, size):
    domain = Domain.polygon(random_polygon(np.random.default_rng(seed), 7, 30))
    s = skeleton_points(domain, size)
    if s.complete:
        discs_are_empty(s.mesh)
        is_delaunay_here(s.mesh)
    assert len(s.points) + len(s.bare) == len(s.mesh.segments)  # every facet has one side inside
    assert len(s.why) == len(s.bare) and all(s.why) and domain.contains(s.points).all()
    ends = s.mesh.points[s.mesh.segments[s.segment]]
    for end in (0, 1):  # equilateral
        np.testing.assert_allclose(
            np.linalg.norm(s.points - ends[:, end], axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        )
    turn = np.linalg.det(np.stack([ends[:, 1] - ends[:, 0], s.points - ends[:, 0]], axis=1))
    assert (np.sign(turn) == s.side).all()


def test_points_that_keep_their_distance_leave_guarded_edges():
    """Throw points that are farther than l / sqrt(3) from all vertices: no edge with its tips breaks."""
    domain = fan_domain([(50, 0), (0, 50), (-50, 0), (0, -50)], far=2)
    s = skeleton_points(domain, 25.0)
    assert s.complete
    length = np.linalg.norm(np.diff(s.mesh.points[s.mesh.segments], axis=1)[:, 0], axis=1)
    rng, points = np.random.default_rng(1), s.mesh.points
    for p in rng.uniform(-100, 100, (3000, 2)):
        if np.linalg.norm(points - p, axis=1).min() > length.max() / np.sqrt(3):
            points = np.vstack([points, p])
    assert len(points) > len(s.mesh.points) + 30
    edges = {frozenset(e) for e in delaunay(points).edges.tolist()}
    bare = set(s.bare[:, 0].tolist())
    for row, e in enumerate(s.mesh.segments.tolist()):
        assert row in bare or frozenset(e) in edges


def test_inner_segments_have_tips_on_both_sides():
    domain = Domain([(0, 0), (10, 0), (10, 10), (0, 10), (4, 5), (6, 5)], [(0, 1), (1, 2), (2, 3), (3, 0)],
                    inner=[(4, 5)])  # fmt: skip
    s = skeleton_points(domain, 2.0)
    row = [k for k, e in enumerate(s.mesh.segments.tolist()) if s.mesh.piece[k] == 4]
    assert sorted(s.side[np.isin(s.segment, row)].tolist()) == [-1, 1]
    corner = [w for (r, _), w in zip(s.bare.tolist(), s.why.tolist()) if s.mesh.piece[r] < 4]
    assert corner and all("near" in w or "disk" in w for w in corner)  # the tips of a corner crowd each other


def test_a_skeleton_cannot_bring_an_edge_back():
    """Points never make a missing edge present: the plain definition, on the ten spokes."""
    points = [(0, 0), *TEN]
    lost = [q for q in TEN if missing(points, (0, 0), q)]
    assert len(lost) == 5
    rng = np.random.default_rng(0)
    more = points + [tuple(p) for p in rng.integers(-1000, 1000, (200, 2)).tolist()]
    assert all(missing(more, (0, 0), q) for q in lost)
    assert len(bw.triangulate(points)) > 0


@given(
    st.integers(0, 10**6), st.booleans(), st.sampled_from([0.0, 0.5, 0.9]), st.sampled_from([None, 12.0, 6.0])
)
@settings(max_examples=15, deadline=None)
def test_skeletons_are_those_of_the_plain_version(seed, wall, gap, size):
    """From the same disks, all empty, the same tips on the same sides."""
    ring = random_polygon(np.random.default_rng(seed), 6, 30)
    n = len(ring)
    rows = [(k, (k + 1) % n) for k in range(n)]
    around = [(n + k, n + (k + 1) % 4) for k in range(4)]
    box = [(-40, -40), (70, -40), (70, 70), (-40, 70)]
    domain = Domain([*ring, *box], around, inner=rows) if wall else Domain.polygon(ring)
    fast = skeleton_points(domain, size, gap=gap)
    assume(fast.complete)
    old = np.setdiff1d(np.arange(len(fast.mesh.points)), fast.vertex)
    points, number = fast.mesh.points[old], np.full(len(fast.mesh.points), -1)
    number[old] = np.arange(len(old))
    segments, outer = number[fast.mesh.segments], fast.mesh.piece < (4 if wall else n)
    start = constrained_delaunay(Domain(points, segments[outer], inner=segments[~outer]))
    cells = [tuple(cell) for cell in start.origin[start.simplices].tolist()]
    slow = protection.skeleton(points.tolist(), segments.tolist(), cells, gap)
    sides = zip(fast.segment.tolist(), fast.side.tolist())
    assert dict(zip(sides, map(tuple, fast.points.tolist()), strict=True)) == slow
