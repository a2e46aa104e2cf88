"""Chapters in the form of the whole book keep every rule of it, and each rule sees what it should."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import nbformat
import pytest
from book_files import ROOT, chapters, notebook, notebooks
from chapter_rules import RULES, dead_links, links_of, right_answers_pass

SKELETON = ROOT / "book" / "skeleton" / "0.0-skeleton.ipynb"


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
@pytest.mark.parametrize("path", [SKELETON, *chapters()], ids=lambda path: path.stem)
def test_chapters_keep_the_rules(path: Path, rule: Callable[[Path], Iterator[str]]) -> None:
    wrong = list(rule(path))
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_every_link_to_a_statement_has_its_anchor(path: Path) -> None:
    wrong = list(dead_links(path))
    assert not wrong, "\n".join(wrong)


def test_the_skeleton_has_what_it_shows() -> None:
    assert len(list(links_of(SKELETON))) == 2


# What is changed in the sources of the skeleton, and what a rule then says.
BROKEN = [
    (r"^names = ", "names = " + 80 * " ", "a line of 9"),
    (r"^def apex_naive.*\n", lambda m: m[0] + 30 * "    1\n", r"\d\d lines of code on the page"),
    (r"theorem-0-0-1\"></a>", 'theorem-0-0-2"></a>', "this is statement number 1 of 0.0"),
    (r"\*\*Theorem 0.0.1", "**Theorem 0.0.2", r"must be \*\*Theorem 0.0.1 \(name\)"),
    (r'<a id="theorem-0-0-1"></a>', "", "Theorem 0.0.1 .* has no anchor|no numbered theorem"),
    (r'<a id="equation-0-0-1"></a>\n', "", "not every numbered equation has an anchor"),
    (r"\*Proof\.\*", "Clear.", "theorem-0-0-1.*: no .Proof"),
    (r"\(#equation-0-0-1\)", "(#equation-0-0-7)", "a link to equation-0-0-7 in 0.0-skeleton"),
    (r"\(#equation-0-0-1\)", "(2.1-x.ipynb#equation-2-1-1)", "a link to equation-2-1-1 in 2.1-x.ipynb"),
    (r"\(C12\.2\.4-02\)", "", "names no claim"),
    (r"\(C12\.2\.4-02\)", "(C12.2.4-02, C12.2.4-99)", "C12.2.4-99, which the ledger does not have"),
    (r"^> \*\*Source\.\*\* ", "", "'source chapter' outside"),
    (r"\(C12\.2\.4-02\)", "(C12.2.4-02)" + 5 * "\n> Again and again.", "more than four lines"),
    (r"^### Exercise 4.*", "", "3 exercises; four to eight"),
    (r"^### Exercise 3: find the bug", "### Exercise 3: a fault", "no exercise has 'find the bug'"),
    (r"^### Exercise 2: prove", "### Exercise 2: show", "no exercise has 'prove'"),
    (r"^### Exercise 4: an open question", "### Exercise 4: a new idea", "no exercise has 'open'"),
    (r"\*Rubric:\*", "By the way", "no exercise has 'open'"),
    (r"^<details><summary>Solution</summary>", "<details>", "write the proof in Markdown"),
    (r"\*Hint: Thales\.\*", "", "exercise 1 has no .Hint"),
    (r"^\*The height MX", "The height MX", "does not begin with a caption"),
    (r"^- A slope fails.*\n", "", "must have five items"),
    (r"^## When it breaks", "## Trouble", "no section 'When it breaks'"),
    (r"^## Predict first", "## Sources and Predict first", "in another order"),
    (r"10 minutes", "a while", "how many minutes"),
    (r"^- G. Voronoi.*", "", "less than two works"),
    (r"^The edges of the running", "The least angle and edges of the running", "'least angle'"),
]  # fmt: skip


@pytest.mark.parametrize(("find", "replace", "said"), BROKEN)
def test_a_rule_sees_what_is_wrong(tmp_path: Path, find: str, replace: str, said: str) -> None:
    broken = nbformat.from_dict(notebook(SKELETON))
    count = 0
    for cell in broken.cells:
        cell.source, found = re.subn(find, replace, cell.source, flags=re.M)
        count += found
    assert count, "the skeleton does not have this"
    nbformat.write(broken, tmp_path / SKELETON.name)
    wrong = [text for rule in RULES for text in rule(tmp_path / SKELETON.name)]
    assert any(re.search(said, text) for text in wrong), wrong


JUDGE = "def accepts(x):\n    return x() > 1\n\ndef answer():\n    return 1\n\n"
JUDGED = [
    ('print("solved" if accepts(answer) else "not yet")\nassert not accepts(lambda: 1)', []),
    ('print("solved" if accepts(answer) else "not yet")\nassert not accepts(answer)', ["answer"]),
    ('print("solved" if answer() == 2 else "not yet")\nassert answer() == 1', []),
    ('good = answer() == 2\nprint("solved" if good else "not yet")\nassert not good', ["good"]),
    ('print("solved" if accepts(answer) else "not yet")\nboth = [answer]\nassert both', ["both"]),
]


@pytest.mark.parametrize(("judged", "names"), JUDGED)
def test_asserts_that_fail_for_a_right_answer_are_seen(tmp_path: Path, judged: str, names: list[str]) -> None:
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(JUDGE + judged)])
    nbformat.write(book, tmp_path / "0.1-judged.ipynb")
    found = [
        re.search(r"asserts of '(\w+)'", text)[1]
        for text in right_answers_pass(tmp_path / "0.1-judged.ipynb")
    ]
    assert found == names


def without_tags(cell: nbformat.NotebookNode) -> None:
    cell.metadata.pop("tags", None)
    cell.metadata.pop("jupyter", None)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without_tags, "only imports; fold it"),
        (without_tags, "draws with 1. lines"),
        (without_tags, "% of the page are code"),
        (without_tags, "exercise 1 has no executed solution"),
        (lambda cell: cell.metadata.pop("jupyter", None), "folded on the site or in JupyterLab alone"),
        (lambda cell: cell.metadata.pop("mystnb", None), "a picture without alt text"),
        (
            lambda cell: [
                o.update(metadata={"widget": {"kind": "control"}}) for o in cell.get("outputs", [])
            ],
            "is dead on the site",
        ),
    ],
)
def test_a_rule_sees_what_is_wrong_in_metadata(tmp_path: Path, change: Callable, said: str) -> None:
    broken = nbformat.read(SKELETON, as_version=4)
    for cell in broken.cells:
        change(cell)
    nbformat.write(broken, tmp_path / SKELETON.name)
    wrong = [text for rule in RULES for text in rule(tmp_path / SKELETON.name)]
    assert any(re.search(said, text) for text in wrong), wrong
