"""A reader's browser: the built website, stepped without a kernel; a notebook live in JupyterLab."""

from __future__ import annotations

import ast
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from book_files import BOOK, ROOT, chapters, code_cells, ledger, notebooks

from unstruct import Domain, constrained_delaunay, view

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason=f"no browser: none of {', '.join(NAMES)} is installed"
)
QUIET = ["disable-gpu", "disable-quic", "no-first-run", "disable-background-networking", "disable-sync"]
PATIENCE = 900_000  # milliseconds, to end what hangs; a busy machine may be slow
CLIPPED = (ROOT / "tests" / "helpers" / "clipped.js").read_text(encoding="utf-8")
WIDTHS = 1280, 390  # a laptop, a telephone
PAPER = 650  # pixels between the margins of a sheet
FLAGS = ["--no-sandbox", "--disable-component-update", *(f"--{flag}" for flag in QUIET)]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS, timeout=PATIENCE)
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page of the website, read from the disk: it may fetch nothing and report no error."""
    page = browser.new_page(viewport={"width": 1200, "height": 900})
    page.set_default_timeout(PATIENCE)
    wrong: list[str] = []
    page.on("request", lambda r: wrong.append(r.url) if r.url.startswith("http") else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda m: wrong.append(m.text) if m.type == "error" else None)
    yield page
    page.close()
    assert not wrong, wrong


def widgets(cell: nbformat.NotebookNode) -> list[dict[str, Any]]:
    return [o.metadata["widget"] for o in cell.outputs if "widget" in o.get("metadata", {})]


def parts(widget: dict[str, Any]) -> Iterator[dict[str, Any]]:
    yield widget
    for child in widget.get("children", []):
        yield from parts(child)


def sets_up(source: str) -> bool:
    """Whether a cell only imports, and sets the style."""
    kinds = [type(node) for node in ast.parse(source).body if ast.unparse(node) != "view.setup()"]
    return set(kinds) <= {ast.Import, ast.ImportFrom}


def shows_player(cell: nbformat.NotebookNode) -> bool:
    tops = widgets(cell)
    return any(w["kind"] == "anywidget" and len(w["traits"].get("frames", [])) > 1 for w in tops)


def needs_a_kernel(cell: nbformat.NotebookNode) -> bool:
    return any(part["kind"] == "control" for widget in widgets(cell) for part in parts(widget))


def test_the_ledger_is_filtered(page: Any, site: Path) -> None:
    """By section and verdict, together; a link to a row that is hidden shows all again."""
    page.goto((site / "ledger.html").as_uri())
    rows = page.locator("table.ledger tr[data-verdict]")
    shown = page.locator("table.ledger tr[data-verdict]:visible")
    claims = ledger()
    assert rows.count() == shown.count() == len(claims)
    page.get_by_label("verdict").select_option("false")
    wrong = [row for row in claims if row["verdict"] == "false"]
    assert shown.count() == len(wrong)
    page.get_by_label("section").select_option("12.2.6")
    some = [row["id"] for row in wrong if row["section"] == "12.2.6"]
    assert [text.strip() for text in shown.locator("td:first-child").all_inner_texts()] == some
    assert page.locator(".ledger-filters output").inner_text() == f"{len(some)} of {len(claims)} claims"
    page.evaluate("location.hash = '#claim-12-2-1-01'")
    page.wait_for_function(
        "document.querySelector('tr:target') && !document.querySelector('tr:target').hidden"
    )
    assert shown.count() == len(claims)


def test_front_page_leads_to_the_chapters(site: Path, page: Any) -> None:
    page.goto((site / "index.html").as_uri())
    assert "Unstructured mesh generation" in page.title()
    for chapter in chapters():
        assert page.locator(f"article a[href='{chapter.stem}.html']").count() > 0, chapter.name
    page.locator("article a[href^='2.']").first.click()
    page.wait_for_selector("mjx-container svg")
    assert page.evaluate("document.querySelectorAll('.merror, mjx-merror, [data-mjx-error]').length") == 0
    page.locator("button.theme-switch-button").last.click()
    page.locator("button.theme-switch-button").last.click()
    assert page.evaluate("document.documentElement.dataset.theme") in ("dark", "light")


def test_search_finds_a_chapter(site: Path, page: Any) -> None:
    page.goto((site / "search.html").as_uri() + "?q=circumcircle")
    page.wait_for_selector("#search-results li a")
    hits = [a.get_attribute("href") for a in page.locator("#search-results li a").all()]
    assert any(hit.startswith("2.") for hit in hits), hits


def test_search_finds_entries_of_the_index(site: Path, page: Any) -> None:
    """And leads to their places in the chapters. Results appear one after the other."""
    page.goto((site / "search.html").as_uri() + "?q=sliver")
    hit = page.wait_for_selector("#search-results li a[href^='2.8a'][href*='#index-']")
    address = hit.get_attribute("href")
    page.goto((site / address).as_uri().replace("%23", "#").replace("%3F", "?"))
    assert page.evaluate("!!document.getElementById(location.hash.slice(1))")


def test_mathematics_is_typeset_and_widgets_are_drawn(site: Path, page: Any) -> None:
    for chapter in chapters():
        page.goto((site / f"{chapter.stem}.html").as_uri())
        count = sum(len(widgets(cell)) for cell in code_cells(chapter))
        page.wait_for_function(f"document.querySelectorAll('[data-state=drawn]').length == {count}")
        if page.locator("script[src*='tex-svg']").count() == 0:
            continue  # no mathematics on this page
        page.wait_for_function("!!window.MathJax?.startup?.promise")
        page.evaluate("window.MathJax.startup.promise.then(() => true)")
        assert page.locator("mjx-container svg").count() > 0, chapter.name
        errors = page.locator("[data-mml-node='merror']")
        assert errors.count() == 0, f"{chapter.name}: {errors.first.inner_text()}"


def test_nothing_is_clipped(site: Path, page: Any) -> None:
    """On a laptop, a telephone and on paper, folded cells opened: what is too wide can be scrolled to."""
    wrong = []
    for name in notebooks():
        page.set_viewport_size({"width": WIDTHS[0], "height": 900})
        page.goto((site / f"{name.stem}.html").as_uri())
        if page.locator("script[src*='tex-svg']").count():
            page.wait_for_function("!!window.MathJax?.startup?.promise")
            page.evaluate("window.MathJax.startup.promise.then(() => true)")
        page.wait_for_function("!document.querySelector('.unstruct-widget:not([data-state=drawn])')")
        page.evaluate("document.querySelectorAll('details').forEach((folded) => (folded.open = true))")
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            wrong += [f"{name.stem} at {width} px: {text}" for text in page.evaluate(CLIPPED)]
        page.emulate_media(media="print")
        page.set_viewport_size({"width": PAPER, "height": 900})
        wrong += [f"{name.stem} on paper: {text}" for text in page.evaluate(CLIPPED)]
        page.emulate_media(media="screen")
    assert not wrong, "\n".join(wrong)


def test_players_step_without_a_kernel(site: Path, page: Any) -> None:
    with_player = [path for path in chapters() if any(map(shows_player, code_cells(path)))]
    assert with_player, "no chapter has a player"
    page.goto((site / f"{with_player[0].stem}.html").as_uri())
    page.wait_for_selector(".unstruct-widget[data-state=drawn] .unstruct-player")
    page.wait_for_function("!document.querySelector('.unstruct-widget:not([data-state=drawn])')")
    steps = page.locator("[data-do=next]:visible")  # a panel may have no steps
    player = page.locator(".unstruct-player").filter(has=steps).first
    picture = player.locator(".unstruct-picture")
    first = picture.inner_html()
    player.locator("[data-do=next]").click()
    assert picture.inner_html() != first, "the picture of the second step is the picture of the first"
    player.locator("[data-do=back]").click()
    assert picture.inner_html() == first


def tabbed(page: Any, to: str, most: int = 400) -> None:
    """Press Tab until something has the focus, which must then be seen."""
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate("(to) => document.activeElement.matches(to)", to):
            break
    else:
        raise AssertionError(f"{to} is not reached by Tab")
    style = "getComputedStyle(document.activeElement)"
    look = page.evaluate(f"{style}.outlineStyle"), page.evaluate(f"{style}.outlineWidth")
    assert look == ("solid", "2px"), f"{to} has the focus, which is not seen: {look}"


def test_everything_is_used_by_keys(site: Path, page: Any) -> None:
    """The skip link, players, views in space, folded solutions, the map, and the filters of the ledger."""
    page.goto((site / "2.8a-delaunay-in-space.html").as_uri())
    page.wait_for_function("!document.querySelector('.unstruct-widget:not([data-state=drawn])')")
    tabbed(page, ".skip-link a", 1)
    page.keyboard.press("Enter")
    assert page.evaluate("location.hash") == "#main-content"
    tabbed(page, ".unstruct-player:not(.unstruct-space)")
    caption = lambda: page.evaluate("document.activeElement.querySelector('.unstruct-caption').textContent")  # noqa: E731
    first = caption()
    page.keyboard.press("ArrowRight")
    assert caption() != first
    tabbed(page, ".unstruct-space")
    turned = "document.activeElement.querySelector('canvas').toDataURL()"
    before = page.evaluate(turned)
    page.keyboard.press("ArrowLeft")
    page.wait_for_function(f"before => {turned} != before", arg=before)
    tabbed(page, "details:has(> .cell_input, > summary:only-child, > p) > summary")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.parentElement.open")

    page.goto((site / "index.html").as_uri())
    for _ in range(400):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.closest('.drawing') !== null"):
            break
    frame = "getComputedStyle(document.activeElement.querySelector('rect')).strokeWidth"
    assert page.evaluate(frame) == "3.5px", "the frame of the box shows the focus"
    page.keyboard.press("Enter")
    page.wait_for_url("**/1-introduction.html")

    page.goto((site / "ledger.html").as_uri())
    tabbed(page, "select[name=verdict]")
    page.keyboard.press("f")  # false
    assert page.locator("table.ledger tr[data-verdict]:visible").count() < len(ledger())


def test_players_work_by_touch(site: Path, browser: Any) -> None:
    """On a telephone: a tap steps; a finger that moves up and down over a picture still scrolls the page."""
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto((site / "2.8a-delaunay-in-space.html").as_uri())
    page.wait_for_function("!document.querySelector('.unstruct-widget:not([data-state=drawn])')")
    player = page.locator(".unstruct-player:has(input[max]:not([max='0']))").first
    count = player.locator(".unstruct-bar output")
    player.locator("[data-do=next]").tap()
    assert count.inner_text().startswith("2/")
    touch = "all => [...new Set(all.map((each) => getComputedStyle(each).touchAction))]"
    assert page.locator(".unstruct-picture").evaluate_all(touch) == ["pan-y"]
    controls = page.locator(".unstruct-player :is(button, input, select)")
    heights = controls.evaluate_all("all => all.map((each) => each.getBoundingClientRect().height)")
    assert min(height for height in heights if height) >= 24, "a finger is not a mouse"
    context.close()


def test_the_form_of_new_chapters_on_a_page(skeleton_site: Path, page: Any) -> None:
    """Code of 84 columns is not clipped, folded cells are closed, equations have numbers, anchors work."""
    page.set_viewport_size({"width": 1280, "height": 900})
    page.goto((skeleton_site / "0.0-skeleton.html").as_uri())
    page.wait_for_function("!!window.MathJax?.startup?.promise")
    page.evaluate("window.MathJax.startup.promise.then(() => true)")
    assert page.locator("[data-mml-node='merror']").count() == 0
    folded = page.locator("details:not([open])")
    assert folded.count() == page.locator("details").count() == 9
    assert page.locator(".admonition.source .admonition-title").inner_text() == "Source"
    page.evaluate("document.querySelectorAll('details').forEach((folded) => (folded.open = true))")
    line = page.locator("div.cell_input pre").first
    line.evaluate("(pre) => (pre.textContent = 'x'.repeat(84))")
    wide = "(all) => all.filter((pre) => pre.scrollWidth > pre.clientWidth).map((pre) => pre.textContent)"
    clipped = page.locator("div.cell_input pre").evaluate_all(wide)
    assert not clipped, clipped
    page.set_viewport_size({"width": 390, "height": 900})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    equation = page.locator("div.math mjx-container").first
    assert equation.bounding_box()["x"] >= 0, "the left of a wide formula cannot be reached"
    page.goto((skeleton_site / "0.1-second.html").as_uri())
    page.locator("a[href='0.0-skeleton.html#equation-0-0-1']").first.click()
    page.wait_for_url("**/0.0-skeleton.html#equation-0-0-1")


def test_a_panel_moves_on_a_page(skeleton_site: Path, page: Any) -> None:
    page.goto((skeleton_site / "0.0-skeleton.html").as_uri())
    panel = page.locator(".unstruct-widget[data-state=drawn] .unstruct-player")
    panel.wait_for()
    number = panel.locator(".unstruct-number")
    seen = [number.inner_text()]
    panel.locator("input[data-axis='1']").press("ArrowRight")
    seen.append(number.inner_text())
    panel.locator("select[data-axis='0']").select_option(label="nasty: upright")
    seen.append(number.inner_text())
    panel.locator("[data-do=reset]").click()
    assert seen == ["sides 3.00, 3.00", "sides 3.35, 3.35", "sides 3.20, 3.20"]
    assert number.inner_text() == seen[0]


@pytest.mark.parametrize("width", [320, 390, 1200])
def test_a_view_in_space_fits_its_page(tmp_path: Path, page: Any, width: int) -> None:
    """The slider of the section was cut on narrow pages, and stood beside the picture on wide ones."""
    shown = view.view3d(constrained_delaunay(Domain.box()), alt="A box.", section=("-y", 0.5))
    state = {name: getattr(shown, name) for name in shown.trait_names(sync=True) if not name.startswith("_")}
    state = {name: value for name, value in state.items() if name not in ("layout", "tabbable", "tooltip")}
    draw = Path(view.__file__).parent / "draw"
    script = (draw / "space.js").read_text(encoding="utf-8").replace("export default {", "const shown = {")
    model = "{get: (name) => state[name], set() {}, save_changes() {}, on() {}, off() {}}"
    call = f"shown.render({{model: {model}, el: document.querySelector('main')}})"
    (tmp_path / "page.html").write_text(
        f"<style>{(draw / 'player.css').read_text(encoding='utf-8')}</style><main></main>"
        f"<script type='module'>{script}\nconst state = {json.dumps(state)};\n{call}</script>",
        encoding="utf-8",
    )
    page.set_viewport_size({"width": width, "height": 700})
    page.goto((tmp_path / "page.html").as_uri())
    root = page.locator(".unstruct-space").bounding_box()
    for name in ("explode", "section"):
        box = page.locator(f"[aria-label={name}]").bounding_box()
        assert box["width"] >= 60 and box["x"] + box["width"] <= root["x"] + root["width"] <= width
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[str]:
    """The address of a JupyterLab that serves a folder with a copy of one widget of the book."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    home = tmp_path / "home"
    own = {f"JUPYTER_{kind}_DIR": str(home / kind) for kind in ("CONFIG", "DATA", "RUNTIME")}
    environment = {**os.environ, **own, "JUPYTERLAB_SETTINGS_DIR": str(home), "IPYTHONDIR": str(home)}
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--ip=127.0.0.1"]
    command += [f"--port={port}", "--IdentityProvider.token=", f"--notebook-dir={tmp_path}"]
    command += ["--LabApp.news_url=", "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"]
    with open(tmp_path / "lab.log", "w") as log:
        server = subprocess.Popen(command, env=environment, stdout=log, stderr=log, cwd=tmp_path)
    address = f"http://127.0.0.1:{port}"
    try:
        while True:
            try:
                urllib.request.urlopen(f"{address}/api").close()
                break
            except (urllib.error.URLError, ConnectionError):
                assert server.poll() is None, (tmp_path / "lab.log").read_text()
                time.sleep(0.25)
        yield address
    finally:
        server.terminate()
        server.wait()


