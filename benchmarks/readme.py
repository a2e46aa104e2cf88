"""The table of speed in the README, from the committed rows; ``python -m benchmarks.readme`` writes it."""

from __future__ import annotations

import json
import re
from pathlib import Path

from . import planar_report, prisms_report, report, space_front, surface_report, tree_report, volume_report

README = Path(__file__).parent.parent / "README.md"
RESULTS = Path(__file__).parent / "results"
BLOCK = re.compile(r"(<!-- speed: .*? -->\n).*?(<!-- /speed -->)", flags=re.S)


def _committed(suite: str) -> tuple[list[report.Row], str]:
    """The committed rows of a suite, and how they were measured."""
    result = json.loads((RESULTS / f"{suite}.json").read_text(encoding="utf-8"))
    return result["rows"], f"Measured on {result['machine']}; one core, contestants interleaved, medians."


PAGE_OF_SURFACES = "[page of benchmarks of surfaces](book/benchmarks-surface.ipynb)"


def _on_surfaces() -> list[str]:
    if not (RESULTS / "surface.json").exists():
        return []
    rows, how = _committed("surface")
    text = "Triangles on surfaces in space, by remeshing to a size and by intrinsic flips: triangles per"
    text += f" second by those of others (seconds, distances and angles on the {PAGE_OF_SURFACES}). {how}"
    return [text, surface_report.summary(rows)]


def _front_in_space() -> list[str]:
    if not (RESULTS / "space_front.json").exists():
        return []
    rows, how = _committed("space_front")
    text = "The advancing front in space, on closed surfaces that are kept: cells per second by those"
    text += f" of others that march, and by our own `tetrahedralize` (more on the {PAGE_OF_SURFACES}). {how}"
    return [text, space_front.summary(rows)]


def speed() -> str:
    """The text between the marks in the README."""
    rows, how = _committed("delaunay")
    parts = ["The time of other libraries divided by that of unstruct, for the same points; a ratio below 1,"]
    parts += ["in bold, means that the other library is faster. (TetGen *itself* is its own time, without"]
    parts += ["that of passing arrays to and from Python.)", how]
    text = " ".join(parts) + " More on the [page of benchmarks](book/benchmarks.ipynb)."
    tables = [f"In {d} dimensions:\n\n{report.table(rows, d)}" for d in (2, 3)]
    planar, how = _committed("planar")
    parts = ["Meshes of planar regions: triangles per second, which includes the creation and the checks of"]
    parts += ["the `Domain`, and this speed divided by that of others (the quality of their meshes is on the"]
    parts += [f"[page of planar benchmarks](book/benchmarks-planar.ipynb)). {how}"]
    sections = [text, *tables, " ".join(parts), planar_report.summary(planar)]
    if (RESULTS / "volume.json").exists():
        volume, how = _committed("volume")
        parts = [
            "Tetrahedra in bodies whose surface is kept triangle for triangle: cells per second, checks of"
        ]
        parts += ["the `Domain` included, by those of others (body by body, and in seconds, on the"]
        parts += [f"[page of volume benchmarks](book/benchmarks-volume.ipynb)). {how}"]
        sections += [" ".join(parts), volume_report.summary(volume)]
    sections += _on_surfaces() + _front_in_space()
    if (RESULTS / "tree.json").exists():
        trees, how = _committed("tree")
        parts = [
            "Quadtrees and octrees: leaves that are built and balanced, points that are located, cells that"
        ]
        parts += [
            "templates make, each by the second, and these speeds by those of `discretize`, with the same"
        ]
        parts += [f"leaves (more on the [page of tree benchmarks](book/benchmarks-tree.ipynb)). {how}"]
        sections += [" ".join(parts), tree_report.summary(trees), "Meshes from trees:"]
        sections.append(tree_report.quality(trees))
    if (RESULTS / "prisms.json").exists():
        prisms, how = _committed("prisms")
        parts = [
            "Thirty prismatic layers on closed surfaces: wedges per second, with limits of heights and the"
        ]
        parts += [
            "search for collisions, and wedges that are not positive everywhere, by exact signs (on the"
        ]
        parts += [f"[page of prism benchmarks](book/benchmarks-prisms.ipynb)). {how}"]
        sections += [" ".join(parts), prisms_report.summary(prisms)]
    return "\n\n".join(sections) + "\n"


def main() -> None:
    """Write the table to the README."""
    text, found = BLOCK.subn(lambda marks: marks[1] + speed() + marks[2], README.read_text(encoding="utf-8"))
    if found != 1:
        raise SystemExit("the README must contain the marks <!-- speed: … --> and <!-- /speed --> once")
    README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
