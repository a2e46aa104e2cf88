"""The README's table of speed, made from the committed rows: ``python -m benchmarks.readme`` writes it."""

from __future__ import annotations

import json
import re
from pathlib import Path

from . import report

README = Path(__file__).parent.parent / "README.md"
ROWS = Path(__file__).parent / "results" / "delaunay.json"
BLOCK = re.compile(r"(<!-- speed: .*? -->\n).*?(<!-- /speed -->)", flags=re.S)


def speed() -> str:
    """What stands between the README's marks."""
    result = json.loads(ROWS.read_text(encoding="utf-8"))
    parts = ["How many times as long others take for the same points; below 1, in bold, they are ahead."]
    parts += ["(TetGen *itself*: its own time alone, without that of handing arrays over in Python.)"]
    parts += [f"Measured on {result['machine']}; one core, contestants interleaved, medians."]
    text = " ".join(parts) + " More on the [page of benchmarks](book/benchmarks.ipynb)."
    tables = [f"In {d} dimensions:\n\n{report.table(result['rows'], d)}" for d in (2, 3)]
    return "\n\n".join([text, *tables]) + "\n"


def main() -> None:
    """Put the table in its place."""
    text, found = BLOCK.subn(lambda marks: marks[1] + speed() + marks[2], README.read_text(encoding="utf-8"))
    if found != 1:
        raise SystemExit("the README has no place for the table: <!-- speed: … --> and <!-- /speed -->")
    README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
