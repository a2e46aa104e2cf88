"""Several rays at sharp convex creases: valid meshes, and better ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import (
    Domain,
    DomainMesh,
    InputError,
    Layers,
    Mesh,
    UnstructError,
    check,
    delaunay,
    examples,
    prismatic_layers,
)
from unstruct.generate.prisms.prismatic_layers import layers_alone
from unstruct.generate.prisms.run import PrismOptions
from unstruct.generate.prisms.several import at_vertices, run_with_fans
from unstruct.generate.prisms.walls import base_of

LEAST = "least scaled Jacobian"
LAYERS = Layers(first=0.01, growth=1.2, count=4)


def lens(count: int = 24, rings: int = 4, degrees: float = 16.0) -> Mesh:
    """Two parts of spheres that meet at the rim at some angle, as a trailing edge that is closed."""
    half = np.radians(degrees / 2)
    radius = 1 / np.sin(half)
    angle = 2 * np.pi * np.arange(count) / count
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    points, rows = [np.column_stack([circle, 0 * angle])], []
    k, follow = np.arange(count), (np.arange(count) + 1) % count
    for sign in (1, -1):
        below, many = k, len(np.concatenate(points))
        for share in np.linspace(1, 0, rings + 1)[1:-1]:
            z = np.sqrt(radius**2 - share**2) - np.sqrt(radius**2 - 1)
            points.append(np.column_stack([share * circle, np.full(count, sign * z)]))
            above = many + k
            many += count
            for corner in ((below, below[follow], above[follow]), (below, above[follow], above)):
                rows.append(np.column_stack(corner)[:, ::sign])
            below = above
        points.append(np.array([[0.0, 0.0, sign * (radius - np.sqrt(radius**2 - 1))]]))
        rows.append(np.column_stack([below, below[follow], np.full(count, many)])[:, ::sign])
    return Mesh(np.concatenate(points), np.concatenate(rows))


def bar(skew: float, n: int = 5, m: int = 3) -> tuple[np.ndarray, list[list[int]], int]:
    """A wedge of 16 degrees between two planes: its points, its triangles, and how many are in a section."""
    slope = np.tan(np.radians(8.0))
    x = np.linspace(1, 0, n)
    section = [(s, slope * (1 - s)) for s in x] + [(0.0, slope / 3), (0.0, -slope / 3)]
    section += [(s, -slope * (1 - s)) for s in x[::-1][:-1]]
    many = len(section)
    points = [(s, skew * s * j / m + j / m, z) for j in range(m + 1) for s, z in section]
    rows = []
    for j in range(m):
        for i in range(many):
            a, b = j * many + i, j * many + (i + 1) % many
            rows += [[a, a + many, b + many], [a, b + many, b]]
    return np.array(points), rows, many


def channel(skew: float) -> Domain:
    """A bar between two walls of a channel."""
    points, rows, many = bar(skew)
    n = len(points)
    corners = [(-1, -1), (2, -1), (2, 1), (-1, 1)]
    more = [(x, 0.0, z) for x, z in corners] + [(x, skew * x + 1.0, z) for x, z in corners]
    facets = [([n, n + 1, n + 2, n + 3], list(range(many)))]
    facets += [([n + 4, n + 5, n + 6, n + 7], list(range(n - many, n)))]
    sides = [[n + i, n + (i + 1) % 4, n + 4 + (i + 1) % 4, n + 4 + i] for i in range(4)]
    return Domain(
        np.concatenate([points, more]), rows + facets + sides, markers={"bar": list(range(len(rows)))}
    )


def least(mesh: Mesh) -> float:
    """Over all cells of the mesh as it is."""
    return float(mesh.quality("scaled_jacobian").min())


def pair(surface: Mesh | Domain, **options: object) -> list[DomainMesh]:
    """The meshes with one ray and with several: both are valid, and the second one is no worse."""
    found = []
    for several in (False, True):
        mesh = prismatic_layers(surface, several=several, **{"layers": LAYERS} | options)  # type: ignore[arg-type]
        body = surface if "size" in options and isinstance(surface, Domain) else None
        assert check(mesh, domain=body)
        assert set(mesh.cells) <= {"hexahedron", "wedge", "pyramid", "tetra"}
        found.append(mesh)
    assert least(found[1]) >= (1.0 - 1e-12) * least(found[0])
    assert (found[1].counts["creases with fans"] == 0) <= (found[1].size == found[0].size)
    return found


def better(surface: Mesh | Domain, **options: object) -> tuple[float, float]:
    """The least scaled Jacobian with one ray and with several, which there are."""
    one, several = pair(surface, **options)
    assert several.counts["creases with fans"] > 0
    return least(one), least(several)


def test_a_rim_without_corners() -> None:
    one, several = better(lens())
    assert one < 0.09 and several > 0.27
    mesh = prismatic_layers(lens(), layers=LAYERS, several=True)
    assert list(mesh.cells) == ["hexahedron", "wedge"] and mesh.figures[LEAST] == pytest.approx(several)
    mesh = prismatic_layers(lens(), layers=Layers(first=0.01, growth=1, count=1), several=True)
    assert check(mesh) and list(mesh.cells) == ["wedge"]


def test_a_cube_with_corners_and_account() -> None:
    cube = examples.meshed_sides(Domain.box((0, 0, 0), (1, 1, 1)), 0.25)
    one, several = better(cube)
    assert one < 0.48 and several > 0.7
    mesh = prismatic_layers(cube, layers=LAYERS, several=True)
    edges, n = 12 * 4, len(cube.points)
    counts = mesh.counts
    assert counts["creases with fans"] == 12 and counts["creases with one ray"] == 0
    # Two quads an edge; four triangles a corner.
    quads, corners = 2 * edges, 8 * 4
    assert counts["hexahedra"] == quads * 3 and counts["pyramids"] == 0
    assert counts["tetrahedra"] == corners
    assert counts["wedges"] == 4 * len(cube.facets) + quads + 3 * corners
    assert counts["rays"] == n + 2 * (edges - 12) + 8 * (2 + 3)
    steps, cap = mesh.steps, mesh.markers["cap"]
    assert steps is not None
    assert len(steps["vertex"]) == counts["rays"] and np.array_equal(
        mesh.points[steps["vertex"]], steps["place"]
    )
    assert len(steps["cell_layer"]) == mesh.size and np.array_equal(steps["cap"], cap)
    # Faces of the boundary on no side of the cube, quadrilaterals and triangles.
    assert cap.shape == (len(cube.facets) + quads + corners, 4) and (cap[:, 3] >= 0).sum() == quads
    above = mesh.boundary[(mesh.points[mesh.boundary].min(axis=1) < 0).any(axis=1)]
    assert {frozenset(row) for row in above.tolist()} <= {frozenset(row) for row in cap.tolist()}


def test_a_cube_in_tetrahedra() -> None:
    """There needles are over edges: several rays are better where layers are as high as edges are long."""
    cube = examples.meshed_sides(Domain.box((0, 0, 0), (1, 1, 1)), 0.25)
    one, several = better(cube, layers=Layers(first=0.2, growth=1, count=1), cells="tetrahedron")
    assert one < 0.18 and several > 0.38
    thin = pair(cube, cells="tetrahedron")
    assert thin[1].counts["creases with one ray"] == 12 and np.array_equal(*(m.simplices for m in thin))


BODIES = {
    "cylinder": (Domain.cylinder((0, 0, 0), (0, 0, 2), 0.5, size=0.3), True),
    "wing": (examples.wing(0.15), True),
    "notch": (examples.meshed_sides(examples.notched_box(0.3, 0.8), 0.25), True),
    "wing-body": (examples.wing_body(0.13), True),
    "box from inside": (Domain.box((0, 0, 0), (1, 1, 1)), False),
}


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
@pytest.mark.parametrize("name", BODIES)
def test_no_body_is_worse(name: str, cells: str) -> None:
    surface, outside = BODIES[name]
    layers = Layers(first=0.002 if name == "wing" else 0.01, growth=1.2, count=4)
    one, several = pair(surface, cells=cells, layers=layers, side="outside" if outside else "inside")
    if cells == "wedge" and name in ("cylinder", "wing"):
        assert least(several) > 1.3 * least(one)
    if not outside:
        assert several.counts["creases with one ray"] == several.counts["creases with fans"] == 0


@pytest.mark.parametrize("skew", [0.0, 0.37])
def test_creases_that_end_in_planes(skew: float) -> None:
    points, rows, _ = bar(skew)
    one, several = better(Mesh(points, np.array(rows)))
    assert one < 0.1 and several > 0.29
    body = channel(skew)
    assert better(body, side="inside", walls="bar")[1] > 0.29
    one, several = better(body, size=0.4, walls="bar", layers=Layers(thickness=0.25, growth=1.2, count=4))
    assert several > 1.5 * one


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
def test_what_is_compared_is_what_the_mesh_has(cells: str) -> None:
    """Vertex by vertex, with fans and without."""
    cube = examples.meshed_sides(Domain.box((0, 0, 0), (1, 1, 1)), 0.25)
    layers, base = Layers(first=0.2, growth=1.1, count=1 + (cells == "wedge")), base_of(cube, None, "outside")
    found = run_with_fans(base, layers, PrismOptions(cells=cells))
    assert found.fanned == 12 and len(found.run.fans.quads) and not len(found.without.fans.quads)
    for run in (found.run, found.without):
        mesh = layers_alone(run)
        quality, expected = mesh.quality("scaled_jacobian"), np.full(len(cube.points), np.inf)
        steps = mesh.steps
        assert steps is not None
        stem = np.full(len(mesh.points), -1)
        for k in range(run.levels + 1):
            at = {tuple(p): v for v, p in enumerate(mesh.points.tolist())}
            stem[[at[tuple(p)] for p in run.places[k].tolist()]] = run.fans.base
        rows = [row for block in mesh.cells.values() for row in block.tolist()]
        for row, value in zip(rows, quality.tolist(), strict=True):
            np.minimum.at(expected, stem[row], value)
        least_at = at_vertices(run)  # tetrahedra count at all vertices of the cell that they are a part of
        assert least_at.min() == pytest.approx(expected.min(), rel=1e-12)
        assert (least_at <= expected * (1.0 + 1e-12)).all()
        if cells == "wedge":
            np.testing.assert_allclose(least_at, expected, rtol=1e-12)


def in_a_box(surface: Mesh | Domain, half: float = 2.0) -> tuple[Domain, list[int]]:
    """A body in a box, and the facets of the body."""
    box = Domain.box((-half,) * 3, (half,) * 3)
    body = box.with_holes(Domain.surface(surface) if isinstance(surface, Mesh) else surface)
    return body, list(range(len(box.facets), len(body.facets)))


def test_pyramids_with_tetrahedra_beyond() -> None:
    body, walls = in_a_box(lens())
    layers = Layers(first=0.04, growth=1.2, count=4)
    one, several = better(body, size=1.0, walls=walls, layers=layers)
    assert several > 1.8 * one
    mesh = prismatic_layers(body, 1.0, layers=layers, walls=walls, several=True)
    quads = 24 * 4
    assert mesh.counts["pyramids"] == quads and mesh.counts["hexahedra"] == 3 * quads
    assert mesh.markers["cap"].shape == (336 + 4 * quads, 3) and mesh.steps is not None
    layer = mesh.steps["cell_layer"]
    assert (layer == 5).sum() == quads and layer.max() == 5
    pair(body, size=1.0, walls=walls, cells="tetrahedron", layers=layers)


def test_where_tetrahedra_beyond_are_worse_there_is_one_ray() -> None:
    """The cap over edges is narrow above thin layers, and so are the tetrahedra on it."""
    body = channel(0.0)
    assert better(body, side="inside", walls="bar")[1] > 0.29
    _, several = pair(body, size=0.4, walls="bar")
    assert several.counts["creases with fans"] == 0 and "pyramid" not in several.cells


def test_pyramids_are_lowered_where_there_is_no_room() -> None:
    """Two cubes, one above the other, closer than pyramids are high; and the box around."""
    cubes = Domain.box((-1, -1, -1.2), (1, 1, -0.1)).points, Domain.box((-1, -1, 0.1), (1, 1, 1.2)).points
    facets = np.asarray(Domain.box((-1, -1, -1), (1, 1, 1)).triangulated.triangles)
    both = Domain(np.concatenate(cubes), np.concatenate([facets, facets + 8]))
    body, walls = in_a_box(both)
    pair(body, size=1.0, walls=walls, layers=Layers(thickness=0.05, growth=1.2, count=3))


@pytest.mark.filterwarnings("ignore::unstruct.HiddenVertexWarning")
def test_narrow_fans_beside_creases_without_any() -> None:
    """Found by a fuzz: what is wrong with creases that have no fans any more says nothing of the others."""
    digits = "121 131 132 122 221 231 232 222 133 123 223 233 212 213 312 322 323 313 332 333"
    corners = "dcba efgh ehda bcgf bfea jicd hkjd cilg jkli nkhm opqr ornm hpom nrqk pstq glts gsph kqtl"
    points = np.array([[float(x) for x in word] for word in digits.split()])
    sides = [[ord(letter) - ord("a") for letter in word] for word in corners.split()]
    box = Domain.box((-2, -2, -2), (5, 5, 5))
    body = box.with_holes(Domain(points, sides))
    walls = list(range(len(box.facets), len(body.facets)))
    layers = Layers(thickness=0.2, growth=1.3, count=4)
    mesh = prismatic_layers(body, 1.0, layers=layers, walls=walls, several=True)
    assert check(mesh, domain=body) and mesh.counts["creases with one ray"] > 0


@pytest.mark.parametrize("options", [{"recompute": True}, {"stop": "stop"}])
def test_what_fans_cannot_do_is_refused(options: dict) -> None:
    with pytest.raises(InputError, match="several rays"):
        prismatic_layers(lens(), layers=LAYERS, several=True, **options)


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10**6),
    st.integers(5, 20),
    st.sampled_from([0.1, 1.0, 5.0]),
    st.sampled_from(["wedge", "tetrahedron"]),
)
@pytest.mark.filterwarnings("ignore::unstruct.HiddenVertexWarning")
def test_convex_polyhedra(seed: int, count: int, thickness: float, cells: str) -> None:
    """Hulls of points of a grid, or of any: corners of many creases, acute and flat ones."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 4, (count, 3)) if seed % 2 else rng.normal(size=(count, 3))
    try:
        hull = delaunay(np.unique(points, axis=0)).boundary
        used, number = np.unique(hull, return_inverse=True)
        body = Domain(np.unique(points, axis=0)[used].astype(float), number.reshape(-1, 3))
    except UnstructError:
        return
    layers = Layers(thickness=thickness, growth=1.3, count=3)
    pair(body, layers=layers, cells=cells)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.01, 0.05, 0.2]), st.sampled_from(["wedge", "tetrahedron"]))
@pytest.mark.filterwarnings("ignore::unstruct.HiddenVertexWarning")
def test_merged_bodies(seed: int, first: float, cells: str) -> None:
    """Creases that begin and end anywhere."""
    body = examples.merged_body(seed, parts=2 + seed % 4)
    try:
        surface = examples.level_surface(body, 0.3, rounds=seed % 3)
    except UnstructError:
        return
    pair(surface, layers=Layers(first=first, growth=1.2, count=3), cells=cells)
