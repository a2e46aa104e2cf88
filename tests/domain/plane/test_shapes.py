"""Ready-made regions: airfoils, letters, splines, geographic outlines, the book's own; .poly files."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from unstruct import Bezier, Domain, InputError, check, constrained_delaunay, refine, voronoi_segment
from unstruct.examples.regions import coastline, coastline_size, plate, running_domain, wing_with_flap, word
from unstruct.examples.running import running_region, running_size

# ---------------------------------------------------------------------- shapes


TRIANGLE = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1], [0, 0]]]}


@pytest.mark.parametrize("given", [SimpleNamespace(__geo_interface__=TRIANGLE), TRIANGLE])
def test_a_geometry_is_no_array_of_corners(given: object) -> None:
    with pytest.raises(InputError, match="from_geojson"):
        Domain.polygon(given)
    with pytest.raises(InputError, match="from_geojson"):
        Domain.polygon([(0, 0), (1, 0), (0, 1)], holes=[given])
    assert Domain.from_geojson(given).area == 0.5


def test_polygons_discs_rectangles() -> None:
    closed = Domain.polygon([[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], [[[1, 1], [2, 1], [2, 2], [1, 2]]])
    assert len(closed.points) == 8 and closed.area == 15
    rings = [[0, 0], [9, 0], [9, 9], [0, 9]], [[1, 1], [8, 1], [8, 8], [1, 8]], [[2, 2], [3, 2], [2, 3]]
    island = Domain.polygon(rings[0], rings[1:2])
    island = Domain(
        np.concatenate([island.points, rings[2]]), np.concatenate([island.facets, [[8, 9], [9, 10], [10, 8]]])
    )
    assert (
        island.area == 81 - 49 + 0.5 and island.contains([[2.2, 2.2]])[0] and not island.contains([[5, 5]])[0]
    )
    assert Domain.rectangle((1, 2), (3, 5)).area == 6
    assert Domain.rectangle().markers.keys() == {"bottom", "right", "top", "left"}
    assert Domain.disc((1, 1), 2).bounds.tolist() == [[-1, -1], [3, 3]]
    named = Domain.rectangle(markers={"wall": [0, 2]}, regions={"room": [0.5, 0.5]})
    assert {"wall", "top"} <= named.markers.keys() and named.regions["room"].tolist() == [[0.5, 0.5]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Domain.polygon([[0, 0], [1, 1]]), "a ring needs three"),
        (lambda: Domain.polygon([[0, 0], [1, 0], [0, 1]], [[[0, 0, 0]]]), r"holes\[0\] must have shape"),
        (lambda: Domain.rectangle((0, 0), (0, 1)), "must be less"),
        (lambda: Domain.disc(radius=0), "radius"),
        (lambda: Domain.naca("24-2"), "2412"),
        (lambda: Domain.naca("2012"), "come together"),
        (lambda: Domain.naca("0000"), "thickness"),
        (lambda: Domain.naca("0012", chord=-1), "chord"),
        (lambda: Domain.letters("  "), "visible"),
        (lambda: Domain.smooth([[0, 0], [1, 0], [1, 0], [0, 1]]), "equals the next"),
        (lambda: Domain.from_geojson({"type": "Cube"}), "'Cube'"),
        (lambda: Domain.from_geojson(3), "__geo_interface__"),
        (lambda: Domain.from_geojson({"type": "FeatureCollection"}), "list of 'features'"),
        (lambda: Domain.from_geojson({"type": "MultiPoint", "coordinates": []}), "empty"),
        (
            lambda: Domain.from_geojson({"type": "LineString", "coordinates": [["a", 0], [1, 0]]}),
            "real numbers",
        ),
        (lambda: Domain.from_geojson({"type": "Polygon", "coordinates": [[0, 0], [1, 0]]}), "positions"),
        (lambda: Domain.rectangle((0, 0, 0), (1, 1, 1)), "lower must be two coordinates"),
        (lambda: Domain.disc(3.0), "center must be two coordinates"),
        (lambda: Domain.naca("0012", attack="steep"), "attack must be a number"),  # type: ignore[arg-type]
        (lambda: Domain.polygon([[0, 0], [1, 0], [0, 1]], None), "holes must be"),  # type: ignore[arg-type]
        (lambda: Domain.from_geojson({"type": "GeometryCollection", "geometries": []}), "empty"),
    ],
)
def test_bad_shapes(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def thickness_area(thickness: float, last: float) -> float:
    """Twice the integral of the half thickness over the chord."""
    a = 0.2969, -0.1260, -0.3516, 0.2843, last
    return 2 * 5 * thickness * (a[0] / 1.5 + a[1] / 2 + a[2] / 3 + a[3] / 4 + a[4] / 5)


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("digits", ["0012", "2412", "6509"])
def test_airfoils(digits: str, closed: bool) -> None:
    wing = Domain.naca(digits, chord=2.0, nose=(1, 1), attack=10, closed=closed)
    flat = Domain.naca(digits, closed=closed)
    wanted = thickness_area(int(digits[2:]) / 100, -0.1036 if closed else -0.1015)
    assert math.isclose(wing.area, 4 * flat.area, rel_tol=1e-12)
    if digits[0] == "0":
        assert math.isclose(flat.area, wanted, rel_tol=1e-9)
    x = flat.at(flat.markers["upper"][0], np.linspace(0, 1, 400))
    assert (np.diff(x[:, 0]) < 1e-12).sum() > 380 and np.isclose(np.ptp(x[:, 0]), 1, atol=2e-3)
    t = 2 * math.asin(math.sqrt(int(digits[1]) / 10)) / math.pi  # where the camber is greatest
    middle = (flat.at(0, 1 - t) + flat.at(1, t)) / 2
    assert np.allclose(middle, [[int(digits[1]) / 10, int(digits[0]) / 100]], atol=1e-12)
    mesh = refine(wing, 0.1)
    assert check(mesh, domain=wing) and ("trailing edge" in wing.markers) is not closed


def test_letters_keep_their_curves() -> None:
    text = Domain.letters("aB8 g", size=2.0)
    assert len(text.curves) > 20 and all(isinstance(c, Bezier) for c in text.curves.values())
    mesh = constrained_delaunay(text)
    assert check(mesh, domain=text)
    assert mesh.euler_characteristic == (1 - 1) + (1 - 2) + (1 - 2) + (1 - 1)  # components minus holes
    assert math.isclose(
        Domain.letters("I", size=1.0).area * 4, Domain.letters("I", size=2.0).area, rel_tol=1e-12
    )


def test_splines_are_smooth_and_closed() -> None:
    n = 24
    angle = np.arange(n) * (2 * np.pi / n)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    ring = Domain.smooth(2 * circle, [circle])
    assert abs(ring.area - 3 * np.pi) < 2e-3 and len(ring.curves) == 2 * n
    before, after = ring.at(0, [1 - 1e-6, 1.0]), ring.at(1, [0.0, 1e-6])
    assert np.allclose(np.diff(before, axis=0), np.diff(after, axis=0), rtol=1e-4)
    assert check(refine(ring, 0.4), domain=ring)


# ---------------------------------------------------------------------- several in one, files


def test_domains_in_one() -> None:
    outer = Domain.rectangle((0, 0), (4, 4), inner=[[0, 2]], regions={"lower": [3.5, 1]})
    hole = Domain.disc((1, 3), 0.5, markers={"rim": range(4), "top": [0]})
    both = outer.with_holes(hole, Domain.polygon([[2, 1], [3, 1], [3, 2]]))
    assert math.isclose(both.area, 16 - math.pi / 4 - 0.5, rel_tol=1e-14)
    assert both.markers["rim"].tolist() == [4, 5, 6, 7] and both.markers["top"].tolist() == [2, 4]
    assert sorted(both.curves) == [4, 5, 6, 7] and both.inner.tolist() == [[0, 2]]
    mesh = refine(both, 0.5)
    assert check(mesh, domain=both)


POLY = """# a square with a square wall, a hole, and a seed
8 2 0 1
1 0 0 0
2 4 0 0
3 4 4 0
4 0 4 0
5 1 1 0
6 2 1 0
7 2 2 0
8 1 2 0
8 1
1 1 2 5
2 2 3 5
3 3 4 0
4 4 1 0
5 5 6 0
6 6 7 0
7 7 8 0
8 8 5 7
{holes}
1
1 0.5 0.5 3 0.25
"""


@pytest.mark.parametrize("with_hole", [True, False])
def test_poly_files(tmp_path: Path, with_hole: bool) -> None:
    path = tmp_path / "square.poly"
    path.write_text(POLY.format(holes="1\n1 1.5 1.5" if with_hole else "0"))
    domain = Domain.read(path)
    assert domain.area == (15 if with_hole else 16)  # without a seed the ring is a wall, not a hole
    assert len(domain.inner) == (0 if with_hole else 4)
    assert domain.regions["3"].tolist() == [[0.5, 0.5]] and domain.max_areas == {"3": 0.25}
    ends = domain.points[domain.pieces[domain.markers["7"]]]
    assert ends.tolist() == [[[1, 2], [1, 1]]] and len(domain.markers["5"]) == 2
    domain.write(tmp_path / "again.poly")
    again = Domain.read(tmp_path / "again.poly")
    assert again.area == domain.area and len(again.inner) == len(domain.inner)
    assert again.max_areas == domain.max_areas and again.markers.keys() == domain.markers.keys()
    mesh = refine(domain, max_area=again.max_areas)
    assert check(mesh, domain=domain)


def test_poly_takes_vertices_from_its_node_file(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n")
    (tmp_path / "a.poly").write_text("0 2 0 0\n4 0\n0 0 1\n1 1 2\n2 2 3\n3 3 0\n0\n")
    assert Domain.read(tmp_path / "a.poly").area == 1


def test_poly_eats_from_beyond_through_gaps(tmp_path: Path) -> None:
    """A notch that the hull closes, but no segment does, is outside; a dangling segment stays inside."""
    (tmp_path / "notch.poly").write_text(
        "8 2 0 0\n0 0 0\n1 4 0\n2 4 4\n3 2 1\n4 0 4\n5 1 0.5\n6 2 0.5\n7 3 3.9\n"
        "6 0\n0 0 1\n1 1 2\n2 2 3\n3 3 4\n4 4 0\n5 5 6\n0\n"
    )
    domain = Domain.read(tmp_path / "notch.poly")
    assert domain.area == 16 - 6 and domain.inner.tolist() == [[5, 6]] and domain.loose.tolist() == [7]
    assert 7 not in constrained_delaunay(domain).origin


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "ends where the number of vertices"),
        ("3 2 0 0\n0 0 0\n1 1 0\n", "ends where a vertex"),
        ("3 4 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n", "in 4 dimensions"),
        ("1 2 0 0\n0 zero 0\n", "'zero' among vertices is no number"),
        ("3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n0 0\n", "a segment needs 3 entries"),
        ("3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n0 0 9\n", "outside 0..2"),
        ("3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n0 0 1.5\n", "'1.5' among segments is no whole number"),
        ("-3 2 0 0\n", "the number of vertices is -3"),
        ("nan 2 0 0\n", "'nan' among the number of vertices is not finite"),
    ],
)
def test_bad_poly_files(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "bad.poly").write_text(text)
    with pytest.raises(InputError, match=message):
        Domain.read(tmp_path / "bad.poly")
    with pytest.raises(InputError, match="no file"):
        Domain.read(tmp_path / "none.poly")
    with pytest.raises(InputError, match="written as"):
        Domain.rectangle().write(tmp_path / "a.stl")


def test_poly_region_names_have_all_digits(tmp_path: Path) -> None:
    """Attributes that differ in the seventh digit are different regions."""
    path = tmp_path / "two.poly"
    path.write_text(
        "6 2 0 0\n0 0 0\n1 1 0\n2 2 0\n3 2 1\n4 1 1\n5 0 1\n7 0\n0 0 1\n1 1 2\n2 2 3\n3 3 4\n4 4 5\n"
        "5 5 0\n6 1 4\n0\n2\n0 0.5 0.5 1234567 0.1\n1 1.5 0.5 1234568 0.2\n"
    )
    domain = Domain.read(path)
    assert (
        domain.max_areas
        == {"1234567": 0.1, "1234568": 0.2}
        == {name: domain.max_areas[name] for name in domain.regions}
    )


def test_poly_accounts_for_its_repairs(tmp_path: Path) -> None:
    """Repairs and origins refer to the rows of the file."""
    path = tmp_path / "bow.poly"
    path.write_text("5 2 0 0\n0 0 0\n1 1 1\n2 1 0\n3 0 1\n4 0 0\n4 0\n0 0 1\n1 1 2\n2 2 3\n3 3 4\n0\n")
    domain = Domain.read(path, resolve=True)
    assert [r.kind for r in domain.repairs] == ["duplicate points", "crossing"] and domain.area == 0.5
    assert domain.origin.tolist() == [0, 1, 2, 3, -1]
    assert sorted(domain.piece_origin.tolist()) == [0, 0, 1, 2, 2, 3]
    assert Domain.read(path, resolve=True, inner=[[0, 3]]).piece_origin.min() >= 0  # there as facet 3 already


def test_names_in_poly_files_stay_apart(tmp_path: Path) -> None:
    """A name that is no number gets one that no other name is."""
    ring = [[0, 0], [2, 0], [2, 2], [0, 2]]
    domain = Domain(
        np.array([*ring, [1, 0], [1, 2]], dtype=float),
        [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]], inner=[[4, 5]],
        markers={"wall": [0], "1": [1], "0": [2], "\u00b2": [3]}, regions={"steel": [0.5, 1], "1": [1.5, 1]},
    )  # fmt: skip
    domain.write(tmp_path / "names.poly")
    text = (tmp_path / "names.poly").read_text(encoding="utf-8")
    assert "# marker 2: 'wall'\n" in text and "# region 2: 'steel'\n" in text
    again = Domain.read(tmp_path / "names.poly")
    assert {name: len(rows) for name, rows in again.markers.items()} == {"1": 1, "2": 1, "3": 1, "4": 1}
    assert {name: seeds.tolist() for name, seeds in again.regions.items()} == {
        "2": [[0.5, 1]],
        "1": [[1.5, 1]],
    }


def test_holes_of_curves_are_written_with_seeds(tmp_path: Path) -> None:
    text = Domain.letters("B8")
    text.write(tmp_path / "b8.poly")
    chords = text.sampled()
    assert Domain.read(tmp_path / "b8.poly").area == Domain(chords.points, chords.ends).area


# ---------------------------------------------------------------------- the book's regions

REGIONS = {
    "running": (running_domain, running_size),
    "wing": (wing_with_flap, lambda x: 0.02 + 0.15 * np.hypot(x[:, 0] - 0.6, x[:, 1])),
    "word": (word, 0.1),
    "plate": (plate, 0.12),
}


@pytest.mark.parametrize("name", REGIONS)
def test_the_regions_of_the_book(name: str) -> None:
    make, size = REGIONS[name]
    domain = make()
    for mesh in (constrained_delaunay(domain), refine(domain, size), voronoi_segment(domain, size)):
        report = check(mesh, domain=domain)
        assert report, report
        assert mesh.complete or mesh.reasons.size


def test_the_running_domain_is_the_running_region() -> None:
    points, segments = running_region(0.01)
    polygon, domain = Domain(points, segments), running_domain()
    assert abs(polygon.area - domain.area) < 2e-3
    x = np.random.default_rng(0).random((4000, 2)) * [3, 2]
    assert (polygon.contains(x) != domain.contains(x)).mean() < 2e-3
    assert set(domain.markers) == {"shore", "island"}


def test_the_plate_has_three_materials() -> None:
    domain = plate()
    mesh = constrained_delaunay(domain)
    assert set(np.unique(mesh.markers["region"])) == {0, 1, 2} and 1 - mesh.euler_characteristic == 21
    inlay = mesh.volumes[mesh.markers["region"] == 2].sum()
    assert abs(inlay - np.pi * (0.25**2 - 0.1**2)) < 0.06


def test_the_coast() -> None:
    sea = coastline()
    assert len(sea.points) > 1000 and "frame" in sea.markers
    assert not sea.contains(np.array([1.0, 0.9]))  # on Vancouver Island
    assert sea.contains(np.array([0.2, 0.2])) and sea.contains(np.array([1.55, 1.1]))
    size = coastline_size(sea)
    assert size(sea.points).max() < 0.6 and size(sea.points).min() == 0.015
    mesh = voronoi_segment(sea, size)
    assert check(mesh, domain=sea)
