"""Named features as domains: what polygons cover, common borders, names of regions and lines."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, check, constrained_delaunay, refine
from unstruct.base.errors import DomainError, InputError

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
HOLE = [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]
LEFT, RIGHT = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], [[1, 0], [2, 0], [2, 1], [1, 1], [1, 0]]


class Shape:
    """What shapely offers."""

    def __init__(self, mapping: dict):
        self.__geo_interface__ = mapping


def polygon(*rings: Any) -> dict:
    return {"type": "Polygon", "coordinates": list(rings)}


def feature(geometry: dict | None, **properties: Any) -> dict:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features: dict) -> dict:
    return {"type": "FeatureCollection", "features": list(features)}


def test_geojson() -> None:
    triangle = [[4, 4, 7.5], [5, 4, 7.5], [5, 5, 7.5], [4, 4, 7.5]]
    assert Domain.from_geojson(polygon(SQUARE, HOLE)).area == 15
    both = {"type": "MultiPolygon", "coordinates": [[SQUARE, HOLE], [triangle]]}  # they touch in a corner
    assert Domain.from_geojson(Shape(both)).area == 15.5 and len(Domain.from_geojson(both).points) == 10
    line = {"type": "LineString", "coordinates": [[3, 1], [3, 2], [2.5, 3]]}
    dots = {"type": "MultiPoint", "coordinates": [[0.5, 0.5], [3.5, 3.5]]}
    domain = Domain.from_geojson(collection(*map(feature, (polygon(SQUARE, HOLE), line, dots))))
    assert len(domain.inner) == 2 and len(domain.loose) == 2 and domain.area == 15
    assert list(domain.regions) == ["0"] and list(domain.markers) == ["1"]
    assert Domain.from_geojson({"type": "LinearRing", "coordinates": HOLE}).area == 1


def test_geojson_without_places_and_with_some_heights() -> None:
    """Features without geometry, empty geometry, and heights at some positions only are all legal."""
    ring = [[0, 0], [2, 0, 5.0], [2, 2], [0, 2], [0, 0]]
    empty = [{"type": kind, "coordinates": []} for kind in ("Point", "LineString", "Polygon", "MultiPoint")]
    domain = Domain.from_geojson(collection(feature(polygon(ring)), feature(None), *empty))
    assert domain.area == 4 and len(domain.points) == 4


def test_inner_segments_of_geometry_and_caller_are_joined() -> None:
    """The caller's inner segments come after those of the geometry, which stay."""
    line = {"type": "LineString", "coordinates": [[1, 0.5], [3, 0.5]]}
    both = {"type": "GeometryCollection", "geometries": [polygon(SQUARE), line]}
    domain = Domain.from_geojson(both, inner=[[0, 2]], markers={"caller's": [5]}, resolve=True)
    assert domain.area == 16 and len(domain.markers["caller's"]) >= 1
    line["coordinates"] = [[2, 0.5], [3, 0.5]]
    domain = Domain.from_geojson(both, inner=[[0, 2]], markers={"caller's": [5]})
    assert domain.inner.tolist() == [[4, 5], [0, 2]] and domain.markers["caller's"].tolist() == [5]


def test_neighbors_keep_their_border_and_their_names() -> None:
    domain = Domain.from_geojson({"type": "MultiPolygon", "coordinates": [[LEFT], [RIGHT]]})
    assert domain.area == 2 and len(domain.inner) == 1 and not domain.regions and not domain.repairs
    domain = Domain.from_geojson(
        collection(feature(polygon(LEFT), name="left"), feature(polygon(RIGHT), name="right"))
    )
    assert len(domain.points) == 6 and len(domain.facets) == 6 and len(domain.inner) == 1
    assert list(domain.regions) == ["left", "right"] and len(domain.loose) == 0
    mesh = refine(domain, max_area={"left": 0.01})
    assert check(mesh, domain=domain) and mesh.regions == {"left": 0, "right": 1}
    left = mesh.volumes[mesh.markers["region"] == 0]
    assert left.max() <= 0.01 and left.sum() == pytest.approx(1) and len(mesh.volumes) - len(left) < 60


def test_an_enclave_and_a_lake() -> None:
    """The hole of a country is another one; the hole of that is a lake, which belongs to nobody."""
    around, inside = polygon(SQUARE, [[1, 1], [3, 1], [3, 3], [1, 3]]), [[1, 1], [3, 1], [3, 3], [1, 3]]
    lake = [[1.5, 1.5], [2, 1.5], [2, 2]]
    domain = Domain.from_geojson([feature(around, NAME="S"), feature(polygon(inside, lake), NAME="L")])
    assert domain.area == 16 - 0.125 and len(domain.inner) == 4 and len(domain.facets) == 7
    mesh = constrained_delaunay(domain)
    assert check(mesh, domain=domain)
    areas = [mesh.volumes[mesh.markers["region"] == mesh.regions[name]].sum() for name in "SL"]
    assert areas == pytest.approx([12, 4 - 0.125])


