"""Intrinsic flips against angles, the plane, their plain version, and on surfaces that are hard."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import bipyramid, cylinder, icosphere, random_surface, saddle, torus

from unstruct.base.errors import InputError, MeshError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.surface.intrinsic import IntrinsicTriangulation
from unstruct.examples.running import random_triangulation
from unstruct.mesh.mesh import Mesh
from unstruct.plain.intrinsic_delaunay import following, intrinsic_delaunay


def consistent(found):
    """Twins, lengths and directions fit together, areas are those of the lengths."""
    sides = found.sides
    h = np.arange(len(sides.twin))
    inner = sides.twin >= 0
    g = sides.twin[inner]
    assert (sides.twin[g] == h[inner]).all() and (sides.length[g] == sides.length[inner]).all()
    after = np.where(g % 3 == 2, g - 2, g + 1)
    assert (sides.vertex[after] == sides.vertex[inner]).all()
    a, b, c = (sides.length[k::3] for k in range(3))
    s = (a + b + c) / 2
    area = np.sqrt(np.maximum(s * (s - a) * (s - b) * (s - c), 0.0))
    longest = np.maximum(np.maximum(a, b), c)
    assert (np.abs(area - sides.content / 4) <= 1e-7 * longest**2).all()


def corner_angles(found):
    """(vertex, angle) of all corners, by the law of cosines."""
    sides = found.sides
    h = np.arange(len(sides.twin))
    before, after = np.where(h % 3 == 0, h + 2, h - 1), np.where(h % 3 == 2, h - 2, h + 1)
    left, right, far = sides.length[h], sides.length[before], sides.length[after]
    cosine = (left**2 + right**2 - far**2) / (2 * left * right)
    return sides.vertex, np.arccos(np.clip(cosine, -1, 1))


def around(found, many):
    vertex, angle = corner_angles(found)
    return np.bincount(vertex, angle, many)


def chains(found):
    points, start = found.polylines()
    return [points[a:b] for a, b in pairwise(start)]


def length_of(chain):
    return np.sqrt((np.diff(chain, axis=0) ** 2).sum(axis=1)).sum()


def edge_counts(found):
    """Each edge as its two vertices and its length."""
    sides, edges = found.sides, found.edges
    after = np.where(edges % 3 == 2, edges - 2, edges + 1)
    ends = np.sort(np.stack([sides.vertex[edges], sides.vertex[after]], axis=1), axis=1)
    return Counter((int(a), int(b), f"{x:.7g}") for (a, b), x in zip(ends, found.lengths.ravel()[edges]))


def test_a_planar_mesh_becomes_the_planar_delaunay_mesh():
    for seed in range(5):
        flat = np.random.default_rng(seed).random((60, 2))
        start = random_triangulation(flat, seed)
        turn = np.linalg.qr(np.random.default_rng(seed).random((3, 3)))[0]
        space = np.column_stack([flat, np.zeros(60)]) @ turn
        found = IntrinsicTriangulation(Mesh(space, start.simplices))
        assert found.delaunay() > 0
        rows = {tuple(sorted(row)) for row in found.simplices.tolist()}
        assert rows == {tuple(sorted(row)) for row in delaunay(flat).simplices.tolist()}


@pytest.mark.parametrize(
    "mesh",
    [
        icosphere(3, (1.0, 0.1, 0.05)), torus(40, 12), torus(6, 200), cylinder(60, 3), saddle(12, 4.0),
        bipyramid(9, 30.0, 0.05), bipyramid(3, 200.0, 300.0),
    ],
)  # fmt: skip
def test_legal_straight_and_conserved(mesh):
    found = IntrinsicTriangulation(mesh)
    before, area, energy = around(found, len(mesh.points)), found.areas.sum(), found.energy
    found.delaunay()
    consistent(found)
    assert len(found.illegal()) == 0 and found.counts["held"] == 0
    assert found.areas.sum() == pytest.approx(area, rel=1e-12)
    assert np.allclose(around(found, len(mesh.points)), before, atol=1e-6)
    assert found.energy <= energy
    for edge, chain in zip(found.edges, chains(found)):
        assert length_of(chain) == pytest.approx(found.lengths.ravel()[edge], rel=1e-9)


def test_energy_falls_with_each_flip():
    found = IntrinsicTriangulation(icosphere(2, (1.0, 0.1, 0.02)))
    start = found.energy
    found.delaunay()
    values = [found.replayed(found.flips[:k]).energy for k in range(0, len(found.flips) + 1, 7)]
    assert values[0] == start and (np.diff(values) < 0).all() and len(values) > 20
    again = found.replayed(found.flips)
    assert (again.simplices == found.simplices).all() and (again.lengths == found.lengths).all()


def test_an_edge_may_join_a_vertex_to_itself():
    """Around a sharp tip the shortest edges run around it: from a vertex to the same vertex."""
    loops = 0
    for seed in range(20):
        found = IntrinsicTriangulation(bipyramid(3, 300.0, 400.0, seed))
        found.delaunay()
        consistent(found)
        rows = found.simplices
        loops += (rows == np.roll(rows, 1, axis=1)).any()
        assert len(found.illegal()) == 0
        for edge, chain in zip(found.edges, chains(found)):
            assert length_of(chain) == pytest.approx(found.lengths.ravel()[edge], rel=1e-8)
    assert loops > 0


@given(st.integers(0, 100_000))
@settings(max_examples=60, deadline=None)
def test_random_surfaces_and_the_plain_version(seed):
    mesh = random_surface(seed)
    found = IntrinsicTriangulation(mesh)
    area = found.areas.sum()
    found.delaunay()
    consistent(found)
    assert len(found.illegal()) == 0
    assert found.areas.sum() == pytest.approx(area, rel=1e-9)
    plain, _ = intrinsic_delaunay(mesh.points.tolist(), mesh.simplices.tolist())
    ends = Counter()
    for side, v in plain.vertex.items():
        if side not in plain.twin or side < plain.twin[side]:
            a, b = sorted((v, plain.vertex[following(side)]))
            ends[a, b, f"{plain.length[side]:.7g}"] += 1
    cotangents = found.cotangents()[found.sides.twin[found.edges] >= 0]
    if (np.abs(cotangents) > 1e-7).all():  # without ties there is one such triangulation
        assert sum(ends.values()) == len(found.edges)
        mine = edge_counts(found)
        assert Counter((a, b) for a, b, _ in ends.elements()) == Counter(
            (a, b) for a, b, _ in mine.elements()
        )
        theirs = sorted(float(x) for _, _, x in ends.elements())
        assert np.allclose(theirs, sorted(float(x) for _, _, x in mine.elements()), rtol=1e-5)


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_insertions_lie_on_the_surface(seed):
    mesh, rng = random_surface(seed), np.random.default_rng(seed)
    found = IntrinsicTriangulation(mesh)
    area = found.areas.sum()
    for k in range(30):
        if k % 2:
            found.insert(int(rng.integers(len(found.simplices))), rng.random(3) + 0.05)
        else:
            h = int(rng.integers(found.simplices.size))
            twin = found.sides.twin[h]
            if twin < 0 or twin // 3 != h // 3:
                found.split(h, rng.uniform(0.2, 0.8))
        if k % 5 == 0:
            found.delaunay()
    found.delaunay()
    consistent(found)
    assert found.areas.sum() == pytest.approx(area, rel=1e-9)
    assert len(found.illegal()) == 0
    new = found.origin < 0
    assert (around(found, len(found.origin))[new] <= 2 * np.pi + 1e-6).all()
    size = np.ptp(mesh.points, axis=0).max()
    for edge, chain in zip(found.edges, chains(found)):
        assert abs(length_of(chain) - found.lengths.ravel()[edge]) < 1e-9 * size


def test_kept_edges_stay():
    mesh = icosphere(2, (1.0, 0.1, 0.02))
    kept = mesh.edges[::3]
    found = IntrinsicTriangulation(mesh, kept)
    found.delaunay()
    there = {tuple(sorted(e)) for row in found.simplices.tolist() for e in zip(row, row[1:] + row[:1])}
    assert {tuple(e) for e in kept.tolist()} <= there
    assert len(found.illegal()) == 0 and (found.cotangents() < -1e-9).any()


def test_surfaces_that_are_cut_open():
    """Three squares on one edge; two tetrahedra with a common vertex; a strip with one twist."""
    points = [(0, 0, 0), (0, 0, 1), (1, 0, 0.2), (-1, 1, 0.4), (-1, -1, 0.7)]
    found = IntrinsicTriangulation(Mesh(points, [(0, 1, 2), (0, 1, 3), (1, 0, 4)]))
    assert (found.sides.twin < 0).all() and found.gluing.cut.sum() == 3 and found.delaunay() == 0
    tips = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)], float)
    rows = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    other = [tuple(0 if v == 0 else v + 3 for v in row[::-1]) for row in rows]
    found = IntrinsicTriangulation(Mesh(tips, rows + other))
    assert len(found.origin) == 8 and found.origin[7] == 0 and (found.sides.twin >= 0).all()
    assert np.allclose(around(found, 8)[[0, 7]], 1.5 * np.pi)
    turn, n = np.linspace(0, np.pi, 12, endpoint=False), 12
    middle = np.stack([np.cos(2 * turn), np.sin(2 * turn), 0 * turn], axis=1)
    out = np.stack([np.cos(2 * turn) * np.cos(turn), np.sin(2 * turn) * np.cos(turn), np.sin(turn)], axis=1)
    ring = np.concatenate([middle + 0.4 * out, middle - 0.4 * out])
    rows = []
    for k in range(n):
        a, b = k, k + n
        c, d = (k + 1, k + 1 + n) if k + 1 < n else (n, 0)
        rows += [(a, b, c), (b, d, c)]
    found = IntrinsicTriangulation(Mesh(ring, rows))
    found.delaunay()
    consistent(found)
    assert found.gluing.cut.sum() == 2


def test_nearly_flat_triangles():
    """A corner that is off its opposite edge by 1e-9 of its length, beside good triangles."""
    points = [(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0), (0.5, -1, 0), (0.5, 1, 0.3)]
    rows = [(0, 1, 2), (1, 0, 3), (0, 2, 4), (2, 1, 4)]
    found = IntrinsicTriangulation(Mesh(points, rows))
    assert found.delaunay() >= 1
    consistent(found)
    assert len(found.illegal()) == 0


def test_very_large_and_very_small():
    for factor in (1e-200, 1e200):
        found = IntrinsicTriangulation(
            Mesh(icosphere(1, (1, 0.1, 0.1)).points * factor, icosphere(1).simplices)
        )
        reference = IntrinsicTriangulation(icosphere(1, (1, 0.1, 0.1)))
        assert found.delaunay() == reference.delaunay()
        assert np.allclose(found.lengths / factor, reference.lengths)


def test_errors():
    mesh = icosphere(0)
    with pytest.raises(InputError, match="Mesh of triangles in space"):
        IntrinsicTriangulation(delaunay(np.random.default_rng(0).random((9, 2))))
    with pytest.raises(InputError, match="Mesh of triangles in space"):
        IntrinsicTriangulation(3)
    with pytest.raises(MeshError, match=r"triangle 1 .*flat"):
        IntrinsicTriangulation(Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)], [(0, 1, 2), (0, 3, 1)]))
    far = [v for v in range(1, 12) if [0, v] not in mesh.edges.tolist()]
    with pytest.raises(InputError, match=r"kept\[0\] = .* is no edge"):
        IntrinsicTriangulation(mesh, [(0, far[0])])
    with pytest.raises(InputError, match="pairs"):
        IntrinsicTriangulation(mesh, [0, 1])
    found = IntrinsicTriangulation(cylinder(3, 1))
    with pytest.raises(InputError, match="flips"):
        found.replayed([0.5])
    boundary = int(np.flatnonzero(found.sides.twin < 0)[0])
    with pytest.raises(InputError, match=r"flips\[0\]"):
        found.replayed([boundary])
    with pytest.raises(InputError, match="weights"):
        found.insert(0, [1, 0, 0])
    with pytest.raises(InputError, match="weights differ too much"):
        found.insert(0, [1, 1, 5e-324])
    large, equal = (IntrinsicTriangulation(cylinder(3, 1)) for _ in range(2))
    large.insert(0, [1.7e308] * 3)
    equal.insert(0, [1] * 3)
    assert large.areas == pytest.approx(equal.areas)
    with pytest.raises(InputError, match="not 99"):
        found.insert(99, [1, 1, 1])
    with pytest.raises(InputError, match="part"):
        found.split(0, 1.0)
    with pytest.raises(InputError, match="half-edges"):
        found.split(-1)
    with pytest.raises(InputError, match="half_edges"):
        found.polylines([-1])
