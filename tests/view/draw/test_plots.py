"""Pictures: the roles differ by more than color, frames are valid, every plot draws what it should."""

import io
from itertools import combinations
from types import SimpleNamespace

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import mixed_cells
import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from scipy.spatial import Delaunay, Voronoi

from unstruct import Mesh, view
from unstruct.base.errors import InputError
from unstruct.view.draw import colors, frames, plots
from unstruct.view.draw.painting import axes3, things_of


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def planar():
    points = np.random.default_rng(3).random((12, 2))
    made = Delaunay(points)
    return SimpleNamespace(points=points, simplices=made.simplices, neighbors=made.neighbors, cells=None)


def collections(ax, kind):
    return [c for c in ax.collections if isinstance(c, kind)]


# ---- roles -------------------------------------------------------------------------------------

# what is left of linear RGB for the two common kinds of color blindness (Viénot and others, 1999)
BLIND = {
    "protanopia": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deuteranopia": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}


def test_no_two_roles_differ_by_color_alone():
    for (a, x), (b, y) in combinations(view.ROLES.items(), 2):
        assert (x.width, x.dash) != (y.width, y.dash), f"lines of {a} and {b} differ by color alone"
        assert x.marker != y.marker or x.size != y.size, f"points of {a} and {b} differ by color alone"


@pytest.mark.parametrize("kind", BLIND)
def test_roles_met_together_are_told_apart_by_color_blind_readers(kind):
    together = ["vertex", "inserted", "cavity", "circumcircle", "voronoi", "highlight"]
    seen = {n: np.array(BLIND[kind]) @ np.array(to_rgb(view.ROLES[n].color)) ** 2.2 for n in together}
    for a, b in combinations(together, 2):
        apart = np.abs(np.clip(seen[a], 0, 1) ** (1 / 2.2) - np.clip(seen[b], 0, 1) ** (1 / 2.2)).max()
        assert apart > 0.1, (a, b, apart)


def test_an_unknown_role_is_named():
    with pytest.raises(KeyError, match=r"no role 'purple'.*vertex"):
        colors.role("purple")


def test_pictures_are_opaque_and_the_same_bytes_twice(planar):
    view.setup()
    made = [colors.png(view.plot(planar, names=True).figure) for _ in range(2)]
    assert made[0] == made[1] and b"Software" not in made[0] and len(made[0]) < 20000
    pixels = plt.imread(io.BytesIO(made[0]))
    assert pixels.shape[2] == 3 or (pixels[..., 3] == 1).all()
    assert (pixels[0, 0, :3] == 1).all(), "the paper stays white"


def test_setup_in_a_notebook_shows_figures_as_such_pictures(planar):
    """In IPython, a figure that is displayed goes through the book's own PNG writer."""
    from IPython.core.interactiveshell import InteractiveShell

    class Shell(InteractiveShell):
        def enable_gui(self, gui=None):
            """No windows here."""

    shell = Shell.instance()
    backend = matplotlib.get_backend()
    try:
        view.setup()
        figure = view.plot(planar).figure
        shown, _ = shell.display_formatter.format(figure)
        assert shown["image/png"] == colors.png(figure)
        assert matplotlib.get_backend().endswith("inline")
    finally:
        Shell.clear_instance()
        matplotlib.use(backend)


def test_the_few_colors_of_a_picture_are_near_the_true_ones(planar):
    figure = view.plot(planar, values=np.arange(len(planar.simplices)), label="number").figure
    full = io.BytesIO()
    figure.savefig(full, format="png", bbox_inches="tight", pad_inches=0.06)
    true, few = (plt.imread(io.BytesIO(b))[..., :3] for b in (full.getvalue(), colors.png(figure)))
    assert true.shape == few.shape and np.abs(true - few).mean() < 0.01


def test_bars_of_letters_are_drawn():
    """A halo by path effects lost the middle bar of E and F at some places."""
    for shift in np.linspace(0, 1, 8):
        figure, ax = plt.subplots(figsize=(1, 1), dpi=90)
        view.draw(
            frames.frame("", frames.labels("vertex", [[0.3, 0.3 + shift / 50]], "E"), view=(0, 1, 0, 1)), ax
        )
        figure.canvas.draw()
        ink = np.asarray(figure.canvas.buffer_rgba())[..., 0] < 190
        assert (ink.sum(axis=1) >= 4).sum() >= 3, "three bars"


# ---- frames ------------------------------------------------------------------------------------


def test_frames_made_by_the_helpers_are_valid():
    one = frames.frame(
        "all kinds",
        frames.dots("inserted", [0, 1], handles=["P"]),
        frames.segments("edge", [[[0, 0], [1, 1]]]),
        frames.polygons("cavity", [[[0, 0], [1, 0], [0, 1]]], opacity=0.5),
        frames.circles("circumcircle", [[0, 0]], [2]),
        frames.labels("vertex", [[0, 0]], ["A"]),
        number="R = 2",
        view=(0, 1, 0, 1),
    )
    view.check_frame(one)
    assert frames.bounds([one]) == [0, 1, 0, 1]


BAD = {
    "kind": {"kind": "blobs"},
    "role": {"role": "purple"},
    "not a list": {"data": np.zeros((1, 2))},
    "finite numbers": {"data": [[0.0, float("nan")]]},
    "2 finite": {"data": [[0.0, 1.0, 2.0]]},
    "handles": {"handles": ["P", "Q"]},
    "opacity": {"opacity": 2},
    "text": {"kind": "labels"},
    "two ends": {"kind": "segments", "data": [[[0.0, 0.0]]]},
    "radius": {"kind": "circles", "data": [[0.0, 0.0, -1.0]]},
}


@pytest.mark.parametrize("word", BAD)
def test_a_bad_item_is_named(word):
    item = {"kind": "points", "role": "vertex", "data": [[0.0, 1.0]], **BAD[word]}
    with pytest.raises(InputError, match=f"item 0 of the frame 'x'.*{word}"):
        view.check_frame(frames.frame("x", item))


def test_a_frame_with_missing_or_strange_entries_is_refused():
    good = frames.frame("x")
    for bad in ({}, {**good, "title": "y"}, {**good, "number": 3}, {**good, "view": [1, 0, 0, 1]}):
        with pytest.raises(InputError):
            view.check_frame(bad)


def test_one_huge_circle_does_not_shrink_the_window():
    triangle = frames.polygons("cell", [[[0, 0], [2, 0], [0, 1]]])
    huge = frames.circles("circumcircle", [[0, 0]], [1e6])
    x0, x1, y0, y1 = frames.bounds([frames.frame("", triangle, huge)])
    assert -0.5 < x0 < 0 and 2 < x1 < 2.5 and -0.5 < y0 < 0 and 1 < y1 < 1.5
    assert frames.bounds([frames.frame("", frames.circles("muted", [[0, 0]], [1]))])[1] >= 1
    assert frames.bounds([frames.frame("")]) == [0, 1, 0, 1]
    flat = frames.bounds([frames.frame("", frames.dots("vertex", [[0, 0], [4, 0]]))])
    assert flat[3] - flat[2] >= 1, "collinear points still get a window"


def test_a_shared_side_is_dashed_once():
    squares = [
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        [[1.0, 1.0], [1.0, 1e-13], [2.0, 0.0], [2.0, 1.0]],
    ]
    assert len(frames.outline(squares)) == 7 + 1, "1e-13 is another corner"
    squares[1][1][1] = 0.0
    assert len(frames.outline(squares)) == 7
    ax = view.draw(frames.frame("", frames.polygons("voronoi", squares)))
    assert len(collections(ax, LineCollection)[0].get_segments()) == 7


# ---- strips and plots --------------------------------------------------------------------------


def test_the_strip_has_a_picture_a_frame_in_one_window():
    history = [
        frames.frame(f"step {k}", frames.dots("vertex", [[0, 0], [k, 1]]), number=f"k = {k}")
        for k in range(1, 7)
    ]
    figure = view.strip(history, columns=4)
    shown = [ax for ax in figure.axes if ax.axison]
    assert len(shown) == 6 and len(figure.axes) == 8
    assert len({ax.get_xlim() + ax.get_ylim() for ax in shown}) == 1
    assert shown[2].get_title(loc="left").startswith("3") and shown[2].get_xlabel() == "k = 3"
    with pytest.raises(InputError):
        view.strip([])


def test_every_kind_of_item_is_drawn():
    ax = view.draw(
        frames.frame(
            "",
            frames.polygons("cavity", [[[0, 0], [1, 0], [0, 1]]] * 3),
            frames.circles("circumcircle", [[0, 0]] * 2, [1, 2]),
            frames.segments("front", [[[0, 0], [1, 1]]] * 4),
            frames.dots("inserted", [[0.5, 0.5]]),
            frames.labels("vertex", [[0, 0]], ["A"]),
            frames.dots("vertex", []),
        )
    )
    assert len(collections(ax, PolyCollection)[0].get_paths()) == 3
    assert len(collections(ax, EllipseCollection)[0].get_offsets()) == 2
    assert len(collections(ax, LineCollection)[0].get_segments()) == 4
    assert len(ax.lines) == 1 and ax.texts[0].get_text() == "A"


def test_plot_draws_every_cell_of_every_type():
    quads = SimpleNamespace(
        points=np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]]),
        simplices=None,
        cells={"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]]},
    )
    ax = view.plot(quads, names=True, role="accepted")
    assert sorted(len(p.vertices) - 1 for p in collections(ax, PolyCollection)[0].get_paths()) == [3, 4]
    assert [t.get_text() for t in ax.texts] == [c for c in "01234" for _ in (0, 1)], "a halo and a text each"


