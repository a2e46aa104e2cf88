"""Mesh: validation, adjacency, location, selection, files, pictures."""

import warnings
import xml.etree.ElementTree as ElementTree
from fractions import Fraction
from itertools import pairwise

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, Delaunay

from unstruct import InputError, Mesh, MeshError, UnstructError
from unstruct.assess.check import check
from unstruct.connect.insertion.delaunay import delaunay

SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
TWO = [[0, 1, 2], [0, 2, 3]]


def random_mesh(n=30, d=2, seed=0):
    return delaunay(np.random.default_rng(seed).random((n, d)))


def ring(n=12):
    """An annulus of quadrilaterals cut in two: not convex, not simply connected."""
    turn = 2 * np.pi * np.arange(n) / n
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    return Mesh(
        np.concatenate([circle, 2 * circle]),
        np.concatenate([np.column_stack([i, i + n, j + n]), np.column_stack([i, j + n, j])]),
    )


# ---------------------------------------------------------------------- construction


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (dict(points=[0.0, 1.0], simplices=TWO), "shape"),
        (dict(points=[["a", "b"]] * 4, simplices=TWO), "real numbers"),
        (dict(points=np.array(SQUARE) * 1j, simplices=TWO), "real numbers"),
        (dict(points=[[0, 0], [1], [2, 2]], simplices=TWO), "shape"),
        (dict(points=[*SQUARE[:3], [np.nan, 0]], simplices=TWO), r"points\[3\].*not finite"),
        (dict(points=[*SQUARE[:2], [0, np.inf], [0, 0]], simplices=TWO), r"points\[2\].*not finite"),
        (dict(points=np.ma.masked_less(SQUARE, 0.5), simplices=TWO), r"points\[0\] is masked"),
        (dict(points=SQUARE, simplices=[[0, 1, 2], [0, 2, 4]]), r"simplices\[1\] = \[0, 2, 4\]"),
        (dict(points=SQUARE, simplices=[[0, 1, 1]]), "repeats a vertex"),
        (dict(points=SQUARE, simplices=[[0, 1, 2, 3]]), "cannot lie in 2 dimensions"),
        (dict(points=SQUARE), "either simplices or cells"),
        (dict(points=SQUARE, simplices=TWO, cells={"triangle": TWO}), "either simplices or cells"),
        (dict(points=SQUARE, simplices=TWO, neighbors=[[-1, 1], [0, -1]]), "neighbors must have shape"),
        (dict(points=SQUARE, simplices=TWO, origin=[0, 1]), "origin must have shape"),
        (dict(points=SQUARE, simplices=TWO, origin=[0.0, 1, 2, 3]), "origin must be integers"),
        (dict(points=SQUARE, simplices=TWO, duplicates=[[0, 7]]), "duplicates refers"),
        (dict(points=SQUARE, simplices=TWO, markers={"a": [1, 2, 3]}), r"markers\['a'\]"),
        (dict(points=SQUARE, simplices=TWO, markers={"a": [[1, 9]]}), r"markers\['a'\]\[0\] = \[1, 9\]"),
        (dict(points=SQUARE, cells={}), "empty"),
        (dict(points=SQUARE, cells={"circle": [[0, 1]]}), "no kind of cell is called 'circle'"),
        (dict(points=SQUARE, cells={"quad": [[0, 1, 2]]}), "4 vertices per row"),
        (dict(points=SQUARE, cells={"quad": [[0, 1, 2, 5]]}), r"cells\['quad'\].*\[0, 1, 2, 5\]"),
        (dict(points=SQUARE, cells={"polygon": [[0, 1, 2], [0, 1]]}), "polygon 1"),
        (dict(points=SQUARE, cells={"polygon": [[0, 1, 2, 1]]}), "repeats"),
        (dict(points=SQUARE, cells={"polygon": [[0, 1, 12]]}), "outside"),
        (dict(points=SQUARE, cells={"triangle": TWO, "line": [[0, 1]]}), "different dimensions"),
    ],
)
def test_wrong_input_is_named(arguments, words):
    with pytest.raises(UnstructError, match=words):
        Mesh(**arguments)


