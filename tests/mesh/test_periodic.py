"""Matching sides of meshes: checked, handed on, in Gmsh's files and back; others name what they drop."""

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
from regions import sector

import unstruct
from unstruct import Domain, InputError, Mesh
from unstruct.geometry.motion import Motion
from unstruct.mesh.periodic import facet_images

FORMS = [(version, binary) for version in ("2.2", "4.1") for binary in (False, True)]
RIGHT = Motion.translation([1.0, 0.0])


def square(size: float = 0.3) -> Mesh:
    return unstruct.refine(Domain.rectangle().matched("left", "right").matched("bottom", "top"), size)


def turned(parts: int = 7, center=(0.0, 0.0)) -> Mesh:
    domain = sector(parts, center).matched("low", "high", rotation=360 / parts, center=center)
    return unstruct.refine(domain, 0.2)


def same(one: Mesh, two: Mesh) -> bool:
    return len(one.periodic) == len(two.periodic) and all(
        (a.motion is None) == (b.motion is None)
        and (a.motion is None or np.array_equal(a.motion.affine(), b.motion.affine()))
        and np.array_equal(a.pairs, b.pairs)
        for a, b in zip(one.periodic, two.periodic)
    )


@pytest.mark.parametrize(
    "rows", [[[0, 0]], [[0, 3], [0, 2]], [[0, 4]], [[-1, 0]], [[0.5, 1]], [0, 1], [[0, 1, 2]]], ids=str
)
def test_wrong_pairs_are_refused(rows):
    with pytest.raises(InputError, match=r"periodic\[0\]"):
        Mesh([(0, 0), (1, 0), (1, 1), (0, 1)], [[0, 1, 2]], periodic=[(RIGHT, rows)])


def test_wrong_motions_are_refused():
    for motion in ("right", Motion.translation([1, 0, 0])):
        with pytest.raises(InputError, match="needs a Motion in 2 dimensions or None"):
            Mesh([(0, 0), (1, 0), (0, 1)], [[0, 1, 2]], periodic=[(motion, [[0, 1]])])


def test_pairs_of_several_motions_are_joined_and_handed_on():
    mesh = square()
    assert [str(motion) for motion, _ in mesh.periodic] == ["moved by (1, 0)", "moved by (0, 1)"]
    assert len(mesh.pairs) == sum(len(pairs) for _, pairs in mesh.periodic) == 8
    for other in (mesh.oriented(), unstruct.smooth(mesh), pickle.loads(pickle.dumps(mesh)),
                  unstruct.swap_diagonals(mesh)):  # fmt: skip
        assert same(mesh, other)
    assert (
        Mesh(mesh.points, mesh.simplices).periodic == () and len(Mesh(mesh.points, mesh.simplices).pairs) == 0
    )


def test_selected_cells_keep_pairs_that_remain_and_weights():
    mesh = square(0.1)
    low = mesh.select(mesh.corners[..., 1].mean(axis=1) < 0.5)
    ((motion, pairs),) = low.periodic  # nothing is left of bottom and top
    assert np.array_equal(low.points[pairs[:, 1]], motion(low.points[pairs[:, 0]])) and len(pairs) > 3
    assert set(map(tuple, low.origin[pairs].tolist())) <= set(map(tuple, mesh.origin[mesh.pairs].tolist()))
    rng = np.random.default_rng(0)
    heavy = unstruct.delaunay(rng.random((60, 2)), weights=0.05 * rng.random(60))
    part = heavy.select(np.arange(5))
    assert np.array_equal(part.weights, heavy.weights[part.origin]) and len(heavy.hidden) > 0


def test_images_of_facets():
    # a strip of three squares: edges 0-1, 2-3, 4-5, 6-7 from left to right, all images of the one before
    facets = np.array([[0, 1], [3, 2], [4, 5], [6, 7], [0, 2], [1, 3]], dtype=np.int32)
    pairs = np.array([[0, 2], [1, 3], [2, 4], [3, 5]])
    assert [rows.tolist() for rows in facet_images(pairs, facets, 8)] == [[0, 1], [1, 2]]
    assert [len(rows) for rows in facet_images(pairs[:1], facets, 8)] == [0, 0]
    assert [len(rows) for rows in facet_images(np.array([[0, 1], [1, 0]]), facets, 8)] == [0, 0]


# ---------------------------------------------------------------------- files


