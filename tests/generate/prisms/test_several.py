"""Several rays at sharp convex creases: valid meshes, and better ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import (
    Domain,
    InputError,
    Layers,
    Mesh,
    UnstructError,
    check,
    delaunay,
    examples,
    prismatic_layers,
)

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


def better(surface: Mesh | Domain, **options: object) -> tuple[float, float]:
    """The least scaled Jacobian with one ray and with several; both meshes are valid."""
    found = []
    for several in (False, True):
        mesh = prismatic_layers(surface, several=several, **{"layers": LAYERS} | options)  # type: ignore[arg-type]
        body = surface if "size" in options and isinstance(surface, Domain) else None
        assert check(mesh, domain=body)
        assert set(mesh.cells) <= {"hexahedron", "wedge", "pyramid", "tetra"}
        found.append(mesh.figures[LEAST])
    assert mesh.counts["creases with fans"] > 0
    return found[0], found[1]


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
def test_a_rim_without_corners(cells: str) -> None:
    one, several = better(lens(), cells=cells)
    assert one < 0.14 and several > 0.25
    mesh = prismatic_layers(lens(), layers=Layers(first=0.01, growth=1, count=1), several=True)
    assert check(mesh) and "hexahedron" not in mesh.cells


def test_a_cube_with_corners_and_account() -> None:
    cube = examples.meshed_sides(Domain.box((0, 0, 0), (1, 1, 1)), 0.25)
    one, several = better(cube)
    assert one < 0.48 and several > 0.75
    mesh = prismatic_layers(cube, layers=LAYERS, several=True)
    edges, n = 12 * 4, len(cube.points)
    counts = mesh.counts
    assert counts["creases with fans"] == 12 and counts["creases with one ray"] == 0
    # Two quads an edge; four triangles a corner. Top hexahedra are five pyramids, two tetrahedra.
    quads, corners = 2 * edges, 8 * 4
    assert counts["hexahedra"] == quads * 2 and counts["pyramids"] == 5 * quads
    assert counts["tetrahedra"] == 2 * quads + corners
    assert counts["wedges"] == 4 * len(cube.facets) + quads + 3 * corners
    assert counts["rays"] == n + 2 * (edges - 12) + 8 * (2 + 3)
    steps = mesh.steps
    assert steps is not None
    assert len(steps["vertex"]) == counts["rays"] and np.array_equal(
        mesh.points[steps["vertex"]], steps["place"]
    )
    assert len(steps["cell_layer"]) == mesh.size and len(steps["cap"]) == len(mesh.markers["cap"])


@pytest.mark.parametrize("skew", [0.0, 0.37])
def test_creases_that_end_in_planes(skew: float) -> None:
    points, rows, _ = bar(skew)
    one, several = better(Mesh(points, np.array(rows)))
    assert one < 0.1 and several > 0.29
    body = channel(skew)
    assert better(body, side="inside", walls="bar")[1] > 0.29
    assert better(body, size=0.4, walls="bar")[1] > 0.29


def test_with_tetrahedra_beyond() -> None:
    box = Domain.box((-2, -2, -2), (2, 2, 2))
    body = box.with_holes(Domain.surface(lens()))
    walls = list(range(len(box.facets), len(body.facets)))
    one, several = better(body, size=1.0, walls=walls)
    assert several > 2 * one
    better(body, size=1.0, walls=walls, cells="tetrahedron")


def test_what_is_worse_keeps_one_ray() -> None:
    """Creases of a wing that fade out; a box from inside, which has no convex edges."""
    mesh = prismatic_layers(
        examples.wing(0.15), layers=Layers(first=0.002, growth=1.2, count=5), several=True
    )
    plain = prismatic_layers(examples.wing(0.15), layers=Layers(first=0.002, growth=1.2, count=5))
    assert check(mesh) and mesh.figures[LEAST] >= plain.figures[LEAST]
    box = prismatic_layers(Domain.box((0, 0, 0), (1, 1, 1)), layers=LAYERS, several=True, side="inside")
    assert box.counts["creases with one ray"] == box.counts["creases with fans"] == 0


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
    mesh = prismatic_layers(body, layers=layers, several=True, cells=cells)
    assert check(mesh)
    assert mesh.counts["creases with fans"] + mesh.counts["creases with one ray"] >= 0
