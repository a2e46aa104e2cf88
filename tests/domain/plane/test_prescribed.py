"""A spacing given along a piece, in every method."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import unstruct
from unstruct import Arc, Domain, InputError, Spacing, check

METHODS = [
    unstruct.refine,
    unstruct.voronoi_segment,
    unstruct.advancing_front,
    unstruct.circumcenter_insertion,
    unstruct.conforming_delaunay,
]
SQUARE = Domain.rectangle()


def lengths(mesh, piece):
    rows = mesh.piece == piece
    order = np.argsort(mesh.span[rows, 0])
    return np.linalg.norm(np.diff(mesh.points[mesh.segments[rows]], axis=1)[:, 0], axis=1)[order]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_every_method_keeps_exactly_these_points(method):
    domain = SQUARE.spaced(
        {"bottom": 20, "top": Spacing(first=0.01, last=0.1), 1: Spacing(count=7, growth=1.5)}
    )
    mesh = method(domain, 0.3)
    assert check(mesh, domain=domain) and check(mesh, domain=SQUARE)
    assert np.allclose(lengths(mesh, 0), 0.05, atol=1e-15) and len(lengths(mesh, 0)) == 20
    top, right = lengths(mesh, 2), lengths(mesh, 1)
    assert len(top) == 25 and np.ptp(top[1:] / top[:-1]) < 1e-12
    assert abs(top[0] - 0.01) < 1e-4 and abs(top[-1] - 0.1) < 1e-3
    assert len(right) == 7 and np.allclose(right[1:] / right[:-1], 1.5)
    if method is unstruct.refine:
        assert set(mesh.reasons) <= {"kept: only a vertex on a piece that must not be split would help"}


def test_without_a_size_and_as_a_domain_of_straight_pieces():
    domain = SQUARE.spaced({"bottom": 4})
    mesh = unstruct.constrained_delaunay(domain)
    assert len(mesh.points) == 7 and len(mesh.segments) == 7 and check(mesh, domain=domain)
    again = unstruct.refine(domain.sampled(0.5), 0.05, min_angle=20)
    bottom = again.points[np.unique(again.segments)]
    assert (bottom[:, 1] == 0).sum() == 5
    assert pickle.loads(pickle.dumps(domain)).spacings.keys() == {0}
    assert SQUARE.spacings == {} and len(SQUARE.sampled().points) == 4


def test_along_curves():
    disc = Domain.disc().spaced({0: 3, 1: Spacing(first=0.05, growth=1.25)})
    mesh = unstruct.refine(disc, 0.5)
    assert check(mesh, domain=disc) and np.allclose(lengths(mesh, 0), 2 * np.sin(np.pi / 12))
    graded = 2 * np.arcsin(lengths(mesh, 1) / 2)
    assert np.allclose(graded[1:] / graded[:-1], 1.25, atol=1e-5)


def test_a_curve_is_cut_further_where_it_must_be():
    near = Arc.through((0, 0), (0.5, -0.5), (1, 0))
    domain = Domain(
        [(0, 0), (1, 0), (0.5, -0.4), (0.6, -0.3), (0.4, -0.3), (0.5, 1)],
        [(0, 1), (1, 5), (5, 0), (2, 3), (3, 4), (4, 2)],
        curves={0: near},
    )
    mesh = unstruct.constrained_delaunay(domain.spaced({0: 1}))
    assert check(mesh, domain=domain) and (mesh.piece == 0).sum() > 1


@given(
    st.floats(1e-3, 1e3), st.floats(1e-3, 0.9), st.floats(1e-3, 0.9), st.integers(1, 300), st.floats(0.9, 1.1)
)
def test_shares(length, first, last, count, growth):
    for spacing in (
        Spacing(count=count),
        Spacing(count=count, growth=growth),
        Spacing(first=first * length, last=last * length),
        Spacing(first=first * length, growth=max(growth, 1.0)),
    ):
        share = spacing.shares(length)
        parts = np.diff(share)
        assert share[0] == 0 and share[-1] == 1 and (parts > 0).all()
        if len(parts) > 2 and parts.min() > 1e-6:
            assert np.ptp(parts[1:] / parts[:-1]) < 1e-7
    assert len(Spacing(count=count).shares(length)) == count + 1
    parts = np.diff(Spacing(first=first * length, last=last * length).shares(length))
    if len(parts) > 10:
        assert abs(np.log(parts[0] / first)) < 0.2 and abs(np.log(parts[-1] / last)) < 0.2


@pytest.mark.parametrize(
    ("spacing", "text"),
    [
        ({"floor": 3}, r"spacing names marker 'floor', but the markers are \['bottom'"),
        ({9: 3}, r"spacing names pieces outside 0\.\.3"),
        ({"top": 0}, "count = 0 must be a whole number"),
        ({"top": 1.5}, "count = 1.5 must be a whole number"),
        ({(0.5,): 3}, "marker or piece numbers"),
        (3, "spacing must"),
    ],
)
def test_errors(spacing, text):
    with pytest.raises(InputError, match=text):
        SQUARE.spaced(spacing)


def test_errors_of_spacings():
    with pytest.raises(InputError, match="not nothing"):
        Spacing()
    with pytest.raises(InputError, match="first and growth, not"):
        Spacing(count=3, first=0.1)
    with pytest.raises(InputError, match="first"):
        Spacing(first=-1, last=1)
    with pytest.raises(InputError, match="never fill"):
        SQUARE.spaced({"top": Spacing(first=0.1, growth=0.5)})
    with pytest.raises(InputError, match="shorter than rounding"):
        SQUARE.spaced({"top": Spacing(count=2000, growth=2)})
    with pytest.raises(InputError, match="cannot be simplified"):
        SQUARE.spaced({"top": 3}).simplified(0.1)
    with pytest.raises(InputError, match="cannot be combined"):
        SQUARE.spaced({"top": 3}).with_holes(Domain.disc((0.5, 0.5), 0.1))
