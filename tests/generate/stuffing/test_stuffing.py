"""isosurface_stuffing: bodies by formulas, sizes, reports, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.value_tables import assert_sound, dihedral_range
from unstruct import Domain, IncompleteWarning, InputError, check, isosurface_stuffing
from unstruct.topology import components

BOX = [(-1.3,) * 3, (1.3,) * 3]


def ball(x: np.ndarray) -> np.ndarray:
    return 1.0 - (x * x).sum(axis=1)


def ring(x: np.ndarray) -> np.ndarray:
    flat = np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2) - 0.8
    return 0.3 - np.sqrt(flat**2 + x[:, 2] ** 2)


def two_balls(x: np.ndarray) -> np.ndarray:
    return np.maximum(
        0.4 - np.abs(x - [0.7, 0, 0]).max(axis=1), 0.45 - np.sqrt(((x - [-0.6, 0, 0]) ** 2).sum(1))
    )


@pytest.mark.parametrize(
    ("body", "euler", "parts"), [(ball, 1, 1), (ring, 0, 1), (two_balls, 2, 2)], ids=["ball", "ring", "two"]
)
def test_bodies(body, euler: int, parts: int) -> None:
    mesh = isosurface_stuffing(body, 0.12, box=BOX)
    assert mesh.complete
    assert check(mesh)
    assert_sound(mesh)
    assert mesh.euler_characteristic == euler
    assert components(mesh.neighbors)[0] == parts
    least, most = dihedral_range(mesh)
    assert least >= 15
    assert most <= 152


def test_vertices_on_the_boundary_are_zeros() -> None:
    mesh = isosurface_stuffing(ball, 0.2, box=BOX)
    x = mesh.points[np.unique(mesh.boundary)]
    assert np.abs(np.sqrt((x * x).sum(axis=1)) - 1.0).max() < 1e-10
    rough = isosurface_stuffing(ball, 0.2, box=BOX, tolerance=None)
    x = rough.points[np.unique(rough.boundary)]
    assert 1e-5 < np.abs(np.sqrt((x * x).sum(axis=1)) - 1.0).max() < 0.02
    assert rough.counts["values"] < mesh.counts["values"]


def test_each_vertex_is_asked_once() -> None:
    asked = []

    def body(x: np.ndarray) -> np.ndarray:
        asked.append(x.copy())
        return ball(x)

    mesh = isosurface_stuffing(body, 0.2, box=BOX, tolerance=None)
    x = np.concatenate(asked)
    assert len(x) == mesh.counts["values"]
    assert len(np.unique(x, axis=0)) >= len(x) - 8  # the corners of the box, from both sides
    assert len(asked) < 20
    assert (np.abs(x) <= 1.3).all()


def test_surfaces_through_vertices_of_the_lattice() -> None:
    """A cube whose faces are planes of the lattice: exact, and without small angles."""
    mesh = isosurface_stuffing(lambda x: 0.5 - np.abs(x).max(axis=1), 0.25, box=[(-1,) * 3, (1,) * 3])
    assert mesh.volume == 1.0
    assert mesh.counts["moved"] == 0
    assert dihedral_range(mesh)[0] > 44


def test_larger_cells_inside() -> None:
    even = isosurface_stuffing(ball, 0.08, box=BOX)
    mesh = isosurface_stuffing(
        ball, lambda x: 0.08 + 0.5 * np.maximum(0, 0.8 - np.sqrt((x * x).sum(1))), box=BOX
    )
    assert mesh.complete
    assert check(mesh)
    assert mesh.size < 0.85 * even.size
    assert np.array_equal(
        np.unique(even.points[even.boundary], axis=0), np.unique(mesh.points[mesh.boundary], axis=0)
    )
    least, most = dihedral_range(mesh)
    assert least >= 10.7
    assert most <= 164.8


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("seed", range(6))
def test_graded_surfaces(seed: int) -> None:
    rng = np.random.default_rng(seed)
    center = rng.normal(size=3)
    center /= np.sqrt((center**2).sum())
    wave = rng.normal(size=(3, 6))

    def body(x: np.ndarray) -> np.ndarray:
        return ball(x) + 0.06 * np.cos(3 * (x[:, :, None] * wave).sum(axis=1)).sum(axis=1)

    mesh = isosurface_stuffing(
        body,
        lambda x: 0.03 + 0.25 * np.sqrt(((x - center) ** 2).sum(1)),
        box=[(-2,) * 3, (2,) * 3],
        graded=True,
    )
    assert_sound(mesh)
    assert dihedral_range(mesh)[0] >= 8


def test_what_touches_itself_is_told() -> None:
    def wedges(x: np.ndarray) -> np.ndarray:  # two pyramids that meet in a vertex of the lattice
        return np.minimum(np.abs(x[:, 2]) - np.abs(x[:, :2]).max(axis=1) * 0.9, 0.8 - np.abs(x[:, 2]))

    with pytest.warns(IncompleteWarning, match="touches itself"):
        mesh = isosurface_stuffing(wedges, 0.2, box=[(-1,) * 3, (1,) * 3])
    assert mesh.counts["pinched"] == 1
    assert not mesh.complete


def test_a_body_beyond_the_box() -> None:
    with pytest.raises(InputError, match="cap=True"):
        isosurface_stuffing(ball, 0.1, box=[(-0.5,) * 3, (0.5,) * 3])
    with pytest.raises(InputError, match="cap=True"):
        isosurface_stuffing(ball, lambda x: 0.1 + 0 * x[:, 0], box=[(-0.5,) * 3, (0.5,) * 3], graded=True)
    mesh = isosurface_stuffing(ball, 0.125, box=[(-0.5,) * 3, (0.5,) * 3], cap=True)
    assert check(mesh)
    assert mesh.volume == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (lambda x: np.where(x[:, 0] > 1, np.nan, -1.0), "is nan at"),
        (lambda x: np.full(len(x), np.inf), "is inf at"),
        (lambda x: 1.0, "must return shape"),
        (lambda x: x, "must return shape"),
        (lambda x: ["a"] * len(x), "plain real numbers"),
        (lambda x: 1 / 0, "raised ZeroDivisionError"),
        (lambda x: -np.ones(len(x)), "thinner than a cell"),
    ],
)
def test_functions_that_are_none(body, message: str) -> None:
    with pytest.raises(InputError, match=message):
        isosurface_stuffing(body, 0.3, box=BOX)


def slab(x: np.ndarray) -> np.ndarray:
    return 0.5 - np.abs(x).max(axis=1)


@pytest.mark.parametrize("graded", [False, True])
@pytest.mark.parametrize(
    "body",
    [
        lambda x: (ball(x) > 0).astype(float),
        lambda x: (slab(x) > 0).astype(np.int64),
        lambda x: np.maximum(ball(x), 0.0),
        lambda x: np.where(x[:, 0] > 0, ball(x), np.maximum(ball(x), 0.0)),
    ],
    ids=["indicator", "whole numbers", "density", "one half"],
)
def test_zero_outside_is_refused(body, graded: bool) -> None:
    size = (lambda x: 0.2 + 0 * x[:, 0]) if graded else 0.2
    with pytest.raises(InputError, match="exactly 0 at"):
        isosurface_stuffing(body, size, box=BOX, graded=graded)


@pytest.mark.parametrize(
    "body",
    [
        lambda x: np.where(ball(x) > 0, 1.0, -1.0),
        lambda x: (ball(x) > 0) - 0.5,
        lambda x: np.where(ball(x) < -0.8, 0.0, ball(x)),  # zero far away, as in narrow bands
        slab,  # zero on planes of the lattice
        lambda x: np.where(ball(x) > 0, ball(x), np.minimum(slab(x), 0)),
    ],
    ids=["signs", "half less", "band", "planes", "kink"],
)
def test_zeros_elsewhere_are_not(body) -> None:
    mesh = isosurface_stuffing(body, 0.25, box=[(-1.5,) * 3, (1.5,) * 3])
    assert mesh.complete
    assert check(mesh)


def test_zeros_inside_a_body_fill_no_cell() -> None:
    mesh = isosurface_stuffing(lambda x: slab(x) * x[:, 0] ** 2, 0.25, box=[(-1,) * 3, (1,) * 3])
    assert mesh.complete
    assert mesh.volume == 1.0


def test_other_refusals() -> None:
    with pytest.raises(InputError, match="needs a box"):
        isosurface_stuffing(ball, 0.3)
    with pytest.raises(InputError, match="a function, a Domain in space"):
        isosurface_stuffing(3, 0.3, box=BOX)
    with pytest.raises(InputError, match="its own"):
        isosurface_stuffing(Domain.box(), 0.3, box=BOX)
    with pytest.raises(InputError, match="budget"):
        isosurface_stuffing(ball, 1e-3, box=BOX, budget=10_000)
    with pytest.raises(InputError, match="too small"):
        isosurface_stuffing(ball, 1e-12, box=BOX)


def test_the_body_may_bring_its_box() -> None:
    class Body:
        box = np.array(BOX)

        def __call__(self, x: np.ndarray) -> np.ndarray:
            return ball(x)

    assert isosurface_stuffing(Body(), 0.3).size == isosurface_stuffing(ball, 0.3, box=BOX).size


def test_a_bubble_whose_tetrahedron_turns_over_is_reported() -> None:
    """Four vertices of one tetrahedron lie in it and pass each other: the cells around overlap."""

    def around_bubble(p: np.ndarray) -> np.ndarray:
        x, y, z = (2 * p).T
        one = np.maximum.reduce([abs(x - 1) - 2, y - 0.569, -1.1 - y, abs(z) - 0.59])
        two = np.maximum.reduce([abs(z) - 2, 0.431 - y, y - 2.1, abs(x - 1) - 0.59])
        return np.minimum.reduce([one, two, 7.5 - abs(x), 7.5 - abs(y), 7.5 - abs(z)])

    with pytest.warns(IncompleteWarning):
        mesh = isosurface_stuffing(around_bubble, 1.0, box=[(-5,) * 3, (5,) * 3])
    overlap = [problem for problem in check(mesh).problems if problem.kind == "overlap"]
    assert len(overlap) == 1 and not mesh.complete
    assert set(overlap[0].cells) == set(mesh.unrefined.tolist())
    assert all("overlap" in reason for reason in mesh.reasons)
