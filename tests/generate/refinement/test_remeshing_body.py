"""refine of meshes of tetrahedra: what they have is kept, and what they lack is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import (
    Domain,
    IncompleteWarning,
    Mesh,
    MeshError,
    check,
    constrained_delaunay,
    refine,
    tetrahedralize,
)
from unstruct.simplex import circumradius

BOX = Domain.box()


@pytest.fixture(scope="module")
def coarse() -> Mesh:
    mesh = tetrahedralize(BOX, 0.5)
    middle = mesh.corners.mean(axis=1)
    return Mesh(
        mesh.points,
        mesh.simplices,
        origin=mesh.origin,
        markers={
            "region": (middle[:, 0] > 0.5).astype(int),
            "load": np.where(middle[:, 1] > 0.5, 2.5, 1.0),
            "corner": np.array([[0], [3]]),
            "wall": mesh.boundary[:5],
            "wire": mesh.edges[:1],
        },
        regions={"left": 0, "right": 1},
    )


def test_everything_is_kept(coarse: Mesh) -> None:
    mesh = refine(coarse, {"left": 0.2, "right": 0.4})
    assert check(mesh) and mesh.size > 5 * coarse.size
    # Diagonals of faces meet at 45 degrees, and flat cells have centers far away.
    assert len(mesh.unrefined) <= 0.03 * mesh.size
    assert {reason.split(":")[0] for reason in mesh.reasons.tolist()} <= {"input angle", "flat"}
    n = len(coarse.points)
    assert np.array_equal(mesh.points[:n], coarse.points)
    assert np.array_equal(mesh.origin[:n], coarse.origin) and (mesh.origin[n:] == -1).all()
    assert mesh.regions == {"left": 0, "right": 1} and mesh.markers["corner"].tolist() == [[0], [3]]
    for name in ("region", "load"):
        for value in np.unique(coarse.markers[name]):
            before = coarse.volumes[coarse.markers[name] == value].sum()
            assert np.isclose(mesh.volumes[mesh.markers[name] == value].sum(), before, rtol=1e-12)
    left = mesh.markers["region"] == 0
    radius = circumradius(mesh.corners) * np.sqrt(2)
    radius[mesh.unrefined] = 0.0
    assert radius[left].max() < 0.2 * (1 + 1e-9) < radius[~left].max() < 0.4 * (1 + 1e-9)

    def area(points: np.ndarray, rows: np.ndarray) -> float:
        x = points[rows]
        return float(np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum() / 2)

    assert np.isclose(area(mesh.points, mesh.markers["wall"]), area(coarse.points, coarse.boundary[:5]))
    assert np.isclose(area(mesh.points, mesh.boundary), 6)
    ends = np.linalg.norm(np.diff(mesh.points[mesh.markers["wire"]], axis=1), axis=2).sum()
    assert np.isclose(ends, np.linalg.norm(np.subtract(*coarse.points[coarse.edges[0]])))
    by_number = refine(coarse, {0: 0.2, "right": 0.4})
    assert np.array_equal(by_number.simplices, mesh.simplices)


def test_a_result_and_a_boundary_that_stays() -> None:
    """Cells of a body with an interface and a wire; and no point where none is allowed."""
    points = np.vstack(
        [BOX.points, [(0.5, 0, 0), (0.5, 1, 0), (0.5, 1, 1), (0.5, 0, 1), (0.1, 0.4, 0.4), (0.3, 0.6, 0.6)]]
    )
    body = Domain(
        points, [list(facet) for facet in BOX.facets], inner=[(8, 9, 10, 11), (12, 13)],
        regions={"a": (0.2, 0.2, 0.2), "b": (0.8, 0.2, 0.2)}, resolve=True,
    )  # fmt: skip
    first = constrained_delaunay(body)
    mesh = refine(first, 0.3)
    assert check(mesh) and mesh.complete and mesh.regions == first.regions
    wire = np.linalg.norm(np.diff(mesh.points[mesh.segments], axis=1), axis=2).sum()
    assert np.isclose(wire, np.sqrt(0.12))
    with pytest.warns(IncompleteWarning):
        kept = refine(first, 0.3, split_boundary=False)
    assert check(kept) and not kept.steiner.size
    assert any("kept" in reason for reason in kept.reasons)


def test_a_mesh_from_a_file(coarse: Mesh, tmp_path: Path) -> None:
    coarse.write(tmp_path / "box.vtu")
    mesh = Mesh.read(tmp_path / "box.vtu")
    fine = refine(mesh, max_volume=2e-3)
    assert check(fine) and fine.complete and fine.volumes.max() <= 2e-3
    assert np.isclose(fine.volumes.sum(), 1.0)


def test_not_delaunay_and_thin() -> None:
    """Cells that are not Delaunay are made so: six around a diagonal of a flat box."""
    corner = np.array([(i & 1, i >> 1 & 1, (i >> 2) * 0.3) for i in range(8)], dtype=float)
    ways = [(1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)]
    mesh = Mesh(corner, [(0, a, b, 7) for a, b in ways]).oriented()
    with pytest.warns(IncompleteWarning, match="input angle"):
        fine = refine(mesh, 0.2)
    assert check(fine) and len(fine.unrefined) < 30 and np.isclose(fine.volumes.sum(), 0.3)


def test_refused(coarse: Mesh) -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (0.3, 0.3, 2)], dtype=float)
    wedge = Mesh(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], dtype=float),
                 cells={"wedge": np.array([[0, 1, 2, 3, 4, 5]])})  # fmt: skip
    for mesh, match in (
        (wedge, "tetrahedra"),
        (Mesh(points, [[0, 1, 2]]), "tetrahedra"),
        (Mesh(points, [[0, 2, 1, 3]]), r"simplices\[0\] .* not positively"),
        (Mesh(points, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]), "more than two|3 cells"),
        (Mesh(points, [[0, 1, 2, 3], [0, 1, 2, 5]]), "overlap|cross"),
        (Mesh(points, [[0, 1, 2, 3]], markers={"wall": [[1, 2, 4]]}), r"markers\['wall'\].*not a face"),
        (Mesh(points, [[0, 1, 2, 3]], markers={"wire": [[1, 4]]}), "not an edge"),
    ):
        with pytest.raises(MeshError, match=match):
            refine(mesh, 0.3)
    with pytest.raises(ValueError, match="min_angle is for the plane"):
        refine(coarse, 0.3, min_angle=20)
    with pytest.raises(ValueError, match="names region"):
        refine(coarse, {"middle": 0.3})
