"""The website for everybody: by keys, by a screen reader, in light and dark, without motion.

No browser is needed here. What only a browser knows, such as where the Tab key leads, is in
`test_browser.py`.
"""

from __future__ import annotations

import re
from html import unescape
from itertools import pairwise
from pathlib import Path

import pytest
from book_files import BOOK, ROOT, chapters
from contrast import GRAPHIC, TEXT, contrast, variables

SHEETS = ("theme.css", "pydata-sphinx-theme.css", "sphinx-book-theme.css")  # in the order of a page
VIEW = ROOT / "unstruct" / "view"


@pytest.fixture(scope="module")
def texts(site: Path) -> dict[str, str]:
    """Each page of the book, by its name."""
    return {path.stem: path.read_text(encoding="utf-8") for path in sorted(site.glob("*.html"))}


def article(text: str) -> str:
    return text[text.index("<article") : text.index("</article>")] if "<article" in text else ""


# ---- the page ----------------------------------------------------------------------------------


def test_pages_say_their_language_and_can_be_skipped_to(texts: dict[str, str]) -> None:
    for name, text in texts.items():
        assert '<html lang="en"' in text, name
        if name == "genindex" or not article(text):
            continue
        body = text[text.index("<body") :]
        assert re.search(r"<a\b[^>]*>", body)[0] == '<a href="#main-content">', (
            f"{name}: the first link skips"
        )
        assert 'id="main-content"' in text, name


def test_headings_are_in_order(texts: dict[str, str]) -> None:
    for name, text in texts.items():
        levels = [int(level) for level in re.findall(r"<h([1-6])[ >]", article(text))]
        if name in ("search", "genindex"):
            continue
        assert levels[0] == 1 and levels.count(1) == 1, name
        assert all(b <= a + 1 for a, b in pairwise(levels)), f"{name}: a level is left out"


def test_no_page_knows_the_machine_it_was_made_on(site: Path, texts: dict[str, str]) -> None:
    scripts = [path.read_text(encoding="utf-8") for path in site.glob("*.js")]
    for text in [*texts.values(), *scripts]:
        assert str(ROOT) not in text and "file://" not in text and str(Path.home()) + "/" not in text


def test_what_is_folded_has_a_name(texts: dict[str, str]) -> None:
    """A summary is a button for keys and screen readers; solutions say that they are some."""
    for name, text in texts.items():
        for summary in re.findall(r"<summary[^>]*>(.*?)</summary>", text, flags=re.S):
            assert re.sub(r"<[^>]+>", "", summary).strip(), name
    text = texts["2.1-dirichlet-tessellation"]
    hidden = re.findall(
        r'<div class="cell tag_hide-cell[^>]*>\s*<details[^>]*>\s*<summary[^>]*>(.*?)</summary>', text, re.S
    )
    names = {re.sub(r"<[^>]+>", "", summary).split("\n")[1] for summary in hidden}
    assert names == {"Show the solution", "Show the check"}


def test_the_map_is_made_of_links(texts: dict[str, str]) -> None:
    (drawing,) = re.findall(r'<div class="drawing">(.*?)</div>', texts["index"], flags=re.S)
    links = re.findall(r'<a href="([^"]+)" aria-label="([^"]+)">', drawing)
    assert [address for address, _ in links] == [f"{path.stem}.html" for path in chapters()]
    for (_, label), path in zip(links, chapters()):
        assert unescape(label).startswith(path.stem.split("-")[0] + " ") and label.endswith(" reading")


# ---- players, views in space, filters ----------------------------------------------------------


