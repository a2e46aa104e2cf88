"""Size fields, their combinations, and the tables that kernels read."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import InputError
from unstruct.examples.running import running_size
from unstruct.sizing import SizeField, SizeTable, as_size, clip, control, maximum, minimum, product

TIP = np.array([0.3137, 0.7071])
SMOOTH = {
    "constant function": lambda x: np.full(len(x), 0.1),
    "linear": lambda x: 0.01 + 0.2 * x[:, 0] + 0.05 * x[:, 1],
    "cone": lambda x: 1e-4 + 0.1 * np.linalg.norm(x - TIP, axis=1),
    "circle": lambda x: 0.01 + 0.1 * np.abs(np.linalg.norm(x - 0.5, axis=1) - 0.3),
    "running": running_size,
    "by 1e4": lambda x: 10.0 ** (-1 - 4 * x[:, 0]) * (1 + 0.1 * np.sin(5 * x[:, 1])),
}


def jump(x: np.ndarray) -> np.ndarray:
    return np.where(x[:, 0] + 0.3 * x[:, 1] < 0.61, 0.01, 0.3)


def grid(k: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.linspace(0, 1, k), np.linspace(0, 1, k)), axis=-1).reshape(-1, 2)


# ---------------------------------------------------------------------- what a size is


def test_numbers_functions_and_fields() -> None:
    field = as_size(0.25)
    assert field.constant == 0.25 and field([[0, 0], [5, 5]]).tolist() == [0.25, 0.25]
    assert (
        as_size(np.float32(0.5)).constant == as_size(np.array(0.5)).constant == 0.5
        and as_size(2).constant == 2.0
    )
    assert as_size(field) is field
    function = as_size(running_size)
    assert function.constant is None and "running_size" in repr(function)
    x = grid(7)
    assert (function(x) == running_size(x)).all()
    assert as_size(lambda x: x[:, 2])([[1, 2, 3]]).tolist() == [3.0]  # three dimensions


@pytest.mark.parametrize("bad", [0, -1.0, math.nan, math.inf, "0.1", None, [0.1], np.ones(1), True, 1j, {}])
def test_what_is_no_size(bad: object) -> None:
    with pytest.raises(InputError, match="size must be"):
        as_size(bad)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda x: x[:, 0] - 0.5, r"it is -0.5 at x\[0\] = \[0.0, 0.0\]"),
        (lambda x: np.where(x[:, 0] > 0.9, 0.0, 1.0), r"it is 0.0 at x\[4\] = \[1.0, 0.0\]"),
        (lambda x: np.where(x[:, 1] > 0.9, np.nan, 1.0), r"it is nan at x\[20\] = \[0.0, 1.0\]"),
        (lambda x: 1 / np.where(x[:, 0] > 0.9, 0.0, 1.0), r"it is inf at x\[4\]"),
        (lambda x: 0.1, r"shape \(25,\) for 25 points, not \(\); give a constant size"),
        (lambda x: np.ones((len(x), 1)), r"not \(25, 1\)"),
        (lambda x: ["a"] * len(x), "plain real numbers"),
        (lambda x: np.full(len(x), 1j), "plain real numbers"),
        (lambda x: np.ma.masked_less(x[:, 0] + 1, 1.5), "plain real numbers"),
        (lambda x: x.no_such_thing, r"AttributeError .* at x\[0\]"),
        (lambda x: [1 / (1.0 - float(a)) for a, _ in x], r"ZeroDivisionError .* at x\[4\] = \[1.0, 0.0\]"),
        (lambda x: [math.sqrt(0.4 - b) + 1 for _, b in x], r"ValueError .* at x\[10\] = \[0.0, 0.5\]"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_bad_functions_are_named_with_the_place(function: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        as_size(function)(grid(5))


def test_the_cause_is_kept_and_inner_fields_speak_for_themselves() -> None:
    with pytest.raises(InputError) as caught:
        as_size(lambda x: x[:, 7])(grid(2))
    assert isinstance(caught.value.__cause__, IndexError)
    with pytest.raises(InputError, match=r"it is -1\.0 at x"):
        minimum(0.5, lambda x: np.full(len(x), -1.0))(grid(2))
    with pytest.raises(KeyboardInterrupt):  # never swallowed
        as_size(lambda x: exec("raise KeyboardInterrupt"))(grid(2))


def test_a_field_asks_for_a_function_and_finite_points() -> None:
    with pytest.raises(InputError, match="needs a function"):
        SizeField(0.1)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"x\[1\]"):
        as_size(0.1)([[0, 0], [np.nan, 0]])


# ---------------------------------------------------------------------- combinations


def test_combinations() -> None:
    x = grid(6)
    a, b = as_size(lambda x: 0.1 + x[:, 0]), as_size(0.5)
    assert (minimum(a, b, 0.7)(x) == np.minimum(0.1 + x[:, 0], 0.5)).all()
    assert (maximum(a, b)(x) == np.maximum(0.1 + x[:, 0], 0.5)).all()
    assert np.allclose(product(0.5, a)(x), 0.05 + x[:, 0] / 2)
    assert (clip(a, 0.3, 0.6)(x) == np.clip(0.1 + x[:, 0], 0.3, 0.6)).all()
    assert minimum(0.2, 0.1).constant == 0.1 and product(0.5, 0.1).constant == 0.05
    assert clip(0.1, 0.2, 0.3).constant == 0.2
    field = minimum(SizeField(running_size, landmarks=[[1, 2]]), SizeField(running_size, landmarks=[[3, 4]]))
    assert field.landmarks.tolist() == [[1, 2], [3, 4]]


def test_bad_combinations() -> None:
    with pytest.raises(InputError, match="at least one"):
        minimum()
    with pytest.raises(InputError, match="lower <= upper"):
        clip(0.1, 0.3, 0.2)
    with pytest.raises(InputError, match="positive"):
        clip(0.1, 0.0, 0.2)
    with pytest.raises(InputError, match="positive"):
        maximum(0.1, -1)


# ---------------------------------------------------------------------- tables


def leaves_of(table: SizeTable) -> list[tuple[list[Fraction], list[Fraction], list[float]]]:
    """Lower corner, upper corner and corner values of each leaf, exactly, by plain recursion."""
    found, box = [], [Fraction(float(v)) for v in table.box]

    def walk(node: int, low: list[Fraction], high: list[Fraction]) -> None:
        child = int(table.child[node])
        if child < 0:
            found.append((low, high, table.values[node].tolist()))
            return
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        for k in range(4):
            bits = [k % 2, k // 2]
            walk(
                child + k,
                [m if bit else a for a, m, bit in zip(low, middle, bits)],
                [b if bit else m for m, b, bit in zip(middle, high, bits)],
            )

    walk(0, box[:2], box[2:])
    return found


def plain_value(leaves: list, x: list[Fraction]) -> set[float]:
    """The values at x of all closed leaves that hold it."""
    values = set()
    for low, high, (a, b, c, d) in leaves:
        if all(p <= q <= r for p, q, r in zip(low, x, high)):
            u, v = ((q - p) / (r - p) for p, q, r in zip(low, x, high))
            a, b, c, d = map(Fraction, (a, b, c, d))
            values.add(float((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d)))
    return values


@pytest.mark.parametrize("name", SMOOTH)
def test_tables_keep_their_promise(name: str) -> None:
    field = as_size(SMOOTH[name])
    for tolerance in (0.1, 0.01):
        table = field.table([0, 0], [1, 1], tolerance=tolerance)
        x = np.random.default_rng(1).random((20000, 2))
        true, seen = field(x), table(x)
        assert table.error <= tolerance and sum(table.capped.values()) == 0
        assert np.abs(seen / true - 1).max() < 2.5 * tolerance  # between the points that were looked at
        assert np.quantile(np.abs(seen / true - 1), 0.99) < tolerance
        assert true.min() * 0.999 <= seen.min() and seen.max() <= 1.001 * true.max()


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1.0, 0.25, 2.0**-40, 2.0**30]),
    st.sampled_from([10**6, 1200, 30]),
)
def test_the_descent_is_that_of_plain_fractions(seed: int, factor: float, room: int) -> None:
    rng = np.random.default_rng(seed)
    tip, lower = rng.random(2), np.round(rng.random(2) * 8) / 4
    field = as_size(lambda x: 0.05 + 0.4 * np.linalg.norm(x - tip, axis=1))
    table = field.table(lower, lower + np.array([1.5, 0.75]), factor=factor, tolerance=0.05, max_nodes=room)
    assert len(table.child) <= room
    leaves = leaves_of(table)
    for x in lower + np.round(rng.random((6, 2)) * 64) / 64 * [1.5, 0.75]:
        wanted = plain_value(leaves, [Fraction(float(v)) * Fraction(factor) for v in x])
        assert min(abs(float(table([x])[0]) * factor / w - 1) for w in wanted) < 1e-13
    area = sum((h[0] - l[0]) * (h[1] - l[1]) for l, h, _ in leaves)
    assert area == (Fraction(1.5) * Fraction(factor)) * (Fraction(0.75) * Fraction(factor))


def test_a_constant_is_one_node() -> None:
    table = as_size(0.3).table([-1, -1], [1, 1], factor=0.5)
    assert table.child.tolist() == [-1] and table.values.tolist() == [[0.15] * 4]
    assert table.child.dtype == np.int32 and table.values.dtype == table.box.dtype == np.float64
    assert table.box.tolist() == [-0.5, -0.5, 0.5, 0.5] and table.error == 0
    assert (table(np.random.default_rng(0).normal(size=(100, 2)) * 10) == 0.3).all()
    assert table.capped == {"resolved": 0, "depth": 0, "nodes": 0}


@pytest.mark.parametrize("field", [*SMOOTH.values(), jump])
def test_outside_of_the_box_the_nearest_point_counts(field: object) -> None:
    table = as_size(field).table([0.2, 0.1], [0.8, 0.9])
    x = np.random.default_rng(2).normal(size=(500, 2)) * 3
    assert (table(x) == table(np.clip(x, [0.2, 0.1], [0.8, 0.9]))).all()
    assert np.allclose(table([[-5, -5], [5, 5]]), as_size(field)([[0.2, 0.1], [0.8, 0.9]]))


def test_a_function_is_never_asked_outside_of_the_box() -> None:
    lower, upper = np.array([0.1, 0.3]), np.array([0.7, 1.9])

    def inside_only(x: np.ndarray) -> np.ndarray:
        assert (x >= lower).all() and (x <= upper).all()
        return 0.1 + x[:, 0] ** 2

    inside_only_table = as_size(inside_only).table(lower, upper, tolerance=0.003)
    assert inside_only_table.error <= 0.003


def test_few_calls() -> None:
    calls = []
    field = as_size(lambda x: (calls.append(len(x)), SMOOTH["cone"](x))[1])
    table = field.table([0, 0], [1, 1])
    assert len(calls) < 20 and sum(calls) < 10 * len(table.child)


def test_a_jump_is_followed_as_far_as_a_mesh_could_and_reported() -> None:
    table = as_size(jump).table([0, 0], [1, 1])
    assert table.error > 1 and table.capped["resolved"] > 100 and table.capped["depth"] == 0
    x = np.random.default_rng(3).random((20000, 2))
    off = np.abs(x[:, 0] + 0.3 * x[:, 1] - 0.61) > 0.01  # a wanted edge length away from the jump
    assert (table(x[off]) == jump(x[off])).all()
    assert ((table(x) >= 0.01) & (table(x) <= 0.3)).all()
    assert "capped" in repr(table)


def test_caps_are_honest() -> None:
    field = as_size(SMOOTH["cone"])
    shallow = field.table([0, 0], [1, 1], max_depth=6)
    assert shallow.capped["depth"] > 0 and shallow.error > 0.02
    small = field.table([0, 0], [1, 1], max_nodes=1400)
    assert small.capped["nodes"] > 0 and len(small.child) <= 1400 and small.error > 0.02
    assert field.table([0, 0], [1, 1], max_nodes=1).child.tolist() == [-1]
    worst = field.table([0, 0], [1, 1], max_nodes=1500)
    assert worst.error <= small.error  # what room there is goes to the worst leaves


def test_landmarks_are_not_overlooked() -> None:
    place = np.array([[0.5371, 0.2213]])

    def narrow(x: np.ndarray) -> np.ndarray:
        return np.where(np.linalg.norm(x - place, axis=1) < 1e-3, 0.002, 0.1)

    blind, told = SizeField(narrow), SizeField(narrow, landmarks=[*place.tolist(), [9, 9], [1, 1]])
    assert blind.table([0, 0], [1, 1])(place)[0] == 0.1
    assert told.table([0, 0], [1, 1])(place)[0] < 0.003
    assert told.table([0, 0], [1, 1]).error > 0.02 and blind.table([0, 0], [1, 1]).error == 0


def test_landmarks_in_space_have_no_table_in_the_plane() -> None:
    with pytest.raises(InputError, match="landmarks"):
        SizeField(lambda x: x[:, 0] + 1, landmarks=[[0, 0, 0]]).table([0, 0], [1, 1])


@pytest.mark.parametrize("upper", [[1, 0], [0, 1], [0, 0]])
def test_flat_boxes(upper: list[float]) -> None:
    field = as_size(lambda x: 0.01 + x.sum(axis=1))
    table = field.table([0, 0], upper)
    ends = np.array([[0, 0], upper], dtype=float)
    assert np.allclose(table(ends), field(ends)) and table.error <= 0.02


def test_corners_are_those_of_the_leaves() -> None:
    field = as_size(SMOOTH["circle"])
    table = field.table([0, 0.5], [1, 2], factor=0.25)
    places, values = table.corners()
    wanted = set()
    for low, high, _ in leaves_of(table):
        wanted |= {(float(4 * x), float(4 * y)) for x in (low[0], high[0]) for y in (low[1], high[1])}
    assert wanted == set(map(tuple, places.tolist()))
    assert np.allclose(values, field(places), rtol=1e-14)


@pytest.mark.parametrize(
    ("lower", "upper", "options", "words"),
    [
        ([1, 1], [0, 2], {}, "not a box"),
        ([0, 0], [np.inf, 1], {}, "not a box"),
        ([-1e308, 0], [1e308, 1], {}, "not a box"),
        ([0, 0, 0], [1, 1, 1], {}, "box of the plane"),
        ([0], [1], {}, "box of the plane"),
        (["a", 0], [1, 1], {}, "two coordinates"),
        ([0, 0], [1, 1], {"factor": 0.0}, "factor"),
        ([0, 0], [1, 1], {"tolerance": -1.0}, "tolerance"),
        ([0, 0], [1, 1], {"factor": 2.0**-1060}, "range of doubles"),
        ([0, 0], [1, 1], {"factor": 2.0**1023}, "range of doubles"),
        ([0, 0], [1, 1], {"max_depth": -1}, "max_depth"),
        ([0, 0], [1, 1], {"max_depth": 51}, "max_depth"),
    ],
)
def test_bad_tables(lower: list, upper: list, options: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        as_size(lambda x: 10 + x[:, 0]).table(lower, upper, **options)
    with pytest.raises(InputError, match=r"shape \(k, 2\)"):
        as_size(1.0).table([0, 0], [1, 1])([[1, 2, 3]])


def test_errors_of_functions_come_through_a_table() -> None:
    with pytest.raises(InputError, match=r"it is -\S+ at x\[\d+\] = \[0.75\d*, 0.125\]|it is -"):
        as_size(lambda x: 0.7 - x[:, 0]).table([0, 0], [1, 1])


def test_without_numba_tables_say_the_same() -> None:
    code = """
