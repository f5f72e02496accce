"""The page of a sweep in a real browser, of real runs."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from hectorscope.sweep.executors import executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Table
from hectorscope.web.sweep_server import SweepServer
from tests.browser.conftest import PATIENCE
from tests.sweeps import recording, specs_of

SIGMAS = (0.1, 0.2, 0.4)
pytestmark = pytest.mark.browser
BROKEN = "<img src=x onerror=alert(1)>.bag"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings with three settings each, and one that cannot be read, whose name looks like markup."""
    made = tmp_path_factory.mktemp("page")
    bags = [recording(made, f"{name}.bag", seed=seed) for seed, name in enumerate(("first", "second"), 1)]
    specs = [*specs_of(*bags, sigmas=SIGMAS), RunSpec(BROKEN, "/nowhere/x.bag", {"matcher.sigma": 0.1})]
    table = Table(made, ["matcher.sigma"])
    with executor(1) as pool:
        sweep(specs, table, pool, Limits())
    table.finish(specs)
    return made


@pytest.fixture
def page(browser: Browser, folder: Path) -> Iterator[Page]:
    """The page, once its table is there; no script of it may fail."""
    server = SweepServer(folder, port=0)
    server.start()
    errors: list[str] = []
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    made = context.new_page()
    made.set_default_timeout(PATIENCE)
    made.on("pageerror", lambda error: errors.append(str(error)))
    made.goto(server.url)
    expect(made.locator("#runs tbody tr")).to_have_count(7)
    yield made
    context.close()
    server.stop()
    assert not errors


def column(page: Page, name: str) -> list[str]:
    """The cells of a column of the table, from above."""
    heads = [head.removesuffix(" ▲").removesuffix(" ▼") for head in page.locator("#runs th").all_inner_texts()]
    rows = page.locator("#runs tbody tr").all()
    return [row.locator("td").nth(heads.index(name)).inner_text() for row in rows]


def test_the_page_shows_all_runs_and_how_they_ended(page: Page):
    """Counts, maps of the best and the worst, a point and a line a run, a row a recording; names are no markup."""
    expect(page.locator("#counts")).to_have_text("7 runs: 6 ok, 1 refused")
    expect(page.locator("#maps img")).to_have_count(6)
    for image in page.locator("#maps img").all():
        assert image.evaluate("image => image.naturalWidth") > 10
    expect(page.locator("#scatter circle")).to_have_count(6)  # one has no figures
    expect(page.locator("#parallel path.line")).to_have_count(7)
    expect(page.locator("#breakdown tbody tr")).to_have_count(3)
    assert BROKEN in column(page, "recording")
    expect(page.locator("td img, figcaption img")).to_have_count(0)


def test_headings_sort_and_a_recording_filters(page: Page):
    """Up, and down at the second click; what has no value is last either way."""
    heading = page.get_by_role("button", name="consistency")
    heading.click()
    up = column(page, "consistency")
    heading.click()
    down = column(page, "consistency")
    assert up[-1] == down[-1] == "–"
    assert up[:-1] == sorted(up[:-1], key=float) == down[-2::-1]
    page.locator("#breakdown").get_by_role("button", name="second.bag").click()
    expect(page.locator("#runs tbody tr")).to_have_count(3)
    assert set(column(page, "recording")) == {"second.bag"}
    page.locator("#recording").select_option("all")
    expect(page.locator("#runs tbody tr")).to_have_count(7)


def test_the_axes_of_the_scatter_are_chosen(page: Page):
    """Their names stand at the axes."""
    page.locator("#scatter-x").select_option("consistency")
    expect(page.locator("#scatter text", has_text="consistency")).to_have_count(1)


def test_two_runs_are_compared(page: Page):
    """Figures and settings side by side, both trajectories on one map; a third takes the place of the first."""
    ticks = page.locator("#runs tbody input")
    ticks.nth(0).check()
    expect(page.locator("#compared")).to_be_hidden()
    ticks.nth(1).check()
    expect(page.locator("#compared")).to_be_visible()
    expect(page.locator("#comparison svg").first.locator("polyline")).to_have_count(2)
    expect(page.locator("#comparison svg image")).to_have_count(3)
    row = page.locator("#comparison tr", has=page.get_by_role("rowheader", name="matcher.sigma", exact=True))
    assert row.locator("td").all_inner_texts() == column(page, "matcher.sigma")[:2]
    page.locator("#scatter circle:not(.chosen)").first.dispatch_event("click")
    expect(page.locator("#runs tr.chosen")).to_have_count(2)
    expect(ticks.nth(0)).not_to_be_checked()


@pytest.mark.slow
def test_a_click_on_a_row_opens_that_run_on_the_bench(page: Page):
    """A new tab has it, with the recording and the settings of the row; one that cannot be opened says why."""
    page.get_by_role("button", name="matcher.sigma").click()
    with page.expect_popup() as popup:
        page.locator("#runs tbody tr", has_text="second.bag").last.locator("td.number").first.click()
    bench = popup.value
    bench.wait_for_url("http://127.0.0.1:*/")
    expect(bench).to_have_title("Hectorscope")
    expect(bench.get_by_text("second.bag").first).to_be_attached()
    expect(page.locator("#message")).to_contain_text("The run is at http://127.0.0.1:")
    page.locator("#runs").get_by_role("button", name=BROKEN).click()
    expect(page.locator("#message")).to_contain_text("cannot be opened: /nowhere/x.bag does not exist")


def test_a_long_path_stays_in_its_button(page: Page):
    """It wraps there, and leaves the columns beside it readable."""
    cut = """[...document.querySelectorAll("td button")].filter((e) => {
      e.textContent = "/a/very/long/path/of/a/recording".repeat(4) + ".bag";
      const [box, cell] = [e, e.parentElement].map((each) => each.getBoundingClientRect());
      return e.scrollWidth > e.clientWidth + 1 || box.right > cell.right + 1;
    }).length"""
    expect(page.locator("#runs tbody tr")).to_have_count(7)
    assert page.evaluate(cut) == 0


@pytest.mark.slow
def test_a_table_that_cannot_be_read_is_named(page: Page, folder: Path):
    """The runs stay as they were, and the message goes once the table is whole again."""
    csv = folder / "runs.csv"
    whole = csv.read_bytes()
    csv.write_bytes(b"no table\n")
    try:
        expect(page.locator("#message")).to_contain_text("is no table of a sweep", timeout=PATIENCE)
        expect(page.locator("#runs tbody tr")).to_have_count(7)
    finally:
        csv.write_bytes(whole)
    expect(page.locator("#message")).to_be_hidden(timeout=PATIENCE)


def test_the_page_fits_a_phone(page: Page):
    """Tables scroll within their own boxes."""
    page.set_viewport_size({"width": 390, "height": 800})
    expect(page.locator("#runs tbody tr")).to_have_count(7)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
