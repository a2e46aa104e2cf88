"""The form of a chapter: each rule gives what is wrong with a notebook, as sentences.

`book/skeleton/0.0-skeleton.ipynb` is a chapter to copy that keeps all of them; CONTRIBUTING.md explains them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from book_files import CLAIM, code_cells, ledger, notebook, tags

COLUMNS = 84  # what the website shows at a width of 1280 pixels
SECTIONS = (
    "Predict first",
    "By hand",
    "When it breaks",
    "Real regions",
    "What to take away",
    "Exercises",
    "Sources",
)
LINES = 30  # of a cell whose code is shown
FOLDED_TAGS = {"hide-cell", "hide-input"}
STATEMENTS = "Theorem|Lemma|Corollary|Proposition|Definition"
ANCHOR = re.compile(r'<a id="([a-z]+)-(\w+(?:-\w+)*)-(\d+)"></a>')
LINK = re.compile(rf"\]\(([\w.-]*)#((?:{STATEMENTS.lower()}|equation)-[\w-]+)\)")
BOX = re.compile(r"^> \*\*Source\.\*\*.*\n?(?:^>.*\n?)*", flags=re.M)
NEEDS_BOX = {"needs-assumption", "false", "misprint", "vague"}
# Words of the field's own are in CONTRIBUTING.md; these are the others that were found in drafts.
NOT_OURS = r"least angles?|in earnest|[Ss]o the chapter|just if"


def chapter(path: Path) -> str:
    """The number of a chapter in its anchors: "3-1" for 3.1-x.ipynb, "2-6c" for 2.6c-x.ipynb."""
    return path.stem.split("-")[0].replace(".", "-")


def folded(cell: Any) -> bool:
    return bool(FOLDED_TAGS & set(tags(cell)))


def texts(path: Path) -> list[Any]:
    return [cell for cell in notebook(path).cells if cell.cell_type == "markdown"]


def section(path: Path, title: str) -> list[Any]:
    """The cells from the heading of the second level that contains ``title`` to the next such heading."""
    found, inside = [], False
    for cell in notebook(path).cells:
        heading = re.search(r"^## (.*)$", cell.source, flags=re.M) if cell.cell_type == "markdown" else None
        if heading:
            inside = title in heading[1].lower()
        if inside:
            found.append(cell)
    return found


def pictures(cell: Any) -> bool:
    """Whether a cell stores a picture, that of a widget counting too."""
    return any("image/png" in o.get("data", {}) or "image/svg+xml" in o.get("data", {}) for o in cell.outputs)


def sets_up(source: str) -> bool:
    """Whether a cell only imports, and sets the style."""
    kinds = {type(node) for node in ast.parse(source).body if ast.unparse(node) != "view.setup()"}
    return kinds <= {ast.Import, ast.ImportFrom}


def code_is_narrow_and_short(path: Path) -> Iterator[str]:
    for cell in code_cells(path):
        lines = cell.source.splitlines()
        for line in lines:
            if len(line) > COLUMNS:
                yield f"{cell.id}: a line of {len(line)} columns, the site shows {COLUMNS}: {line[:40]}..."
        if not folded(cell) and len(lines) > LINES:
            yield f"{cell.id}: {len(lines)} lines of code on the page"


def code_that_does_not_teach_is_folded(path: Path) -> Iterator[str]:
    for cell in code_cells(path):
        lines = len(cell.source.splitlines())
        if not folded(cell) and sets_up(cell.source):
            yield f"{cell.id}: only imports; fold it with the tag hide-input"
        elif not folded(cell) and pictures(cell) and lines > 8:
            yield f"{cell.id}: draws with {lines} lines; fold it with the tag hide-input"
        if folded(cell) != bool(cell.metadata.get("jupyter", {}).get("source_hidden")):
            yield f"{cell.id}: folded on the site or in JupyterLab alone; run book/execute.py"


def height(cell: Any) -> tuple[float, float]:
    """About how many lines of a page are code of a cell, and how many are anything else."""
    if cell.cell_type == "markdown":
        return 0.0, sum(1 + len(line) / 90 for line in cell.source.splitlines())
    printed = "".join(o.get("text", "") for o in cell.outputs).count("\n")
    shown = 22 * pictures(cell) + min(printed, 30) + 1
    return (0.0 if folded(cell) else len(cell.source.splitlines()) + 1.0), shown


def a_third_is_code(path: Path) -> Iterator[str]:
    code, rest = map(sum, zip(*(height(cell) for cell in notebook(path).cells)))
    if code > (code + rest) / 3:
        yield f"{100 * code / (code + rest):.0f} % of the page are code; a third at most"


def statements_are_numbered(path: Path) -> Iterator[str]:
    """Statements share one count, equations have another; both start at 1, with anchors that agree."""
    own, dotted = chapter(path), path.stem.split("-")[0]
    counts = {"statement": 0, "equation": 0}
    for cell in texts(path):
        for found in ANCHOR.finditer(cell.source):
            kind, where, number = found[1], found[2], int(found[3])
            after = cell.source[found.end() :]
            if kind == "equation":
                good = re.match(
                    rf"\n(> ?)*\$\$[^$]*?\\tag\{{{re.escape(dotted)}\.{number}\}}[^$]*\$\$", after
                )
                wanted = f"a line with $$ ... \\tag{{{dotted}.{number}}} $$"
            else:
                good = re.match(rf"\*\*{kind.capitalize()} {re.escape(dotted)}\.{number}[ .]", after)
                wanted = f"**{kind.capitalize()} {dotted}.{number} (name).**"
            key = "equation" if kind == "equation" else "statement"
            counts[key] += 1
            if where != own or number != counts[key]:
                yield f"{cell.id}: anchor {found[0]}, but this is {key} number {counts[key]} of {dotted}"
            if not good:
                yield f"{cell.id}: after {found[0]} there must be {wanted}"
        bare = re.sub(ANCHOR.pattern, "\0", cell.source)
        for name in re.findall(rf"^(?:> ?)*\*\*((?:{STATEMENTS})\b[^*]*)\*\*", bare, flags=re.M):
            yield f"{cell.id}: {name} has no anchor"
        if len(re.findall(r"\\tag\{", cell.source)) != len(re.findall(r'<a id="equation-', cell.source)):
            yield f"{cell.id}: not every numbered equation has an anchor"
    if not counts["statement"]:
        yield "no numbered theorem"


def statements_are_proved(path: Path) -> Iterator[str]:
    """A proof in words, which ends with ∎, between each theorem and the next."""
    whole = "\n".join(cell.source for cell in texts(path))
    starts = [m for m in ANCHOR.finditer(whole) if m[1] not in ("equation", "definition")]
    ends = [m.start() for m in starts[1:]] + [len(whole)]
    for found, end in zip(starts, ends):
        if not re.search(r"\*Proof\b[^*]*\*.*∎", whole[found.end() : end], flags=re.S):
            yield f"{found[0]}: no *Proof.* that ends with ∎ before the next theorem"


def links_of(path: Path) -> Iterator[tuple[str, Path, str]]:
    """Each link to a numbered statement: the cell, the notebook it leads to, the anchor there."""
    for cell in texts(path):
        for name, anchor in LINK.findall(cell.source):
            yield cell.id, path.with_name(name) if name else path, anchor


def dead_links(path: Path) -> Iterator[str]:
    for cell, target, anchor in links_of(path):
        if not target.is_file() or not any(f'<a id="{anchor}"></a>' in c.source for c in texts(target)):
            yield f"{cell}: a link to {anchor} in {target.name}, which has no such anchor"


def the_source_has_boxes(path: Path) -> Iterator[str]:
    """What the source says differently stands in boxes of at most four lines, one for each such claim."""
    verdicts = {row["id"]: row["verdict"] for row in ledger()}
    sources = {cell.id for cell in section(path, "sources")}
    named: set[str] = set()
    for cell in texts(path):
        for box in BOX.findall(cell.source):
            named |= {m[0] for m in CLAIM.finditer(box)}
            if not CLAIM.search(box):
                yield f"{cell.id}: a Source box names no claim of the ledger"
            if len(box.strip().splitlines()) > 4 or len(box) > 500:
                yield f"{cell.id}: a Source box has more than four lines"
        rest = BOX.sub("", cell.source)
        said = re.search(
            r"\bthe source\b|\bsource chapter\b|\b[Tt]he chapter (says|claims|states)|Liseikin", rest
        )
        if said and cell.id not in sources:
            yield f"{cell.id}: {said[0]!r} outside of a Source box"
    for name in sorted(named - set(verdicts)):
        yield f"a Source box names {name}, which the ledger does not have"
    tagged = {tag for cell in code_cells(path) for tag in tags(cell) if verdicts.get(tag) in NEEDS_BOX}
    for name in sorted(tagged - named):
        yield f"{name} is {verdicts[name]}, but no Source box names it"


def exercises_are_complete(path: Path) -> Iterator[str]:
    """Four to eight, with hints and folded solutions; one is a proof in words, one a bug, and one is open."""
    tasks: list[tuple[str, list[Any]]] = []
    for cell in section(path, "exercises"):
        title = re.search(r"^### (.*)$", cell.source, flags=re.M) if cell.cell_type == "markdown" else None
        if title:
            tasks.append((title[1], []))
        if tasks:
            tasks[-1][1].append(cell)
    if not 4 <= len(tasks) <= 8:
        yield f"{len(tasks)} exercises; four to eight"
    for number, (title, cells) in enumerate(tasks, start=1):
        if not title.startswith(f"Exercise {number}: "):
            yield f"'### {title}' should be '### Exercise {number}: ...'"
        said = "\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
        if "*Hint" not in said:
            yield f"exercise {number} has no *Hint: ...*"
        if "prove" in title.lower():
            solution = re.search(
                r"^<details><summary>Solution</summary>\n\n(.*?)\n\n</details>", said, re.M | re.S
            )
            if not solution or "$" not in solution[1] or len(solution[1].split()) < 30:
                yield f"exercise {number}: write the proof in Markdown, with formulas, in <details>"
        elif not any(c.cell_type == "code" and "hide-cell" in tags(c) and c.execution_count for c in cells):
            yield f"exercise {number} has no executed solution with the tag hide-cell"
    for kind in ("prove", "find the bug"):
        if not any(kind in title.lower() for title, _ in tasks):
            yield f"no exercise has '{kind}' in its title"
    questions = [cells for title, cells in tasks if "open" in title.lower()]
    if not any(re.search(r"rubric|good answer", cell.source, re.I) for cells in questions for cell in cells):
        yield "no exercise has 'open' in its title and says by its rubric what a good answer has"


def read_by(*nodes: ast.AST) -> set[str]:
    return {part.id for node in nodes for part in ast.walk(node) if isinstance(part, ast.Name)}


def answers_judged(tree: ast.Module) -> set[str]:
    """The names in a cell that a reader's answer changes: what is judged, and what is made of that."""
    made: dict[str, set[str]] = {node.name: set() for node in tree.body if isinstance(node, ast.FunctionDef)}
    for node in tree.body:
        if isinstance(node, ast.Assign):
            made |= dict.fromkeys(read_by(*node.targets), read_by(node.value))
    given: list[ast.AST] = []
    waiting = [
        node.test for node in ast.walk(tree) if isinstance(node, ast.IfExp) and "not yet" in ast.unparse(node)
    ]
    while waiting:  # of "accepts(answer) == 2" the answer, not the judge
        node = waiting.pop()
        if isinstance(node, ast.Call):
            given += [*node.args, *(keyword.value for keyword in node.keywords)]
        elif isinstance(node, ast.Name):
            given.append(node)
        else:
            waiting += [part for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)]
    judged = read_by(*given) & set(made)
    return judged | {name for name, read in made.items() if read & judged}


