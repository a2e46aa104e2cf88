"""Meshes joined at common vertices: mixed cells, names, regions; layers over bodies, and what is beyond."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_cells import planar, spatial

from unstruct import (
    Domain,
    InputError,
    Layers,
    Mesh,
    MeshError,
    advancing_layers,
    check,
    delaunay,
    join,
    tetrahedralize,
)


def keys(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(v for v in row if v >= 0) for row in rows.tolist()}


def places(mesh: Mesh) -> list[list[tuple[float, ...]]]:
    return sorted(
        sorted(map(tuple, mesh.points[row].tolist())) for block in mesh.cells.values() for row in block
    )


def wedges(body: Domain | Mesh, height: float, count: int = 3) -> Mesh:
    """Layers over a star-shaped body: each vertex moves away from the origin, ever faster."""
    surface = body.triangulated if isinstance(body, Domain) else body
    down = surface.triangles if isinstance(body, Domain) else body.simplices
    n = len(surface.points)
    levels = 1 + height * np.cumsum(1.3 ** np.arange(count)) / np.sum(1.3 ** np.arange(count))
    points = np.concatenate([surface.points * level for level in (1.0, *levels)])
    cells = np.concatenate([np.hstack([down + k * n, down + (k + 1) * n]) for k in range(count)])
    mesh = Mesh(points, cells={"wedge": cells}).oriented()
    cap = down + count * n
    layer = np.repeat(np.arange(count), len(down))
    ends = {"wall": down, "cap": cap, "facets": np.concatenate([down, cap])}
    return Mesh(mesh.points, cells=mesh.cells, markers={**ends, "layer": layer})


def cube() -> Domain:
    plane = Domain.rectangle((-1, -1), (1, 1))
    block = Domain.extruded(plane, 2, size=0.6)
    return Domain(block.points - [0, 0, 1], block.facets)


BODIES = {"cube": cube(), "ball": Domain.ball(size=0.4)}
SIDES = ("left", "right", "front", "back", "bottom", "top")


@pytest.mark.parametrize("name", BODIES)
def test_the_cap_of_layers_bounds_tetrahedra(name: str) -> None:
    layers = wedges(BODIES[name], 0.2)
    assert check(layers) and layers.volumes.min() > 0
    cap = Mesh(
        layers.points, layers.markers["cap"], markers={"cap": np.ones(len(layers.markers["cap"]), bool)}
    )
    surface = Domain.surface(cap)
    far = Domain.box((-3, -3, -3), (3, 3, 3), regions={"air": [(2.5, 2.5, 2.5)]})
    domain = far.with_holes(surface)
    assert set(domain.markers) == {*SIDES, "cap"} and domain.volume == pytest.approx(216 - surface.volume)
    rest = tetrahedralize(domain, 0.8)
    assert not np.isin(rest.steiner, rest.markers["cap"]).any(), "no vertex is added on the cap"
    assert len(rest.markers["cap"]) == cap.size and all(len(rest.markers[side]) for side in SIDES)
    triangles = [sorted(map(tuple, layers.points[row].tolist())) for row in layers.markers["cap"]]
    kept = [sorted(map(tuple, rest.points[row].tolist())) for row in rest.markers["cap"]]
    assert sorted(triangles) == sorted(kept), "triangle for triangle"
    assert check(rest, domain=domain)
    mesh = join(layers, rest)
    report = check(mesh)
    assert report, str(report)
    assert mesh.size == layers.size + rest.size and list(mesh.cells) == ["wedge", "tetra"]
    assert mesh.volume == pytest.approx(216 - BODIES[name].volume)
    assert len(mesh.points) == len(layers.points) + len(rest.points) - len(np.unique(layers.markers["cap"]))
    assert np.array_equal(mesh.points[: len(layers.points)], layers.points)
    for part, names in ((layers, ("wall", "cap")), (rest, (*SIDES, "cap"))):
        assert all(len(mesh.markers[n]) == len(part.markers[n]) for n in names)
    assert keys(mesh.markers["facets"]) == keys(mesh.boundary)
    assert keys(mesh.markers["inner"]) == keys(mesh.markers["cap"])
    assert mesh.regions == {"air": 0}
    assert (mesh.markers["region"] == 0).sum() == rest.size
    assert (mesh.markers["layer"][: layers.size] == layers.markers["layer"]).all()


def test_layers_on_a_floor() -> None:
    """The cap ends in a plane, where the floor of the tetrahedra has a hole with its rim."""
    block = Domain.extruded(Domain.rectangle((-1, -1), (1, 1)), 1, size=0.6).triangulated
    above = block.triangles[block.points[block.triangles][:, :, 2].max(axis=1) > 0]
    layers = wedges(Mesh(block.points, above), 0.3)
    cap = np.unique(layers.markers["cap"])
    points = layers.points[cap]
    number = np.zeros(len(layers.points), dtype=int)
    number[cap] = np.arange(len(cap))
    used = np.unique(above)
    assert len(cap) == len(used), "each vertex of the surface has one of the cap above it"
    rim = np.flatnonzero(points[:, 2] == 0)
    rim = rim[np.argsort(np.arctan2(points[rim, 1], points[rim, 0]))]
    far = Domain.box((-3, -3, 0), (3, 3, 3))
    sides = [row.tolist() for row in far.facets if (far.points[row][:, 2] > 0).any()]
    ground = next(row.tolist() for row in far.facets if not far.points[row][:, 2].any())
    triangles = (number[layers.markers["cap"]] + 8).tolist()
    facets = [*sides, [ground, (rim + 8).tolist()], *triangles]
    markers = {"floor": [5], "cap": range(6, len(facets)), "far": range(5)}
    domain = Domain(np.concatenate([far.points, points]), facets, markers=markers)
    assert domain.volume == pytest.approx(6 * 6 * 3 - 1.3**3 * 4)
    rest = tetrahedralize(domain, 0.8)
    assert not np.isin(rest.steiner, rest.markers["cap"]).any()
    assert len(rest.markers["cap"]) == len(layers.markers["cap"])
    mesh = join(layers, rest)
    assert check(mesh) and mesh.volume == pytest.approx(6 * 6 * 3 - 4)
    ground = mesh.boundary[
        (mesh.points[mesh.boundary][:, :, 2] == 0).all(axis=1) & (mesh.boundary[:, 3] >= 0)
    ]
    assert len(ground) == 3 * len(rim), "the sides of the layers"


def test_layers_and_fill_of_the_plane_are_put_together_again() -> None:
    mesh = advancing_layers(Domain.disc(radius=1), 0.3, layers=Layers(first=0.05, count=2))
    layer = np.hypot(*mesh.points[mesh.simplices].mean(axis=1).T) > 0.88
    assert layer.any() and not layer.all()
    one, two = mesh.select(layer), mesh.select(~layer)
    again = join(one, two)
    assert places(again) == places(mesh) and len(again.points) == len(mesh.points) and check(again)
    assert again.volume == pytest.approx(mesh.volume)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["planar", "spatial", "delaunay"]), st.integers(1, 4))
def test_parts_are_the_whole_again(seed: int, kind: str, count: int) -> None:
    rng = np.random.default_rng(seed)
    mesh: Mesh = {
        "planar": lambda: planar(4, seed=seed),
        "spatial": lambda: spatial(2, seed=seed),
        "delaunay": lambda: delaunay(rng.integers(0, 5, (40, 3)).astype(float)),
    }[kind]()
    part = rng.integers(0, count, mesh.size)
    part[:count] = np.arange(count)
    region = rng.integers(0, 3, mesh.size)
    ends = mesh.boundary
    marks = {"a": ends[::2], "region": region, "x": rng.random(mesh.size), "facets": ends}
    mesh = Mesh(mesh.points, cells=mesh.cells, markers=marks, regions={"r0": 0, "r1": 1, "r2": 2})
    pieces = [mesh.select(part == k) for k in range(count)]
    whole = join(*pieces)
    assert places(whole) == places(mesh)
    assert len(whole.points) == len(
        np.unique(np.concatenate([np.concatenate(list(b)) for b in mesh.cells.values()]))
    )
    assert whole.volume == pytest.approx(mesh.volume) and len(whole.boundary) == len(mesh.boundary)
    assert len(whole.markers["a"]) == len(marks["a"])
    assert keys(whole.markers["facets"]) == keys(whole.boundary)
    names = {k: n for n, k in whole.regions.items()}
    by_place = {
        tuple(sorted(map(tuple, whole.points[row].tolist()))): (names[r], x)
        for row, r, x in zip(
            (row for block in whole.cells.values() for row in block),
            whole.markers["region"].tolist(),
            whole.markers["x"],
        )
    }
    rows = (row for block in mesh.cells.values() for row in block)
    for row, r, x in zip(rows, region.tolist(), marks["x"]):
        assert by_place[tuple(sorted(map(tuple, mesh.points[row].tolist())))] == (f"r{r}", x)


TRIANGLES = Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])


def test_regions_without_names_stay_apart() -> None:
    other = Mesh(
        [[1, 1], [0, 1], [1, 0], [9, 9]],
        [[0, 1, 2]],
        markers={"region": [3], "hot": [True]},
        regions={"b": 3},
    )
    mesh = join(TRIANGLES, other, Mesh([[5, 5], [6, 5], [5, 6]], [[0, 1, 2]]))
    assert mesh.markers["region"].tolist() == [1, 0, 2] and mesh.regions == {"b": 0}
    assert mesh.markers["hot"].tolist() == [False, True, False] and mesh.markers["hot"].dtype == bool
    assert mesh.origin.tolist() == [0, 1, 2, 3, 6, 7, 8, 9] and mesh.simplices[1].tolist() == [3, 2, 1]
    assert join(TRIANGLES).markers == {}
    zero = Mesh([[-0.0, 0.0], [1, 0], [0, -1]], [[0, 2, 1]])
    assert len(join(TRIANGLES, zero).points) == 4, "zero has one place, whatever its sign"


def test_duplicates_and_matching_sides_follow() -> None:
    square = delaunay([[0, 0], [1, 0], [1, 1], [0, 1], [1, 0]])
    mesh = join(Mesh([[2, 0], [2, 1], [1, 0]], [[0, 1, 2]]), square)
    assert mesh.duplicates.tolist() == [[6, 2]] and len(mesh.points) == 7
    ends = Mesh([[1, 1], [2, 1], [1, 2]], [[0, 1, 2]], periodic=[(None, [[1, 2]])])
    assert join(square, ends).pairs.tolist() == [[5, 6]]


@pytest.mark.parametrize(
    ("meshes", "error", "word"),
    [
        ((), InputError, "at least one"),
        ((TRIANGLES, "mesh"), InputError, r"meshes\[1\] must be a Mesh"),
        ((TRIANGLES, Mesh(np.eye(3), [[0, 1, 2]])), InputError, "cannot be joined"),
        ((TRIANGLES, TRIANGLES, TRIANGLES), MeshError, "shared by 3 cells"),
        (
            (TRIANGLES, Mesh([[0, 0], [0, 0], [-1, 0], [0, -1], [-1, -1]], [[0, 2, 3], [1, 3, 4]])),
            MeshError,
            r"vertices 0 and 1 of meshes\[1\] are both at \[0.0, 0.0\]",
        ),
        (
            (
                Mesh(TRIANGLES.points, TRIANGLES.simplices, markers={"a": [1]}),
                Mesh(TRIANGLES.points + 5, TRIANGLES.simplices, markers={"a": [[0, 1]]}),
            ),
            MeshError,
            "'a' stands for faces",
        ),
    ],
)
def test_what_cannot_be_joined_is_named(meshes: tuple, error: type[Exception], word: str) -> None:
    with pytest.raises(error, match=word):
        join(*meshes)


def test_a_cut_face_is_not_joined_and_check_says_so() -> None:
    """Two triangles on a quadrilateral: nothing holds them together."""
    cube = np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)])
    block = Mesh(cube, cells={"hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]]})
    above = delaunay(np.concatenate([cube[4:], [[0.5, 0.5, 2]]]))
    mesh = join(block, above)
    assert len(mesh.points) == 9 and not check(mesh)