def test_names() -> None:
    both = [polygon(LEFT), polygon(RIGHT)]

    def names(name: str | None, *features: dict) -> list[str]:
        return list(Domain.from_geojson(list(features), name=name).regions)

    assert names(None, *map(feature, both)) == ["0", "1"]
    assert names(None, feature(both[0], id=7, land="A"), feature(both[1], NAME="B", id=8)) == ["7", "B"]
    assert names(None, {**feature(both[0]), "id": "x"}, feature(both[1], name=None)) == ["x", "1"]
    assert names("land", feature(both[0], land="A", name="B"), feature(both[1])) == ["A", "1"]
    assert names(None, feature(both[0], name="A"), feature(both[1], name="A")) == ["A"]
    with pytest.raises(InputError, match="no feature has the property 'x'; there are 'land', 'name'"):
        names("x", feature(both[0], land="A", name="B"))
    lines = feature({"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, name="fault")
    domain = Domain.from_geojson([feature(both[0], name="A"), lines])
    assert domain.markers["fault"].tolist() == [4] and len(domain.regions["A"]) == 2
    assert constrained_delaunay(domain).regions == {"A": 0}


FAULTS = {
    "overlap": (
        [polygon(SQUARE), polygon(HOLE)],
        r"polygon 0 of feature 0 and polygon 0 of feature 1 overlap near",
    ),
    "equal": ([polygon(SQUARE), polygon(SQUARE)], "overlap near"),
    "crossing": ([polygon(SQUARE), polygon([[3, 1], [5, 1], [5, 2], [3, 2]])], r"cross at \(4, [12]\)"),
    "hole beside": (
        [polygon(LEFT, [[5, 5], [6, 5], [6, 6]])],
        "hole 0 of polygon 0 of feature 0 lies outside",
    ),
    "hole along": ([polygon(SQUARE, [[1, 0], [2, 0], [2, 1], [1, 1]])], "share a line near"),
    "two holes": (
        [polygon(SQUARE, HOLE, [[1.2, 1.2], [1.5, 1.2], [1.5, 1.4]])],
        "hole 0 of .* and hole 1 of .* overlap",
    ),
    "spike": (
        [polygon([[0, 0], [4, 0], [4, 4], [6, 6], [4, 4], [0, 4]])],
        r"runs along itself near \(5, 5\)",
    ),
    "two corners": (
        [polygon(SQUARE), polygon([[9, 9], [8, 8], [9, 9]])],
        "has 2 corners; a ring needs three",
    ),
    "one corner": (
        [polygon(SQUARE), polygon([[9, 9], [9, 9], [9, 9]])],
        "has 2 corners; a ring needs three",
    ),
    "line": (
        [polygon(LEFT), {"type": "LineString", "coordinates": [[-1, 0.5], [2, 0.5]]}],
        "a line of feature 1 cross",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_named_and_can_be_resolved(name: str) -> None:
    geometries, message = FAULTS[name]
    areas = {"crossing": 17, "hole beside": 1, "hole along": 15, "two holes": 15, "line": 1}
    with pytest.raises(InputError, match=message) as caught:
        Domain.from_geojson([feature(g) for g in geometries])
    if name not in ("two corners", "one corner"):
        assert isinstance(caught.value, DomainError) and np.isfinite(caught.value.faults[0].place).all()
    domain = Domain.from_geojson([feature(g) for g in geometries], resolve=True)
    assert domain.area == areas.get(name, 16) and domain.repairs and len(domain.loose) == 0
    assert check(constrained_delaunay(domain), domain=domain)


def test_what_covers_nothing() -> None:
    flat = polygon([[0, 0], [1, 0], [2, 0]])
    for geometry, resolve in ((flat, True), (polygon([[0, 0], [1, 1]]), True), (polygon(LEFT, LEFT), True)):
        with pytest.raises(InputError, match="cover no area"):
            Domain.from_geojson(geometry, resolve=resolve)
    with pytest.raises(InputError, match="runs along itself"):
        Domain.from_geojson(flat)


# ---------------------------------------------------------------------- against counted cells


def rectangle(size: int) -> st.SearchStrategy[tuple[int, int, int, int]]:
    """Corners (x0, y0, x1, y1) on an integer grid."""
    pair = st.lists(st.integers(0, size), min_size=2, max_size=2, unique=True).map(sorted)
    return st.tuples(pair, pair).map(lambda xy: (xy[0][0], xy[1][0], xy[0][1], xy[1][1]))


def ring(box: tuple[int, int, int, int]) -> list[tuple[int, int]]:
    x0, y0, x1, y1 = box
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def cells(box: tuple[int, int, int, int]) -> set[tuple[int, int]]:
    return {(i, j) for i in range(box[0], box[2]) for j in range(box[1], box[3])}


@settings(max_examples=60)
@given(st.lists(st.tuples(rectangle(6), st.lists(rectangle(6), max_size=2)), min_size=1, max_size=4))
def test_overlapping_rectangles_cover_their_cells(polygons: list) -> None:
    """With `resolve` each cell belongs to the first polygon that contains it, outer minus holes."""
    owner: dict[tuple[int, int], int] = {}
    for i, (outer, holes) in enumerate(polygons):
        for cell in cells(outer) - set().union(*map(cells, holes)):
            owner.setdefault(cell, i)
    features = [
        feature(polygon(ring(outer), *map(ring, holes)), name=f"p{i}")
        for i, (outer, holes) in enumerate(polygons)
    ]
    if not owner:
        with pytest.raises(InputError, match="cover no area"):
            Domain.from_geojson(features, resolve=True)
        return
    domain = Domain.from_geojson(features, resolve=True)
    mesh = constrained_delaunay(domain)
    assert domain.area == len(owner) and check(mesh, domain=domain) and len(domain.loose) == 0
    counts = {
        name: int((np.array(list(owner.values())) == i).sum())
        for i, name in enumerate(f"p{i}" for i in range(4))
    }
    areas = {name: mesh.volumes[mesh.markers["region"] == k].sum() for name, k in mesh.regions.items()}
    assert areas == pytest.approx({name: count for name, count in counts.items() if count})


@st.composite
def tilings(draw: st.DrawFn) -> list[tuple[int, int, int, int]]:
    """A rectangle cut into others again and again; corners of some lie on sides of others."""
    tiles = [(0, 0, draw(st.integers(1, 9)), draw(st.integers(1, 9)))]
    for _ in range(draw(st.integers(0, 7))):
        x0, y0, x1, y1 = tiles.pop(draw(st.integers(0, len(tiles) - 1)))
        if draw(st.booleans()) and x1 - x0 > 1:
            cut = draw(st.integers(x0 + 1, x1 - 1))
            tiles += [(x0, y0, cut, y1), (cut, y0, x1, y1)]
        elif y1 - y0 > 1:
            cut = draw(st.integers(y0 + 1, y1 - 1))
            tiles += [(x0, y0, x1, cut), (x0, cut, x1, y1)]
        else:
            tiles.append((x0, y0, x1, y1))
    return tiles


@settings(max_examples=60)
@given(
    tilings(), st.integers(0, 255), st.sampled_from([((1, 0), (0, 1)), ((2, 1), (-1, 3)), ((7, 3), (2, 5))])
)
def test_tiles_with_corners_on_sides(tiles: list, left_out: int, turn: tuple) -> None:
    """Corners on sides split them exactly, without `resolve`, in oblique tilings too; some are left out."""
    move = np.array(turn, dtype=float)
    kept = [t for i, t in enumerate(tiles) if not left_out >> i & 1] or tiles[:1]
    features = [feature(polygon(np.array(ring(t)) @ move), name=str(t)) for t in kept]
    domain = Domain.from_geojson(features)
    scale = round(abs(np.linalg.det(move)))
    assert domain.area == scale * sum(len(cells(t)) for t in kept) and not domain.repairs
    mesh = constrained_delaunay(domain)
    assert check(mesh, domain=domain) and len(domain.loose) == 0
    for t in kept:
        area = mesh.volumes[mesh.markers["region"] == mesh.regions[str(t)]].sum()
        assert area == pytest.approx(scale * len(cells(t)))


def test_countries_of_shapely() -> None:
    """Cells of a grid with random owners, united by shapely: holes, islands, and corners that touch."""
    shapely = pytest.importorskip("shapely")
    for seed in range(6):
        rng = np.random.default_rng(seed)
        own = rng.integers(-1, 4, (7, 7))
        lands = {
            f"land {k}": shapely.unary_union(
                [shapely.box(i, j, i + 1, j + 1) for i, j in np.argwhere(own == k)]
            )
            for k in range(4)
        }
        features = [feature(shapely.geometry.mapping(land), name=name) for name, land in lands.items()]
        domain = Domain.from_geojson(features)
        mesh = constrained_delaunay(domain)
        assert check(mesh, domain=domain) and domain.area == (own >= 0).sum()
        for name, land in lands.items():
            area = mesh.volumes[mesh.markers["region"] == mesh.regions[name]].sum()
            assert area == pytest.approx(land.area)


def test_many_features() -> None:
    """Many squares with names: each is a region."""
    n = 50
    features = [
        feature(polygon([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]), name=f"{i} {j}")
        for i in range(n)
        for j in range(n)
    ]
    domain = Domain.from_geojson(features)
    mesh = constrained_delaunay(domain)
    assert len(domain.regions) == n * n and len(domain.inner) == 2 * n * (n - 1)
    assert (np.bincount(mesh.markers["region"]) == 2).all() and len(mesh.regions) == n * n
    assert check(mesh, domain=domain)
