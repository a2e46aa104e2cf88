"""Points in cells of all kinds: against rationals, half-spaces in integers, and the count of cells."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_cells import GOOD, planar, spatial

from unstruct import InputError, Mesh
from unstruct.mesh.split import simplices_of_cells


def in_polygon(corners: list[list[Fraction]], q: list[Fraction]) -> bool:
    """On a side, or an upward ray crosses an odd number of sides; flat polygons contain nothing."""
    sides = list(zip(corners, [*corners[1:], corners[0]]))
    first = corners[0]
    other = next((c for c in corners if c != first), first)

    def side(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    if all(side(first, other, c) == 0 for c in corners):
        return False
    odd = False
    for a, b in sides:
        if side(a, b, q) == 0 and all(min(a[i], b[i]) <= q[i] <= max(a[i], b[i]) for i in (0, 1)):
            return True
        if (a[0] <= q[0]) != (b[0] <= q[0]):
            height = a[1] + (b[1] - a[1]) * (q[0] - a[0]) / (b[0] - a[0])
            odd ^= height > q[1]
    return odd


lattice = st.tuples(st.integers(0, 4), st.integers(0, 4))


@settings(max_examples=200, deadline=None)
@given(
    st.lists(st.lists(lattice, min_size=3, max_size=7), min_size=1, max_size=4),
    st.lists(st.tuples(st.integers(-1, 9), st.integers(-1, 9)), min_size=1, max_size=12),
    st.sampled_from([1.0, 0.1, 1e-200]),
)
def test_any_polygons_on_a_lattice(polygons: list, queries: list, scale: float) -> None:
    """Crossed, folded and flat ones too; queries at half steps, so that most are on sides or corners."""
    points = np.array([p for polygon in polygons for p in polygon], dtype=float) * scale
    start = np.cumsum([0, *map(len, polygons)])
    rows = [np.arange(a, a + len(polygon)) for a, polygon in zip(start, polygons)]
    kinds: dict[str, list] = {
        "polygon": [r for r in rows if len(r) != 4],
        "quad": [r for r in rows if len(r) == 4],
    }
    mesh = Mesh(points, cells={kind: block for kind, block in kinds.items() if block})
    x = np.array(queries) * (scale / 2)
    order = [*kinds["polygon"], *kinds["quad"]]
    exact = [[list(map(Fraction, points[v])) for v in row] for row in order]
    for q, found in zip(x.tolist(), mesh.find_simplex(x).tolist()):
        wanted = [t for t, corners in enumerate(exact) if in_polygon(corners, list(map(Fraction, q)))]
        assert found == (wanted[0] if wanted else -1)


# ---------------------------------------------------------------------- solids


def half_spaces(mesh: Mesh) -> list[np.ndarray]:
    """For each convex cell of integer corners its planes (a, b, c, d), inside where a x + b y + c z >= d."""
    facets = {
        "tetra": [(1, 2, 3), (2, 0, 3), (0, 1, 3), (1, 0, 2)],
        "pyramid": [(0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
        "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4), (1, 2, 5), (2, 0, 3)],
        "hexahedron": [(0, 3, 2), (4, 5, 6), (0, 1, 5), (1, 2, 6), (2, 3, 7), (3, 0, 4)],
    }
    result = []
    for kind, block in mesh.cells.items():
        for row in block:
            x = np.rint(6 * mesh.points[row]).astype(np.int64)
            planes = []
            for i, j, k in facets[kind]:
                normal = np.cross(x[k] - x[i], x[j] - x[i])
                planes.append([*normal, normal @ x[i]])
            result.append(np.array(planes))
    return result


@pytest.mark.parametrize("seed", range(4))
def test_convex_solids_against_half_spaces(seed: int) -> None:
    """A lattice of queries: corners, edges, faces and inner points of cells; the lowest number wins."""
    mesh = spatial(2, seed=seed)
    assert (np.rint(6 * mesh.points) - 6 * mesh.points < 1e-9).all()
    mesh = Mesh(np.rint(6 * mesh.points), cells=mesh.cells)
    planes = half_spaces(Mesh(mesh.points / 6, cells=mesh.cells))
    steps = np.arange(-6, 55, 6)
    x = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    x = np.vstack([x, np.random.default_rng(seed).integers(0, 48, (300, 3)), mesh.points.astype(int)])
    inside = np.array([(x @ p[:, :3].T >= p[:, 3]).all(axis=1) for p in planes])
    wanted = np.where(inside.any(axis=0), inside.argmax(axis=0), -1)
    assert mesh.find_simplex(x.astype(float)).tolist() == wanted.tolist()
    rows, cells = mesh.holding(x.astype(float))
    found = np.zeros_like(inside)
    found[cells, rows] = True
    assert (found == inside).all() and (np.diff(rows) >= 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_cells_with_bent_faces_tile(seed: int) -> None:
    """No point of the cube is in two cells or in none, and the tetrahedra of the cells agree."""
    mesh = spatial(3, jitter=0.15, seed=seed)
    x = np.random.default_rng(seed).uniform(0, 12, (4000, 3))
    rows, cells = mesh.holding(x)
    assert np.bincount(rows, minlength=len(x)).tolist() == [1] * len(x)
    parts, owner = simplices_of_cells(mesh.cells)
    tetra = Mesh(mesh.points, parts)
    assert (tetra.volumes > 0).all() and tetra.neighbors.shape == parts.shape
    assert (owner[tetra.find_simplex(x)] == cells).all()
    assert tetra.volume == pytest.approx(12**3)


def test_corners_of_cells_with_bent_faces() -> None:
    """A corner lies on many cells; the one with the lowest number is returned."""
    mesh = spatial(2, jitter=0.2, seed=1)
    indptr, stars = mesh.stars
    assert mesh.find_simplex(mesh.points).tolist() == stars[indptr[:-1]].tolist()


@pytest.mark.parametrize("kind", ["pyramid", "wedge", "hexahedron"])
def test_orientation_and_scale_do_not_matter(kind: str) -> None:
    corners = np.array(GOOD[kind], dtype=float)
    rows = [list(range(len(corners)))]
    x = np.random.default_rng(0).uniform(-1, 5, (500, 3))
    wanted = Mesh(corners, cells={kind: rows}).find_simplex(x)
    assert 0 < (wanted == 0).sum() < 500
    for factor in (2.0**-1000, 2.0**900):
        assert (Mesh(corners * factor, cells={kind: rows}).find_simplex(x * factor) == wanted).all()
    assert (Mesh(corners * [1, 1, -1], cells={kind: rows}).find_simplex(x * [1, 1, -1]) == wanted).all()


def test_solids_that_are_not_convex_or_flat() -> None:
    """A hexahedron with a dent, which the half-spaces of its faces would not decide."""
    corners = np.array(GOOD["hexahedron"], dtype=float)
    corners[6] = [1, 1, 1]
    mesh = Mesh(corners, cells={"hexahedron": [range(8)]})
    x = np.array([[0.5, 0.5, 0.5], [3.5, 0.1, 0.1], [1.5, 1.5, 1.5], [0.1, 0.1, 3.5], [3, 3, 3]])
    assert mesh.find_simplex(x).tolist() == [0, 0, -1, 0, -1]
    flat = Mesh(np.column_stack([corners[:, :2], np.zeros(8)]), cells={"hexahedron": [range(8)]})
    assert flat.find_simplex([[1.0, 1.0, 0.0]]).tolist() == [-1]


def test_planar_mixtures_tile() -> None:
    for seed in range(4):
        mesh = planar(5, jitter=0.3, seed=seed)
        x = np.random.default_rng(seed).uniform(-0.5, 5.5, (3000, 2))
        rows, _ = mesh.holding(x)
        inside = ((x >= 0) & (x <= 5)).all(axis=1)
        assert np.bincount(rows, minlength=len(x)).tolist() == inside.astype(int).tolist()
        indptr, stars = mesh.stars
        assert mesh.find_simplex(mesh.points).tolist() == stars[indptr[:-1]].tolist()


def test_wrong_queries_are_named() -> None:
    mesh = spatial(2)
    with pytest.raises(InputError, match=r"x\[1\].*not finite"):
        mesh.find_simplex([[0, 0, 0], [np.nan, 0, 0]])
    assert mesh.find_simplex(np.empty((0, 3))).shape == (0,)
    empty = mesh.select(np.zeros(mesh.size, dtype=bool))
    assert empty.find_simplex([[1.0, 1.0, 1.0]]).tolist() == [-1]
