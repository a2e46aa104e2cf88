"""Triangles removed one by one, and lines that cut a mesh: the counts are those of meshes made anew."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from unstruct import InputError, Mesh, check, delaunay
from unstruct.plain.adjacency import face_counts
from unstruct.view import CUT_MESH, check_frame, cut_counts, line_cut_state, peeling_frames


def three(number: str) -> list[int]:
    return [int(word) for word in number.split() if word.isdigit()]


@pytest.mark.parametrize("seed", range(4))
def test_a_disk_is_peeled_to_any_triangle(seed: int) -> None:
    mesh = delaunay(np.random.default_rng(seed).random((12, 2)))
    for keep in range(0, mesh.size, 3):
        frames = peeling_frames(mesh.points, mesh.simplices.tolist(), keep)
        assert len(frames) == mesh.size
        for k, one in enumerate(frames):
            check_frame(one)
            n, e, t, chi = three(one["number"])
            assert t == mesh.size - k and n - e + t == chi == 1
        last = [i for i in frames[-1]["items"] if i["role"] == "highlight"]
        assert np.array_equal(last[0]["data"][0], mesh.corners[keep])


def test_what_is_no_disk_is_refused() -> None:
    ring = [(0, 1, 3), (1, 4, 3), (1, 2, 4), (2, 5, 4), (2, 0, 5), (0, 3, 5)]
    points = [(0, 0), (9, 0), (4, 9), (3, 2), (5, 2), (4, 4)]
    frames = peeling_frames(points, ring[:5])  # a ring that is cut open is a disk
    assert len(frames) == 5
    with pytest.raises(InputError, match=r"none of the .* triangles but 0 may be removed: this is no disk"):
        peeling_frames(points, ring)
    with pytest.raises(InputError, match=r"keep = 7 must be one of the 6"):
        peeling_frames(points, ring, 7)


def twice(p: list) -> Fraction:
    """Twice the area of a polygon."""
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(p, [*p[1:], p[0]]))


@pytest.mark.parametrize("offset", np.linspace(0, 6, 13))
@pytest.mark.parametrize("slope", [-2, -1, -0.5, 0, 0.25, 2])
def test_cuts(offset: float, slope: float) -> None:
    """Each piece is joined to a fan of triangles; the mesh of them all has the counts that are claimed."""
    points, cells = CUT_MESH
    (n, e, t), below, above = cut_counts(points, cells, offset, slope)
    pieces = below + above
    assert len(pieces) == t and n - e + t == 1
    assert len({p for piece in pieces for p in piece}) == n
    sides = {frozenset(side) for piece in pieces for side in zip(piece, [*piece[1:], piece[0]])}
    assert len(sides) == e
    assert sum(twice(piece) for piece in pieces) == sum(
        twice([tuple(map(Fraction, points[v])) for v in cell]) for cell in cells
    )
    one = line_cut_state(offset, slope)
    check_frame(one)
    assert three(one["number"]) == [*face_counts(cells), 1, n, e, t, 1]


def test_the_example_is_a_mesh() -> None:
    assert check(Mesh(np.array(CUT_MESH[0], dtype=float), CUT_MESH[1]))


@pytest.mark.parametrize(("offset", "slope"), [(-1, 0), (7, 0), (3, 2.5), (float("nan"), 0)])
def test_wrong_lines(offset: float, slope: float) -> None:
    with pytest.raises(InputError, match="must lie between"):
        line_cut_state(offset, slope)
