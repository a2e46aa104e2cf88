"""What a notebook shows for a domain: a small, well-formed card; and its picture by matplotlib."""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest
from fixtures import HARD_2D

from unstruct import Domain, DomainError, delaunay, examples

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
HOLE = [(1, 1), (2, 1), (2, 2), (1, 2)]


def numbers(path: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?[\d.]+", path)]


def rings(html: str) -> list[np.ndarray]:
    """The closed lines that are filled."""
    path = ElementTree.fromstring(html).find(".//path").attrib["d"]
    return [np.array(numbers(ring)).reshape(-1, 2) for ring in path.split("M")[1:]]


def filled(html: str) -> float:
    """The filled area, by even-odd lines that do not cross: the largest ring less the others inside of it."""
    areas = []
    for ring in rings(html):
        x, y = ring.T
        areas.append(abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2)
    return max(areas) - (sum(areas) - max(areas))


def several() -> dict[str, Domain]:
    turn = np.linspace(0, 2 * np.pi, 20_001)[:-1]
    rough = 1 + 0.1 * np.random.default_rng(0).random(len(turn))
    return {
        "a plate": Domain.polygon(SQUARE, [HOLE], markers={"a <b> & 'c'": [0]}, regions={"rock": (3, 3)}),
        "curves": Domain.disc(),
        "a section": Domain.naca("2412"),
        "pieces inside": Domain([*SQUARE, (1, 1), (3, 3)], [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5)]),
        "points alone": Domain([(0, 0), (1, 2), (3, 1)], np.empty((0, 2), int)),
        "one point": Domain([(7, 7)], np.empty((0, 2), int)),
        "no points": Domain(np.empty((0, 2)), np.empty((0, 2), int)),
        "huge": Domain.polygon(np.array(SQUARE) * 1e307),
        "tiny": Domain.polygon(np.array(SQUARE) * 1e-300),
        "a needle": Domain.polygon([(0, 0), (1, 0), (0.5, 1e-12)]),
        "many": Domain.polygon(np.column_stack([np.cos(turn), np.sin(turn)]) * rough[:, None]),
        "a coast": examples.coastline(),
        "many names": Domain.polygon(SQUARE, markers={f"side {i}": [i % 4] for i in range(50)}),
    }


@pytest.mark.parametrize("name", several())
def test_the_card_is_well_formed_and_small(name: str) -> None:
    domain = several()[name]
    html = domain._repr_html_()
    root = ElementTree.fromstring(html)
    for path in root.findall(".//path"):
        drawn = numbers(path.attrib["d"])
        assert all(0 <= x <= 200 for x in drawn)
    assert len(html) < 100_000 and f"{len(domain.points):,}" in html
    assert len(root.findall(".//circle")) == len(domain.loose)


def test_the_inside_is_filled() -> None:
    side = 200 - 2 * 6
    assert filled(Domain.polygon(SQUARE, [HOLE])._repr_html_()) == pytest.approx(side**2 * 15 / 16, rel=1e-3)
    assert filled(Domain.disc()._repr_html_()) == pytest.approx(np.pi / 4 * side**2, rel=2e-3)


def test_rounding_keeps_the_area() -> None:
    """Twenty thousand corners become a few hundred; the lines stay closed."""
    domain = several()["many"]
    html, side = domain._repr_html_(), (200 - 2 * 6) / np.ptp(domain.bounds, axis=0).max()
    assert 100 < sum(len(ring) for ring in rings(html)) <= 2000
    assert filled(html) == pytest.approx(domain.area * side**2, rel=0.1)


def test_names_are_listed_and_escaped() -> None:
    texts = [
        "".join(row.itertext())
        for row in ElementTree.fromstring(several()["a plate"]._repr_html_()).iter("tr")
    ]
    assert texts == ["points8", "facets8", "markersa <b> & 'c'", "regionsrock"]
    assert "side 5, ... (50)" in several()["many names"]._repr_html_()
    mended = Domain.polygon([(0, 0), (4, 0), (4, 4), (4, 4), (0, 4)], resolve=True)
    assert f"repairs</td><td style='text-align:right'>{len(mended.repairs)}" in mended._repr_html_()


@pytest.mark.parametrize("name", HARD_2D)
def test_hard_points_have_a_card(name: str) -> None:
    domain = Domain(np.unique(np.asarray(HARD_2D[name], dtype=float), axis=0), np.empty((0, 2), int))
    ElementTree.fromstring(domain._repr_html_())


def test_a_mesh_has_the_same_frame() -> None:
    one, two = (value._repr_html_() for value in (delaunay(SQUARE), Domain.polygon(SQUARE)))
    head = "viewBox='0 0 200 200' style='background:white'><title>"
    assert head in one and head in two


def test_plot() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    domain = Domain.polygon(SQUARE, [HOLE], markers={"left": [3]}, regions={"rock": (3, 3)})
    shown = {text.get_text() for text in domain.plot().texts}
    assert {"rock", "f3: left", "7"} <= shown
    assert {text.get_text() for text in domain.plot(numbers=False, names=False).texts} == set()
    _, ax = plt.subplots()
    assert domain.plot(ax) is ax
    with pytest.raises(DomainError) as caught:
        Domain.polygon([(0, 0), (4, 4), (4, 0), (0, 4)])
    assert caught.value.plot(numbers=False) is not None
    plt.close("all")


@cache
def bodies() -> dict[str, Domain]:
    plate = Domain.polygon(SQUARE, [HOLE], markers={"a <b>": [0]}, regions={"rock": (3, 3)})
    return {
        "a box": Domain.box(),
        "a plate": Domain.extruded(plate, 1),
        "a fine ball": Domain.ball(size=0.04),
        "a torus": Domain.torus(size=0.05),
        "a diagonal": Domain.box(inner=[(0, 7)]),
        "points in space": Domain([(0, 0, 0), (1, 2, 3)], ()),
        "no points in space": Domain(np.empty((0, 3)), ()),
        "huge in space": Domain.ball(radius=1e300, size=4e299),
        "tiny in space": Domain.box((0, 0, 0), (1e-300, 1e-300, 1e-300)),
    }


@pytest.mark.parametrize(
    "name",
    [
        "a box", "a plate", "a fine ball", "a torus", "a diagonal", "points in space", "no points in space",
        "huge in space", "tiny in space",
    ],
)  # fmt: skip
def test_bodies_have_a_small_card(name: str) -> None:
    body = bodies()[name]
    html = body._repr_html_()
    root = ElementTree.fromstring(html)
    for path in root.findall(".//path"):
        assert all(0 <= x <= 200 for x in numbers(path.attrib["d"]))
    assert len(html) < 60_000 and f"{len(body.points):,}" in html
    assert len(root.findall(".//circle")) == len(body.loose)
    drawn = root.find(".//path").attrib["d"].count("M") if len(body.facets) else 0
    if name == "a box":
        assert drawn == 12
    if name == "a fine ball":  # the outline alone, a circle of the width of the picture
        at = np.array(numbers(root.find(".//path").attrib["d"])).reshape(-1, 2)
        assert np.ptp(np.hypot(*(at - 100).T)) < 6 and drawn > 60
