"""The README's table of speed, made from the committed rows: ``python -m benchmarks.readme`` writes it."""

from __future__ import annotations

import json
import re
from pathlib import Path

from . import planar_report, report

README = Path(__file__).parent.parent / "README.md"
RESULTS = Path(__file__).parent / "results"
BLOCK = re.compile(r"(<!-- speed: .*? -->\n).*?(<!-- /speed -->)", flags=re.S)


def _told(suite: str) -> tuple[list[report.Row], str]:
    """The committed rows of a suite, and how they were measured."""
    result = json.loads((RESULTS / f"{suite}.json").read_text(encoding="utf-8"))
    return result["rows"], f"Measured on {result['machine']}; one core, contestants interleaved, medians."


def speed() -> str:
    """What stands between the README's marks."""
    rows, how = _told("delaunay")
    parts = ["How many times as long others take for the same points; below 1, in bold, they are ahead."]
    parts += ["(TetGen *itself*: its own time alone, without that of handing arrays over in Python.)", how]
    text = " ".join(parts) + " More on the [page of benchmarks](book/benchmarks.ipynb)."
    tables = [f"In {d} dimensions:\n\n{report.table(rows, d)}" for d in (2, 3)]
    planar, how = _told("planar")
    parts = ["Meshes of planar regions, the making and checking of the `Domain` counted in: triangles a"]
    parts += ["second, and this divided by the same of others (whose quality is on the"]
    parts += [f"[page of planar benchmarks](book/benchmarks-planar.ipynb)). {how}"]
    return "\n\n".join([text, *tables, " ".join(parts), planar_report.summary(planar)]) + "\n"


def main() -> None:
    """Put the table in its place."""
    text, found = BLOCK.subn(lambda marks: marks[1] + speed() + marks[2], README.read_text(encoding="utf-8"))
    if found != 1:
        raise SystemExit("the README has no place for the table: <!-- speed: … --> and <!-- /speed -->")
    README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
