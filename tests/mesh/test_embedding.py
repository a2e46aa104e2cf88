"""Overlaps, compared with separating planes in integers: a test that uses no adjacency."""

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Mesh
from unstruct.assess.check import check
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.mesh.embedding import crossing_facets


def interiors_meet(s, t):
    """Two simplices (rows of integers) in the plane or in space: no candidate plane separates them.

    For convex polytopes a separating plane, if there is one, is parallel to a facet of one of them, or in
    space to an edge of each.
    """
    d = len(s[0])
    sides = [[[y - x for x, y in zip(a, b)] for a, b in combinations(rows, 2)] for rows in (s, t)]
    if d == 2:
        axes = [(-y, x) for edges in sides for x, y in edges]
    else:
        axes = [cross(u, v) for edges in sides for u, v in combinations(edges, 2)]
        axes += [cross(u, v) for u in sides[0] for v in sides[1]]
    for axis in axes:
        if any(axis):
            one, two = ([sum(a * x for a, x in zip(axis, row)) for row in rows] for rows in (s, t))
            if max(one) <= min(two) or max(two) <= min(one):
                return False
    return True


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def overlapping(mesh):
    cells = [[[int(x) for x in row] for row in corners] for corners in mesh.corners.tolist()]
    return any(interiors_meet(s, t) for s, t in combinations(cells, 2))


def wrapped(seed, d, factor):
    """Random cells of a half annulus (in space: of a half ring), bent round the axis by a factor.

    Bending keeps small cells positive; beyond a factor of 2 it makes the ends run over each other.
    """
    rng = np.random.default_rng(seed)
    n = {2: 28, 3: 24}[d]
    angle, radius = rng.random(n) * np.pi, 1 + rng.random(n)
    height = rng.random((n, d - 2))
    flat = np.column_stack([angle, radius, height])
    mesh = delaunay(flat)
    turned = angle * factor
    points = np.column_stack([radius * np.cos(turned), radius * np.sin(turned), height])
    points = np.rint(points * 2000)
    bent = Mesh(points, mesh.simplices[:, ::-1] if d == 2 else mesh.simplices)
    signs = bent.volumes * (1 if d == 2 else np.sign(np.median(bent.volumes)))
    bent = bent.oriented() if d == 3 and np.median(bent.volumes) < 0 else bent
    return bent.select((signs > 0) & (rng.random(mesh.size) < 0.85))


@pytest.mark.parametrize("d", [2, 3])
def test_bent_meshes_against_separating_planes(d):
    """Whatever `check` lets pass does not overlap; whatever overlaps is reported as such."""
    outcomes = {True: 0, False: 0}
    for seed in range({2: 60, 3: 16}[d]):
        mesh = wrapped(seed, d, 0.6 + 0.05 * (seed % 50 if d == 2 else 3 * seed))
        meets = overlapping(mesh)
        for brute in (False, True):
            report = check(mesh, brute=brute)
            kinds = {problem.kind for problem in report.problems}
            found = bool(kinds & {"crossing", "overlap"})
            assert found == meets, (seed, report)
        outcomes[meets] += 1
    assert min(outcomes.values()) >= 3, outcomes


@pytest.mark.parametrize("d", [2, 3])
def test_two_pieces_against_separating_planes(d):
    rng = np.random.default_rng(d)
    outcomes = {True: 0, False: 0}
    for _ in range({2: 60, 3: 25}[d]):
        one, two = (np.rint(rng.random((d + 3, d)) * 500) for _ in range(2))
        two = two + np.rint(rng.standard_normal(d) * 300)
        parts = delaunay(one), delaunay(two)
        mesh = Mesh(np.vstack([one, two]), np.vstack([parts[0].simplices, parts[1].simplices + len(one)]))
        meets = overlapping(mesh)
        assert bool(check(mesh, brute=False)) is not meets
        assert bool(check(mesh, brute=True)) is not meets
        outcomes[meets] += 1
    assert min(outcomes.values()) >= 3, outcomes


def triangles_meet(s, t, points):
    """Closed triangles in space with no common vertex: no plane separates them strictly (all candidates)."""
    rows = [[[int(x) for x in points[v]] for v in triangle] for triangle in (s, t)]
    sides = [[[y - x for x, y in zip(a, b)] for a, b in combinations(r, 2)] for r in rows]
    normals = [cross(edges[0], edges[1]) for edges in sides]
    axes = normals + [cross(u, v) for u in sides[0] for v in sides[1]]
    axes += [cross(n, u) for n, edges in zip(normals, sides) for u in edges]  # for coplanar ones
    for axis in axes:
        one, two = ([sum(a * x for a, x in zip(axis, row)) for row in r] for r in rows)
        if max(one) < min(two) or max(two) < min(one):
            return False
    return True