def right_answers_pass(path: Path) -> Iterator[str]:
    """What stands beside "not yet" is asserted of the stub: of the reader's names it fails when solved."""
    for cell in code_cells(path):
        if "not yet" not in cell.source or "hide-cell" in tags(cell):
            continue
        tree = ast.parse(cell.source)
        asserted = read_by(*(node for node in tree.body if isinstance(node, ast.Assert)))
        for name in sorted(asserted & answers_judged(tree)):
            yield f"{cell.id}: asserts of {name!r}, which a reader changes; write what the stub has again"


def pictures_speak(path: Path) -> Iterator[str]:
    """Alt text, a caption in italics below, and a number or an assertion beside each."""
    exercises = {cell.id for cell in section(path, "exercises")}
    for cell, after in pairwise([*notebook(path).cells, None]):
        if cell.cell_type != "code" or not pictures(cell):
            continue
        if len(cell.metadata.get("mystnb", {}).get("image", {}).get("alt", "")) < 20:
            yield f"{cell.id}: a picture without alt text"
        if not re.search(r"^\s*assert\b|\bprint\(", cell.source, flags=re.M):
            yield f"{cell.id}: a picture without a number or an assertion beside it"
        captioned = after is not None and after.cell_type == "markdown" and re.match(r"\*[^*]", after.source)
        own = any("widget" in output.get("metadata", {}) for output in cell.outputs)  # captions of its frames
        if not captioned and not own and cell.id not in exercises:
            yield f"{cell.id}: the next cell does not begin with a caption in italics"


