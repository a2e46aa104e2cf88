"""The plain Rebay insertion: every step is a constrained Delaunay mesh, and the fast one takes such steps."""

from math import dist, hypot, isclose, sqrt

import numpy as np
import pytest

from unstruct import Domain, voronoi_segment
from unstruct.examples.running import running_region, running_size
from unstruct.generate.rebay.voronoi_segment import CASES
from unstruct.geometry.segment_tree import SegmentTree
from unstruct.plain import rebay
from unstruct.plain import rebay_step as rs
from unstruct.plain.constrained import is_constrained_delaunay
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import orient

TEN = [(0, 0), (1, -0.1), (2, 0), (2.9, 0.4), (3.2, 1.35), (2.7, 2.2), (1.8, 2.5), (0.8, 2.6), (-0.1, 2.1)]
TEN = [*TEN, (-0.6, 1.1)]
BENT = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (1, 2), (1, 3), (0, 3), (0, 2), (0, 1)]
FRAME = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (3, 3), (2, 3), (1, 3), (0, 3), (0, 2), (0, 1)]
HOLE = [(1.2, 1.2), (1.2, 1.9), (1.9, 1.9), (1.9, 1.2)]


def ring(count, first=0):
    return [(first + k, first + (k + 1) % count) for k in range(count)]


