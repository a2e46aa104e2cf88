"""What a `Domain` can be read from: Triangle's files, GeoJSON, WKT, Shapefile, airfoils; by path or text."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...base.files import as_path, bytes_of, suffix_of, text_of
from ...base.optional import optional
from ...mesh.node_ele import read_points
from . import poly
from .sections import read_section, section_parts
from .well_known import is_wkt, wkt_geometries

__all__ = ["REGION_SUFFIXES", "as_geometry", "read_domain", "source_of"]

GEOJSON = (".geojson", ".json", ".geojsonl", ".ndjson", ".geojsons")
MESHES = tuple(".msh .ele .vtu .vtk .su2 .stl .off .obj .ply .xdmf .mesh .inp .bdf .med .cgns".split())
REGION_SUFFIXES = (".poly", ".node", *GEOJSON, ".wkt", ".txt", ".shp", ".shx", ".dbf", ".zip", ".dat")


def as_geometry(source: Any) -> Any:
    """GeoJSON or WKT by path or text as a mapping; everything else as it is."""
    if not isinstance(source, str | Path):
        return source
    kind, content = source_of(source)
    if kind != "features":
        raise InputError(f"{source} contains no geometries: Domain.read reads it")
    return content


def read_domain(
    cls: Any,
    make: Callable[[dict[str, Any], Mapping[str, Any]], Any],
    source: str | Path,
    *,
    shape: str,
    name: str | None,
    options: Mapping[str, Any],
) -> Any:
    """The domain of a source; see `Domain.read`. ``make`` joins parts and options."""
    kind, content = source_of(source, shape=shape)
    if kind == "features":
        return cls.from_geojson(content, **({} if name is None else {"name": name}), **options)
    if kind == "parts":
        return make(content, options)
    found = poly.read_poly(content, make=cls, resolve=bool(options.get("resolve")))
    domain = make(found.parts, options)
    poly.account(domain, found)
    return domain


def source_of(source: str | Path, *, shape: str = "spline") -> tuple[str, Any]:
    """Find out what a source is, and read it.

    Parameters
    ----------
    source : str or Path
        The path of a file, or a text in GeoJSON or WKT.
    shape : str
        "spline" or "polygon", for airfoils.

    Returns
    -------
    kind : str
        "poly": a file of Triangle. "features": GeoJSON. "parts": arguments of a `Domain`.
    content : Path, or mapping of GeoJSON, or dict

    Raises
    ------
    InputError
        The message names the file, the line where there is one, and the remedy.
    """
    if isinstance(source, str):
        if source.lstrip("\ufeff \t\r\n")[:1] in ("{", "["):
            return "features", _from_json(source.lstrip("\ufeff"), "the text")
        if is_wkt(source):
            return "features", _collection(wkt_geometries(source, "the text"))
        if "\n" in source.strip() or len(source) > 4000:
            raise InputError(
                f"the text {source[:40]!r}... is neither GeoJSON, which begins with '{{', nor WKT, which "
                "begins with the name of a geometry such as POLYGON; nor is it a path"
            )
    path = as_path(source)
    suffix = suffix_of(path)
    if suffix == ".poly":
        return "poly", path
    if suffix == ".node":
        return "parts", _from_points(path)
    if suffix in (".shp", ".shx", ".dbf", ".zip"):
        return "features", _from_shapefile(path if suffix == ".zip" else _sibling(path))
    if suffix in GEOJSON:
        return "features", _from_json(text_of(path), path.name)
    if suffix == ".dat":
        points, _ = read_section(path)
        return "parts", section_parts(points, shape)
    if suffix in MESHES:
        raise InputError(f"{path.name} is a mesh, not a region: read it with Mesh.read")
    data = bytes_of(path)
    if b"\0" not in data or suffix in (".wkt", ".txt"):
        text = text_of(path)
        if is_wkt(text):
            return "features", _collection(wkt_geometries(text, path.name))
        if text.lstrip()[:1] == "{":
            return "features", _from_json(text, path.name)
        if suffix == ".wkt":
            return "features", _collection(wkt_geometries(text, path.name))
    raise InputError(
        f"{path.name} cannot be read: its suffix {suffix!r} is none of {', '.join(REGION_SUFFIXES)}"
    )


def _sibling(path: Path) -> Path:
    return (
        path if suffix_of(path) == ".shp" else path.with_suffix(".SHP" if path.suffix.isupper() else ".shp")
    )


def _collection(geometries: list[dict[str, Any]]) -> dict[str, Any]:
    """One geometry by itself, several as a collection."""
    if len(geometries) == 1:
        return geometries[0]
    return {"type": "GeometryCollection", "geometries": geometries}


def _from_json(text: str, name: str) -> dict[str, Any]:
    """A mapping of GeoJSON; several, one in each line, become a collection of features."""
    try:
        found = json.loads(text)
    except json.JSONDecodeError as error:
        lines = [line.strip("\x1e \t\r") for line in text.splitlines()]
        try:
            found = [json.loads(line) for line in lines if line]
            if not found:
                raise error
        except json.JSONDecodeError:
            raise InputError(f"{name}, line {error.lineno}: this is not JSON: {error.msg}") from None
        features = [f if _type(f) == "Feature" else {"type": "Feature", "geometry": f} for f in found]
        return {"type": "FeatureCollection", "features": features}
    except RecursionError:
        raise InputError(f"{name} is not GeoJSON: its brackets are nested too deeply") from None
    if not isinstance(found, dict) or not isinstance(found.get("type"), str):
        raise InputError(f"{name} is JSON, but not GeoJSON: a mapping with a 'type' is expected")
    if found["type"] == "Topology":
        raise InputError(f"{name} is TopoJSON, not GeoJSON: convert it, for example with topo2geo")
    return found


def _type(value: Any) -> Any:
    return value.get("type") if isinstance(value, dict) else None


def _from_points(path: Path) -> dict[str, Any]:
    points, _, _ = read_points(path)
    if points.shape[1] != 2:
        raise InputError(f"{path.name} has points in {points.shape[1]} dimensions, not 2")
    return {"points": points, "facets": np.empty((0, 2), dtype=np.int32)}


def _from_shapefile(path: Path) -> dict[str, Any]:
    """Shapes and their records as a collection of features."""
    data = bytes_of(path)
    shapefile = optional("shapefile", f"reading {path.name}")
    if data[:4] not in (b"\x00\x00\x27\x0a", b"PK\x03\x04"):
        raise InputError(f"{path.name} is not a Shapefile: it does not begin as one")
    code = _encoding(path)
    features: list[dict[str, Any]] = []
    try:
        with shapefile.Reader(str(path), encoding=code, encodingErrors="replace") as reader:
            named = suffix_of(path) == ".zip" or any(path.with_suffix(s).is_file() for s in (".dbf", ".DBF"))
            records = reader.records() if named else []
            for i, shape in enumerate(reader.shapes()):
                geometry = None if shape.shapeType == 0 else shape.__geo_interface__
                values = records[i].as_dict() if i < len(records) else {}
                features.append({"type": "Feature", "properties": values, "geometry": geometry})
    except (shapefile.ShapefileException, struct.error, ValueError, IndexError, OSError) as error:
        raise InputError(
            f"{path.name}, shape {len(features)}: {type(error).__name__}: {error}; is the Shapefile whole? "
            ".shp, .shx and .dbf belong together"
        ) from None
    return {"type": "FeatureCollection", "features": features}


def _encoding(path: Path) -> str:
    """The encoding of texts that the file beside says, or UTF-8."""
    for name in (".cpg", ".CPG"):
        if path.with_suffix(name).is_file():
            code = text_of(path.with_suffix(name)).strip()
            code = re.sub(r"^(?:ANSI |ISO[- ]?)?(\d{3,5})$", r"cp\1", code)
            try:
                "".encode(code)
            except (LookupError, UnicodeError):
                return "utf-8"
            return code
    return "utf-8"
