"""Meshes of bodies from files: their faces are found on the pieces again, and checked as strictly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, Mesh, check, constrained_delaunay, tetrahedralize
from unstruct.assess.held import with_pieces
from unstruct.mesh.domain_mesh import DomainMesh

PLANE = Domain.rectangle((0, 0), (2, 1), inner=[(0, 2)], markers={"seam": [4]}, regions={"a": (1.5, 0.5)})
INNER = [[8, 9, 10, 11], [12, 13]]
MORE = [
    (0.25, 0.25, 0.5),
    (0.75, 0.25, 0.5),
    (0.75, 0.75, 0.5),
    (0.25, 0.75, 0.5),
    (0.1, 0.1, 0.1),
    (0.2, 0.3, 0.2),
]
BOX = Domain.box()
BODIES = {
    "box": BOX,
    "ball": Domain.ball(size=0.5),
    "turned": Domain(
        BOX.points @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0], BOX.facets
    ),
    "two regions": Domain.extruded(PLANE, 1.0),
    "inner": Domain([*BOX.points.tolist(), *MORE], [*BOX.facets], inner=INNER, markers={"sheet": [6]}),
}  # fmt: skip


def bare(mesh: Mesh) -> Mesh:
    """What a file keeps."""
    return Mesh(mesh.points, mesh.simplices, markers=mesh.markers, regions=mesh.regions)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("size", [None, 0.4])
def test_the_record_is_found_again(name: str, size: float | None) -> None:
    body = BODIES[name]
    mesh = constrained_delaunay(body) if size is None else tetrahedralize(body, size, split_boundary=True)
    assert check(mesh, domain=body)
    report = check(bare(mesh), domain=body)
    assert report, report
    again = with_pieces(bare(mesh), body)
    assert isinstance(again, DomainMesh)

    def record(mesh: DomainMesh) -> set[tuple[int, ...]]:
        return {(*sorted(row), p) for row, p in zip(mesh.faces.tolist(), mesh.face_piece.tolist())}

    assert record(again) == record(mesh)
    assert sorted(map(sorted, again.segments.tolist())) == sorted(map(sorted, mesh.segments.tolist()))
    assert {(v, o) for v, o in enumerate(again.origin) if o >= 0} <= set(enumerate(mesh.origin.tolist()))


def test_what_is_wrong_is_named() -> None:
    body = BODIES["box"]
    mesh = tetrahedralize(body, 0.5)
    lost = bare(mesh).select(np.arange(mesh.size) > 0)
    assert not check(lost, domain=body)
    points = np.array(mesh.points)
    new = int(np.flatnonzero((mesh.origin < 0) & (points[:, 0] == 1))[0])
    points[new, 0] -= 1e-6
    moved = Mesh(points, mesh.simplices, markers=mesh.markers)
    assert "the mesh ends at faces that are on no facet" in str(check(moved, domain=body))
    assert not check(bare(mesh), domain=Domain.ball(size=0.5))
    flat = constrained_delaunay(Domain.rectangle())
    assert "not tetrahedra" in str(check(flat, domain=body))


def test_through_a_file(tmp_path: Path) -> None:
    body = BODIES["two regions"]
    mesh = tetrahedralize(body, 0.4)
    mesh.write(tmp_path / "a.msh")
    assert check(Mesh.read(tmp_path / "a.msh"), domain=body)
