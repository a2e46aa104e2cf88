"""Open the book in JupyterLab, in a working copy that is the reader's own.

    python book/read.py                   # copy what is new, and open the front page
    python book/read.py --pristine        # first put back all pages as the book has them
    python book/read.py --pristine 2.1    # only those whose names start so
    python book/read.py --copy            # copy only, open nothing

JupyterLab saves a notebook that was run, and a saved notebook differs from the book's: other outputs, other
metadata. So readers get the folder `reading/` beside `book/`, which git ignores. A page that they changed is
never overwritten: if the book has a newer one, the program says so, and `--pristine` moves theirs to
`reading/yours/` before it copies. Other arguments go to JupyterLab (`--no-browser`, `--port=8900`, …).
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BOOK = ROOT / "book"
READING = ROOT / "reading"
COPIED = ".copied.json"  # which state of each file the reader was given
MODULES = ("chapters.py", "claims.py", "maps.py", "terms.py", "works.py")  # which cells import
PAGES = ("*.ipynb", *MODULES, "*.toml", "*.txt", "*.png")


def fingerprint(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def update(book: Path, reading: Path, pristine: tuple[str, ...] | None = None) -> list[str]:
    """Copy the pages of ``book`` into ``reading``; return a sentence for each page that needs one.

    ``pristine`` are beginnings of names: these pages are put back as the book has them, ``()`` means all.
    """
    reading.mkdir(exist_ok=True)
    record = reading / COPIED
    given = json.loads(record.read_text(encoding="utf-8")) if record.exists() else {}
    told = []
    for page in sorted({path for pattern in PAGES for path in book.glob(pattern)}):
        copy, newest = reading / page.name, fingerprint(page)
        now = fingerprint(copy) if copy.exists() else None
        changed = now is not None and now not in (given.get(page.name), newest)
        wanted = pristine is not None and page.name.startswith(pristine or ("",))
        if changed and wanted:
            told.append(f"{page.name}: yours is now {_aside(copy).relative_to(reading.parent)}")
        elif changed:
            if given.get(page.name) != newest:
                told.append(f"{page.name}: the book has a newer one; yours was kept (see --pristine)")
            continue
        if now != newest:
            shutil.copyfile(page, copy)
        given[page.name] = newest
    record.write_text(json.dumps(given, indent=1) + "\n", encoding="utf-8")
    return told


def _aside(copy: Path) -> Path:
    """Move a reader's page to the folder `yours`, under a number if there is one of this name already."""
    folder = copy.parent / "yours"
    folder.mkdir(exist_ok=True)
    place, number = folder / copy.name, 1
    while place.exists():
        number += 1
        place = folder / f"{copy.stem}-{number}{copy.suffix}"
    return copy.rename(place)


def lab(arguments: list[str]) -> list[str]:
    """The command that opens JupyterLab on the front page of the working copy."""
    command = [
        sys.executable,
        "-m",
        "jupyterlab",
        f"--LabApp.default_url=/lab/tree/{READING.name}/index.ipynb",
    ]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        command.append("--allow-root")  # in a container there is often no other user
    return [*command, *arguments]


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--pristine", nargs="*", metavar="NAME", help="put pages back as the book has them")
    parser.add_argument("--copy", action="store_true", help="copy the pages and open nothing")
    options, others = parser.parse_known_args()
    pristine = None if options.pristine is None else tuple(options.pristine)
    for sentence in update(BOOK, READING, pristine):
        print(sentence)
    if options.copy:
        return 0
    try:
        return subprocess.run(lab(others), cwd=ROOT, check=False).returncode
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
