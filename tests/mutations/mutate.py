"""Put what is wrong into the cells that check claims, and require that they notice.

    python tests/mutations/mutate.py            # every mutation
    python tests/mutations/mutate.py --jobs 2   # the same, two chapters at a time
    python tests/mutations/mutate.py --tenth    # a tenth of each chapter's, always the same
    python tests/mutations/mutate.py 3.1 2.3    # those of two chapters
    python tests/mutations/mutate.py 3.1 C12.3-02

Each file `<chapter>.toml` beside this one lists mutations: the claim whose tag the cell carries, the text to
find (once) in that cell, and what to put in its place: the source's formula, a dropped hypothesis, or a
changed constant. All code cells up to the tagged one are run, in one process without a kernel; the changed
cell runs in a child of that process, so that its changes are lost. It must raise an `AssertionError` (or what
`raises` names): a mutation that passes shows a cell that cannot fail, and a `NameError` shows nothing.

The tenth is quicker also because of the cells before the tagged one it runs only those that bind
needed names (`slices.py`), and all of them where that is not enough.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import linecache
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slices import needed

HERE = Path(__file__).resolve().parent
BOOK = HERE.parents[1] / "book"
SEED = 16  # of the tenth that the tests run
SHARE = 10


@dataclass(frozen=True)
class Mutation:
    """One change of one cell: see the module. ``why`` says what is put in."""

    claim: str
    find: str
    replace: str
    why: str
    raises: str = "AssertionError"


@dataclass(frozen=True)
class Result:
    """What became of a mutation: ``red`` if the cell raised what it should; ``told`` says what happened."""

    mutation: Mutation
    red: bool
    told: str


class Wrong(Exception):
    """A list of mutations does not fit its notebook, or the unchanged notebook does not run."""


def read(path: Path) -> list[Mutation]:
    """The mutations of a file; a key that is unknown or missing is an error."""
    rows = tomllib.loads(path.read_text(encoding="utf-8")).get("mutation", [])
    try:
        return [Mutation(**row) for row in rows]
    except TypeError as error:
        raise Wrong(f"{path.name}: {error}") from None


def files(book: Path = BOOK, folder: Path = HERE) -> Iterator[tuple[Path, Path]]:
    """Each file of mutations with its notebook: `3.1.toml` belongs to `3.1-<name>.ipynb`."""
    for path in sorted(folder.glob("*.toml")):
        found = list(book.glob(f"{path.stem}-*.ipynb"))
        if len(found) != 1:
            raise Wrong(f"{path.name}: {len(found)} notebooks are named {path.stem}-…")
        yield path, found[0]


def tenth(mutations: Sequence[Mutation]) -> list[Mutation]:
    """One in ten of a chapter's mutations (one, where there are less than fifteen), chosen by their texts.

    So it does not hang on their order, on the day, or on the mutations of other chapters.
    """

    def key(mutation: Mutation) -> bytes:
        return hashlib.sha256(
            f"{SEED}\0{mutation.claim}\0{mutation.find}\0{mutation.replace}".encode()
        ).digest()

    count = max(1, round(len(mutations) / SHARE))
    chosen = set(sorted(mutations, key=key)[:count])
    return [mutation for mutation in mutations if mutation in chosen]


def code_of(notebook: Path) -> list[dict[str, Any]]:
    """The code cells, each with its source as one text."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return [{**cell, "source": "".join(cell["source"])} for cell in cells if cell["cell_type"] == "code"]


def place(mutation: Mutation, cells: Sequence[dict[str, Any]]) -> int:
    """The number of the code cell that carries the claim and contains the text, once; else `Wrong`."""
    tagged = [k for k, cell in enumerate(cells) if mutation.claim in cell["metadata"].get("tags", [])]
    if not tagged:
        raise Wrong(f"{mutation.claim}: no cell has this tag")
    if mutation.find == mutation.replace:
        raise Wrong(f"{mutation.claim}: {mutation.find!r} is replaced by itself")
    counts = {k: cells[k]["source"].count(mutation.find) for k in tagged}
    if sum(counts.values()) != 1:
        raise Wrong(f"{mutation.claim}: {mutation.find!r} stands {sum(counts.values())} times in its cell")
    return next(k for k in tagged if counts[k])


def changed(mutation: Mutation, cells: Sequence[dict[str, Any]]) -> tuple[int, str]:
    """The number of the cell, and its changed source, which must still be Python."""
    number = place(mutation, cells)
    source = without_magics(cells[number]["source"].replace(mutation.find, mutation.replace))
    try:
        compile(source, "mutation", "exec")
    except SyntaxError as error:
        raise Wrong(f"{mutation.claim}: {mutation.replace!r} makes no Python: {error}") from None
    return number, source


def without_magics(source: str) -> str:
    return re.sub(r"^[%!].*$", "", source, flags=re.M)