def test_no_widget_is_dead_on_the_website() -> None:
    """All move without a kernel."""
    dead = [path.stem for path in notebooks() if any(map(needs_a_kernel, code_cells(path)))]
    assert not dead, dead


def test_a_panel_answers_in_jupyterlab(lab: str, tmp_path: Path, browser: Any) -> None:
    """That of the skeleton: run its cell, move a slider, see the picture change."""
    skeleton = BOOK / "skeleton" / "0.0-skeleton.ipynb"
    setup = [cell.source for cell in code_cells(skeleton) if sets_up(cell.source)]
    (panel,) = [cell.source for cell in code_cells(skeleton) if "view.panel(" in cell.source]
    cells = [nbformat.v4.new_code_cell(source) for source in [*setup, panel]]
    metadata = json.loads(skeleton.read_text(encoding="utf-8"))["metadata"]
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata=metadata), tmp_path / "widget.ipynb")

    page = browser.new_page(viewport={"width": 1200, "height": 1400})
    page.set_default_timeout(PATIENCE)
    page.goto(f"{lab}/lab/tree/widget.ipynb?reset")
    page.wait_for_selector("text=| Idle")
    page.click("text=Run >> nth=0")
    page.click("text=Run All Cells")
    trouble = "[data-mime-type='application/vnd.jupyter.stderr']"
    page.wait_for_selector(f".unstruct-grid, {trouble}")
    error = page.locator(trouble)
    assert error.count() == 0, error.first.inner_text()
    picture = page.locator(".unstruct-picture").first
    before = picture.inner_html()
    page.locator(".unstruct-grid input").first.press("ArrowRight")
    assert page.locator(".unstruct-grid ~ .unstruct-number").inner_text() == "sides 3.35, 3.35"
    assert picture.inner_html() != before
    page.close()
