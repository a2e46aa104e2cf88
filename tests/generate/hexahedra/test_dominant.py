"""Hexahedra in a body, and all else up to its surface: valid, conforming, with all names."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers.random_bodies import marched
from tests.helpers.solids import cube, schoenhardt
from tests.helpers.voxels import voxels
from unstruct import Domain, InputError, Mesh, check, octree, quadtree
from unstruct.generate.hexahedra import dominant

UNIT = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
SIDES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def blob(seed: int) -> Domain:
    """A ball with waves, of some hundred triangles."""
    rng = np.random.default_rng(seed)
    x = np.stack(np.meshgrid(*[np.linspace(-1.4, 1.4, 8)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    f = np.linalg.norm(x, axis=1) - 1
    for _ in range(4):
        f = f + 0.1 * np.sin(x @ (rng.normal(size=3) * rng.uniform(1, 5)) + rng.uniform(0, 6))
    return Domain(*marched(8, x, np.where(np.abs(x).max(axis=1) > 1.39, np.abs(f) + 0.05, f)))


def halves(at: float = 0.45) -> Domain:
    """A box of two regions, with names on both ends and on the wall between."""
    points = np.concatenate([UNIT, [[at, 0, 0], [at, 1, 0], [at, 1, 1], [at, 0, 1]]])
    facets = [[0, 8, 9, 3], [8, 1, 2, 9], [4, 11, 10, 7], [11, 5, 6, 10], [0, 8, 11, 4], [8, 1, 5, 11]]
    facets += [[3, 9, 10, 7], [9, 2, 6, 10], [0, 3, 7, 4], [1, 2, 6, 5]]
    return Domain(
        points,
        facets,
        inner=[[8, 9, 10, 11]],
        markers={"left": [8], "wall": [10]},
        regions={"b": [(0.8, 0.5, 0.5)], "a": [(0.2, 0.5, 0.5)]},
    )


def test_ball() -> None:
    body = Domain.ball(size=0.2)
    mesh = octree(body, 0.2).mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert mesh.complete
    assert mesh.figures["share of hexahedra"] > 0.2
    hexahedra = Mesh(mesh.points, None, cells={"hexahedron": mesh.cells["hexahedron"]})
    assert (hexahedra.quality("scaled_jacobian") > 1 - 1e-12).all()
    assert hexahedra.volume / body.volume == pytest.approx(mesh.figures["share of hexahedra"])
    assert Mesh(mesh.points, mesh.cells["tetra"]).quality("min_dihedral").min() > 15
    kept = np.sort(np.asarray(mesh.origin)[mesh.faces], axis=1)
    assert {tuple(row) for row in kept.tolist()} == {tuple(sorted(row)) for row in body.facets.tolist()}
    assert len(mesh.boundary) == len(mesh.faces)
    with pytest.raises(InputError, match="balanced across edges"):
        octree(body, lambda x: 0.05 + 0.5 * np.abs(x[:, 0]), balance=None).mesh("hex-dominant")


def test_same_again() -> None:
    body = Domain.ball(size=0.3)
    one, two = (octree(body, 0.2).mesh("hex-dominant") for _ in range(2))
    assert "hexahedron" in one.cells
    assert np.array_equal(one.points, two.points)
    assert all(np.array_equal(one.cells[kind], two.cells[kind]) for kind in one.cells)


@pytest.mark.parametrize("at", [0.45, 0.5])
def test_names_and_regions(at: float) -> None:
    body = halves(at)
    tree = octree(body, 1 / 16, box=[[0, 0, 0], [1, 1, 1]])  # faces of leaves lie in the sides
    mesh = tree.mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert mesh.regions == {"b": 0, "a": 1}
    volumes = np.bincount(mesh.markers["region"], mesh.volumes)
    assert volumes == pytest.approx([1 - at, at])
    assert np.bincount(mesh.markers["region"][: len(mesh.cells["hexahedron"])]).min() > 0
    assert (mesh.points[mesh.markers["left"]][..., 0] == 0).all()
    assert (mesh.points[mesh.markers["wall"]][..., 0] == at).all()


@pytest.mark.parametrize("suffix", ["vtu", "msh"])
def test_files(suffix: str, tmp_path: Path) -> None:
    body = halves()
    mesh = octree(body, 0.12).mesh("hex-dominant")
    assert {"hexahedron", "pyramid", "tetra"} == set(mesh.cells)
    mesh.write(tmp_path / f"a.{suffix}")
    again = Mesh.read(tmp_path / f"a.{suffix}")
    assert {kind: len(rows) for kind, rows in again.cells.items()} == {
        kind: len(rows) for kind, rows in mesh.cells.items()
    }
    assert check(again, domain=body)


def measured(body: Domain, mesh: Mesh) -> float:
    """The share of cubes of a mesh that is right and complete."""
    assert check(mesh, domain=body)
    assert mesh.complete
    assert mesh.volume == pytest.approx(body.volume, rel=1e-12)
    return mesh.figures["share of hexahedra"]


def test_a_box_in_the_lattice_is_nothing_but_cubes() -> None:
    body = Domain(UNIT, SIDES, markers={"left": [5]})
    tree = octree(body, 1 / 8, box=body.bounds)
    mesh = tree.mesh("hex-dominant")
    assert measured(body, mesh) == 1.0
    assert mesh.size == 512
    assert mesh.markers["left"].shape == (64, 4)
    assert mesh.counts["faces of leaves on facets"] == 384
    assert np.array_equal(np.sort(mesh.origin[mesh.origin >= 0]), np.arange(8))
    assert np.bincount(mesh.face_piece).tolist() == [64] * 6
    assert len(mesh.steiner) == 9**3 - 7**3 - 8
    assert check(tree.mesh("hex-dominant", split_boundary=True), domain=body)
    with pytest.warns(UserWarning, match="all cells are tetrahedra"):
        assert "hexahedron" not in tree.mesh("hex-dominant", split_boundary=False).cells
    graded = octree(body, lambda x: 0.06 + 0.3 * x[:, 0], box=body.bounds).mesh("hex-dominant")
    assert 0.5 < measured(body, graded) < 1.0  # only where levels change there are other cells
    one = octree(body, 2.0, box=body.bounds).mesh("hex-dominant")
    assert one.size == 1


def test_walls_in_the_lattice() -> None:
    body = halves(0.5)
    mesh = octree(body, 1 / 8, box=[[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant")
    assert measured(body, mesh) == 1.0
    assert np.bincount(mesh.markers["region"], mesh.volumes) == pytest.approx([0.5, 0.5])
    assert mesh.markers["wall"].shape == mesh.markers["inner"].shape == (64, 4)
    assert (mesh.points[mesh.markers["wall"]][..., 0] == 0.5).all()
    other = halves(0.45)
    mesh = octree(other, 1 / 16, box=[[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant")
    assert measured(other, mesh) >= 0.75  # up to the sides, but not to the wall


HOLE = [(0.5 + 0.2 * np.cos(t), 0.5 + 0.2 * np.sin(t)) for t in np.linspace(0, 2 * np.pi, 16, endpoint=False)]
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.mark.parametrize(
    ("body", "least"),
    [
        (Domain.extruded(Domain.polygon([(0, 0), (1, 0), (1, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)]), 0.5), 1.0),
        (Domain.extruded(Domain.polygon(SQUARE, holes=[HOLE]), 0.5), 0.7),
        (Domain.extruded(Domain.polygon([(0, 0), (1, 0), (0.7, 1), (0, 1)]), 0.5), 0.75),
        (Domain(UNIT * [0.97, 0.97, 1], SIDES), 0.8),  # two sides between planes, four in them
        (Domain(UNIT * 0.94 + 0.03, SIDES), 0.4),  # all between
    ],
    ids=["L", "hole", "slanted", "two between", "all between"],
)
def test_cubes_reach_sides_in_the_lattice(body: Domain, least: float) -> None:
    tree = octree(body, 1 / 16, box=[[0, 0, 0], [1, 1, 1]])
    mesh = tree.mesh("hex-dominant")
    assert measured(body, mesh) >= least
    again = octree(body, 1 / 16, box=[[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant")
    assert np.array_equal(mesh.points, again.points)


def test_sides_of_triangles_are_reached_when_they_are_polygons() -> None:
    shell = Domain.extruded(Domain.polygon(SQUARE, holes=[HOLE]), 0.5).triangulated
    body = Domain(shell.points, shell.bounding)
    box = [[0, 0, 0], [1, 1, 1]]
    with pytest.warns(UserWarning, match=r"all cells are tetrahedra.*simplified|larger than the leaves"):
        kept = octree(body, 1 / 16, box=box).mesh("hex-dominant")
    assert check(kept, domain=body)
    sides = body.simplified()
    assert measured(sides, octree(sides, 1 / 16, box=box).mesh("hex-dominant")) > 0.7


@pytest.mark.parametrize("suffix", ["vtu", "msh"])
def test_files_of_cubes_at_the_surface(suffix: str, tmp_path: Path) -> None:
    body = Domain.extruded(Domain.polygon(SQUARE, holes=[HOLE]), 0.5, markers={"all": range(18)})
    mesh = octree(body, 1 / 8, box=[[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant")
    assert mesh.markers["all"].shape[1] == 4
    mesh.write(tmp_path / f"a.{suffix}")
    again = Mesh.read(tmp_path / f"a.{suffix}")
    assert check(again, domain=Domain(body.points, body.facets))
    assert pickle.loads(pickle.dumps(mesh)).faces.shape == mesh.faces.shape


@settings(max_examples=25, deadline=None)
@given(
    st.sets(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=7),
    st.sampled_from(["as they are", "sheared", "shorter", "between"]),
    st.sampled_from([0.5, 0.25]),
    st.sampled_from([None, True]),
    st.booleans(),
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_voxels(cells: set, kind: str, size: float, split: bool | None, joined: bool) -> None:
    """Bodies that touch themselves in edges and vertices, with sides in planes of the lattice and without."""
    points, rows = voxels(cells)
    if kind == "sheared":
        top = points[:, 2] == points[:, 2].max()
        points[top, 0] += 0.125
    if kind == "shorter":
        points[:, 1] *= 0.9
    if kind == "between":
        points = 0.93 * points + 0.05
    body = Domain(points, rows)
    body = body.simplified() if joined else body
    mesh = octree(body, size, box=[[0, 0, 0], [4, 4, 4]]).mesh("hex-dominant", split_boundary=split)
    assert check(mesh, domain=body)
    if kind == "as they are" and joined and split:
        bare = all(len(body.pieces.rings(i)[0]) > 3 for i in range(len(body.facets)))
        assert not bare or mesh.figures["share of hexahedra"] == 1.0


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_strips_that_only_touch_the_cubes() -> None:
    """Found by trying: vertices of cubes at which the strip has no face in common with them."""
    cells = {(0, 1, 2), (0, 2, 1), (1, 1, 0), (1, 2, 2), (2, 1, 1), (2, 2, 2)}
    points, rows = voxels(cells)
    points = points / 4 + [0.125, 0, 0.125]
    top = points[:, 2] == points[:, 2].max()
    points[top, 0] += 0.03 * points[top, 2]
    body = Domain(points, rows).simplified()
    tree = octree(body, 1 / 8, box=[[0, 0, 0], [1, 1, 1]], balance="edges")
    assert check(tree.mesh("hex-dominant", split_boundary=True), domain=body)
    cells = {(0, 0, 0), (0, 2, 1), (1, 0, 1), (1, 0, 2), (1, 1, 0), (2, 0, 2), (2, 2, 0)}
    points, rows = voxels(cells)
    body = Domain(points / 4 + [0.125, 0, 0.125], rows).simplified()
    c = np.array([0.43, 0.51, 0.95])
    size = 1 / 16
    tree = octree(body, lambda x: size * 0.6 + 0.3 * np.abs(x - c).max(axis=1), box=[[0, 0, 0], [1, 1, 1]])
    assert check(tree.mesh("hex-dominant"), domain=body)


def test_inner_segments_points_and_cavities() -> None:
    rng = np.random.default_rng(1)
    hole = Domain.ball(center=(0.7, 0.7, 0.7), radius=0.2, size=0.1)
    points = np.concatenate([UNIT, [[0.2, 0.2, 0.2], [0.5, 0.4, 0.3]], rng.uniform(0.1, 0.5, (3, 3))])
    body = Domain(points, SIDES, inner=[[8, 9]], markers={"rod": [6]}).with_holes(hole)
    mesh = octree(body, 0.07).mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert len(mesh.cells["hexahedron"]) > 100
    assert mesh.markers["rod"].shape[1] == 2
    assert mesh.volume == pytest.approx(body.volume, rel=1e-12)


@pytest.mark.parametrize("step", [[1, 1, 0], [1, 1, 1]])
def test_bodies_that_touch(step: list[int]) -> None:
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    body = Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])])
    mesh = octree(body, 0.12).mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert "hexahedron" in mesh.cells


def test_shells_within_shells() -> None:
    shells = [Domain.ball(radius=r, size=0.4 * r) for r in (1.0, 0.65, 0.35)]
    start = np.cumsum([0, *(len(shell.points) for shell in shells)])
    body = Domain(
        np.concatenate([shell.points for shell in shells]),
        np.concatenate([np.asarray(shell.facets) + k for shell, k in zip(shells, start, strict=False)]),
    )
    with pytest.warns(UserWarning, match="all cells are tetrahedra|split_boundary=True divides it"):
        mesh = octree(body, 0.13).mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert len(np.unique(mesh.markers["region"])) == 2


@pytest.mark.parametrize("surface", [schoenhardt(), cube(1)])
@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_large_facets(surface: tuple[np.ndarray, np.ndarray]) -> None:
    body = Domain(*surface)
    tree = octree(body, (body.bounds[1] - body.bounds[0]).max() / 8)
    with pytest.warns(UserWarning, match="all cells are tetrahedra"):
        mesh = tree.mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert not mesh.complete
    divided = tree.mesh("hex-dominant", split_boundary=True)
    assert check(divided, domain=body)
    assert divided.complete
    assert "hexahedron" in divided.cells


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_thin_and_coarse() -> None:
    plate = Domain.box((0, 0, 0), (1, 1, 0.04))
    for tree in (octree(plate, 0.1), octree(plate, max_level=0), octree(Domain.ball(size=0.4), 3.0)):
        mesh = tree.mesh("hex-dominant")
        assert list(mesh.cells) == ["tetra"]
        assert mesh.figures["share of hexahedra"] == 0
        assert check(mesh, domain=tree.domain)


def test_graded() -> None:
    body = Domain.ball(size=0.3)
    for tree in (
        octree(body, lambda x: 0.1 + 0.2 * np.abs(x[:, 0])),
        octree(body, lambda x: 0.1 + 0.15 * np.abs(x[:, 2]), balance="edges"),
    ):
        mesh = tree.mesh("hex-dominant", split_boundary=False)
        assert check(mesh, domain=body)
        low, high = mesh.points[mesh.cells["hexahedron"][:, [0, 6]]].transpose(1, 0, 2)
        assert len(np.unique(np.round((high - low)[:, 0], 9))) > 1


def test_scaled_and_moved() -> None:
    body = Domain(1e3 + 1e-3 * UNIT, SIDES)
    mesh = octree(body, 1.5e-4).mesh("hex-dominant")
    assert check(mesh, domain=body)
    assert "hexahedron" in mesh.cells


@settings(max_examples=2, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([7, 8]), st.sampled_from(["edges", "corners"]))
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_random_bodies(seed: int, parts: int, balance: str) -> None:
    body = blob(seed)
    tree = octree(body, (body.bounds[1] - body.bounds[0]).max() / parts, balance=balance)
    mesh = tree.mesh("hex-dominant")
    assert check(mesh, domain=body)


@settings(max_examples=10, deadline=None)
@given(st.lists(st.tuples(*[st.integers(0, 5)] * 3), min_size=2, max_size=2, unique=True), st.integers(0, 9))
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_random_boxes(ends: list[tuple[int, int, int]], seed: int) -> None:
    """Boxes whose sides lie in faces of leaves, or do not."""
    low, high = np.minimum(*map(np.array, ends)), np.maximum(*map(np.array, ends))
    if (low == high).any():
        return
    body = Domain(low + UNIT * (high - low), SIDES)
    box = [[0, 0, 0], [8, 8, 8]] if seed % 2 else None
    mesh = octree(body, [1.0, 0.5, 0.7][seed % 3], box=box).mesh("hex-dominant")
    assert check(mesh, domain=body)


def test_farther_leaves_where_the_strip_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    class Fails:
        keeps_kernel = False

        def __init__(self, strip: object):
            self.strip = strip

        def __getattr__(self, name: str) -> object:
            return getattr(self.strip, name)

    def strip_of(*given: object) -> object:
        tried.append(given)
        return Fails(real(*given))

    real = dominant.strip_of
    monkeypatch.setattr(dominant, "strip_of", strip_of)
    body = Domain.ball(size=0.4)
    with pytest.warns(UserWarning, match="all cells are tetrahedra"):
        mesh = octree(body, 0.2).mesh("hex-dominant")
    assert len(tried) == 1 + len(dominant.MARGINS)
    assert list(mesh.cells) == ["tetra"]
    assert check(mesh, domain=body)


def test_refused() -> None:
    with pytest.raises(InputError, match="octrees; this is a quadtree"):
        quadtree([[0, 0], [1, 1]], 0.3).mesh("hex-dominant")
    with pytest.raises(InputError, match="split_boundary goes with"):
        octree([[0, 0, 0], [1, 1, 1]]).mesh("cells", split_boundary=True)
    with pytest.raises(InputError, match="split_boundary must be"):
        octree([[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant", split_boundary="yes")  # type: ignore[arg-type]
    one = Domain(UNIT, SIDES, regions={"a": [(0.2, 0.5, 0.5)], "b": [(0.8, 0.1, 0.5)]})
    for kind in ("hex-dominant", "hexahedra", "cut"):
        with pytest.raises(InputError, match="region 'b' is in the same part as one of 'a'"):
            octree(one, 0.12).mesh(kind)