def test_triangles_in_space_on_a_small_lattice():
    """Touching, coplanar and piercing triangles with corners in {0, 1, 2}^3."""
    rng = np.random.default_rng(11)
    points = np.array(list(np.ndindex(3, 3, 3)), dtype=float)
    outcomes = {True: 0, False: 0}
    for _ in range(400):
        six = rng.choice(27, 6, replace=False)
        s, t = six[:3], six[3:]
        if any(not np.cross(points[r[1]] - points[r[0]], points[r[2]] - points[r[0]]).any() for r in (s, t)):
            continue
        meets = triangles_meet(s, t, points)
        assert (len(crossing_facets(points, np.array([s, t]))) > 0) == meets, (s, t)
        outcomes[meets] += 1
    assert min(outcomes.values()) >= 50, outcomes


IN_PLANE = [[1, 1, 0], [2, 1, 0], [2, 0, 0], [2, 2, -1], [2, 2, 2]]


@pytest.mark.parametrize(
    ("other", "meets"),
    [
        ((0, 3, 4), False),  # a common corner only
        ((0, 1, 4), False),  # a common edge
        ((0, 1, 5), True),  # a common edge, folded onto each other
        ((0, 5, 6), True),  # a common corner, overlapping in one plane
        ((0, 7, 3), True),  # along a side, from a common corner
        ((0, 8, 9), True),  # piercing, from a common corner
    ],
)
def test_triangles_with_common_corners(other, meets):
    points = np.array(
        [[0, 0, 0], [4, 0, 0], [0, 4, 0], [-1, 0, 3], [0, -1, 3], *IN_PLANE],
        dtype=float,
    )
    found = crossing_facets(points, np.array([(0, 1, 2), other]))
    assert (len(found) > 0) is meets


def meet_in_their_plane(p: list[tuple[int, int]], s: tuple[int, ...], t: tuple[int, ...]) -> bool:
    """Whether two triangles of integer corners meet in more than a common corner or side."""

    def turn(a: int, b: int, c: int) -> int:
        value = (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[b][1] - p[a][1]) * (p[c][0] - p[a][0])
        return (value > 0) - (value < 0)

    def holds(triangle: tuple[int, ...], v: int) -> bool:
        signs = {turn(triangle[k], triangle[k - 2], v) for k in range(3)}
        return not {1, -1} <= signs

    def between(a: int, b: int, c: int) -> bool:
        return turn(a, b, c) == 0 and all(
            min(p[a][i], p[b][i]) <= p[c][i] <= max(p[a][i], p[b][i]) for i in (0, 1)
        )

    if any(v not in t and holds(t, v) for v in s) or any(v not in s and holds(s, v) for v in t):
        return True
    for i, j in product(range(3), repeat=2):
        a, b, c, d = s[i], s[i - 1], t[j], t[j - 1]
        common = {a, b} & {c, d}
        if len(common) == 2:
            continue
        ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
        if any(three[2] not in common and between(*three) for three in ends):
            return True
        if not common and turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
            return True
    return False


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=6, max_size=9, unique=True), st.data()
)
def test_triangles_in_one_plane_of_space(corners: list[tuple[int, int]], data: st.DataObject) -> None:
    """Sides and corners in common, on each other, through each other; the plane in three positions."""
    flat = [
        t
        for t in combinations(range(len(corners)), 3)
        if np.linalg.det([[1, *corners[v]] for v in t]).round() != 0
    ]
    if len(flat) < 2:
        return
    chosen = data.draw(st.lists(st.sampled_from(flat), min_size=2, max_size=8, unique=True))
    wanted = [
        [i, j]
        for i, j in combinations(range(len(chosen)), 2)
        if meet_in_their_plane(corners, chosen[i], chosen[j])
    ]
    x, y = np.array(corners, dtype=float).T
    for points in ((x, y, 0 * x), (x, 0 * x, y), (0 * x, x, y), (x, y, x + 2 * y + 1)):
        assert crossing_facets(np.column_stack(points), np.array(chosen)).tolist() == wanted
