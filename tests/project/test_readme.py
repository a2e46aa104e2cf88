"""The README says what is so: its code runs, its chapters exist, its numbers are the measured ones."""

from __future__ import annotations

import re
import struct
import subprocess
import sys
from pathlib import Path

from book_files import BOOK, ROOT, chapters, notebooks

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_taste_runs(tmp_path: Path) -> None:
    code, _ = re.findall(r"^```python\n(.*?)^```", README, flags=re.M | re.S)
    assert 8 <= len([line for line in code.splitlines() if line.strip()]) <= 13
    result = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    degrees, cubes = result.stdout.splitlines()
    assert 0 < float(degrees) < 60
    assert re.fullmatch(r"\d+ tetrahedra, total volume 512\.0", cubes)
    assert (tmp_path / "points.vtu").stat().st_size > 100_000


def test_the_region_is_meshed() -> None:
    _, code = re.findall(r"^```python\n(.*?)^```", README, flags=re.M | re.S)
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    *figures, last = result.stdout.splitlines()
    assert any(line.startswith("mean 2r/R") and float(line.split()[-1]) > 0.95 for line in figures)
    complete, degrees = last.split()
    assert complete == "True" and float(degrees) >= 30.0


def test_links_lead_somewhere() -> None:
    for file in ("README.md", "CONTRIBUTING.md"):
        text = (ROOT / file).read_text(encoding="utf-8")
        for alt, target in re.findall(r"(!?\[[^\]]*\])\(([^)#:]+)\)", text):
            assert (ROOT / target).exists(), f"{file} links to {target}"
            assert not alt.startswith("![") or len(alt) > 60, f"{file}: {target} needs a text in its place"


def test_every_chapter_is_listed() -> None:
    linked = re.findall(r"^\| \[.*?\]\(book/(.*?\.ipynb)\)", README, flags=re.M)
    assert [name for name in linked if name[0].isdigit()] == [path.name for path in chapters()]
    assert {"index.ipynb", "ledger.ipynb", "errata.ipynb", "benchmarks.ipynb"} <= set(linked)


def test_the_front_page_leads_to_every_notebook() -> None:
    page = (BOOK / "index.ipynb").read_text(encoding="utf-8")
    linked = set(re.findall(r"\]\(([^()\s]+\.ipynb)\)", page))
    assert linked == {path.name for path in notebooks()} - {"index.ipynb"}


def test_the_cover_is_a_picture() -> None:
    data = (BOOK / "cover.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", data[16:24])
    assert 600 <= width <= 1600 and 200 <= height <= 900 and len(data) < 400_000


def test_the_table_of_speed_is_the_measured_one() -> None:
    from benchmarks.readme import BLOCK, speed

    blocks = BLOCK.findall(README)
    assert len(blocks) == 1
    assert BLOCK.search(README)[0] == blocks[0][0] + speed() + blocks[0][1], "run python -m benchmarks.readme"
