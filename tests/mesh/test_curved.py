"""Second-order triangles: nodes on the true curves, Jacobians positive everywhere, offenders straightened."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import sector

import unstruct
from unstruct import Domain, InputError, Mesh, second_order
from unstruct.mesh.curved import _positive_everywhere, bernstein

WEIGHTS = [(i, j, 6 - i - j) for i in range(7) for j in range(7 - i)]


def determinant(six, weights):
    """The Jacobian determinant at a point, from the shape functions of degree two, in rational arithmetic."""
    a, b, c = (Fraction(w, sum(weights)) for w in weights)
    along = [  # derivatives of the six shape functions by b and by c, where a = 1 - b - c
        (1 - 4 * a, 4 * b - 1, 0, 4 * (a - b), 4 * c, -4 * c),
        (1 - 4 * a, 0, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)),
    ]
    (ux, uy), (vx, vy) = (
        [sum(d * Fraction(x[k]) for d, x in zip(row, six)) for k in range(2)] for row in along
    )
    return ux * vy - uy * vx


@given(st.lists(st.tuples(st.integers(-6, 6), st.integers(-6, 6)), min_size=6, max_size=6))
@settings(max_examples=60)
def test_coefficients_are_those_of_the_determinant(six):
    c = [Fraction(x) for x in bernstein(np.array([six], dtype=float))[0].tolist()]
    for weights in WEIGHTS[::3]:
        a, b, d = (Fraction(w, 6) for w in weights)
        form = c[0] * a * a + c[1] * b * b + c[2] * d * d
        form += 2 * (c[3] * a * b + c[4] * b * d + c[5] * d * a)
        assert form == determinant(six, weights)


CORNERS = st.sampled_from([[(0, 0), (8, 0), (0, 8)], [(0, 0), (8, 0), (3, 1)], [(0, 0), (16, 0), (8, 1)]])


@given(CORNERS, st.lists(st.tuples(st.integers(-8, 8), st.integers(-8, 8)), min_size=3, max_size=3))
@settings(max_examples=80)
def test_what_is_called_positive_is(corners, moves):
    """Nodes moved off the middles by eighths: no determinant of a proved triangle is 0 or less."""
    middles = [
        tuple((Fraction(corners[k][i] + corners[(k + 1) % 3][i], 2) + Fraction(m[i], 8)) for i in range(2))
        for k, m in enumerate(moves)
    ]
    six = [*corners, *middles]
    floats = np.array([[[float(x) for x in place] for place in six]])
    if _positive_everywhere(floats)[0]:
        assert all(determinant(six, w) > 0 for w in WEIGHTS)
    else:
        # A polynomial that is positive on the grid by more than a margin is proved positive.
        largest = max(abs(Fraction(c)) for c in bernstein(floats)[0].tolist())
        assert min(determinant(six, w) for w in WEIGHTS) < largest / 4


@pytest.mark.parametrize("domain", [Domain.disc(), Domain.naca("2412"), Domain.letters("B")])
def test_nodes_are_on_the_curves(domain):
    mesh = unstruct.refine(domain, 0.2)
    curved = second_order(mesh, domain)
    n = len(mesh.points)
    assert np.array_equal(curved.points[:n], mesh.points)
    assert np.array_equal(curved.triangles[:, :3], mesh.simplices)
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        ends = curved.edges[curved.triangles[:, 3 + k] - n, :2]
        assert np.array_equal(np.sort(ends, axis=1), np.sort(mesh.simplices[:, [i, j]], axis=1))
    assert (curved.jacobians() > 0).all() and _positive_everywhere(curved.points[curved.triangles]).all()
    rows = curved.edges[curved.curved]
    a, b, x = curved.points[rows].transpose(1, 0, 2)
    assert np.allclose(np.linalg.norm(x - a, axis=1), np.linalg.norm(x - b, axis=1), rtol=1e-6)
    straight = np.setdiff1d(np.arange(len(curved.edges)), curved.curved)
    ends = curved.points[curved.edges[straight]]
    assert np.array_equal(ends[:, 2], ends[:, :2].mean(axis=1))
    assert abs(curved.area - domain.area) < abs(mesh.volume - domain.area) / 5


def test_the_disc_is_met_to_the_fourth_order():
    errors = []
    disc = Domain.disc()
    for h in (0.4, 0.2, 0.1):
        curved = second_order(unstruct.refine(disc, h), disc)
        assert curved.complete and np.allclose(
            np.linalg.norm(curved.points[curved.edges[curved.curved, 2]], axis=1), 1
        )
        errors.append(abs(curved.area - np.pi))
    assert errors[0] / errors[1] > 8 and errors[1] / errors[2] > 8, errors


def test_a_triangle_that_a_curve_would_turn_over_stays_straight():
    """The arc bulges toward a vertex that is just beyond it: its triangle would overlap itself."""
    height = 0.4
    radius = (1 + height**2) / (2 * height)
    half = np.arcsin(1 / radius)
    arc = unstruct.Arc((1, height - radius), radius, np.pi / 2 + half, -2 * half)
    points = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0.42)]
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], curves={0: arc})
    mesh = unstruct.constrained_delaunay(domain)
    curved = second_order(mesh, domain)
    assert not curved.complete
    assert (curved.jacobians() > 0).all()
    ends = curved.points[curved.edges[curved.straightened]]
    assert np.array_equal(ends[:, 2], ends[:, :2].mean(axis=1)), "the node is back in the middle"


def test_curves_inside():
    ring = Domain.disc((0, 0), 0.5)
    square = Domain.rectangle((-1, -1), (1, 1))
    n = len(square.points)
    domain = Domain(
        np.vstack([square.points, ring.points]),
        square.facets,
        inner=ring.facets + n,
        curves={len(square.facets) + k: c for k, c in ring.curves.items()},
        markers={"ring": len(square.facets) + np.arange(len(ring.facets))},
        regions={"in": (0, 0), "out": (0.9, 0.9)},
    )
    mesh = unstruct.refine(domain, 0.2)
    curved = second_order(mesh, domain)
    inside = mesh.markers["region"] == list(domain.regions).index("in")
    area = bernstein(curved.points[curved.triangles[inside]]).mean(axis=1).sum() / 2
    assert abs(area - np.pi / 4) < 1e-4
    made = curved.to_meshio()
    assert {block.type for block in made.cells} == {"triangle6", "line3"}
    assert {"ring", "facets"} <= set(made.field_data)


def test_scikit_fem_integrates_over_the_curved_region():
    skfem = pytest.importorskip("skfem")
    disc = Domain.disc()
    curved = second_order(unstruct.refine(disc, 0.4), disc)
    theirs = curved.to_skfem()
    area = skfem.Functional(lambda w: 1.0 + 0 * w.x[0]).assemble(skfem.Basis(theirs, skfem.ElementTriP2()))
    assert np.isclose(area, curved.area, rtol=1e-12)
    assert "facets" in theirs.boundaries


@pytest.mark.parametrize(
    "suffix, options", [(".vtu", {}), (".msh", {"file_format": "gmsh22", "binary": False})]
)
def test_files(tmp_path, suffix, options):
    meshio = pytest.importorskip("meshio")
    disc = Domain.disc()
    curved = second_order(unstruct.refine(disc, 0.4), disc)
    curved.write(tmp_path / f"disc{suffix}", **options)
    back = meshio.read(tmp_path / f"disc{suffix}")
    assert np.array_equal(back.cells_dict["triangle6"], curved.triangles)
    assert np.array_equal(back.points[:, :2], curved.points)


def test_without_curves_all_is_straight():
    mesh = unstruct.delaunay(np.random.default_rng(2).random((30, 2)))
    for curved in (
        second_order(mesh),
        second_order(mesh, Domain.disc()),
        second_order(Mesh([(0, 0)], np.empty((0, 3), int))),
    ):
        assert curved.complete and len(curved.curved) == 0
    assert np.isclose(second_order(mesh).area, mesh.volume)


def test_errors():
    disc = Domain.disc()
    mesh = unstruct.refine(disc, 0.5)
    with pytest.raises(InputError, match="planar mesh of triangles"):
        second_order(disc)
    with pytest.raises(InputError, match="must be a Domain"):
        second_order(mesh, mesh)
    with pytest.raises(InputError, match="is this the meshed domain"):
        second_order(mesh, Domain.disc((1, 1), 2))


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("bend", [0.0, 0.2])
def test_nodes_on_sides_that_match_are_images(tmp_path, bend: float) -> None:
    domain = sector(7, bend=bend).matched("low", "high", rotation=360 / 7)
    mesh = unstruct.refine(domain, 0.15)
    curved = second_order(mesh, domain)
    assert curved.complete and curved.jacobians().min() > 0 and (len(curved.curved) > 12) == (bend > 0)
    ((motion, pairs),) = mesh.periodic
    image = dict(pairs.tolist())
    node = {frozenset(ends): v for *ends, v in curved.edges.tolist()}
    found = 0
    for a, b in mesh.markers["low"].tolist():
        one, two = node[frozenset((a, b))], node[frozenset((image[a], image[b]))]
        assert np.array_equal(motion(curved.points[one]), curved.points[two])
        found += 1
    assert found == len(pairs) - 1 >= 4
    pytest.importorskip("meshio")
    with pytest.warns(UserWarning, match="not written: 'periodic'"):
        curved.write(tmp_path / "curved.vtu")