def controls(widget: dict[str, Any]) -> Iterator[str]:
    if widget["kind"] == "control":
        yield widget.get("description", "")
    for child in widget.get("children", []):
        yield from controls(child)


def widgets_move_without_a_kernel(path: Path) -> Iterator[str]:
    for cell in code_cells(path):
        for output in cell.outputs:
            for name in controls(output.get("metadata", {}).get("widget", {"kind": "none"})):
                yield f"{cell.id}: the control {name!r} is dead on the site; use view.panel"


def it_begins_and_ends_well(path: Path) -> Iterator[str]:
    first = notebook(path).cells[0].source
    if not re.search(r"\b\d+ minutes\b", first) or not re.search(r"\]\([\w.-]+\.ipynb", first):
        yield "the first cell must say how many minutes the chapter takes, and link to what it needs"
    headings = re.findall(r"^## (.*)$", "\n\n".join(cell.source for cell in texts(path)), flags=re.M)
    places = [[k for k, title in enumerate(headings) if name in title] for name in SECTIONS]
    for name, found in zip(SECTIONS, places):
        if not found:
            yield f"no section {name!r}"
    if all(places) and [found[0] for found in places] != sorted(found[0] for found in places):
        yield f"the sections are in another order than {', '.join(SECTIONS)}"
    away = "\n".join(cell.source for cell in section(path, "what to take away"))
    if len(re.findall(r"^(?:-|\d\.) ", away, flags=re.M)) != 5:
        yield "what to take away must have five items"
    works = "\n".join(cell.source for cell in section(path, "sources"))
    if len(re.findall(r"^- ", works, flags=re.M)) < 2 or not re.search(r"\b(1[89]|20)\d\d\b", works):
        yield "the section on sources lists less than two works with their years"


def the_words_are_the_field_s(path: Path) -> Iterator[str]:
    for cell in texts(path):
        for word in re.findall(rf"\b(?:{NOT_OURS})\b", cell.source):
            yield f"{cell.id}: {word!r}"


RULES = [
    code_is_narrow_and_short,
    code_that_does_not_teach_is_folded,
    a_third_is_code,
    statements_are_numbered,
    statements_are_proved,
    dead_links,
    the_source_has_boxes,
    exercises_are_complete,
    right_answers_pass,
    pictures_speak,
    widgets_move_without_a_kernel,
    it_begins_and_ends_well,
    the_words_are_the_field_s,
]