def test_arrays_are_typed_read_only_and_not_copied():
    points, simplices = np.array(SQUARE), np.array(TWO, dtype=np.int32)
    mesh = Mesh(points, simplices)
    assert mesh.points.dtype == np.float64 and mesh.simplices.dtype == np.int32
    assert np.shares_memory(mesh.points, points) and points.flags.writeable
    for array in (mesh.points, mesh.simplices, mesh.neighbors, mesh.edges, mesh.boundary, mesh.facets):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_the_square():
    mesh = Mesh(SQUARE, TWO)
    assert mesh.neighbors.tolist() == [[-1, 1, -1], [-1, -1, 0]]
    assert mesh.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    assert mesh.facets.tolist() == mesh.edges.tolist()
    assert sorted(mesh.boundary.tolist()) == [[0, 1], [1, 2], [2, 3], [3, 0]]
    assert mesh.face_counts() == (4, 5, 2) and mesh.euler_characteristic == 1
    assert mesh.volume == 1 and mesh.size == len(mesh) == 2 and mesh.dimension == 2
    assert mesh.origin.tolist() == [0, 1, 2, 3] and mesh.duplicates.shape == (0, 2)
    indptr, indices = mesh.vertex_neighbor_vertices
    assert indices[indptr[0] : indptr[1]].tolist() == [1, 2, 3]
    assert repr(mesh) == "<Mesh: 4 points, 2 triangles in 2D>"


@pytest.mark.parametrize("d", [2, 3, 4])
def test_the_same_as_scipy(d):
    points = np.random.default_rng(d).random((40, d))
    theirs = Delaunay(points)
    mesh = Mesh(points, theirs.simplices).oriented()
    assert check(mesh)
    same = Mesh(points, theirs.simplices)
    assert (same.neighbors == theirs.neighbors).all()
    x = np.random.default_rng(9).random((300, d)) * 1.2 - 0.1
    assert (same.find_simplex(x) == theirs.find_simplex(x)).all()
    indptr, indices = theirs.vertex_neighbor_vertices
    mine, rows = same.vertex_neighbor_vertices
    for v in range(len(points)):
        assert rows[mine[v] : mine[v + 1]].tolist() == sorted(indices[indptr[v] : indptr[v + 1]].tolist())

    def as_sets(rows):
        return {frozenset(row) for row in rows.tolist()}

    assert as_sets(mesh.convex_hull) == as_sets(theirs.convex_hull) == as_sets(mesh.boundary)
    assert mesh.volume == pytest.approx(ConvexHull(points).volume)


def test_convex_hull_of_a_mesh_that_is_not_convex():
    mesh = ring()
    assert {frozenset(e) for e in mesh.convex_hull.tolist()} == {
        frozenset((12 + i, 12 + (i + 1) % 12)) for i in range(12)
    }
    assert len(mesh.boundary) == 24


def test_oriented_turns_negative_cells():
    mesh = Mesh(SQUARE, [[0, 2, 1], [0, 2, 3]])
    assert not check(mesh)
    assert check(mesh.oriented()) and mesh.oriented().volume == 1


@pytest.mark.parametrize("d", [1, 2, 3, 5])
def test_one_simplex_in_any_dimension(d):
    corners = np.vstack([np.zeros(d), np.eye(d)])
    mesh = Mesh(corners, [range(d + 1)])
    assert mesh.euler_characteristic == 1 and len(mesh.boundary) == d + 1
    assert mesh.find_simplex([np.full(d, 0.1), np.full(d, 0.9), corners[-1]]).tolist() == [
        0,
        0 if d == 1 else -1,
        0,
    ]
    assert "points" in str(mesh.summary())


