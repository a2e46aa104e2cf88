"""Heights of layers: any consistent values give the others; others are refused with a value that fits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.sizing.stretching import DEFAULT_GROWTH, Layers

FIRST, GROWTH = st.floats(1e-6, 10.0), st.floats(1.01, 2.0)
COUNT = st.integers(2, 60)


@given(FIRST, st.floats(0.9, 2.0), COUNT)
def test_geometric_sequences(first: float, growth: float, count: int) -> None:
    steps = Layers(first, growth, count).heights()
    np.testing.assert_allclose(steps, first * growth ** np.arange(count), rtol=1e-9)


@settings(max_examples=60)
@given(FIRST, GROWTH, COUNT, st.sampled_from(["geometric", "exponential", "tanh"]))
def test_any_three_give_the_fourth(first: float, growth: float, count: int, function: str) -> None:
    whole = Layers(first, growth, count, function=function)
    assume(growth > 1.001 and whole.thickness > count * first * (1 + 1e-6))
    again = Layers(first=first, count=count, thickness=whole.thickness, function=function)
    assert again.growth == pytest.approx(growth, rel=1e-6)
    back = Layers(growth=growth, count=count, thickness=whole.thickness, function=function)
    assert back.first == pytest.approx(first, rel=1e-6)
    np.testing.assert_allclose(again.cumulative(), whole.cumulative(), rtol=1e-6)
    assert whole.cumulative()[0] == 0.0 and whole.cumulative()[-1] == whole.thickness
    assert (np.diff(whole.cumulative()) > 0).all()


@settings(max_examples=40)
@given(FIRST, GROWTH, st.floats(1.0, 500.0), st.sampled_from(["geometric", "tanh"]))
def test_a_whole_number_of_layers_meets_first_and_thickness(
    first: float, growth: float, ratio: float, function: str
) -> None:
    assume(ratio == 1.0 or ratio > 2.1)
    layers = Layers(first, growth, thickness=ratio * first, function=function)
    total = layers.cumulative()
    assert total[1] == pytest.approx(first, rel=1e-9) and total[-1] == pytest.approx(ratio * first)


def test_the_exponential_function_is_the_geometric_sequence() -> None:
    b, n = 3.0, 17
    total = Layers(count=n, thickness=2.0, growth=np.exp(b / n), function="exponential").cumulative()
    np.testing.assert_allclose(total, 2.0 * np.expm1(b * np.arange(n + 1) / n) / np.expm1(b), rtol=1e-12)


def test_the_hyperbolic_tangent() -> None:
    layers = Layers(first=1e-4, count=30, thickness=0.2, function="tanh")
    s = np.arange(31) / 30

    def total(b: float) -> np.ndarray:
        return 0.2 * (1 + np.tanh(b * (s - 1)) / np.tanh(b))

    found = layers.cumulative()
    fits = [b for b in np.linspace(0.5, 12, 20001) if abs(total(b)[1] - 1e-4) < 1e-7]
    np.testing.assert_allclose(found, total(float(np.median(fits))), rtol=5e-3, atol=1e-9)
    assert np.diff(found)[-1] / np.diff(found)[-2] < 1.1 < np.diff(found)[1] / np.diff(found)[0]


def test_a_function_of_shares() -> None:
    np.testing.assert_allclose(
        Layers(count=4, thickness=2.0, function=lambda s: s**2).heights(), [0.125, 0.375, 0.625, 0.875]
    )
    assert Layers(first=0.125, count=4, function=lambda s: s**2).thickness == pytest.approx(2.0)


def test_sequences_without_an_end() -> None:
    layers = Layers(first=1e-3, growth=1.25)
    assert layers.count is None and layers.thickness is None
    np.testing.assert_allclose(layers.heights(5), 1e-3 * 1.25 ** np.arange(5))
    with pytest.raises(InputError, match="no end"):
        layers.heights()


def test_more_than_all_layers_repeat_the_last_height() -> None:
    layers = Layers(first=1.0, growth=2.0, count=3)
    np.testing.assert_allclose(layers.cumulative(5), [0, 1, 3, 7, 11, 15])
    np.testing.assert_allclose(layers.cumulative(2), [0, 1, 3])


def test_values_by_place_and_by_vertex() -> None:
    by_place = Layers(first=lambda x: 1e-3 * (1 + x[:, 0]), growth=1.2, count=3)
    assert by_place.varies and by_place.thickness is None
    found = by_place.cumulative(at=[[0.0, 0.0], [1.0, 5.0]])
    np.testing.assert_allclose(found[1], 2 * found[0])
    by_vertex = Layers(first=[1.0, 2.0], growth=1.5, count=2)
    np.testing.assert_allclose(by_vertex.heights(), [[1.0, 1.5], [2.0, 3.0]])
    np.testing.assert_allclose(by_vertex.thickness, [2.5, 5.0])
    with pytest.raises(InputError, match="give places"):
        by_place.cumulative()
    with pytest.raises(InputError, match="2 values, but there are 3 places"):
        by_vertex.cumulative(at=np.zeros((3, 2)))


def test_defaults_where_the_growth_is_open() -> None:
    assert Layers(first=1.0, count=4).growth == DEFAULT_GROWTH
    assert Layers(count=4, thickness=1.0).growth == pytest.approx(DEFAULT_GROWTH)
    assert Layers(first=1.0, thickness=5.368).count == 4
    assert Layers(first=1.0, count=1, thickness=1.0).cumulative().tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({}, "do not determine the layers: give also first or thickness"),
        ({"first": 1.0}, "give also growth"),
        ({"growth": 1.2, "count": 3}, "give also first or thickness"),
        ({"growth": 1.2, "thickness": 3.0}, "give also first or count"),
        ({"first": 1.0, "growth": 1.2, "count": 3, "thickness": 3.0}, "thickness = 3 contradicts .* 3.64"),
        ({"first": 1.0, "count": 3, "thickness": 0.5}, r"too small for 3 layers .* growth 1.2 gives 3.64"),
        (
            {"first": 1.0, "growth": 0.5, "thickness": 5.0},
            "never reach 5 times the first: a growth above 0.8",
        ),
        ({"first": 1.0, "growth": 1.2, "thickness": 0.5}, "must not be below first"),
        ({"first": -1.0, "growth": 1.2}, "first = -1.0 must be positive"),
        ({"first": [1.0, np.nan], "growth": 1.2}, r"first\[1\] = nan"),
        ({"first": "thin", "growth": 1.2}, "must be a number"),
        ({"first": [[1.0]], "growth": 1.2}, "one number or one for each vertex"),
        ({"first": [1.0, 2.0], "growth": [1.1, 1.2, 1.3]}, "give equally many"),
        ({"first": 1.0, "growth": 1.2, "count": 2.5}, "count = 2.5 must be a whole number"),
        ({"first": 1.0, "growth": 1.0 + 1e-9, "thickness": 1e9}, "ask for"),
        ({"first": 1.0, "growth": 1.2, "function": "tanh"}, "ends at a thickness"),
        ({"first": 1.0, "growth": 0.9, "count": 5, "function": "tanh"}, "above 1"),
        ({"first": 1.0, "count": 9, "thickness": 8.0, "function": "tanh"}, "hyperbolic tangent"),
        ({"first": 1.0, "growth": 1.2, "function": "cubic"}, "function must be one of"),
        ({"growth": 1.2, "count": 5, "function": np.sqrt}, "by a function of shares take count"),
        ({"first": 1.0, "count": 5, "function": np.cos}, "increasing values"),
    ],
)
def test_refused(values: dict, text: str) -> None:
    with pytest.raises(InputError, match=text):
        Layers(**values)


def test_repr() -> None:
    assert repr(Layers(first=1e-3, growth=1.2)) == "<Layers: first=0.001, growth=1.2, geometric>"
    assert "count=4" in repr(Layers(first=1.0, count=4))


def test_functions_that_raise_are_told_with_the_place() -> None:
    def fails(x: np.ndarray) -> np.ndarray:
        if (x[:, 0] > 2).any():
            raise ZeroDivisionError("no height here")
        return 0.1 + 0 * x[:, 0]

    places = np.array([[0.0, 1.0], [1.0, 1.0], [3.0, 1.0], [4.0, 1.0]])
    with pytest.raises(InputError, match=r"function for first raised ZeroDivisionError \(no height here\) at "
                       r"places\[2\] = \[3.0, 1.0\]"):  # fmt: skip
        Layers(first=fails, growth=1.2, count=4).cumulative(at=places)
    with pytest.raises(InputError, match="function of shares raised KeyError"):
        Layers(count=4, thickness=1.0, function=lambda s: {}[0])