def run(notebook: Path, mutations: Sequence[Mutation], sliced: bool = False) -> Iterator[Result]:
    """Run the notebook's cells in order and, at each tagged one, its mutations first, each in a child.

    If ``sliced``, only the cells that the mutated ones need; a mutation that is not red then runs again after
    all cells. The unchanged cells must pass, else it is `Wrong`.
    """
    cells = code_of(notebook)
    at: dict[int, list[tuple[Mutation, str]]] = {}
    for mutation in mutations:
        number, source = changed(mutation, cells)
        at.setdefault(number, []).append((mutation, source))
    last = max(at, default=-1)
    sources = [without_magics(cell["source"]) for cell in cells]
    wanted = needed(sources, at) if sliced else set(range(last + 1))
    names: dict[str, Any] = {"__name__": "__main__"}
    for number in sorted(wanted):
        for mutation, source in at.get(number, []):
            result = in_a_child(mutation, source, f"<mutation of {mutation.claim}>", names)
            yield result if result.red or not sliced else next(run(notebook, [mutation]))
        cell = cells[number]
        try:
            execute(sources[number], f"<{notebook.stem} {cell.get('id', number)}>", names)
        except Exception as error:
            told = f"{type(error).__name__}: {error}"
            raise Wrong(f"{notebook.name}, cell {cell.get('id')}, unchanged: {told}") from error


def execute(source: str, name: str, names: dict[str, Any]) -> None:
    """Run a cell, so that `inspect` finds the source of its functions, and close its pictures."""
    lines = source.splitlines(keepends=True)
    linecache.cache[name] = (len(source), None, lines, name)
    exec(compile(source, name, "exec"), names)
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


def in_a_child(mutation: Mutation, source: str, name: str, names: dict[str, Any]) -> Result:
    """Run a changed cell in a copy of this process; the names of its exception's classes come back."""
    reading, writing = os.pipe()
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        told = ["", "it passes"]
        try:
            execute(source, name, names)
        except BaseException as error:
            kinds = [kind.__name__ for kind in type(error).__mro__]
            told = [*kinds, f"{kinds[0]}: {str(error).splitlines()[0] if str(error) else ''}"[:100]]
        os.write(writing, json.dumps(told).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as answer:
        text = answer.read()
    os.waitpid(child, 0)
    *kinds, told = json.loads(text) if text else ["", "the process ended"]
    red = mutation.raises in kinds
    return Result(mutation, red, told if red or not kinds[0] else f"{told} (not {mutation.raises})")


def selected(wanted: Sequence[str], a_tenth: bool) -> Iterator[tuple[Path, Path, list[Mutation]]]:
    """The files that are named, or whose claims are, with their notebooks and mutations; all, if none is."""
    claims = {name for name in wanted if name[0] == "C"}
    chapters = set(wanted) - claims
    for path, notebook in files():
        mutations = [m for m in read(path) if not claims or m.claim in claims]
        if mutations and (not chapters or path.stem in chapters):
            yield path, notebook, tenth(mutations) if a_tenth else mutations


def run_here(notebook: Path, mutations: Sequence[Mutation], sliced: bool) -> list[Result]:
    """Run a chapter's mutations in silence, after all cells if a slice does not pass."""
    with open(os.devnull, "w") as quiet, redirect_stdout(quiet):
        try:
            return list(run(notebook, mutations, sliced))
        except Wrong:
            if not sliced:
                raise
            return list(run(notebook, mutations))


def apart(chapter: str, options: argparse.Namespace) -> tuple[str, int, int]:
    """Run a chapter's in a process of its own: what it said, how many there were, how many are not red."""
    claims = [name for name in options.names if name[0] == "C"]
    command = [sys.executable, __file__, chapter, *claims, *(["--tenth"] if options.tenth else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    *said, total = done.stdout.splitlines() or [""]
    counts = re.fullmatch(r"(\d+) mutations, (\d+) not red", total)
    if not counts:
        raise Wrong(f"{chapter}: {done.stderr.strip() or total}")
    return "\n".join(said), int(counts[1]), int(counts[2])


def seconds() -> float:
    """The time that processors have worked for this process and its children."""
    return sum(os.times()[:4])


def main() -> int:
    """Run what is named (chapters and claims; all, where nothing is); 1 if a mutation is not red."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", help="chapters, as 3.1, and claims, as C12.3-02")
    parser.add_argument("--tenth", action="store_true", help="a tenth of each chapter's, always the same")
    parser.add_argument("--jobs", type=int, default=1, help="how many chapters at a time")
    options = parser.parse_args()
    os.environ["MPLBACKEND"] = "agg"
    os.chdir(BOOK)
    sys.path.insert(0, str(BOOK))
    count = green = 0
    work = list(selected(options.names, options.tenth))
    if options.jobs > 1:
        with ThreadPoolExecutor(options.jobs) as pool:
            for said, some, bad in pool.map(lambda item: apart(item[0].stem, options), work):
                count, green = count + some, green + bad
                print(said, flush=True)
    else:
        for path, notebook, mutations in work:
            start = seconds()
            for result in run_here(notebook, mutations, options.tenth):
                count, green = count + 1, green + (not result.red)
                word = "red" if result.red else "NOT RED"
                print(f"{path.stem} {result.mutation.claim} {word}: {result.mutation.why}: {result.told}")
            print(f"{path.stem}: {seconds() - start:.1f} CPU s", flush=True)
    print(f"{count} mutations, {green} not red")
    return int(green > 0 or count == 0)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Wrong as error:
        sys.exit(f"error: {error}")