def test_surfaces_in_space():
    points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    octahedron = [[a, b, c] for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    mesh = Mesh(points, octahedron)
    assert mesh.dimension == 2 and mesh.euler_characteristic == 2 and len(mesh.boundary) == 0
    assert mesh.volume == pytest.approx(8 * np.sqrt(3) / 2)
    assert mesh.quality("2r/R") == pytest.approx(np.ones(8))
    with pytest.raises(MeshError, match="do not fill 3 dimensions"):
        mesh.find_simplex([[0, 0, 0]])


# ---------------------------------------------------------------------- location


def holds(mesh, t, x):
    """Whether x is a convex combination of the corners of cell t (barycentric coordinates in rationals)."""
    corners = [[Fraction(v) for v in row] for row in mesh.points[mesh.simplices[t]].tolist()]
    (ax, ay), (bx, by), (cx, cy) = corners
    qx, qy = map(Fraction, x)
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    u = (bx - qx) * (cy - qy) - (by - qy) * (cx - qx)
    v = (cx - qx) * (ay - qy) - (cy - qy) * (ax - qx)
    return area != 0 and min(u / area, v / area, 1 - (u + v) / area) >= 0


@given(st.lists(st.tuples(st.integers(-5, 25), st.integers(-5, 25)), min_size=1, max_size=30))
@settings(deadline=None, max_examples=40)
def test_location_on_a_lattice_is_exact_and_lowest(queries):
    """Queries at eighths of a lattice: most of them lie on edges and vertices."""
    i, j = np.meshgrid(np.arange(4), np.arange(4), indexing="ij")
    mesh = delaunay(np.column_stack([i.ravel(), j.ravel()]) * 0.7)
    x = np.array(queries) * (0.7 / 8)
    for q, found in zip(x.tolist(), mesh.find_simplex(x).tolist()):
        wanted = [t for t in range(mesh.size) if holds(mesh, t, q)]
        assert found == (wanted[0] if wanted else -1)


def test_location_with_holes_and_pieces():
    mesh = ring()
    assert mesh.find_simplex([0, 0]) == -1 and mesh.find_simplex([1.5, 0.0]) >= 0
    far = Mesh(
        np.concatenate([mesh.points, mesh.points + 10]), np.concatenate([mesh.simplices, mesh.simplices + 24])
    )
    x = np.random.default_rng(0).uniform(-3, 13, (500, 2))
    wanted = [next((t for t in range(far.size) if holds(far, t, q)), -1) for q in x.tolist()]
    assert far.find_simplex(x).tolist() == wanted
    assert far.find_simplex(x.reshape(5, 100, 2)).shape == (5, 100)
    assert far.find_simplex(np.empty((0, 2))).shape == (0,)


def test_location_last_bits():
    """One unit in the last place decides."""
    mesh = Mesh([[0.1, 0.1], [0.3, 0.3], [0.1, 0.3]], [[0, 1, 2]])
    for t in np.linspace(0.1, 0.3, 17):
        assert mesh.find_simplex([t, t]) == 0
        assert mesh.find_simplex([t, np.nextafter(t, 0)]) == -1
        assert mesh.find_simplex([t, np.nextafter(t, 1)]) == (0 if np.nextafter(t, 1) <= 0.3 else -1)


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_location_at_any_scale(scale):
    mesh = random_mesh()
    x = np.random.default_rng(5).random((200, 2)) * 1.2 - 0.1
    power = 2.0 ** round(np.log2(scale))
    assert (Mesh(mesh.points * power, mesh.simplices).find_simplex(x * power) == mesh.find_simplex(x)).all()


def test_location_of_wrong_points():
    mesh = Mesh(SQUARE, TWO)
    with pytest.raises(InputError, match=r"x\[1\].*not finite"):
        mesh.find_simplex([[0, 0], [np.nan, 0]])
    with pytest.raises(InputError, match=r"shape \(\.\.\., 2\)"):
        mesh.find_simplex([1, 2, 3])
    with pytest.raises(InputError, match="real numbers"):
        mesh.find_simplex([["a", "b"]])


def test_flat_cells_contain_nothing():
    mesh = Mesh([[0, 0], [1, 0], [2, 0], [0, 1]], [[0, 1, 2], [0, 1, 3]])
    assert mesh.find_simplex([[0.5, 0.0], [1.5, 0.0]]).tolist() == [1, -1]


# ---------------------------------------------------------------------- selection and mixed cells


def test_select_keeps_origin_and_names():
    mesh = random_mesh(40)
    mesh = Mesh(
        mesh.points,
        mesh.simplices,
        origin=np.arange(40) + 100,
        markers={"value": np.arange(mesh.size), "edge": mesh.edges, "vertex": np.arange(40)[:, None]},
    )
    chosen = np.random.default_rng(0).random(mesh.size) < 0.3
    part = mesh.select(chosen)
    assert part.size == chosen.sum() and (part.markers["value"] == np.nonzero(chosen)[0]).all()
    assert (mesh.points[part.origin - 100] == part.points).all()
    assert (part.corners == mesh.corners[chosen]).all()
    assert {tuple(sorted(e)) for e in part.markers["edge"].tolist()} == {
        tuple(e) for e in part.edges.tolist()
    }
    assert sorted(part.markers["vertex"].ravel().tolist()) == list(range(len(part.points)))
    numbers = np.nonzero(chosen)[0][::-1]
    assert (mesh.select(numbers).markers["value"] == numbers).all()
    assert mesh.select(np.zeros(mesh.size, dtype=bool)).size == 0
    for wrong in ([True], [0.5], [mesh.size], [[0]]):
        with pytest.raises(InputError):
            mesh.select(wrong)


def mixed():
    return Mesh(
        [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1], [3, 0.5], [0.5, 2]],
        cells={"quad": [[0, 1, 2, 3]], "triangle": [[4, 6, 5]], "polygon": [[1, 4, 5, 2], [3, 2, 7]]},
    )


