"""What is written: facets point outward, what a format lacks is said, and a failed write changes nothing."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, InputError, Mesh

BOX = Domain.box()


@pytest.mark.parametrize("suffix", [".stl", ".off", ".ply", ".obj"])
def test_facets_point_outward_whichever_way_they_were_turned(tmp_path: Path, suffix: str) -> None:
    ball = Domain.ball(size=0.5)
    rows = np.asarray(ball.facets).copy()
    rows[::3] = rows[::3, ::-1]
    Domain(ball.points, rows).write(tmp_path / f"a{suffix}")
    again = Domain.read(tmp_path / f"a{suffix}")
    signed = np.linalg.det(again.points[np.asarray(again.facets)]).sum() / 6
    assert signed == pytest.approx(ball.volume, rel=1e-12)


def test_polygons_with_holes_become_triangles(tmp_path: Path) -> None:
    frame = Domain.polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 2), (1, 2)]])
    body = Domain.extruded(frame, 1)
    for name in ("a.off", "a.obj", "a.ply", "a.stl", "a.smesh"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            body.write(tmp_path / name)
        again = Domain.read(tmp_path / name)
        assert again.volume == 15.0 and len(again.facets) == (32 if name == "a.stl" else 24)


@pytest.mark.parametrize(
    ("suffix", "told"),
    [
        (".stl", "not written: inner pieces, regions, loose points; .stl does not store them"),
        (".off", "not written: inner pieces, regions, markers; .off"),
        (".ply", "not written: inner pieces, regions, markers; .ply"),
        (".obj", "not written: regions; .obj"),
    ],
)
def test_what_a_format_lacks_is_said(tmp_path: Path, suffix: str, told: str) -> None:
    points = np.vstack([BOX.points, [(0.3, 0.4, 0.5)]])
    body = Domain(points, BOX.facets, inner=[(0, 7)], markers={"a": [0]}, regions={"r": (0.1, 0.5, 0.2)})
    with pytest.warns(UserWarning) as caught:
        body.write(tmp_path / f"a{suffix}")
    assert told in str(caught[0].message) and Path(caught[0].filename).name == "test_writing.py"
    if suffix == ".obj":
        assert Domain.read(tmp_path / "a.obj").inner[0].tolist() == [0, 7]


@pytest.mark.parametrize(
    ("domain", "name", "options", "told"),
    [
        (BOX, "a.vtu", {}, "a body is written as .stl, .off, .ply, .obj, .smesh, .poly, not as '.vtu'"),
        (BOX, "a", {}, "not as ''"),
        (BOX, "a.off", {"binary": True}, ".off has no option 'binary'; it is for .stl and .ply"),
        (BOX, "none/a.off", {}, "there is no folder"),
        (Domain.ball(radius=1e300), "a.stl", {"binary": True}, "too large for binary STL"),
        (Domain.ball((1e6, 0, 0), 0.01), "a.stl", {"binary": True}, "points become equal in binary STL"),
        (Domain(BOX.points, ()), "a.stl", {}, "without facets cannot be written as .stl"),
        (
            Domain.rectangle(),
            "a.stl",
            {},
            r"a planar region is written as .poly, not as '.stl': mesh it, or extrude",
        ),
        (Domain.rectangle(), "a.poly", {"binary": True}, "'binary' is for bodies in space"),
    ],
)
def test_refusals(tmp_path: Path, domain: Domain, name: str, options: dict, told: str) -> None:
    (tmp_path / "a.stl").write_text("old")
    with pytest.raises(InputError, match=told):
        domain.write(tmp_path / name, **options)
    assert (tmp_path / "a.stl").read_text() == "old" and len(list(tmp_path.iterdir())) == 1


def test_empty_bodies(tmp_path: Path) -> None:
    cloud = Domain([(0, 0, 0), (1, 2, 3)], ())
    for name in ("a.off", "a.ply", "a.obj", "a.smesh", "a.poly"):
        cloud.write(tmp_path / name)
        again = Domain.read(tmp_path / name)
        assert np.array_equal(again.points, cloud.points) and len(again.facets) == 0 and again.dimension == 3


def test_other_libraries_read_the_files(tmp_path: Path) -> None:
    """meshio, through `Mesh.read`; and a mesh of a surface becomes the body again, with its names."""
    ball = Domain.ball(size=0.5)
    for name, binary in (
        ("a.stl", None),
        ("b.stl", True),
        ("a.off", None),
        ("a.ply", None),
        ("b.ply", True),
        ("a.obj", None),
    ):
        ball.write(tmp_path / name, binary=binary)
        mesh = Mesh.read(tmp_path / name)
        assert mesh.size == len(ball.facets) and mesh.points.shape[1] == 3
    region = np.arange(80) % 3
    marks = {"north": np.arange(80) < 9, "part": region * 5, "region": region}
    mesh = Mesh(ball.points, ball.facets, markers=marks, regions={"core": 0, "skin": 2})
    for suffix in (".vtu", ".vtk", ".msh"):
        mesh.write(tmp_path / f"a{suffix}")
        again = Domain.read(tmp_path / f"a{suffix}")
        assert again.volume == ball.volume, suffix
        assert again.markers["core"].tolist() == np.flatnonzero(region == 0).tolist(), suffix
        assert again.markers["skin"].tolist() == np.flatnonzero(region == 2).tolist(), suffix
    assert set(Domain.surface(mesh).markers) == {"north", "part 5", "part 10", "core", "region 1", "skin"}
