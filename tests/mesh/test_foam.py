"""OpenFOAM's polyMesh, read by a reader of the tests' own: closed cells, order, patches, volumes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import Domain, InputError, Mesh, MeshError, constrained_delaunay, tetrahedralize
from unstruct.mesh.exchange import plain_names


def halves() -> Domain:
    """A box of two regions with a named wall between them."""
    plane = Domain(
        [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)],
        [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)],
        inner=[(1, 4)],
        markers={"in let": [5], "out": [2], "wall": [0, 1, 3, 4], "interface": [6]},
        regions={"left": [(0.5, 0.5)], "right": [(1.5, 0.5)]},
    )
    return Domain.extruded(plane, 1)


def contents(path: Path) -> str:
    text = path.read_text()
    assert text.startswith("FoamFile\n{") and f"object {path.name};" in text
    many, body = re.search(r"\}\n(\d+)\n\(\n(.*)\)\n$", text, re.S).groups()
    return f"{many}\n{body}"


def read(folder: Path) -> tuple[np.ndarray, list[list[int]], np.ndarray, np.ndarray, dict[str, tuple]]:
    many, *rows = contents(folder / "points").splitlines()
    points = np.array([list(map(float, row.strip("()").split())) for row in rows])
    assert len(points) == int(many)
    many, *rows = contents(folder / "faces").splitlines()
    faces = []
    for row in rows:
        size, inner = re.fullmatch(r"(\d+)\((.*)\)", row).groups()
        faces.append(list(map(int, inner.split())))
        assert len(faces[-1]) == int(size)
    assert len(faces) == int(many)
    labels = []
    for name in ("owner", "neighbour"):
        many, *rows = contents(folder / name).splitlines()
        labels.append(np.array(list(map(int, rows)), dtype=int))
        assert len(rows) == int(many)
    boundary = contents(folder / "boundary")
    found = re.findall(r"(\S+)\n    \{\n\s+type (\w+);\n\s+nFaces (\d+);\n\s+startFace (\d+);", boundary)
    assert len(found) == int(boundary.split("\n")[0])
    patches = {name: (kind, int(n), int(start)) for name, kind, n, start in found}
    return points, faces, *labels, patches


def area_vector(x: np.ndarray) -> np.ndarray:
    return sum(np.cross(x[i] - x[0], x[i + 1] - x[0]) for i in range(1, len(x) - 1)) / 2


def zones(folder: Path, name: str) -> dict[str, list[int]]:
    found = re.findall(
        r"(\S+)\n\{\n    type (\w+);\n    \w+Labels List<label>\n"
        r"(\d+)\n\(\n([\d\n]*)\)\n;\n(    flipMap.*\n|)\}\n",
        contents(folder / name),
    )
    assert len(found) == int(contents(folder / name).split("\n")[0])
    for _, kind, many, labels, rest in found:
        assert kind == name[:-1] and int(many) == len(labels.split())
        assert rest == (f"    flipMap List<bool> {many}{{0}};\n" if kind == "faceZone" else "")
    return {zone: [int(word) for word in labels.split()] for zone, _, _, labels, _ in found}


def assert_good(folder: Path, mesh: Mesh, thickness: float = 1.0) -> dict[str, tuple]:
    points, faces, owner, neighbour, patches = read(folder)
    assert len(owner) == len(faces) and (owner[: len(neighbour)] < neighbour).all()
    pairs = list(zip(owner[: len(neighbour)].tolist(), neighbour.tolist()))
    assert pairs == sorted(set(pairs)), "upper triangular order"
    assert set(owner.tolist()) | set(neighbour.tolist()) == set(range(mesh.size))
    closed, volume = np.zeros((mesh.size, 3)), np.zeros(mesh.size)
    edges: dict[tuple[int, int, int], int] = {}
    for f, face in enumerate(faces):
        x = points[face]
        sides = [(owner[f], 1)] + ([(neighbour[f], -1)] if f < len(neighbour) else [])
        for cell, way in sides:
            closed[cell] += way * area_vector(x)
            volume[cell] += way * area_vector(x) @ x.mean(axis=0) / 3
            for a, b in zip(face, face[1:] + face[:1]):
                edges[cell, a, b] = edges.get((cell, a, b), 0) + way
                edges[cell, b, a] = edges.get((cell, b, a), 0) - way
    assert np.abs(closed).max() < 1e-12 and not any(edges.values()), "each cell is closed"
    assert volume == pytest.approx(np.abs(mesh.volumes) * thickness) and (volume > 0).all()
    at = len(neighbour)
    for kind, n, start in patches.values():
        assert start == at and kind in ("patch", "empty")
        at += n
    assert at == len(faces) and ("frontAndBack" in patches) == (mesh.dimension == 2)
    if mesh.dimension == 2:
        assert list(patches)[-1] == "frontAndBack"
        assert patches["frontAndBack"][:2] == ("empty", 2 * mesh.size)
    assert len(np.unique(np.concatenate([np.array(face) for face in faces]))) == len(points)
    return patches


@pytest.mark.parametrize("mesh", [spatial(2), spatial(3, jitter=0.1)], ids=repr)
def test_solid_cells_of_all_kinds(tmp_path: Path, mesh: Mesh) -> None:
    mesh.write(tmp_path / "polyMesh")
    patches = assert_good(tmp_path / "polyMesh", mesh)
    assert patches == {"facets": ("patch", len(mesh.boundary), len(read(tmp_path / "polyMesh")[3]))}


def test_tetrahedra_of_a_body_with_regions(tmp_path: Path) -> None:
    mesh = tetrahedralize(halves(), 0.5)
    with pytest.warns(UserWarning, match="renamed: 'in let' as 'in_let'; names in polyMesh have") as caught:
        mesh.write(tmp_path / "polyMesh")
    assert len(caught) == 1, "nothing else is lost"
    folder = tmp_path / "polyMesh"
    patches = assert_good(folder, mesh)
    assert {name: n for name, (_, n, _) in patches.items()} == {
        name: len(mesh.markers[name.replace("_", " ")]) for name in ("in_let", "out", "wall", "bottom", "top")
    }
    points, faces, owner, neighbour, _ = read(folder)
    assert zones(folder, "cellZones") == {
        name: np.flatnonzero(mesh.markers["region"] == k).tolist() for name, k in mesh.regions.items()
    }
    (wall,) = zones(folder, "faceZones").values()
    region = mesh.markers["region"]
    assert len(wall) == len(mesh.markers["interface"]) > 0
    assert all(f < len(neighbour) and (points[faces[f]][:, 0] == 1).all() for f in wall)
    assert sorted(wall) == np.flatnonzero(region[owner[: len(neighbour)]] != region[neighbour]).tolist()
    constrained_delaunay(Domain.rectangle()).write(folder)
    assert zones(folder, "cellZones") == zones(folder, "faceZones") == {}, "no earlier zone is left"


def test_regions_of_the_plane_are_zones(tmp_path: Path) -> None:
    domain = Domain(
        [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)],
        [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)],
        inner=[(1, 4)],
        markers={"middle": [6]},
        regions={"left": [(0.5, 0.5)]},
    )
    mesh = constrained_delaunay(domain)
    mesh.write(tmp_path / "polyMesh")
    assert_good(tmp_path / "polyMesh", mesh, 0.2)
    assert set(zones(tmp_path / "polyMesh", "cellZones")) == {"left", "region_1"}
    assert [len(rows) for rows in zones(tmp_path / "polyMesh", "faceZones").values()] == [1]


def test_turned_solids_and_bad_ones(tmp_path: Path) -> None:
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [1, 1, 0]]
    turned = Mesh(corners, [[0, 2, 1, 3], [1, 2, 3, 4]])
    turned.write(tmp_path / "polyMesh")
    assert_good(tmp_path / "polyMesh", turned)
    for mesh, told in [
        (Mesh(corners, [[0, 1, 2, 5]]), "cell 0 has no volume"),
        (
            Mesh(corners, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 2, 1, 4]]),
            r"the face \[0, 1, 2\]|\[.*\] belongs to more",
        ),
    ]:
        with pytest.raises(MeshError, match=told):
            mesh.write(tmp_path / "polyMesh")
    with pytest.raises(InputError, match="these cells are solid"):
        turned.write(tmp_path / "polyMesh", thickness=1)
    odd = Mesh(corners, turned.simplices, markers={"value": [0.5, 1], "edge": [[0, 1]]})
    with pytest.warns(UserWarning, match="not written: 'value', 'edge'; polyMesh stores"):
        odd.write(tmp_path / "polyMesh")


@pytest.mark.parametrize("mesh", [planar(4, jitter=0.1, seed=1), planar(6, seed=5)], ids=repr)
def test_mixed_cells(tmp_path: Path, mesh: Mesh) -> None:
    mesh.write(tmp_path / "constant" / "polyMesh", thickness=0.25)
    assert_good(tmp_path / "constant" / "polyMesh", mesh, 0.25)


def test_names_become_patches(tmp_path: Path) -> None:
    domain = Domain.rectangle((0, 0), (2, 1)).with_holes(
        Domain.disc((0.5, 0.5), 0.2, markers={"round wall": [0, 1, 2, 3]}), Domain.disc((1.5, 0.5), 0.2)
    )
    mesh = constrained_delaunay(domain)
    mesh.write(tmp_path / "polyMesh")
    patches = assert_good(tmp_path / "polyMesh", mesh, 0.2)
    sizes = {name: n for name, (_, n, _) in patches.items()}
    assert sizes["bottom"] == len(mesh.markers["bottom"]) and sizes["round_wall"] == len(
        mesh.markers["round wall"]
    )
    rest = len(mesh.boundary) - sum(
        len(mesh.markers[n]) for n in ("bottom", "top", "left", "right", "round wall")
    )
    assert sizes["facets"] == rest > 0


def test_turned_cells_and_unused_vertices(tmp_path: Path) -> None:
    mesh = Mesh([[9, 9], [0, 0], [1, 0], [1, 1], [0, 1]], [[1, 3, 2], [1, 3, 4]])
    mesh.write(tmp_path / "polyMesh", thickness=2)
    assert_good(tmp_path / "polyMesh", mesh, 2)
    assert len(read(tmp_path / "polyMesh")[0]) == 8


def test_what_cannot_be_extruded(tmp_path: Path) -> None:
    folder = tmp_path / "polyMesh"
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    Mesh(square, [[0, 1, 2], [0, 2, 3]]).write(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for mesh, told in [
        (Mesh(square, np.empty((0, 3), dtype=int)), "polyMesh is made of planar meshes"),
        (Mesh(np.eye(3), [[0, 1, 2]]), "polyMesh is made of planar meshes"),
        (Mesh([*square, [2, 0]], [[0, 1, 4], [0, 1, 2]]), "cell 0 has no area"),
        (
            Mesh([*square, [0.5, 2]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
            r"the edge \[0, 1\] belongs to more than two",
        ),
    ]:
        with pytest.raises((InputError, MeshError), match=told):
            mesh.write(folder)
    with pytest.raises(InputError, match="thickness = -1"):
        Mesh(square, [[0, 1, 2]]).write(folder, thickness=-1)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_plain_name_is_never_given_to_another_marker() -> None:
    names = ["inlet 1", "inlet_1", "inlet_1_2", "", "_", "inlet(1)"]
    words = plain_names(names)
    assert list(words) == names and len(set(words.values())) == len(names)
    assert all(words[name] == name for name in ("inlet_1", "inlet_1_2", "_"))
    assert words["inlet 1"] == "inlet_1_3"