def test_mixed_cells():
    mesh = mixed()
    assert mesh.face_counts() == (8, 11, 4) and mesh.euler_characteristic == 1
    assert mesh.volumes.tolist() == [1, 0.5, 1, 0.5] and mesh.volume == 3
    boundary = {tuple(e) for e in mesh.boundary.tolist()}
    assert boundary == {(0, 1), (1, 4), (4, 6), (6, 5), (5, 2), (2, 7), (7, 3), (3, 0)}
    assert repr(mesh) == "<Mesh: 8 points, 1 quad, 1 triangle, 2 polygons in 2D>"
    with pytest.raises(MeshError, match="quad, triangle, polygon: use"):
        mesh.simplices  # noqa: B018
    assert mesh.summary()["boundary"] == 8


def test_a_cube_cut_into_solids():
    """A hexahedron, a wedge and a pyramid glued along faces: exact volumes, chi = 1."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    points += [[0.5, 0.5, 2], [2, 0, 0], [2, 0, 1]]
    cells = {"hexahedron": [range(8)], "pyramid": [[4, 5, 6, 7, 8]], "wedge": [[1, 9, 2, 5, 10, 6]]}
    mesh = Mesh(points, cells={name: [list(row) for row in rows] for name, rows in cells.items()})
    assert mesh.volumes == pytest.approx([1, 1 / 3, 1 / 2])
    assert mesh.euler_characteristic == 1 and mesh.face_counts() == (11, 21, 14, 3)
    assert check(mesh)


def test_degree_one_meshes():
    mesh = Mesh([[0.0], [2.0], [1.0]], [[0, 2], [2, 1]])
    assert mesh.find_simplex([[0.5], [1.0], [3.0]]).tolist() == [0, 0, -1]
    assert mesh.volume == 2 and sorted(mesh.boundary.tolist()) == [[0], [1]]


# ---------------------------------------------------------------------- summaries and pictures


def test_summary_is_a_dictionary_and_a_text():
    summary = random_mesh().summary()
    assert summary["points"] == 30 and summary["euler"] == 1
    assert summary["min_angle"]["min"] == random_mesh().quality("min_angle").min()
    text = str(summary)
    assert "30 points" in text and "2r/R" in text and "(min, mean, max)" in text


@pytest.mark.parametrize(
    "mesh", [random_mesh(), random_mesh(d=3), random_mesh(9, 1), mixed(), random_mesh(2000)]
)
def test_the_card_is_well_formed_and_small(mesh):
    html = mesh._repr_html_()
    root = ElementTree.fromstring(html)
    path = root.find(".//path").attrib["d"]
    numbers = [float(x) for x in path.replace("M", " ").replace("L", " ").split()]
    assert numbers and 0 <= min(numbers) and max(numbers) <= 200
    assert len(html) < 60_000 and f"{len(mesh.points):,}" in html


def test_plot_draws_something():
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    assert random_mesh().plot() is not None
    plt.close("all")


# ---------------------------------------------------------------------- files


def marked():
    points = np.random.default_rng(0).random((20, 2))
    mesh = delaunay(np.vstack([points, points[3]]))
    markers = {
        "wall": mesh.boundary[:3],
        "region": np.arange(mesh.size),
        "top": np.arange(mesh.size) > 5,
        "tip": [[2], [5]],
    }
    return Mesh(mesh.points, mesh.simplices, duplicates=mesh.duplicates, origin=mesh.origin, markers=markers)


@pytest.mark.parametrize("suffix", ["vtu", "vtk"])
def test_everything_survives_a_file(tmp_path, suffix):
    mesh = marked()
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    for name in ("points", "simplices", "origin", "duplicates"):
        assert np.array_equal(getattr(again, name), getattr(mesh, name)), name
    assert {name: values.tolist() for name, values in again.markers.items()} == {
        name: values.tolist() for name, values in mesh.markers.items()
    }


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "msh", "off", "ply", "obj", "node", "ele"])
@pytest.mark.filterwarnings("ignore:not written")
def test_points_and_cells_survive_exactly(tmp_path, suffix):
    mesh = marked()
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.simplices, mesh.simplices)


@pytest.mark.parametrize("suffix", ["vtu", "msh", "node"])
def test_tetrahedra_survive(tmp_path, suffix):
    mesh = random_mesh(d=3)
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.simplices, mesh.simplices)


def test_gmsh_keeps_names_and_says_what_it_drops(tmp_path):
    with pytest.warns(UserWarning, match="not written: 'top'"):
        marked().write(tmp_path / "mesh.msh")
    again = Mesh.read(tmp_path / "mesh.msh")
    for name in ("wall", "region", "tip"):
        assert again.markers[name].tolist() == marked().markers[name].tolist()
    assert "top" not in again.markers
    assert again.duplicates.tolist() == marked().duplicates.tolist()


def test_stl_keeps_the_surface_and_says_what_it_drops(tmp_path):
    points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    mesh = Mesh(points, [[a, b, c] for a in (0, 1) for b in (2, 3) for c in (4, 5)], markers={"a": range(8)})
    with pytest.warns(UserWarning, match="not written: 'a'"):
        mesh.write(tmp_path / "mesh.stl")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # meshio's own arithmetic
        again = Mesh.read(tmp_path / "mesh.stl")
    assert again.face_counts() == (6, 12, 8) and again.volume == pytest.approx(mesh.volume)


def test_polygons_in_files(tmp_path):
    mixed().write(tmp_path / "mesh.vtu")
    again = Mesh.read(tmp_path / "mesh.vtu")
    assert again.face_counts() == mixed().face_counts() and again.volume == 3
    with pytest.raises(InputError, match=r"cannot write.*msh"):
        mixed().write(tmp_path / "mesh.msh")


def test_triangle_files_from_elsewhere(tmp_path):
    """Numbered from 1, with comments, attributes and boundary marks."""
    (tmp_path / "box.node").write_text(
        "# a box\n4 2 1 1\n1 0 0 5 1\n2 1 0 5 1\n3 1 1 5 0\n4 0 1 5 2 # last\n"
    )
    (tmp_path / "box.ele").write_text("2 3 1\n1 1 2 3 7\n2 1 3 4 8\n")
    mesh = Mesh.read(tmp_path / "box.node")
    assert mesh.simplices.tolist() == TWO and mesh.volume == 1
    assert mesh.markers["attribute"].tolist() == [7, 8]
    assert mesh.markers["vertices 1"].tolist() == [[0], [1]] and mesh.markers["vertices 2"].tolist() == [[3]]
    (tmp_path / "box.ele").write_text("3 3 1\n1 1 2 3 7\n")
    with pytest.raises(InputError, match="announces 3 rows but contains 1"):
        Mesh.read(tmp_path / "box.ele")
    (tmp_path / "box.ele").write_text("hello\n")
    with pytest.raises(InputError, match=r"box\.ele, line 1: 'hello' .* is no number"):
        Mesh.read(tmp_path / "box.ele")


def test_physical_groups_of_gmsh(tmp_path):
    other = meshio.Mesh(
        np.pad(SQUARE, ((0, 0), (0, 1))),
        [("line", [[0, 1], [1, 2]]), ("triangle", TWO)],
        cell_data={
            "gmsh:physical": [np.array([4, 9]), np.array([2, 2])],
            "gmsh:geometrical": [[1, 1], [1, 1]],
        },
        field_data={"inlet": np.array([4, 1])},
    )
    meshio.write(tmp_path / "box.msh", other, file_format="gmsh22")
    mesh = Mesh.read(tmp_path / "box.msh")
    assert mesh.markers["inlet"].tolist() == [[0, 1]] and mesh.markers["line 9"].tolist() == [[1, 2]]
    assert mesh.markers["gmsh:physical"].tolist() == [2, 2] and mesh.points.shape == (4, 2)


def test_files_that_are_not_meshes(tmp_path):
    with pytest.raises(InputError, match=r"there is no file none\.node; looked in"):
        Mesh.read(tmp_path / "none.node")
    (tmp_path / "bad.vtu").write_text("hello")
    with pytest.raises(InputError, match=r"cannot read bad\.vtu"):
        Mesh.read(tmp_path / "bad.vtu")
    with pytest.raises(InputError, match="cannot write"):
        Mesh(SQUARE, TWO).write(tmp_path / "mesh.hello")
    with pytest.raises(MeshError, match=r"write \.node/\.ele"):
        random_mesh(8, 4).write(tmp_path / "mesh.vtu")


def test_scikit_fem_solves_on_it():
    """Poisson's equation with the linear solution x, whose boundary values are given."""
    skfem = pytest.importorskip("skfem")
    from skfem.models.poisson import laplace

    mesh = random_mesh(60)
    half, third = np.arange(mesh.size) < 9, np.arange(mesh.size) % 3
    mesh = Mesh(mesh.points, mesh.simplices, markers={"all": mesh.boundary, "half": half, "region": third})
    theirs = mesh.to_skfem()
    assert [theirs.subdomains[f"region {k}"][:2].tolist() for k in range(3)] == [[0, 3], [1, 4], [2, 5]]
    assert theirs.t.shape[1] == mesh.size and len(theirs.boundaries["all"]) == len(mesh.boundary)
    assert theirs.subdomains["half"].tolist() == list(range(9))
    basis = skfem.Basis(theirs, skfem.ElementTriP1())
    solution = skfem.solve(
        *skfem.condense(laplace.assemble(basis), x=theirs.p[0].copy(), D=basis.get_dofs("all"))
    )
    assert solution == pytest.approx(theirs.p[0])
    assert random_mesh(d=3).to_skfem().t.shape[0] == 4 and random_mesh(5, 1).to_skfem().t.shape[0] == 2
    with pytest.raises(MeshError, match="scikit-fem"):
        mixed().to_skfem()
    with pytest.raises(MeshError, match="without cells"):
        Mesh(np.empty((0, 2)), np.empty((0, 3), dtype=int)).to_skfem()


def test_boundary_is_a_closed_walk():
    mesh = random_mesh(100)
    following = dict(mesh.boundary.tolist())
    walk = [int(mesh.boundary[0, 0])]
    while len(walk) <= len(following):
        walk.append(following[walk[-1]])
    assert walk[0] == walk[-1] and len(set(walk)) == len(following)
    for a, b in pairwise(walk):
        assert [min(a, b), max(a, b)] in mesh.edges.tolist()
