"""Random values over random graded trees: are all pieces there, and when is the surface a disc?"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest

from tests.helpers.value_tables import assert_sound
from unstruct import DomainMesh, octree
from unstruct.generate.stuffing.background import background_tetrahedra
from unstruct.generate.stuffing.ending import boundary_faces, overlapping_cells
from unstruct.generate.stuffing.filling import Filling, filled_background, lattice_vertices
from unstruct.generate.stuffing.raising import State, is_disc, room_of
from unstruct.generate.stuffing.rounds_of_raising import Background, stars_at
from unstruct.generate.stuffing.warping import Edges

pytestmark = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")


class Rough(NamedTuple):
    """A random tree with random signs, all of its tetrahedra, and where edges are cut."""

    background: Background
    every: np.ndarray
    shares: np.ndarray


def rough(seed: int, inside: float = 0.5, zero: float = 0.05) -> Rough:
    """Nothing is inside at the sides of the root."""
    rng = np.random.default_rng(seed)
    tree = octree([(0,) * 3, (1,) * 3], points=rng.random((60, 3)) ** 2, max_level=5, balance="edges")
    points, place, vertices = lattice_vertices(tree.grid)
    most = 2 << tree.depth
    draw = rng.random(len(points))
    sign = np.where(draw < inside, 1, np.where(draw < inside + zero, 0, -1)).astype(np.int8)
    sign[((place == 0) | (place == most)).any(axis=1)] = -1
    every = background_tetrahedra(tree.grid, vertices.corners, np.ones(len(points), dtype=np.int8))
    cells = background_tetrahedra(tree.grid, vertices.corners, sign)
    background = Background(points, place, sign, cells, tree.grid, vertices.corners)
    return Rough(background, every, rng.random(len(points)))


def fill(given: Rough) -> Filling:
    """Edges are cut at shares that hang on both ends."""

    def shares(edges: Edges) -> np.ndarray:
        return (given.shares[edges.inner] + 7.3 * given.shares[edges.outer]) % 1.0

    return filled_background(given.background, shares)


def det(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


@pytest.mark.parametrize("seed", range(10))
def test_all_pieces_are_there(seed: int) -> None:
    given = rough(seed)
    background, sign = given.background, given.background.sign
    wanted = given.every[(sign[given.every] > 0).any(axis=1)]
    assert {frozenset(t) for t in background.cells.tolist()} == {frozenset(t) for t in wanted.tolist()}

    filling = fill(given)
    mesh = DomainMesh(filling.points, filling.cells)
    assert_sound(mesh)
    faces, _ = boundary_faces(filling.cells, np.ones(len(filling.points), dtype=bool))
    assert filling.on_surface[faces].all()
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    beside = np.unique(ends, axis=0, return_counts=True)[1]
    assert (beside % 2 == 0).all()  # 2 of them, or more where the boundary touches itself
    assert (beside == 2).mean() > 0.5

    x = [[Fraction(c) for c in p] for p in filling.points.tolist()]
    enclosed = sum(det(*(x[v] for v in face)) for face in faces.tolist())
    inside = Fraction(0)
    for a, b, c, d in filling.cells.tolist():
        inside += det(*([p - q for p, q in zip(x[v], x[a], strict=True)] for v in (b, c, d)))
    assert abs(enclosed) == inside > 0


@pytest.mark.parametrize("seed", range(5))
def test_pieces_are_apart(seed: int) -> None:
    """The middle of a cell lies in no other one, unless that is told."""
    filling = fill(rough(seed, 0.3))
    cells, points = filling.cells, filling.points
    told = np.unique(cells[overlapping_cells(points, cells, filling.on_surface)])
    origin, frames = points[cells[:, 0]], points[cells[:, 1:]] - points[cells[:, :1]]
    inverse = np.linalg.inv(frames)
    for row in range(0, len(cells), 17):
        if np.isin(cells[row], told).any():
            continue
        x = points[cells[row]].mean(axis=0)
        weight = np.einsum("na,nab->nb", x - origin, inverse)
        within = (weight.min(axis=1) > 1e-9) & (weight.sum(axis=1) < 1 - 1e-9)
        assert np.flatnonzero(within).tolist() == [row]


def a_disc(sign: np.ndarray, faces: list[tuple[int, int, int]]) -> bool:
    """Whether, on a sphere of triangles with signs, one simple curve divides what is inside from the rest.

    What is inside is connected, so is what is outside, and both are there; and each vertex with sign 0 has
    an arc of neighbors inside, and an arc of neighbors outside, and nothing else between these but single
    vertices with sign 0.
    """
    around: dict[int, dict[int, int]] = {}
    for face in faces:
        for k in range(3):
            around.setdefault(face[k], {})[face[(k + 1) % 3]] = face[(k + 2) % 3]
    for side in (1, -1):
        rest = {v for v in around if sign[v] == side}
        if not rest:
            return False
        reached = [rest.pop()]
        while reached:
            for w in around[reached.pop()]:
                if w in rest:
                    rest.remove(w)
                    reached.append(w)
        if rest:
            return False
    for v, after in around.items():
        if sign[v]:
            continue
        w = first = next(iter(after))
        ring = []
        while not ring or w != first:
            ring.append(int(sign[w]))
            w = after[w]
        if 0 in ring:
            k = ring.index(0)
            ring = ring[k:] + ring[:k]
        if any(one == other == 0 for one, other in zip(ring, [*ring[1:], ring[0]], strict=True)):
            return False
        runs = [s for k, s in enumerate(ring) if s != ring[k - 1]]
        if [s for s in runs if s] not in ([1, -1], [-1, 1]):
            return False
    return True


@pytest.mark.parametrize("seed", range(8))
def test_where_the_surface_is_a_disc(seed: int) -> None:
    """Against connected sets of vertices on the sphere around; no piece is looked at."""
    given = rough(seed, inside=(0.5, 0.15, 0.8)[seed % 3], zero=(0.1, 0.02)[seed % 2])
    background = given.background
    n, sign = len(background.points), background.sign.copy()
    inner = ((background.place > 0) & (background.place < 2 << background.grid.depth)).all(axis=1)
    vertices = np.flatnonzero(inner & (sign != 0))[::3]
    stars = stars_at(background, vertices)
    pairs = np.sort(stars.cells[:, [0, 0, 0, 1, 1, 2, 1, 2, 3, 2, 3, 3]].reshape(-1, 2, 6), axis=1)
    low, high = pairs[:, 0].ravel().astype(np.int64), pairs[:, 1].ravel()
    keys = np.unique(low * n + high)
    place = background.place
    state = State(np.empty((n, 3)), np.empty((n, 3)), background.points, place, sign, sign, keys, np.ones(n))
    room, found = room_of(stars), [0, 0]
    for v in vertices.tolist():
        faces = []
        for t in stars.cells[stars.rows[stars.start[v] : stars.start[v + 1]]].tolist():
            k = t.index(v)
            a, b, c = t[:k] + t[k + 1 :]
            faces.append((a, b, c) if k % 2 else (a, c, b))
        expected = a_disc(sign, faces)
        found[expected] += 1
        assert bool(is_disc(state, stars, v, room)) == expected, v
    assert min(found) > 0