def test_a_mesh_without_points_is_an_empty_picture():
    for d, kind in ((1, "line"), (2, "quad"), (3, "hexahedron")):
        ax = Mesh(np.empty((0, d)), cells={kind: []}).plot()
        assert not collections(ax, PolyCollection)


def test_huge_solids_are_shaded():
    with np.errstate(all="raise", under="ignore"):
        mixed_cells.cloud("pyramid", np.array([mixed_cells.GOOD["pyramid"]]) * 1e150).plot()


def test_plot_of_values_has_a_color_bar_and_counts_them(planar):
    ax = view.plot(planar, values=np.arange(len(planar.simplices)), label="number")
    assert len(ax.figure.axes) == 2 and ax.figure.axes[1].get_ylabel() == "number"
    with pytest.raises(InputError, match="one entry per cell"):
        view.plot(planar, values=[1, 2])


def test_lines_of_many_cells_are_thinner():
    def width(mesh):
        return collections(view.plot(mesh, vertices=False), PolyCollection)[0].get_linewidth()[0]

    points = np.random.default_rng(0).random((600, 2))
    few, many = (Mesh(points[:n], Delaunay(points[:n]).simplices) for n in (60, 600))
    assert width(few) == view.ROLES["cell"].width > width(many) > 0.2


def test_plot_of_a_line_and_of_four_dimensions():
    line = SimpleNamespace(points=np.array([[0.0], [1], [3]]), simplices=np.array([[0, 1], [1, 2]]))
    assert len(collections(view.plot(line), LineCollection)[0].get_segments()) == 2
    with pytest.raises(InputError, match="4 dimensions"):
        view.plot(SimpleNamespace(points=np.zeros((5, 4)), simplices=np.arange(5)[None]))


