"""Histories: every frame is valid, tells the truth about the state, and the last one is the result."""

from math import comb

import numpy as np
import pytest

import unstruct
from unstruct import InputError, Mesh, view
from unstruct.connect.baker.modernized import insert
from unstruct.examples.running import sweep_triangulation
from unstruct.predicates.batch import in_sphere

POINTS = {
    "generic": [[0, 0], [4, 0.3], [1.8, 3.4], [2, 1.2], [3.6, 2.8], [0.4, 2.2], [1.2, 0.7]],
    "lattice": [[x, y] for x in range(3) for y in range(3)],
    "collinear first": [[0, 0], [1, 0], [2, 0], [3, 0], [1, 1], [1, -2]],
    "on an edge": [[0, 0], [2, 0], [0, 2], [1, 1], [1, 0], [0.5, 0.5]],
    "far away": [[0, 0], [1, 0], [0, 1], [1e9, 1e9], [0.3, 0.3]],
}


def drawn(frame, role):
    """The triangles drawn in a role, as sets of corners."""
    return [
        frozenset(map(tuple, polygon))
        for item in frame["items"]
        if item["kind"] == "polygons" and item["role"] == role
        for polygon in item["data"]
    ]


def corners(mesh):
    return {frozenset(map(tuple, cell)) for cell in mesh.corners.tolist()}


@pytest.mark.parametrize("name", POINTS)
def test_insertion_ends_in_the_triangulation_and_every_cavity_is_exact(name):
    points = np.array(POINTS[name], dtype=float)
    history = view.insertion_frames(points)
    for frame in history:
        view.check_frame(frame)
    last = history[-1]
    assert set(drawn(last, "cell") + drawn(last, "accepted")) == corners(
        unstruct.delaunay(points)
    ) or name in (
        "lattice",
        "on an edge",  # where ties leave a choice, the number of triangles does not depend on it
    )
    assert len(drawn(last, "cell") + drawn(last, "accepted")) == unstruct.delaunay(points).size
    for frame in history:
        (point,) = [i["data"][0] for i in frame["items"] if i["role"] == "inserted"] or [None]
        for cell in drawn(frame, "cavity"):
            assert in_sphere(counterclockwise(cell), np.array(point)) > 0, "only circles that hold the point"
    assert len({tuple(f["view"]) for f in history}) == 1, "the window never moves"


def counterclockwise(cell):
    triangle = np.array(sorted(cell))
    return triangle if unstruct.predicates.orient(triangle) > 0 else triangle[::-1]


def test_an_interior_cavity_of_k_triangles_has_k_plus_2_edges():
    history = view.insertion_frames(POINTS["generic"])
    inside = [f for f in history if f["caption"].startswith("Locate")]
    assert len(inside) == 2
    for frame in inside:
        cavity = history[history.index(frame) + 1]
        edges = int(cavity["number"].split()[0])
        assert edges == len(drawn(cavity, "cavity")) + 2
        assert len(drawn(history[history.index(frame) + 2], "accepted")) == edges


def test_a_copy_of_a_vertex_is_reported():
    history = view.insertion_frames([[0, 0], [1, 0], [0, 1], [1, 0]])
    assert history[-1]["caption"] == "Point 3 equals vertex 1: nothing to do"


def test_baker_tells_triangles_that_lie_apart_from_the_cavity():
    """Three circles contain the point; one of the triangles is not joined to the others."""
    mesh = sweep_triangulation([[5.0, 8.0], [1, 8], [3, 3], [8, 3], [5, 0], [7, 4], [4, 6]])
    point = [3.5, 3.75]
    history = view.baker_frames(mesh, [point])
    for frame in history:
        view.check_frame(frame)
    apart = [f for f in history if "apart" in f["caption"]]
    assert len(apart) == 1 and len(drawn(apart[0], "bad")) >= 1
    kept = set(drawn(history[-1], "cell"))
    assert set(drawn(apart[0], "bad")) <= kept, "what lies apart stays"
    assert kept | set(drawn(history[-1], "accepted")) == corners(insert(mesh, point))


def test_baker_from_delaunay_is_bowyer_watson():
    points = np.array(POINTS["generic"])
    start = unstruct.delaunay(points[:6])
    by_baker = view.baker_frames(start, points[6:])
    plain = view.insertion_frames(points)
    assert [f["caption"] for f in by_baker[1:]] == [f["caption"] for f in plain[-3:]]
    assert [sorted(map(sorted, drawn(f, "cavity"))) for f in by_baker[1:]] == [
        sorted(map(sorted, drawn(f, "cavity"))) for f in plain[-3:]
    ]


def test_gift_wrapping_shows_its_front_until_nothing_is_left():
    points = np.random.default_rng(4).random((12, 2))
    mesh = unstruct.delaunay(points)
    history = view.gift_wrap_frames(mesh)
    assert len(history) == mesh.size + 1 and history[-1]["number"] == "front: 0 edges"
    for k, frame in enumerate(history):
        view.check_frame(frame)
        assert len(drawn(frame, "accepted")) == max(k - 1, 0)
    assert set(drawn(history[-1], "accepted") + drawn(history[-1], "highlight")) == corners(mesh)


def test_flips_end_in_the_delaunay_triangulation():
    mesh = sweep_triangulation(np.random.default_rng(5).random((10, 2)))
    after, swaps = unstruct.swap_diagonals(mesh, history=True)
    history = view.flip_frames(mesh, swaps)
    assert len(history) == len(swaps) + 2 and 0 < len(swaps) <= comb(10, 2)
    assert set(drawn(history[-1], "cell")) == corners(after)
    least = [float(f["number"].split()[-1].rstrip("°")) for f in history]
    assert least == sorted(least), "no swap makes the least angle smaller"
    for frame in history:
        view.check_frame(frame)
    assert [f["caption"] for f in view.flip_frames(after, [])][-1].startswith("Nothing to swap")


def test_a_swapped_quadrilateral_is_crossed_by_both_diagonals():
    mesh = sweep_triangulation(np.random.default_rng(8).random((9, 2)))
    swaps = unstruct.swap_diagonals(mesh, history=True)[1]
    for frame in view.flip_frames(mesh, swaps)[1:-1]:
        (old,), (new,) = (
            [i["data"][0] for i in frame["items"] if i["role"] == r and i["kind"] == "segments"]
            for r in ("bad", "inserted")
        )
        (around,) = drawn(frame, "highlight")
        assert around == {tuple(p) for p in old + new}


def test_only_the_plane():
    for call in (
        view.insertion_frames,
        lambda p: view.baker_frames(Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), p),
    ):
        with pytest.raises(InputError, match="plane"):
            call(np.eye(4)[:, :3])
