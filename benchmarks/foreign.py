"""Polygons of other projects' tests and of public maps: what the library accepts, mends and refuses.

    python -m benchmarks.foreign FOLDER --fetch     # clone the sources into FOLDER (git, network), then run
    python -m benchmarks.foreign FOLDER             # run what is there
    python -m benchmarks.foreign FOLDER --only geos --list

Nothing of the sources is stored in this project. Each polygon becomes a `Domain` as it is; if it is refused,
`resolve=True` is tried. What was accepted or mended is triangulated, and `check` compares the mesh with its
domain. With shapely installed, areas are compared: of valid polygons with shapely's, of mended ones with
those of its `make_valid`, where the two meanings may differ (this is counted, not called a fault).
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import unstruct
from unstruct import Domain, UnstructError

try:
    import shapely
    from shapely.geometry import shape
except ImportError:
    shapely = None

CLOSE = 1e-9  # of areas, relative
ROUNDED = 1e-14  # of the squared extent: shapely's areas are rounded, and slivers may be nothing to it


class Case(NamedTuple):
    """One polygon: its name, how to make a domain of it, and the same as a geometry, if it is one."""

    name: str
    make: Callable[..., Domain]
    geometry: dict[str, Any] | None = None
    hull: bool = False


class Source(NamedTuple):
    """A public repository: where it is, its license, its files, and how to read one."""

    address: str
    license: str
    files: str
    read: Callable[[Path], Iterator[Case]]


def _geojson(geometry: dict[str, Any], name: str) -> Case:
    return Case(name, lambda **options: Domain.from_geojson(geometry, **options), geometry)


def read_map(path: Path) -> Iterator[Case]:
    """The features of a GeoJSON file, one by one."""
    data = json.loads(path.read_text(encoding="utf-8"))
    for number, feature in enumerate(data.get("features", [])):
        if feature["geometry"] and feature["geometry"]["type"].endswith("Polygon"):
            yield _geojson(feature["geometry"], f"{path.stem} {number}")


def read_rings(path: Path) -> Iterator[Case]:
    """A JSON list of rings, the first of which is the outer one."""
    rings = json.loads(path.read_text(encoding="utf-8"))
    if rings and isinstance(rings[0], list) and rings[0] and isinstance(rings[0][0], list):
        yield _geojson({"type": "Polygon", "coordinates": rings}, path.stem)


def read_lines(path: Path) -> Iterator[Case]:
    """A point in each line; lines of words start a hole, or single points, which are left out."""
    rings: list[list[list[float]]] = [[]]
    for line in path.read_text(encoding="utf-8").splitlines():
        if re.match(r"\s*HOLE", line):
            rings.append([])
        elif re.match(r"\s*STEINER", line):
            break
        elif len(line.split()) == 2:
            rings[-1].append([float(x) for x in line.split()])
    yield _geojson({"type": "Polygon", "coordinates": rings}, path.stem)


def read_segments(path: Path) -> Iterator[Case]:
    """Counts, points, and pairs of points to be joined."""
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
    n, m = int(lines[0][0]), int(lines[0][1])
    if len(lines) < 1 + n + m or any(len(line) < 2 for line in lines[1 : 1 + n + m]):
        return
    points = np.array([line[:2] for line in lines[1 : 1 + n]], dtype=float)
    rows = np.array([line[:2] for line in lines[1 + n : 1 + n + m]], dtype=int).reshape(-1, 2)
    nothing = np.empty((0, 2), dtype=int)
    yield Case(path.stem, lambda **options: Domain(points, nothing, inner=rows, **options), None, hull=True)


TEXT = re.compile(r"(?:MULTI)?POLYGON\s*(?:Z\s*)?\([^A-Za-z<]*\)", re.IGNORECASE)


def read_texts(path: Path) -> Iterator[Case]:
    """Every polygon in well-known text in a file, each once."""
    if shapely is None:
        return
    texts = dict.fromkeys(TEXT.findall(path.read_text(encoding="utf-8", errors="replace")))
    for number, text in enumerate(texts):
        try:
            geometry = shapely.from_wkt(text)
        except shapely.errors.ShapelyError:
            continue  # some tests are of texts that are not well formed
        if not geometry.is_empty:
            yield _geojson(geometry.__geo_interface__, f"{path.stem} {number}")


def read_poly(path: Path) -> Iterator[Case]:
    """A file of Triangle's."""
    yield Case(path.stem, lambda **options: Domain.read(path, **options))