def test_circumcircles_pass_through_the_corners(planar):
    ax = view.plot_circumcircles(planar, [0, 2])
    circles = collections(ax, EllipseCollection)[0]
    centers, radii = circles.get_offsets(), circles.get_widths() / 2
    corners = planar.points[planar.simplices[[0, 2]]]
    assert np.allclose(np.linalg.norm(corners - centers[:, None], axis=2), radii[:, None])


def test_a_flat_cell_has_no_circle_to_draw():
    flat = SimpleNamespace(
        points=np.array([[0.0, 0], [1, 0], [2, 0], [0, 1]]), simplices=np.array([[0, 1, 2], [0, 1, 3]])
    )
    assert len(collections(view.plot_circumcircles(flat), EllipseCollection)[0].get_offsets()) == 1


def test_the_dual_of_a_mesh_is_the_voronoi_diagram(planar):
    """Ridges from the mesh's neighbors and from SciPy's diagram are the same segments and rays."""

    def canonical(diagram):
        lines, nodes, pairs = plots.dual_segments(diagram, reach=9.0)
        order = np.argsort([min(p) * 1000 + max(p) for p in pairs])
        return [sorted(map(tuple, np.round(lines[k], 6).tolist())) for k in order], len(nodes)

    assert canonical(planar) == canonical(Voronoi(planar.points))


