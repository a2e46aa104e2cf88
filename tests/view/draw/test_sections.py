"""What is seen of solids: sections by planes, and parts moved away from each other."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.collections import PolyCollection

from unstruct import Mesh, delaunay, view
from unstruct.base.errors import InputError
from unstruct.view.draw.items import cut_items, solid_items
from unstruct.view.draw.sections import Plane, as_plane, face_normals, filled_rows, shown_faces

CUBE = np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)])
KINDS = {
    "hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]],
    "wedge": [[0, 1, 2, 4, 5, 6], [3, 2, 1, 7, 6, 5]],
    "pyramid": [[0, 1, 3, 2, 4], [1, 5, 7, 3, 4], [3, 7, 6, 2, 4]],
    "tetra": [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]],
}


@pytest.fixture(autouse=True)
def close():
    yield
    plt.close("all")


def cloud(seed=0, count=60):
    return delaunay(np.random.default_rng(seed).random((count, 3)))


def areas(mesh, plane, *, flat):
    """The area vectors of the faces that are seen, their areas, and which of them are in the plane."""
    shown = shown_faces(mesh.points, mesh.cells, plane, flat=flat)
    normals = face_normals(shown.extended(mesh.points), shown.rows) / 2
    return normals, np.linalg.norm(normals, axis=1), shown


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("height", [0.3, 0.5, 1.0, 0.0])
def test_the_section_of_a_cube_is_a_square(kind, height):
    cube = Mesh(CUBE, cells={kind: KINDS[kind]})
    assert cube.volume == pytest.approx(1)
    for axis in "xyz":
        for sign, left in (("", height), ("-", 1 - height)):
            normals, sizes, shown = areas(cube, as_plane((sign + axis, height)), flat=True)
            if left == 0:
                assert len(shown.rows) == 0, "a cell that only touches the plane is not seen"
                continue
            assert sizes[shown.cap].sum() == pytest.approx(1)
            assert sizes[~shown.cap].sum() == pytest.approx(1 + 4 * left)
            assert shown.inner[shown.cap].all() == (left < 1), "the last face is one of the cube"
            assert np.allclose(normals.sum(axis=0), 0)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.lists(st.integers(-3, 3), min_size=3, max_size=3).filter(any), st.booleans())
def test_what_is_seen_is_closed_and_bounds_what_is_left(seed, normal, grid):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 4, (30, 3)).astype(float) if grid else rng.random((30, 3))
    points = np.unique(np.concatenate([CUBE, points]), axis=0)
    mesh = delaunay(points)
    plane = as_plane((points[rng.integers(len(points))], normal))
    for flat in (False, True):
        normals, _, shown = areas(mesh, plane, flat=flat)
        corners = shown.extended(mesh.points)
        heights = plane.heights(corners[shown.rows[shown.rows >= 0]])
        if flat and len(heights):
            assert heights.max() <= 1e-12
            assert np.allclose(plane.heights(corners[filled_rows(shown.rows[shown.cap])]), 0, atol=1e-12)
        assert np.allclose(normals.sum(axis=0), 0, atol=1e-9), "a closed surface"
        middle = np.einsum("ij,ij->", normals, corners[shown.rows[:, 0]]) / 3
        kept = plane.heights(mesh.points[mesh.simplices].mean(axis=1)) <= 0
        wanted = mesh.volumes[kept].sum() if not flat else below(mesh, plane)
        assert middle == pytest.approx(wanted, abs=1e-9)


def below(mesh, plane):
    """The volume of what is below a plane: cells are halved where an edge crosses it."""
    waiting = [(plane.heights(x).tolist(), v) for x, v in zip(mesh.points[mesh.simplices], mesh.volumes)]
    total = 0.0
    while waiting:
        heights, volume = waiting.pop()
        low, high = min(heights), max(heights)
        if low >= 0 or high <= 0:
            total += volume * (low < 0)
            continue
        share = low / (low - high)
        i, j = heights.index(low), heights.index(high)
        waiting.append(([0.0 if k == j else h for k, h in enumerate(heights)], share * volume))
        waiting.append(([0.0 if k == i else h for k, h in enumerate(heights)], (1 - share) * volume))
    return total


def test_only_the_boundary_of_what_is_kept_is_drawn():
    mesh = cloud(count=400)
    plane = as_plane(("x", 0.5))
    shown = shown_faces(mesh.points, mesh.cells, plane)
    kept = mesh.select(plane.heights(mesh.points[mesh.simplices].mean(axis=1)) <= 0)
    assert len(shown.rows) == len(kept.boundary) and shown.inner.sum() < len(shown.rows)
    turned = Mesh(mesh.points, mesh.simplices[:, [1, 0, 2, 3]])
    again = shown_faces(turned.points, turned.cells, plane)
    assert {frozenset(r) for r in again.rows.tolist()} == {frozenset(r) for r in shown.rows.tolist()}
    outward = face_normals(turned.points, again.rows)
    assert (outward / 2 * turned.points[again.rows[:, 0]]).sum() / 3 == pytest.approx(kept.volume)


def test_parts_are_moved_together():
    mesh = cloud()
    half = (mesh.points[mesh.simplices].mean(axis=1)[:, 0] > 0.5).astype(int)
    whole = solid_items(mesh, parts=half, explode=0.0)[0]
    apart = solid_items(mesh, parts=half, explode=0.5)[0]
    assert len(whole["data"]) == len(apart["data"]) > len(mesh.boundary), "faces between parts are seen"
    width = np.ptp(np.array(apart["points"])[np.unique(np.concatenate(apart["data"]))], axis=0)
    assert width[0] > np.ptp(mesh.points[:, 0]) * 1.1
    each = solid_items(mesh, parts=np.arange(mesh.size), explode=0.5)[0]
    assert len(each["data"]) == 4 * mesh.size


def test_options_of_plot():
    mesh = cloud(count=40)
    marked = Mesh(mesh.points, mesh.simplices, markers={"region": np.arange(mesh.size) % 3}, regions={"a": 0})
    for cut in ("cells", "flat"):
        for values in (None, "region", "min_dihedral", mesh.points[:, 0], np.arange(mesh.size)):
            ax = marked.plot(section=("-y", 0.5), cut=cut, values=values, explode=0.2, together="region")
            assert any(isinstance(c, PolyCollection) for c in ax.collections)
    ax = marked.plot(values="region")
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["a", "region 1", "region 2"]
    assert ax.get_aspect() == 1, "equal scales"
    ax = marked.plot(values="min_dihedral", section=((0.5, 0.5, 0.5), (1, 1, 1)))
    assert ax.figure.axes[1].get_ylabel() == "min dihedral"
    flat = delaunay(np.random.default_rng(0).random((9, 2)))
    assert flat.plot(values="min_angle").figure.axes[1].get_ylabel() == "min angle"
    colored = Mesh(flat.points, flat.simplices, markers={"region": np.arange(flat.size) % 2})
    assert len(colored.plot(values="region").get_legend().get_texts()) == 2
    assert len(flat.plot(values=flat.points[:, 0]).figure.axes) == 2


def test_a_surface_is_cut_too():
    ball = Mesh(cloud().points, cloud().boundary)
    plane = as_plane(("z", 0.5))
    crinkled, cut = (shown_faces(ball.points, ball.cells, plane, flat=flat) for flat in (False, True))
    assert len(crinkled.rows) < ball.size and not cut.cap.any()
    assert plane.heights(cut.extended(ball.points)[filled_rows(cut.rows)]).max() < 1e-12


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"section": "x"}, "section must be"),
        ({"section": ("w", 1)}, "section must be"),
        ({"section": ((0, 0, 0), (0, 0, 0))}, "normal with a length"),
        ({"section": ("x", np.nan)}, "finite"),
        ({"section": ("x", 0.5), "cut": "half"}, "'cells' or 'flat'"),
        ({"together": "region", "explode": 1.0}, "marker of cells"),
        ({"values": "region"}, "no marker 'region'"),
        ({"values": "beauty"}, "beauty"),
        ({"values": [1.0, 2.0]}, "or per vertex"),
    ],
)
def test_bad_options_are_named(options, word):
    with pytest.raises(InputError, match=word):
        cloud().plot(**options)


def test_planar_meshes_have_no_sections():
    with pytest.raises(InputError, match="section"):
        delaunay(np.random.default_rng(0).random((9, 2))).plot(section=("x", 0.5))


def test_the_turning_view_has_a_plane():
    mesh = cloud(count=100)
    shown = view.view3d(mesh, alt="A cube.", section=("y", 0.25), values="min_dihedral")
    low, high = mesh.points[:, 1].min(), mesh.points[:, 1].max()
    assert shown.section == pytest.approx((0.25 - low) / (high - low))
    assert shown.scene["section"]["normal"] == [0, 1, 0]
    assert shown.still() != view.view3d(mesh, alt="A cube.", values="min_dihedral").still()
    mixed = Mesh(CUBE, cells={"wedge": KINDS["wedge"]})
    assert {len(row) for row in view.view3d(mixed, alt="a", section=("x", 1)).scene["items"][0]["data"]} == {
        6
    }
    with pytest.raises(InputError, match="no solid cells"):
        view.view3d(Mesh(mesh.points, mesh.boundary), alt="a", section=("x", 0.5))


def test_a_scene_is_cut_like_a_mesh():
    mesh = cloud(count=100)
    plane = Plane(np.full(3, 0.5), np.array([1.0, 0, 0]))
    (item,) = cut_items([view.item3("cells", "cell", mesh.simplices, mesh.points)], plane, 0.0)
    shown = shown_faces(mesh.points, mesh.cells, plane)
    assert {frozenset(r) for r in item["data"]} == {frozenset(r) for r in shown.rows.tolist()}
    assert sum(c is not None for c in item["colors"]) == shown.inner.sum()


def test_histogram_of_dihedral_angles():
    mesh = cloud()
    ax = view.plot_dihedrals({"cloud": mesh, "again": mesh})
    heights = ax.patches[0].get_data().values
    assert heights.sum() == pytest.approx(1) and ax.get_xlim() == (0, 180)
    assert "cloud: minimum" in ax.get_legend().get_texts()[0].get_text()
    with pytest.raises(InputError, match="not tetrahedra"):
        view.plot_dihedrals(Mesh(CUBE, cells={"wedge": KINDS["wedge"]}))


@pytest.mark.parametrize("scale", [1e300, 1.0, 1e-300])
@pytest.mark.filterwarnings("error")
def test_pictures_at_all_scales_and_without_cells(scale):
    corners = CUBE * scale
    cube = Mesh(corners, KINDS["tetra"])
    for cut in ("cells", "flat"):
        ax = cube.plot(section=("x", 0.5 * scale), cut=cut, explode=0.1)
        assert np.isfinite(ax.dataLim.get_points()).all()
    empty = Mesh(corners, np.empty((0, 4), dtype=int))
    for options in ({}, {"cut": "flat"}, {"explode": 0.3}):
        empty.plot(section=("x", 0.5), values=np.empty(0), **options)
    curve = Mesh(corners, [[0, 1], [1, 3]])
    curve.plot(section=("x", 0.5 * scale), cut="flat")


def test_polygons_of_a_surface_are_cut():
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 1.5, 0], [0, 1, 0], [2, 0, 1]]
    mesh = Mesh(points, cells={"polygon": [[0, 1, 2, 3, 4]], "triangle": [[1, 5, 2]]})
    _, sizes, shown = areas(mesh, as_plane(("x", 0.5)), flat=True)
    assert sizes.tolist() == pytest.approx([0.5 + 0.125]) and shown.owner.tolist() == [0]
    ax = mesh.plot(section=("x", 0.5), cut="flat", values=np.arange(6.0))
    assert len(ax.collections) == 1
