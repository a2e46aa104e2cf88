"""The feature that the reader drags, over the whole range of the panel; trees as frames."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, quadtree
from unstruct.plain import tree as plain
from unstruct.view import check_frame
from unstruct.view.scenes.tree_states import TREE_FEATURE, TREE_KINDS, TREE_PLACES, tree_frame, tree_state


def lines(one: dict, role: str) -> int:
    return sum(len(i["data"]) for i in one["items"] if i["kind"] == "segments" and i["role"] == role)


@pytest.mark.parametrize("kind", TREE_KINDS)
def test_the_whole_range(kind: str) -> None:
    _, across = TREE_KINDS[kind]
    for x in TREE_PLACES:
        for y in TREE_PLACES:
            one = tree_state(x, y, kind)
            check_frame(one)
            leaves = int(one["caption"].split()[0])
            numbers = [float(w.strip("(),:")) for w in one["number"].split() if w.strip("(),:")[0].isdigit()]
            assert lines(one, "cell") == 2 * (leaves - 1) // 3
            if across is None:
                assert numbers == [(leaves - 1) // 3] and lines(one, "layer") == 0
                continue
            before, after, factor, most = numbers
            assert before <= after == (leaves - 1) // 3 and most == 9
            assert factor == pytest.approx(after / before, abs=0.006) and 1 <= factor <= 9
            assert lines(one, "layer") == 2 * (after - before)


@pytest.mark.parametrize(("x", "y"), [(0.5, 0.5), (0.05, 0.95), (0.32, 0.68)])
@pytest.mark.parametrize("kind", [kind for kind in TREE_KINDS if "depth 5" in kind])
def test_it_is_the_tree_of_the_plain_version(x: float, y: float, kind: str) -> None:
    depth, across = TREE_KINDS[kind]

    def meets(cell: tuple[int, ...]) -> bool:
        low, high = plain.box(cell)
        beyond = [max(float(a) - c, c - float(b), 0.0) for a, c, b in zip(low, (x, y), high)]
        return beyond[0] ** 2 + beyond[1] ** 2 <= TREE_FEATURE**2

    leaves = plain.build(2, meets, depth)
    if across is not None:
        leaves = plain.balance(leaves, across)
    boxes = [tuple(float(c) for corner in plain.box(cell) for c in corner) for cell in leaves]
    vertices = {(u, v) for a, b, c, d in boxes for u in (a, c) for v in (b, d)}
    hanging = sum(
        any((u in (a, c) and b < v < d) or (v in (b, d) and a < u < c) for a, b, c, d in boxes)
        for u, v in vertices
    )
    one = tree_state(x, y, kind)
    assert one["caption"] == f"{len(leaves)} leaves, {hanging} hanging vertices"


def test_an_unknown_kind() -> None:
    with pytest.raises(InputError, match="tree = 'deep' must be one of 'depth 5, as divided'"):
        tree_state(0.5, 0.5, "deep")


def test_a_tree_as_a_frame() -> None:
    disc = Domain.disc((0, 0), 1)
    tree = quadtree(disc, boundary_size=0.3)
    one = tree_frame(tree, "a disc", hanging=True, points=[(0, 0)])
    check_frame(one)
    roles = {i["role"]: i["data"] for i in one["items"] if i["kind"] == "polygons"}
    assert {role: len(data) for role, data in roles.items()} == {
        "muted": (tree.states == -1).sum(),
        "cell": (tree.states == 1).sum(),
        "waiting": (tree.states == 0).sum(),
    }
    dots = [i["data"] for i in one["items"] if i["kind"] == "points"]
    assert len(dots[0]) == len(tree.hanging.vertices) and dots[1] == [[0, 0]]
    assert one["number"] == f"{len(tree)} leaves, depth {tree.depth}"
    area = sum(np.ptp(p, axis=0).prod() for data in roles.values() for p in data)
    assert area == pytest.approx(np.ptp(tree.box, axis=0).prod())