def test_rays_point_away_from_the_sites(planar):
    lines, nodes, pairs = plots.dual_segments(planar, reach=9.0)
    rays = [k for k, line in enumerate(lines) if not np.isclose(line[1], nodes).all(axis=1).any()]
    assert len(rays) >= 3
    for k in rays:
        far = np.linalg.norm(planar.points - lines[k][1], axis=1)
        assert set(np.argsort(far)[:2]) == set(pairs[k].tolist()), "the far end is nearest to its two sites"


def test_collinear_sites_have_whole_lines():
    line = SimpleNamespace(
        points=np.array([[0.0, 0], [1, 0], [3, 0]]),
        vertices=np.zeros((0, 2)),
        ridge_points=np.array([[0, 1], [1, 2]]),
        ridge_vertices=[[-1, -1], [-1, -1]],
    )
    drawn = plots.dual_segments(line, reach=5.0)[0]
    assert np.allclose(drawn[:, :, 0], [[0.5, 0.5], [2, 2]]) and (np.ptp(drawn[:, :, 1], axis=1) >= 10).all()
    assert len(collections(view.plot_voronoi(line, delaunay=True), LineCollection)) == 2


def test_the_cavity_is_marked(planar):
    ax = view.plot_cavity(planar, [0, 1], planar.points[planar.simplices[0]].mean(axis=0), vertices=False)
    assert len(collections(ax, PolyCollection)[1].get_paths()) == 2
    assert [line.get_marker() for line in ax.lines] == [view.ROLES["inserted"].marker]
    solid = SimpleNamespace(points=np.eye(4)[:, :3], simplices=np.arange(4)[None])
    with pytest.raises(InputError, match="view3d"):
        view.plot_cavity(solid, [0], [0, 0, 0])


def test_quality_histograms_share_bins_and_tell_what_is_not_finite():
    fine = SimpleNamespace(quality=lambda name: np.array([10.0, 20.0, 60.0]))
    flat = SimpleNamespace(quality=lambda name: np.array([30.0, np.inf]))
    ax = view.plot_quality({"fine": fine, "flat": flat}, "min_angle")
    shown = [t.get_text() for t in ax.get_legend().get_texts()]
    assert shown == ["fine: minimum 10, mean 30", "flat: minimum 30, mean 30, 1 not finite"]
    assert "degrees" in ax.get_xlabel() and len(ax.patches) == 4


def test_huge_circles_are_arcs_that_pass_where_they_should():
    """Every point of the arc keeps its distance from the center, to a pixel of the window."""
    for r in (10.0, 1e3, 1e8, 1e15):
        line = frames.arc([0.5 + r, 0.5, r], (0, 1, 0, 1))
        assert np.allclose(np.hypot(line[:, 0] - 0.5 - r, line[:, 1] - 0.5), r, rtol=1e-12)
        assert np.abs(line[24] - 0.5).max() < 1e-9 or r > 1e14
    huge = frames.frame("", frames.circles("circumcircle", [[1e9, 0], [0, 0]], [1e9, 1]), view=(-1, 1, -1, 1))
    ax = view.draw(huge)
    assert len(collections(ax, LineCollection)[0].get_segments()) == 1
    assert len(collections(ax, EllipseCollection)[0].get_offsets()) == 1


# ---- the player --------------------------------------------------------------------------------