def area(points, cells):
    total = 0.0
    for a, b, c in cells:
        (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
        total += ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
    return total


REGIONS = {
    "ten points": (TEN, ring(10), 1.0),
    "bent": (BENT, ring(12), 0.8),
    "with a hole": (FRAME + HOLE, ring(12) + ring(4, 12), 0.75),
    "long edges": ([(0, 0), (4, 0), (4, 4), (0, 4)], ring(4), 2.0),
}


@pytest.mark.parametrize("name", REGIONS)
def test_every_step(name):
    points, segments, size = REGIONS[name]
    cells, fixed = rebay.start(points, segments)
    whole = area(points, cells)
    count = 0
    for one in rebay.voronoi_segment(points, segments, lambda x: size / sqrt(3)):
        assert one.cavity <= cells and one.waiting in one.cavity and not one.star & cells
        cells = one.cells
        assert isclose(area(one.points, cells), whole, rel_tol=1e-12)
        assert all(orient([one.points[v] for v in cell]) > 0 for cell in cells)
        assert not rebay.is_accepted(one.points, one.waiting, lambda x: size / sqrt(3), 1.35)
        tip = one.points[-1]
        side = hypot(one.step.p, one.step.distance)
        assert all(isclose(dist(one.points[v], tip), side, rel_tol=1e-9) for v in one.edge)
        count += 1
    assert count >= 1 and is_constrained_delaunay(one.points, cells, [tuple(e) for e in fixed])


def test_ten_points_take_four_insertions():
    """The example of the book: a fan at vertex 1, then four points, and all is accepted."""
    made = list(rebay.voronoi_segment(TEN, ring(10), lambda x: 1 / sqrt(3)))
    assert [one.edge for one in made] == [(6, 7), (3, 4), (9, 0), (11, 10)]
    assert [len(one.cavity) for one in made] == [8, 5, 3, 3]
    last = made[-1]
    assert all(rebay.is_accepted(last.points, c, lambda x: 1 / sqrt(3), 1.35) for c in last.cells)


def test_a_point_that_flattens_a_boundary_edge_is_refused():
    """In a flat box the step from the long edge would see the other one under more than 120 degrees."""
    points = [(0, 0), (2, 0), (2, 1.1), (0, 1.1)]
    made = list(rebay.voronoi_segment(points, ring(4), lambda x: 0.8, accept=1.2))
    for one in made:
        for a, b in ring(4):
            assert rebay.angle_at(points[a], points[b], one.points[-1]) < 2 * np.pi / 3


def test_limit_and_nothing_to_do():
    points, segments, size = REGIONS["bent"]
    assert len(list(rebay.voronoi_segment(points, segments, lambda x: size / 3, limit=3))) == 3
    assert list(rebay.voronoi_segment(points, segments, lambda x: 10.0)) == []


# ---- the fast one --------------------------------------------------------------------------------


def replay(domain, size, mesh):
    """Take the steps that the fast one has recorded, plainly; the cells at the end, and the cases seen."""
    sampled = domain.sampled(size)
    points = [tuple(p) for p in sampled.points.tolist()]
    cells, fixed = rebay.start(points, sampled.ends.tolist())
    steps, seen = mesh.steps, 0
    for k, v in enumerate(steps["vertex"].tolist()):
        assert v == len(points)
        x = tuple(steps["point"][k].tolist())
        (a, b), d, c = steps["edge"][k].tolist(), int(steps["waiting"][k]), int(steps["accepted"][k])
        seed = triangle(a, b, d)
        assert seed in cells
        assert (triangle(b, a, c) in cells) if c >= 0 else frozenset((a, b)) in fixed
        got = rs.step(points[a], points[b], points[d], steps["f"][k])
        assert np.allclose(got.point, x, rtol=1e-9, atol=1e-12)
        assert got.beyond == bool(steps["case"][k] & CASES["clamped"])
        gone, rim = rebay.cavity(points, cells, fixed, seed, x)
        points.append(x)
        cells = cells - gone | {triangle(u, w, v) for u, w in rim}
        deleted = not any({a, b} <= set(cell) for cell in cells)
        assert deleted == bool(steps["case"][k] & CASES["deleted"])
        seen |= int(steps["case"][k])
    return points, cells, seen


@pytest.mark.parametrize("size", [0.15, 0.11, running_size], ids=["0.15", "0.11", "running size"])
def test_the_fast_one_takes_the_steps_of_the_plain_one(size):
    scaled = size if isinstance(size, float) else lambda x: 1.6 * size(x)
    domain = Domain(*running_region(scaled))
    mesh = voronoi_segment(domain, scaled, finish=False, history=True, evaluate="middle")
    assert mesh.counts["circumcenters"] == mesh.counts["splits"] == 0
    points, cells, seen = replay(domain, scaled, mesh)
    assert np.array_equal(np.array(points), mesh.points)
    assert cells == {triangle(*t) for t in mesh.simplices.tolist()}
    assert seen & CASES["capped"] and len(points) > 60


def test_plain_and_fast_reach_the_same_quality():
    size = 0.15
    domain = Domain(*running_region(size))
    fast = voronoi_segment(domain, size, finish=False)
    points, segments = running_region(size)
    *_, last = rebay.voronoi_segment(points.tolist(), segments.tolist(), lambda x: size / sqrt(3))
    assert abs(len(last.points) - len(fast.points)) <= 0.06 * len(fast.points)
    radii = [rebay.circumradius(last.points, cell) for cell in last.cells]
    assert np.mean(np.array(radii) < 1.35 * size / sqrt(3)) > 0.97


# ---- the theorem of the book ---------------------------------------------------------------------


@pytest.mark.parametrize("order", ["first", "last"])
@pytest.mark.parametrize("accept", [1.1, 1.2, 1.35, 1.41, 1.5, 1.8])
def test_edges_and_angles_away_from_the_boundary(accept, order):
    """No edge is shorter than m f, m = min(sqrt 2, delta), and no angle less than arcsin(m / 2 delta)."""
    shortest = min(sqrt(2), accept)
    bound = np.degrees(np.arcsin(shortest / (2 * accept)))
    domains = [(Domain(*running_region(h)), h) for h in (0.045, 0.06)] + [(Domain.disc(), 0.08)]
    for domain, h in domains:
        mesh = voronoi_segment(domain, h, accept=accept, finish=False, order=order)
        far = SegmentTree(mesh.points[mesh.boundary]).distance(mesh.points) > 1.2 * h
        ends = mesh.points[mesh.edges[far[mesh.edges].all(axis=1)]]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) * sqrt(3) / h
        assert len(lengths) > 100 and lengths.min() >= shortest * (1 - 1e-12)
        cells = mesh.select(far[mesh.simplices].all(axis=1))
        assert cells.quality("min_angle").min() >= bound * (1 - 1e-12)
