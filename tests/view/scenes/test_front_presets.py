"""The presets of the classical front: each shows the difficulty that its name says."""

from __future__ import annotations

import itertools

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.front_presets import FRONT_KEYS, FRONT_PRESETS, FRONT_WINDOW, front_state

SWALLOWED = "a hole, without the third test"


@pytest.mark.parametrize("preset", FRONT_PRESETS)
def test_the_whole_range(preset: str) -> None:
    low_x, high_x, low_y, high_y = FRONT_WINDOW
    for order in FRONT_KEYS:
        frames = front_state(preset, order)
        for one in frames:
            check_frame(one)
            for x, y in itertools.chain.from_iterable(
                item["data"] for item in one["items"] if item["kind"] == "points" and item["role"] != "bad"
            ):
                assert low_x < x < high_x and low_y < y < high_y
        whole = (
            frames[-1]["caption"] == "the front is empty" and "on 100% of the region" in frames[-1]["number"]
        )
        assert whole or (preset == SWALLOWED and "swallowed" in frames[-1]["caption"])


@pytest.mark.parametrize(
    ("preset", "said"),
    [
        ("a hole", "in a wider search 5, 2 contains; 3 is taken"),
        (SWALLOWED, "edge 0 1: 4, 3 not round; 5 is taken"),
        ("no vertex in the circle", "edge 1 2: X too near; in a wider search 7 is taken"),
        ("X beyond the opposite front", "edge 1 2: X crosses; in a wider search 7 is taken"),
        ("a line and a loose vertex", "X too near; 13 crosses; 14 not round; 1 crosses; 2 is taken"),
        ("fronts that touch", "X too near; 17 crosses; 20 is taken"),
        ("a corner of 1 degree", "8, 7 not round; X crosses; in a wider search 8 is taken"),
    ],
)  # fmt: skip
def test_each_shows_its_difficulty(preset: str, said: str) -> None:
    assert any(said in one["caption"] for one in front_state(preset))


def test_smallest_first_leaves_a_gap() -> None:
    angle = {
        order: float(front_state("sizes that grow", order)[-1]["number"].split()[-2])
        for order in ("oldest", "shortest", "smallest")
    }
    assert angle["smallest"] < 12 < 23 < min(angle["oldest"], angle["shortest"])


def test_of_equally_near_candidates_the_first_is_taken() -> None:
    points = FRONT_PRESETS["ties on a grid"].points
    caption = front_state("ties on a grid")[1]["caption"]
    (chosen,) = (int(word) for word in caption.split(": ")[1].split() if word.isdigit())
    middle = 1.5
    same = [k for k, (x, y) in enumerate(points) if y == 1 and abs(x - middle) == 0.5]
    assert caption.startswith("edge 1 2") and chosen == min(same) and len(same) == 2


def test_unknown_names() -> None:
    for options, text in ((("other",), "preset"), (("a hole", "widest"), "order")):
        with pytest.raises(InputError, match=text):
            front_state(*options)
