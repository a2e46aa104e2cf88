"""The frames of tree meshes: every square in its turn, and the panel over its whole range."""

from __future__ import annotations

import pytest

from unstruct.errors import InputError
from unstruct.plain import tree, tree_templates
from unstruct.view import check_frame
from unstruct.view.scenes.tree_meshes import CUT_BOUNDARIES, cut_state, template_frames


def test_each_square_gets_its_triangles_once() -> None:
    leaves = (set(tree.children((0, 0, 0))) - {(1, 0, 0)}) | set(tree.children((1, 0, 0)))
    frames = template_frames(leaves)
    for one in frames:
        check_frame(one)
    assert frames[0]["number"] == f"{len(leaves)} squares"
    assert frames[-1]["number"] == f"{len(tree_templates.triangles(leaves))} triangles"
    counts = [int(one["number"].split()[0]) for one in frames[3:-1]]
    assert sum(counts) == len(tree_templates.triangles(leaves))
    assert len(frames) == 3 + 2 + 2  # two squares have a hanging vertex


def test_leaves_that_are_not_balanced_are_refused() -> None:
    leaves = set(tree.children((0, 0, 0)))
    for cell in ((1, 0, 0), (2, 1, 1)):
        leaves = (leaves - {cell}) | set(tree.children(cell))
    with pytest.raises(InputError, match="not balanced"):
        template_frames(leaves)


@pytest.mark.parametrize("boundary", CUT_BOUNDARIES)
def test_the_whole_range(boundary: str) -> None:
    for offset in (-0.1, -0.06, -0.02, 0.0, 0.02, 0.06, 0.1):
        for threshold in (0.0, 0.2, 0.4):
            one = cut_state(boundary, offset, threshold)
            check_frame(one)
            angle, moved = float(one["number"].split()[2]), int(one["number"].split()[4])
            assert 0 < angle <= 45
            assert moved == len(next(i for i in one["items"] if i["role"] == "inserted")["data"])
            assert (moved == 0) == (threshold == 0.0) or moved == 0


def test_warping_helps_where_the_boundary_almost_meets_vertices() -> None:
    name = "nasty: near a row"
    cut, warped = (float(cut_state(name, 0.02, t)["number"].split()[2]) for t in (0.0, 0.2))
    assert cut < 3 and warped > 30