@pytest.mark.parametrize(("version", "binary"), FORMS)
def test_files_of_gmsh_keep_pairs_and_motions(tmp_path: Path, version: str, binary: bool):
    path = tmp_path / "mesh.msh"
    for mesh in (square(), turned(), turned(5, (3.3, -2.1))):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            mesh.write(path, version=version, binary=binary)
            again = Mesh.read(path)
        assert same(mesh, again) and sorted(again.markers) == sorted(mesh.markers)
        bare = Mesh(mesh.points, mesh.simplices, periodic=[*mesh.periodic, (None, [[0, 1]])])  # no elements
        bare.write(path, version=version, binary=binary)
        assert same(bare, Mesh.read(path))


def test_gmsh_reads_the_pairs(tmp_path: Path):
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Verbosity", 0)
        gmsh.option.setNumber("Mesh.SaveAll", 1)
        for mesh in (square(), turned()):
            for binary in (False, True):
                mesh.write(tmp_path / "ours.msh", version="4.1", binary=binary)
                gmsh.clear()
                gmsh.merge(str(tmp_path / "ours.msh"))
                found = set()
                for _, tag in gmsh.model.getEntities(1):
                    _, images, nodes, _ = gmsh.model.mesh.getPeriodicNodes(1, tag)
                    found |= set(zip((nodes - 1).tolist(), (images - 1).tolist()))
                assert sorted(found) == list(map(tuple, mesh.pairs.tolist()))
                gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
                gmsh.write(str(tmp_path / "theirs.msh"))
                again = Mesh.read(tmp_path / "theirs.msh")
                assert len(again.pairs) == len(mesh.pairs)
                for motion, pairs in again.periodic:
                    assert np.abs(motion(again.points[pairs[:, 0]]) - again.points[pairs[:, 1]]).max() < 1e-12
    finally:
        gmsh.finalize()


OLD = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 2 2 0 1 1 2 3
2 2 2 0 1 1 3 4
$EndElements
$Periodic
2
0 2 1
1
2 1
1 2 4
{affine}
2
2 1
{last}
$EndPeriodic
"""


def test_links_of_version_two_and_their_faults(tmp_path: Path):
    path = tmp_path / "old.msh"
    path.write_text(OLD.format(affine="Affine 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1", last="3 4"))
    mesh = Mesh.read(path)
    assert mesh.pairs.tolist() == [[0, 1], [3, 2]] and [motion for motion, _ in mesh.periodic] == [
        None,
        RIGHT,
    ]
    for last, affine, message in (
        ("3", "Affine 1", "Periodic"), ("3 x", "", "Periodic"), ("3 9", "", "there is no node 9"),
    ):  # fmt: skip
        path.write_text(OLD.format(affine=affine, last=last))
        with pytest.raises(InputError, match=message):
            Mesh.read(path)


SECOND = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
9
1 0 0 0
2 .5 0 0
3 1 0 0
4 1 .5 0
5 1 1 0
6 .5 1 0
7 0 1 0
8 0 .5 0
9 .5 .5 0
$EndNodes
$Elements
2
1 9 2 0 1 1 3 5 2 4 9
2 9 2 0 1 1 5 7 9 6 8
$EndElements
$Periodic
1
1 2 4
Affine 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1
3
3 1
5 7
4 8
$EndPeriodic
"""


@pytest.mark.filterwarnings("ignore:.*second or higher order")
def test_pairs_of_cells_of_second_order(tmp_path: Path):
    (tmp_path / "second.msh").write_text(SECOND)
    mesh = Mesh.read(tmp_path / "second.msh")
    assert mesh.points[mesh.pairs].tolist() == [[[0, 0], [1, 0]], [[0, 1], [1, 1]]]


@pytest.mark.filterwarnings("ignore:not written")
@pytest.mark.parametrize("name", ["a.vtu", "a.su2", "a.node", "polyMesh"])
def test_other_formats_say_that_they_drop_pairs_and_weights(tmp_path: Path, name: str):
    if name.endswith("vtu"):
        pytest.importorskip("meshio")
    with pytest.warns(UserWarning, match="not written: 'periodic'"):
        square().write(tmp_path / name)
    rng = np.random.default_rng(0)
    heavy = unstruct.delaunay(rng.random((30, 2)), weights=0.01 * rng.random(30))
    for other in (name, "a.msh"):
        with pytest.warns(UserWarning, match="not written: 'weights'"):
            heavy.write(tmp_path / other)