GITHUB = "https://github.com/"
SOURCES = {
    "world.geo.json": Source(
        f"{GITHUB}johan/world.geo.json", "public domain", "countries/**/*.json", read_map
    ),
    "geos": Source(f"{GITHUB}libgeos/geos", "LGPL 2.1", "tests/xmltester/tests/**/*.xml", read_texts),
    "earcut": Source(f"{GITHUB}mapbox/earcut", "ISC", "test/fixtures/*.json", read_rings),
    "poly2tri": Source(f"{GITHUB}jhasse/poly2tri", "BSD 3-clause", "testbed/data/*.dat", read_lines),
    "CDT": Source(f"{GITHUB}artem-ogre/CDT", "MPL 2.0", "CDT/tests/inputs/*.txt", read_segments),
    "triangle": Source(f"{GITHUB}drufat/triangle", "LGPL 3", "triangle/data/*.poly", read_poly),
}


class Outcome(NamedTuple):
    """What became of a polygon: "accepted", "mended", "refused" or "fault"; a remark; its vertices."""

    what: str
    remark: str
    vertices: int


def _area(geometry: dict[str, Any] | None) -> tuple[float | None, bool]:
    """The area by shapely, of the geometry or of what `make_valid` makes of it; and whether it is valid."""
    if geometry is None or shapely is None:
        return None, False
    try:
        theirs = shape(geometry)
    except ValueError:  # rings of less than three corners
        return None, False
    return (theirs.area, True) if theirs.is_valid else (shapely.make_valid(theirs).area, False)


def run(case: Case) -> Outcome:
    """Make a domain of a polygon, mesh it and check the mesh."""
    remark = ""
    try:
        try:
            domain, what = case.make(), "accepted"
        except UnstructError as error:
            remark = str(error)
            try:
                domain, what = case.make(resolve=True), "mended"
            except UnstructError as worse:
                return Outcome("refused", str(worse), 0)
        hull = case.hull or not len(domain.facets)  # open chains around a hole are taken for inner segments
        mesh = unstruct.constrained_delaunay(domain, hull="holes" if hull else False)
        report = unstruct.check(mesh, domain=None if hull else domain)
    except UnstructError as error:
        return Outcome("fault", f"not meshed: {error}", 0)
    except Exception as error:  # the point of this program is to find these
        return Outcome("fault", f"{type(error).__name__}: {error}", 0)
    if not report:
        return Outcome("fault", f"check: {report}", len(domain.points))
    area, valid = _area(case.geometry)
    if area is not None:
        extent = float(np.ptp(domain.points, axis=0).max())
        if abs(domain.area - area) > CLOSE * abs(area) + ROUNDED * extent**2:
            remark = f"area {domain.area:.12g}, shapely's {area:.12g}; {remark}"
            if valid:
                return Outcome("fault", remark, len(domain.points))
            what += ", another area"
    return Outcome(what, remark, len(domain.points))


def main(arguments: list[str] | None = None) -> int:
    """Run all polygons; return 1 if there was a fault."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.foreign", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("folder", type=Path, help="where the sources are, a folder for each")
    parser.add_argument("--fetch", action="store_true", help="clone the sources that are not there")
    parser.add_argument("--only", choices=sorted(SOURCES), action="append", help="may be repeated")
    parser.add_argument(
        "--list", action="store_true", help="print every polygon that was not simply accepted"
    )
    options = parser.parse_args(arguments)
    faults = 0
    print(f"{'source':16}{'license':>14}{'polygons':>10}{'vertices':>10}{'seconds':>9}  outcomes")
    for name, source in SOURCES.items():
        folder = options.folder / name
        if options.only and name not in options.only:
            continue
        if options.fetch and not folder.exists():
            subprocess.run(["git", "clone", "--quiet", "--depth=1", source.address, folder], check=True)
        if not folder.exists():
            print(f"{name:16} is not in {options.folder}; --fetch gets it")
            continue
        start, found, vertices = time.process_time(), Counter[str](), 0
        for path in sorted(folder.glob(source.files)):
            for case in source.read(path):
                outcome = run(case)
                found[outcome.what] += 1
                vertices += outcome.vertices
                if outcome.what == "fault" or (options.list and outcome.what != "accepted"):
                    print(f"    {case.name}: {outcome.what}: {outcome.remark[:200]}", flush=True)
        faults += found["fault"]
        outcomes = ", ".join(f"{what} {count}" for what, count in found.most_common())
        seconds = time.process_time() - start
        print(
            f"{name:16}{source.license:>14}{found.total():10}{vertices:10}{seconds:9.1f}  {outcomes}",
            flush=True,
        )
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