def test_the_player_holds_all_that_it_draws():
    history = [frames.frame(f"step {k}", frames.dots("vertex", [[k / 3, 1 / 7]])) for k in range(3)]
    shown = view.player(history, alt=" Three points. ")
    assert shown.index == 0 and shown.alt == "Three points." and set(shown.styles) == set(view.ROLES)
    assert [f["caption"] for f in shown.frames] == ["step 0", "step 1", "step 2"]
    assert shown.frames[1]["items"][0]["data"] == [[0.33333, 0.14286]], "coordinates to a part of a pixel"
    assert history[1]["items"][0]["data"] == [[1 / 3, 1 / 7]], "the frames given are left alone"
    assert len(repr(shown)) < 100, "what a page without widgets shows is short"
    shown.show(history[:2], index=5)
    assert shown.index == 1 and len(shown.frames) == 2


def test_the_player_refuses_what_it_cannot_show():
    good = frames.frame("x", frames.dots("vertex", [[0, 0]]))
    with pytest.raises(InputError, match="at least one frame"):
        view.player([], alt="x")
    with pytest.raises(InputError, match="alt"):
        view.player([good], alt=" ")
    with pytest.raises(InputError, match="item 0"):
        view.player([good, {**good, "items": [{"kind": "blobs"}]}], alt="x")


# ---- space -------------------------------------------------------------------------------------

SOLID = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], [[0, 1, 2, 3], [1, 4, 2, 3]])


def test_the_axes_of_a_view_are_orthonormal_and_right_handed():
    for azimuth, elevation in ((0, 0), (-55, 22), (200, -90), (30, 90)):
        turn = axes3(azimuth, elevation)
        assert np.allclose(turn @ turn.T, np.eye(3)) and np.isclose(np.linalg.det(turn), 1)
    assert np.allclose(axes3(0, 0)[2], [1, 0, 0]), "azimuth 0 looks along the x axis"


def test_a_view_in_space_holds_the_cells_and_their_ball():
    shown = view.view3d(SOLID, alt="Two tetrahedra.", caption="two", explode=0.5)
    (item,) = shown.scene["items"]
    assert item["kind"] == "cells" and item["data"] == SOLID.simplices.tolist()
    assert np.allclose(shown.scene["ball"], [0.5, 0.5, 0.5, 3**0.5 / 2])
    assert (shown.explode, shown.caption, repr(shown)) == (0.5, "two", "Space(Two tetrahedra.)")


def test_items_in_space_follow_the_kind_of_cells():
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    mixed = Mesh([*square, [2, 0.5]], cells={"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]]})
    assert [len(i["data"][0]) for i in view.mesh_items3(mixed)] == [4, 3]
    assert {i["kind"] for i in view.mesh_items3(mixed)} == {"polygons"}
    cube = Mesh([[*p, z] for z in (0, 1) for p in square], cells={"hexahedron": [range(8)]})
    assert len(view.mesh_items3(cube)[0]["data"]) == 6, "of other solids, the boundary"
    curve = Mesh([[0.0, 0, 0], [1, 0, 1]], [[0, 1]])
    assert view.mesh_items3(curve)[0]["kind"] == "segments"
    assert len(view.mesh_items3(SOLID, only=[1])[0]["data"]) == 1


def test_a_large_solid_is_its_boundary():
    points = np.random.default_rng(0).random((700, 3))
    large = Mesh(points, Delaunay(points).simplices)
    (item,) = view.mesh_items3(large)
    assert large.size > 2500 and item["kind"] == "polygons" and len(item["data"]) == len(large.boundary)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("blobs", "edge", []), "no kind"),
        (("polygons", "edge", [[0, 1, 2]], [[0, 0, 0]]), "row 0"),
        (("segments", "edge", [[-1, 0]], [[0, 0, 0]]), "row 0"),
        (("points", "edge", [[0, 0, np.nan]]), "finite"),
        (("labels", "edge", [[0, 0, 0]]), "texts"),
    ],
)
def test_bad_items_in_space_are_named(arguments, word):
    with pytest.raises(InputError, match=word):
        view.item3(*arguments)


