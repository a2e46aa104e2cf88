"""improve: rounder tetrahedra in any mesh, all that is marked is kept, and the worst is no worse."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import cube

from unstruct import Domain, DomainMesh, Mesh, MeshError, check, delaunay, improve, smooth, tetrahedralize


def quality(mesh: Mesh) -> np.ndarray:
    """6 sqrt(2) volume / (mean square edge)^1.5, in plain numpy."""
    corners = mesh.corners
    squares = sum(((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i in range(4) for j in range(i))
    six = np.linalg.det(np.diff(corners, axis=1))
    return np.sqrt(2) * six / (squares / 6) ** 1.5


def test_random_points() -> None:
    mesh = delaunay(np.random.default_rng(0).random((300, 3)))
    better = improve(mesh)
    assert check(better) and better.counts["refills"] and better.counts["moves"]
    assert quality(better).min() >= quality(mesh).min() - 1e-12
    assert np.quantile(quality(better), 0.05) > 2 * np.quantile(quality(mesh), 0.05)
    hull = np.unique(mesh.boundary)
    assert np.array_equal(better.points[hull], mesh.points[hull])
    same = {*map(tuple, np.sort(mesh.boundary, axis=1).tolist())}
    assert same == {*map(tuple, np.sort(better.boundary, axis=1).tolist())}
    again = improve(mesh)
    assert np.array_equal(again.simplices, better.simplices) and np.array_equal(again.points, better.points)


def test_what_is_marked_stays() -> None:
    rng = np.random.default_rng(1)
    plain = delaunay(rng.random((200, 3)))
    side = (plain.corners.mean(axis=1)[:, 0] > 0.5).astype(np.int32)
    material = (plain.corners.mean(axis=1)[:, 1] > 0.6).astype(np.int32)
    cells = rng.choice(plain.size, 12, replace=False)
    markers = {
        "region": side,
        "material": material,
        "faces": plain.simplices[cells[:4], :3],
        "edges": plain.simplices[cells[4:8], :2],
        "vertices": plain.simplices[cells[8:], :1],
    }
    mesh = Mesh(plain.points, plain.simplices, markers=markers)
    better = improve(mesh)
    assert check(better)
    for name in ("faces", "edges", "vertices"):
        rows = markers[name]
        assert np.array_equal(better.markers[name], rows)
        assert np.array_equal(better.points[rows], mesh.points[rows])
        present = [set(cell) for cell in better.simplices.tolist()]
        assert all(any(set(row) <= cell for cell in present) for row in rows.tolist())
    for name in ("region", "material"):
        for value in (0, 1):
            volumes = [
                np.linalg.det(np.diff(m.corners[m.markers[name] == value], axis=1)).sum()
                for m in (mesh, better)
            ]
            assert volumes[0] == pytest.approx(volumes[1])


def test_a_mesh_of_a_body() -> None:
    outer, faces = cube(4)
    domain = Domain(np.vstack([outer, [(2, 2, 1), (2, 2, 2.5)]]), faces, inner=[(len(outer), len(outer) + 1)])
    raw = tetrahedralize(domain, 1.1, optimize=False)
    better = improve(raw)
    assert check(better, domain=domain) and isinstance(better, DomainMesh)
    assert np.array_equal(better.faces, raw.faces) and np.array_equal(better.segments, raw.segments)
    assert better.quality("min_dihedral").min() >= raw.quality("min_dihedral").min()
    same = tetrahedralize(domain, 1.1)
    assert np.array_equal(same.simplices, better.simplices)


def test_refused() -> None:
    mesh = delaunay(np.random.default_rng(0).random((20, 3)))
    with pytest.raises(MeshError, match="smooth is for planar"):
        improve(delaunay(np.random.default_rng(0).random((20, 2))))
    with pytest.raises(MeshError, match="see improve"):
        smooth(mesh)
    turned = mesh.simplices.copy()
    turned[3, :2] = turned[3, 1::-1]
    with pytest.raises(MeshError, match=r"simplices\[3\] is not positively oriented"):
        improve(Mesh(mesh.points, turned))


@settings(deadline=None, max_examples=25)
@given(
    st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=5, max_size=40, unique=True),
    st.integers(-900, 900),
)
def test_lattice_points(points: list, exponent: int) -> None:
    """Many cells of equal quality, flat ones, any scale; the worst never becomes worse."""
    rows = np.array(points, dtype=float)
    if np.linalg.matrix_rank(rows[1:] - rows[0]) < 3:
        return
    mesh = delaunay(np.ldexp(rows, exponent))
    better = improve(mesh)
    report = check(better)
    assert report, report
    one, two = (quality(Mesh(np.ldexp(m.points, -exponent), m.simplices)).min() for m in (mesh, better))
    assert two >= one - 1e-12
