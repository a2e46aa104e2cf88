"""Pictures of domains: what is drawn, with numbers and names, and the faults that an error names."""

import pickle

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import PathPatch

from unstruct import Domain, DomainError, InputError, view

SQUARE = [(0, 0), (2, 0), (2, 1), (0, 1)]
RING = [[0, 1], [1, 2], [2, 3], [3, 0]]


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


def texts(ax) -> set[str]:
    return {text.get_text() for text in ax.texts}


def colored(ax, x, y) -> bool:
    """Whether the picture has the color of the inside at a place."""
    ax.figure.canvas.draw()
    column, row = ax.transData.transform((x, y))
    pixels = np.asarray(ax.figure.canvas.buffer_rgba())
    return np.allclose(
        pixels[-1 - int(row), int(column), :3] / 255, to_rgb(view.ROLES["cell"].fill), atol=0.01
    )


def test_numbers_names_and_seeds():
    domain = Domain(
        [*SQUARE, (1, 0.5), (0.3, 0.3)],
        RING,
        inner=[[4, 0]],
        markers={"inlet": [3], "wall": [0, 1]},
        regions={"rock": [(1.5, 0.5)]},
    )
    ax = view.plot(domain)
    assert texts(ax) == {*"012345", "f0: wall", "f1", "f2", "f3: inlet", "i0", "rock"}
    assert texts(view.plot_domain(domain, numbers=False)) == {"wall", "inlet", "rock"}
    assert texts(view.plot_domain(domain, numbers=False, names=False)) == set()


def test_many_pieces_have_no_numbers_unless_they_are_asked_for():
    turn = np.linspace(0, 2 * np.pi, 61)[:-1]
    domain = Domain.polygon(np.column_stack([np.cos(turn), np.sin(turn)]))
    assert texts(view.plot_domain(domain)) == set()
    assert {"59", "f59"} <= texts(view.plot_domain(domain, numbers=True))


def test_only_the_inside_is_filled():
    """An island in a hole, both turned like the outer ring, and curves."""
    hole = Domain.rectangle((-2, -2), (2, 2)).with_holes(Domain.disc((0, 0), 1))
    domain = Domain.disc((0, 0), 3).with_holes(hole)
    ax = view.plot_domain(domain, numbers=False)
    assert len([p for p in ax.patches if isinstance(p, PathPatch)]) == 1
    for x in ((2.5, 0.3), (0.3, 0.3), (1.5, 0.2), (2.9, 2.9)):
        assert colored(ax, *x) == bool(domain.contains(x)), x


def test_rings_that_share_a_vertex():
    bow = Domain(
        [(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)], [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]]
    )
    ax = view.plot_domain(bow, numbers=False)
    for x in ((0.7, 0.1), (-0.7, 0.1), (0.05, 0.6)):
        assert colored(ax, *x) == bool(bow.contains(x))


CROSSED = ([(0, 0), (1, 1), (1, 0), (0, 1)], RING)
FAULTY = {
    "crossing": CROSSED,
    "open boundary": (SQUARE, RING[:3]),
    "duplicate points": ([*SQUARE, (0, 0)], RING),
    "repeated segment": (SQUARE, [*RING, [1, 0], [0, 1]]),
    "index": (SQUARE, [*RING, [0, 9]]),
}


@pytest.mark.parametrize("points, facets", FAULTY.values(), ids=FAULTY)
def test_an_error_shows_what_it_names(points, facets):
    with pytest.raises(DomainError) as caught:
        Domain(points, facets)
    error = caught.value
    assert error.faults and error.outline.points.shape == (len(points), 2)
    for ax in (view.plot(error), error.plot(numbers=False)):
        bad = to_rgb(view.ROLES["bad"].color)
        drawn = [
            c
            for c in ax.collections
            if isinstance(c, LineCollection) and np.allclose(c.get_color()[0][:3], bad)
        ]
        drawn += [line for line in ax.lines if np.allclose(to_rgb(line.get_color()), bad)]
        assert drawn or not np.isfinite(error.faults[0].place).all()
        assert not ax.patches, "an outline with faults has no inside"


def test_an_error_goes_to_other_processes():
    with pytest.raises(DomainError) as caught:
        Domain(*CROSSED)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value) and copy.faults == caught.value.faults


def test_loose_points_alone():
    domain = Domain([(0, 0), (1, 2)], np.empty((0, 2), dtype=int))
    assert texts(view.plot(domain)) == {"0", "1"}


def test_options_of_meshes_are_refused():
    with pytest.raises(InputError, match="options of meshes"):
        view.plot(Domain.rectangle(), values=[1.0])