def test_a_view_refuses_what_it_cannot_turn():
    with pytest.raises(InputError, match="alt"):
        view.view3d(SOLID, alt="")
    with pytest.raises(InputError, match="faces"):
        view.view3d([view.item3("polygons", "cell", [[0, 1, 2]] * 20001, np.eye(3))], alt="x")
    with pytest.raises(InputError, match="4 dimensions"):
        view.view3d(SimpleNamespace(points=np.zeros((5, 4)), simplices=np.arange(5)[None]), alt="x")
    with pytest.raises(InputError, match="one entry per cell"):
        view.view3d(SOLID, alt="x", values=[1])


def test_the_static_picture_paints_the_near_face_last():
    for azimuth, near in ((0, 1.0), (180, 0.0)):
        walls = view.item3(
            "polygons",
            "accepted",
            [[0, 1, 2], [3, 4, 5]],
            [[0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [1, 0, 1]],
        )
        things = things_of([walls], np.zeros(3), 1.0, axes3(azimuth, 0), 0.0)
        assert max(things, key=lambda t: t[0])[3][0][0] == near
    ax = view.plot(SOLID, explode=0.3)
    assert sum(len(c.get_paths()) for c in collections(ax, PolyCollection)) == 8


def test_every_kind_of_item_in_space_is_drawn():
    corners = np.eye(4)[:, :3]
    items = [
        view.item3("cells", "accepted", [[3, 0, 1, 2]], corners),
        view.item3("segments", "front", [[0, 1]], corners),
        view.item3("points", "vertex", corners),
        view.item3("labels", "vertex", corners, text="ABCD"),
        view.item3("spheres", "circumcircle", [[0.5, 0.5, 0.5, 0.75**0.5]]),
    ]
    ax = view.picture(items)
    assert sorted(t.get_text() for t in ax.texts) == list("AABBCCDD"), "a halo and a text each"
    assert len(collections(ax, LineCollection)) == 1 and len(ax.patches) == 1
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    assert x1 - x0 > 3**0.5 and y1 - y0 > 3**0.5, "the whole sphere is in the picture"
    colored = view.plot(SOLID, values=[1, 2], label="cell")
    assert colored.figure.axes[1].get_ylabel() == "cell"
    assert len(view.picture([]).collections) == 0


def test_mixed_meshes_are_drawn():
    flat, solid = mixed_cells.planar(4, jitter=0.2, seed=1), mixed_cells.spatial(2, jitter=0.1)
    ax = view.plot(flat, values=np.arange(flat.size))
    (drawn,) = [c for c in ax.collections if isinstance(c, PolyCollection)]
    assert len(drawn.get_paths()) == flat.size and drawn.get_array().tolist() == list(range(flat.size))
    assert len(view.plot(flat).collections) >= 1
    (skin,) = view.mesh_items3(solid)
    assert [len(row) for row in skin["data"]] == [np.count_nonzero(row >= 0) for row in solid.boundary]
    (colored,) = view.mesh_items3(solid, values=np.arange(solid.size))
    kept = {frozenset(row): color for row, color in zip(colored["data"], colored["colors"])}
    owner = dict(
        zip([frozenset(v for v in row if v >= 0) for row in solid.facets.tolist()], solid.facet_cells)
    )
    scale = [to_hex(c) for c in matplotlib.colormaps["cividis"](np.linspace(0, 1, solid.size))]
    assert all(color == scale[owner[face][0]] for face, color in kept.items())
    (part,) = view.mesh_items3(solid, only=[12, 15])
    assert len(part["data"]) == len(solid.select([12, 15]).boundary)
    with pytest.raises(InputError, match="one entry per cell"):
        view.mesh_items3(solid, values=[1, 2])
    assert view.plot(solid, values=np.arange(solid.size)) is not None
    plt.close("all")


def test_histograms_of_mixed_meshes():
    ax = view.plot_quality(
        {"flat": mixed_cells.planar(4), "solid": mixed_cells.spatial(2)}, "scaled_jacobian"
    )
    assert ax.get_xlabel() == "scaled jacobian"
    plt.close("all")
