"""The shortest edges of a front in a channel, over the whole range of the panel."""

from __future__ import annotations

import re

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.tapered_states import TAPERED_RULES, TAPERED_WIDTHS, tapered_state


@pytest.mark.parametrize("rule", TAPERED_RULES)
def test_the_whole_range_keeps_the_bound(rule: str) -> None:
    for width in TAPERED_WIDTHS:
        one = tapered_state(width, rule)
        check_frame(one)
        shortest, first, bound = map(float, re.findall(r"([\d.]+) h", one["number"]))
        assert bound == min(0.64, first) <= shortest <= first
        assert first == pytest.approx(width) or width > 0.8
        (low, high), = next(item["data"] for item in one["items"] if item["role"] == "highlight")  # fmt: skip
        assert shortest == pytest.approx(sum((p - q) ** 2 for p, q in zip(low, high)) ** 0.5, abs=0.006)


def test_the_ends_of_the_range_and_unknown_values() -> None:
    check_frame(tapered_state(0.05, "circle"))
    check_frame(tapered_state(2.6, "equal sides"))
    with pytest.raises(InputError, match="circle"):
        tapered_state(1.0, "square")
    for width in (0.0, 3.0, float("nan")):
        with pytest.raises(InputError, match="width"):
            tapered_state(width)