def test_all_controls_of_players_have_names() -> None:
    """In the scripts that make them: a label around, or a name of its own."""
    scripts = {path.name: path.read_text(encoding="utf-8") for path in VIEW.rglob("*.js")}
    assert set(scripts) == {"player.js", "space.js"}
    for name, script in scripts.items():
        assert re.search(r'class="unstruct-player[^"]*" tabindex="0" role="group"', script), name
        assert re.search(r'class="unstruct-picture" role="img"', script), name
        assert 'setAttribute("aria-label"' in script and 'addEventListener("keydown"' in script
        for button in re.findall(r"<button\b[^>]*>[^<]*", script):
            assert "aria-label=" in button or button.split(">")[1].strip(), f"{name}: {button}"
        for control in re.finditer(r"<(?:input|select)\b[^>]*>", script):
            before = script[: control.start()]
            labeled = before.rfind("<label") > before.rfind("</label>") or "data-axis" in control[0]
            assert labeled or "aria-label=" in control[0], f"{name}: {control[0]}"
    assert "<label><span>" in scripts["player.js"], "the label around each control of a panel"


def test_filters_are_labeled_and_say_what_they_did() -> None:
    script = (ROOT / "site" / "_static" / "ledger.js").read_text(encoding="utf-8")
    assert "label.append(select)" in script and 'setAttribute("aria-live", "polite")' in script


def test_formulas_are_no_stops_of_the_tab_key(texts: dict[str, str]) -> None:
    """A chapter has more than a hundred."""
    assert '"inTabOrder": false' in texts["2.1-dirichlet-tessellation"]


# ---- colors and motion -------------------------------------------------------------------------


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_can_be_read(site: Path, theme: str) -> None:
    color = variables([site / "_static" / "styles" / name for name in SHEETS], theme)
    everywhere = ["text-base", "text-muted", "heading", "inline-code", "link-higher-contrast"]
    pairs = [(name, paper) for name in everywhere for paper in ("background", "surface")]
    for name, paper in [*pairs, ("primary", "background"), ("link", "background")]:
        pair = color[f"--pst-color-{name}"], color[f"--pst-color-{paper}"]
        assert contrast(*pair) >= TEXT, f"{theme}: {name} on {paper}: {pair}"
    ring = color["--pst-color-primary"], color["--pst-color-background"]
    assert contrast(*ring) >= GRAPHIC, "what shows the focus"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_code_can_be_read(site: Path, theme: str) -> None:
    """Each color of the highlighted code on the color behind code."""
    color = variables([site / "_static" / "styles" / name for name in SHEETS], theme)
    style = (site / "_static" / "pygments.css").read_text(encoding="utf-8")
    inks = re.findall(rf'html\[data-theme="{theme}"\][^{{]*\.highlight \.\w+ {{ color: (#\w+)', style)
    assert len(set(inks)) >= 5
    for ink in set(inks):
        assert contrast(ink, color["--pst-color-surface"]) >= TEXT, f"{theme}: {ink}"


def test_our_own_colors_of_text_can_be_read() -> None:
    """On white, where they are used: on paper and in the map."""
    for path in [*(ROOT / "site" / "_static").glob("*.css"), BOOK / "maps.py"]:
        text = path.read_text(encoding="utf-8")
        for ink in re.findall(r"(?<![-\w])color: (#[0-9a-f]{6})", text):
            assert contrast(ink, "#ffffff") >= TEXT, f"{path.name}: {ink}"
        for line in re.findall(r'stroke(?:="|: )(#[0-9a-f]{6})', text):
            assert contrast(line, "#ffffff") >= GRAPHIC, f"{path.name}: {line}"


def test_focus_is_shown_and_motion_can_be_turned_off(site: Path) -> None:
    style = (site / "_static" / "book.css").read_text(encoding="utf-8")
    assert re.search(r":focus-visible \{ outline: 2px solid var\(--pst-color-primary\)", style)
    still = re.search(r"@media \(prefers-reduced-motion: reduce\) \{(.*?)\n\}", style, flags=re.S)
    assert still and all(f"{what}: " in still[1] for what in ("animation", "transition", "scroll-behavior"))
    hidden = [rule for rule in re.findall(r"([^{}]+)\{[^{}]*outline: none", style) if ".drawing" not in rule]
    assert not hidden, "the map shows the focus by the frame of the box; all else by an outline"
