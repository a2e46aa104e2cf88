"""Trees by hand: each frame is a step of the plain version, and the last one its result."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.plain import tree as plain
from unstruct.view import check_frame
from unstruct.view.scenes.trees import (
    balance_frames,
    division_frames,
    halo_frames,
    many,
    order_frame,
    rule_frame,
    search_frames,
)

places = st.tuples(*[st.integers(0, 31)] * 2)


def polygons(one: dict, role: str) -> list:
    """The polygons of a frame that have a role."""
    return [p for i in one["items"] if i["kind"] == "polygons" and i["role"] == role for p in i["data"]]


@given(st.lists(places, min_size=1, max_size=9, unique=True), st.integers(1, 3))
def test_divisions_are_those_of_the_plain_version(at: list[tuple[int, int]], most: int) -> None:
    points = [(Fraction(x, 32), Fraction(y, 32)) for x, y in at]

    def wanted(cell: tuple[int, ...]) -> bool:
        low, high = plain.box(cell)
        return sum(all(a <= x < b for a, x, b in zip(low, p, high)) for p in points) > most

    leaves = plain.build(2, wanted, 10)
    frames = division_frames(np.array(at) / 32, [str(k) for k in range(len(at))], most)
    for one in frames:
        check_frame(one)
    assert [len(polygons(one, "cell")) for one in frames] == [1 + 3 * k for k in range(len(frames))]
    assert all(len(polygons(one, "accepted")) == 4 for one in frames[1:])
    assert sorted(map(tuple, (p[0] for p in polygons(frames[-1], "cell")))) == sorted(
        tuple(float(c) for c in plain.box(cell)[0]) for cell in leaves
    )
    assert frames[-1]["number"].endswith(f"depth {plain.depth(leaves)}")


def test_division_stops_at_the_deepest_level() -> None:
    frames = division_frames([(0.3, 0.3), (0.3, 0.3)], "AB", deepest=4)
    assert len(frames) == 5 and frames[-1]["number"] == "13 leaves, depth 4"


@pytest.mark.parametrize("across", ["faces", "corners"])
@settings(max_examples=25)
@given(st.integers(0, 10**6))
def test_balance_ends_with_the_smallest_balanced_tree(across: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    leaves = plain.build(2, lambda cell: rng.random() < 0.4 or cell[0] < 1, 4)
    frames = balance_frames(leaves, across)
    result = plain.balance(leaves, across)
    for one in frames:
        check_frame(one)
    assert len(frames) - 1 == (len(result) - len(leaves)) // 3  # one division a frame
    assert len(polygons(frames[-1], "cell")) == len(result)
    assert len(polygons(frames[-1], "waiting")) == len(result - leaves)
    assert all(len(polygons(one, role)) == 1 for one in frames[:-1] for role in ("cavity", "highlight"))


@settings(max_examples=25)
@given(st.integers(0, 10**6), places)
def test_search_ends_at_the_leaf_of_the_point(seed: int, place: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    leaves = plain.build(2, lambda cell: rng.random() < 0.6, 5)
    point = tuple(Fraction(c, 32) for c in place)
    frames = search_frames(leaves, [float(c) for c in point])
    for one in frames:
        check_frame(one)
    (found,) = polygons(frames[-1], "accepted")
    cell = plain.locate(leaves, point)
    assert cell is not None and found[0] == [float(c) for c in plain.box(cell)[0]]
    assert len(frames) - 1 <= max(1, int(np.ceil(np.log2(len(leaves)))))
    possible = [len(polygons(one, "accepted")) for one in frames]
    assert possible[0] == len(leaves) and sorted(possible, reverse=True) == possible


def test_the_order_visits_all_leaves_and_the_bar_is_full() -> None:
    leaves = plain.build(2, lambda cell: sum(cell) % 3 != 1, 4)
    one = order_frame(leaves)
    check_frame(one)
    bar = np.array(polygons(one, "cell")[len(leaves) :])
    assert bar[0, 0, 0] == 0 and bar[-1, 1, 0] == 1 and (bar[1:, 0, 0] == bar[:-1, 1, 0]).all()
    (path,) = (item["data"] for item in one["items"] if item["kind"] == "segments")
    assert len(path) == len(leaves) - 1 == len(bar) - 1
    assert len([i for i in order_frame(leaves, numbers=False)["items"] if i["kind"] == "labels"]) == 0


def test_the_rule_and_the_proof() -> None:
    for across, count in (("faces", 3), ("corners", 4)):
        one = rule_frame(across)
        check_frame(one)
        assert len(polygons(one, "waiting")) == count and f"{count} cells" in one["number"]
    frames = halo_frames()
    for one in frames:
        check_frame(one)
    (middle,), (payer,) = polygons(frames[-1], "cavity"), polygons(frames[-1], "accepted")
    assert len(polygons(frames[-1], "layer")) == 8
    low, high = np.min(payer, axis=0), np.max(payer, axis=0)
    side = high[0] - low[0]
    chain = np.array(polygons(frames[-1], "waiting"))
    assert (chain[:, :, 0].max(axis=1) < np.max(middle, axis=0)[0] + side).all()
    assert ((chain[-1] >= low) & (chain[-1] <= high)).all()  # and ends in A
    sides = np.ptp(chain[:, :, 0], axis=1)
    assert sides.tolist() == [side / 2, side / 4, side / 8]
    for before, after in pairwise(chain):  # each touches the one before
        gap = np.maximum(before.min(axis=0) - after.max(axis=0), after.min(axis=0) - before.max(axis=0))
        assert (gap <= 0).all()


def test_numbers_with_their_nouns() -> None:
    assert many(1, "leaf", "leaves") == "1 leaf" and many(0, "point") == "0 points"
