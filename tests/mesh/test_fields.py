"""Solutions beside a mesh: written by `Mesh.write`, read by meshio as they were, or refused by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import Domain, InputError, Mesh, constrained_delaunay, tetrahedralize

meshio = pytest.importorskip("meshio")
MESHES = {
    "triangles": constrained_delaunay(Domain.rectangle(regions={"a": (0.5, 0.5)})),
    "tetrahedra": tetrahedralize(Domain.box(), 0.9),
    "mixed in the plane": planar(4, seed=1),
    "mixed in space": spatial(2),
}
FORMATS = [
    ("a.vtu", {}),
    ("a.vtu", {"binary": False}),
    ("a.vtk", {}),
    ("a.vtk", {"binary": False}),
    ("a.xdmf", {}),
    ("a.xdmf", {"binary": False}),
    ("a.msh", {}),
    ("a.msh", {"version": "4.1", "binary": True}),
]


def fields(many: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(many)
    return {
        "temperature": rng.normal(size=many),
        "flow with <spaces>": rng.normal(size=(many, 3)),
        "pair": rng.normal(size=(many, 2)),
        "stress": rng.normal(size=(many, 9)),
        "short": rng.normal(size=many).astype(np.float32),
        "count": rng.integers(-5, 5, many),
        "flag": rng.random(many) > 0.5,
        "holes": np.where(rng.random(many) > 0.5, np.nan, 1.0),
    }


@pytest.mark.filterwarnings("ignore:(renamed|not written)")
@pytest.mark.parametrize(("name", "options"), FORMATS)
@pytest.mark.parametrize("kind", MESHES)
def test_fields_come_back_through_meshio(
    tmp_path: Path, kind: str, name: str, options: dict[str, Any]
) -> None:
    mesh = MESHES[kind]
    if name == "a.xdmf" and options == {}:
        pytest.importorskip("h5py")
    if "polygon" in mesh.cells and name in ("a.msh", "a.xdmf"):
        kinds = np.repeat(list(mesh.cells), [len(rows) for rows in mesh.cells.values()])
        mesh = mesh.select(kinds != "polygon")
    there, inside = fields(len(mesh.points)), fields(mesh.size)
    mesh.write(tmp_path / name, point_data=there, cell_data=inside, **options)
    theirs = meshio.read(tmp_path / name)
    digits = 1e-11 if name == "a.vtu" and options else 0  # meshio writes so many
    close = np.testing.assert_allclose
    coded = {"flow with <spaces>": "flow with %3Cspaces%3E"}
    for field, values in there.items():
        found = theirs.point_data[coded.get(field, field).replace(" ", "%20" if name == "a.vtk" else " ")]
        wide = np.pad(values, ((0, 0), (0, found.shape[1] - values.shape[1]))) if found.ndim > 1 else values
        close(found, wide, rtol=digits)
    kinds = {kind for kind, rows in mesh.cells.items() if len(rows)}
    for field, values in inside.items():
        blocks = theirs.cell_data[coded.get(field, field).replace(" ", "%20" if name == "a.vtk" else " ")]
        main = [
            (block.type, np.asarray(rows))
            for block, rows in zip(theirs.cells, blocks)
            if (block.type in kinds or block.type.startswith("polygon"))
        ]
        if "polygon" in kinds:  # grouped by their numbers of corners: see below
            assert sum(len(rows) for _, rows in main) == mesh.size
            continue
        found = np.concatenate([rows for _, rows in main])[: mesh.size]
        wide = np.pad(values, ((0, 0), (0, found.shape[1] - values.shape[1]))) if found.ndim > 1 else values
        close(found, wide, rtol=digits)
    again = Mesh.read(tmp_path / name)
    assert list(again.cells) == [k for k in mesh.cells if len(mesh.cells[k])]
    close(again.markers["temperature"], inside["temperature"], rtol=digits)
    assert set(mesh.markers) - {"inner"} <= set(again.markers) | {"region"}


def test_data_of_polygons_are_in_their_order(tmp_path: Path) -> None:
    mesh = planar(4, seed=1)
    mesh.write(tmp_path / "a.vtu", cell_data={"number": np.arange(mesh.size)})
    assert Mesh.read(tmp_path / "a.vtu").markers["number"].tolist() == list(range(mesh.size))


@pytest.mark.parametrize(
    ("what", "values", "told"),
    [
        (
            "point_data",
            {"u": np.zeros(3)},
            r"point_data\['u'\] must have shape \(4,\) or \(4, k\), a row for",
        ),
        ("point_data", {"u": np.zeros(2)}, r"not \(2,\); there are 2 cells: cell_data\?"),
        ("cell_data", {"u": np.zeros(4)}, r"not \(4,\); there are 4 points: point_data\?"),
        ("point_data", {"u": np.zeros((4, 2, 2))}, "write a matrix as one row"),
        ("point_data", {"u": np.zeros((4, 0))}, "must have shape"),
        ("point_data", {"u": [[1], [2, 3], [4], [5]]}, "and no gaps"),
        ("point_data", {"u": np.full(4, 1j)}, r"write \.real and \.imag"),
        ("point_data", {"u": ["a"] * 4}, "must be real numbers"),
        ("point_data", {"u": np.ma.masked_array(np.zeros(4), [0, 1, 0, 0])}, r"\['u'\]\[1\] is masked"),
        ("point_data", {"origin": np.zeros(4)}, "use this name themselves"),
        ("cell_data", {"faces:w": np.zeros(2)}, "use this name themselves"),
        ("cell_data", {"region": np.zeros(2)}, "has a marker of this name"),
        ("cell_data", {None: np.zeros(2)}, "has the name None"),
        ("cell_data", [1, 2], "cell_data must be a dict"),
    ],
)
def test_wrong_fields(tmp_path: Path, what: str, values: Any, told: str) -> None:
    mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], markers={"region": [0, 0]})
    with pytest.raises(InputError, match=told):
        mesh.write(tmp_path / "a.vtu", **{what: values})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.su2", "polyMesh", "a.mesh", "a.node", "a.stl", "a.inp", "a.bdf"])
def test_formats_without_fields(tmp_path: Path, name: str) -> None:
    for what, many in (("point_data", 4), ("cell_data", 2)):
        with pytest.raises(InputError, match=rf"has no option '{what}'; it is for \.vtu, \.vtk, \.xdmf, "):
            MESHES["triangles"].write(tmp_path / name, **{what: {"u": np.zeros(many)}})
    assert not list(tmp_path.iterdir())


def test_rows_that_gmsh_does_not_have(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"point_data\['u'\] has rows of 10 numbers, and \.msh has at most 9"
    ):
        MESHES["triangles"].write(tmp_path / "a.msh", point_data={"u": np.zeros((4, 10))})