import json, numpy as np, unstruct.base.jit
from unstruct.sizing import as_size, local_feature_size, points
from unstruct.domain.domain import Domain
x = np.stack(np.meshgrid(np.linspace(-0.5, 1.5, 7), np.linspace(0, 1, 5)), axis=-1).reshape(-1, 2)
size = as_size(lambda x: 1e-2 + 0.2 * np.hypot(x[:, 0] - 0.3, x[:, 1] - 0.6))
table = size.table([0, 0], [1, 1], factor=0.5)
near = points([[0, 0], [1, 1], [0.2, 0.7]], [0.1, 0.2, 0.05])(x)
lfs = local_feature_size(Domain.disc(), x)
print(json.dumps([unstruct.base.jit.numba is None, table(x).tolist(), near.tolist(), lfs.tolist()]))
"""
    missing = "import sys; sys.modules['numba'] = None\n"
    codes = (missing + code, code)
    run = [subprocess.run([sys.executable, "-c", c], capture_output=True, text=True) for c in codes]
    assert all(r.returncode == 0 for r in run), run[0].stderr + run[1].stderr
    plain, compiled = (json.loads(r.stdout) for r in run)
    assert plain[0] and not compiled[0] and np.allclose(plain[1], compiled[1], rtol=1e-15)
    assert np.allclose(plain[2], compiled[2]) and np.allclose(plain[3], compiled[3])


# ---------------------------------------------------------------------- the chapter's control quantity


def test_control_is_one_for_the_wanted_triangle() -> None:
    h = 0.7
    mesh = unstruct.Mesh([[0, 0], [h, 0], [h / 2, h * math.sqrt(3) / 2]], [[0, 1, 2]])
    assert np.isclose(control(mesh, h)[0], 1.0) and np.isclose(control(mesh, 2 * h)[0], 0.5)


def test_control_asks_at_the_circumcenter() -> None:
    mesh = unstruct.Mesh([[0, 0], [4, 0], [2, 1]], [[0, 1, 2]])  # its circumcenter (2, -3/2) lies outside
    asked = []
    size = as_size(lambda x: (asked.append(x.copy()), 1 + np.abs(x[:, 1]))[1])
    alpha = control(mesh, size)
    assert np.allclose(np.concatenate(asked), [[2, -1.5]])
    assert np.isclose(alpha[0], 2.5 * math.sqrt(3) / 2.5)


def test_control_of_flat_and_foreign_cells() -> None:
    flat = unstruct.Mesh([[0, 0], [1, 1], [2, 2], [2, 0]], [[0, 1, 2], [0, 3, 2]])
    assert control(flat, 1.0)[0] == np.inf and np.isfinite(control(flat, 1.0)[1])
    thin = unstruct.Mesh([[0, 0], [1, 1e-320], [2, 0]], [[0, 2, 1]])
    assert control(thin, lambda x: np.full(len(x), 1.0))[0] == np.inf  # its center is beyond all doubles
    with pytest.raises(InputError, match="triangles in the plane"):
        control(unstruct.delaunay(np.random.default_rng(0).random((8, 3))), 1.0)


# ---------------------------------------------------------------------- what the methods make of bad sizes


@pytest.mark.parametrize(
    "method",
    [
        unstruct.refine,
        unstruct.circumcenter_insertion,
        unstruct.voronoi_segment,
        unstruct.advancing_front,
        unstruct.front_delaunay,
    ],
)
def test_methods_name_the_place_of_a_bad_size(method: object) -> None:
    domain = unstruct.Domain.rectangle((0, 0), (1, 1))
    for bad in (0.0, -0.1, math.nan, math.inf, "fine", [0.1, 0.2]):
        with pytest.raises(InputError, match=r"size (must be|is .* must be)"):
            method(domain, bad)
    for value in (0.0, -0.1, math.nan):
        with pytest.raises(InputError, match=r"is (0.0|-0.1|nan) at .*\[0\.\d+, 0\.\d+\]"):
            method(domain, lambda x: np.where(np.hypot(*(x - 0.5).T) < 0.2, value, 0.1))  # noqa: B023
    with pytest.raises(InputError, match=r"ZeroDivisionError .* at x\[\d+\]"):
        method(domain, lambda x: 1 / 0)


def plain_size(table: SizeTable, x: float, y: float) -> float:
    """The size at a place, by doubling it from leaf to leaf."""
    low, high = table.box[:2].tolist(), table.box[2:].tolist()
    u, v = ((min(max((c - a) / (b - a), 0.0), 1.0)) for c, a, b in zip((x, y), low, high))
    node = 0
    while table.child[node] >= 0:
        node, u, v = int(table.child[node]), 2 * u, 2 * v
        if u >= 1.0:
            node, u = node + 1, u - 1.0
        if v >= 1.0:
            node, v = node + 2, v - 1.0
    a, b, c, d = table.values[node].tolist()
    lower, upper = a + u * (b - a), c + u * (d - c)
    return lower + v * (upper - lower)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 30))
def test_leaves_are_found_by_the_bits_of_places(seed: int, depth: int) -> None:
    """Also on sides of leaves, at the ends of the box, outside of it, and in trees without full levels."""
    rng = np.random.default_rng(seed)
    field = as_size(lambda x: 1e-6 + 0.3 * np.linalg.norm(x - TIP, axis=1))
    table = field.table([0, 0], [1, 1], max_depth=depth)
    x = np.concatenate([
        rng.random((40, 2)), rng.integers(0, 65, (40, 2)) / 64, rng.integers(0, 2**20, (20, 2)) / 2**20,
        TIP + rng.normal(size=(40, 2)) * 10.0 ** rng.integers(-9, 0, (40, 1)), 3 * rng.normal(size=(20, 2)),
    ])  # fmt: skip
    assert table(x).tolist() == [plain_size(table, *row) for row in x.tolist()]
