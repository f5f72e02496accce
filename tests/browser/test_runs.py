"""Runs on the page: a fork, the original over it, the settings that differ, and the way back."""

import pytest
from playwright.sync_api import expect

from hectorscope.page.theme import DARK, SENT
from hectorscope.session.commands import Configure, Pause, Seek, SetSpeed
from hectorscope.session.commands import Open as OpenRecording
from tests.browser.conftest import Open, Opened
from tests.engines import after, until
from tests.scene import names, node

pytestmark = pytest.mark.browser

PATIENCE_S = 120.0
# Metres by which both, walls and trajectory, lie beside the shown run; positive if they do not go together.
APART = """() => {
  const found = ["/floor/compared_map", "/compared"].map((name) => window.__viserMutable.nodeRefFromName[name]);
  const [walls, line] = found.map((node) => node.position.x);
  return walls === line ? line : 1;
}"""
# Whether the camera has both runs in view.
IN_VIEW = """() => {
  const { nodeRefFromName, camera } = window.__viserMutable;
  return ["/floor/compared_map/cells", "/floor/map/level0/cells"].every((name) => {
    const at = nodeRefFromName[name].getWorldPosition(camera.position.clone()).project(camera);
    return Math.abs(at.x) < 0.9 && Math.abs(at.y) < 0.9;
  });
}"""
COLOUR = """() => {
  let found = null;
  window.__viserMutable.nodeRefFromName['/compared/chunk0'].traverse((child) => (found ??= child.material?.color));
  return found && [found.r, found.g, found.b].map((share) => Math.round(share * 100));
}"""


def test_a_run_is_forked_compared_and_shown_again(opened: Opened, open_page: Open) -> None:
    """The original lies over the fork, or beside it, in its own colour, until it is shown itself: by buttons."""
    engine = opened.engine
    key = next(each.key for each in engine.mailbox.latest.library if each.name == "kitchen.bag")  # type: ignore[union-attr]
    begun = after(engine, OpenRecording(key), SetSpeed(float("inf")))
    after(engine, Pause(), Seek(begun.playback.start_ns + 2_000_000_000))
    page = open_page(opened.server.url, own={"plots": "below", "pages": ["Compared runs"]})
    page.get_by_role("tab", name="Runs").click()
    page.get_by_role("button", name="Fork here").click()
    rows = page.locator(".hs-run-row")
    expect(rows).to_have_count(2)
    after(engine, Configure("fusion.omega", 0.2), Seek(begun.playback.start_ns + 3_500_000_000))
    rows.nth(0).get_by_role("button", name="Compare").click()
    shown = until(engine, lambda now: now.compared and now.compared.whole, PATIENCE_S)
    assert shown.compared is not None
    assert len(shown.compared.trajectory) == shown.scans
    table = page.locator(".hs-compared tbody tr")
    expect(table).to_have_count(1)
    expect(table).to_contain_text("fusion.omega")
    page.wait_for_function("!!window.__viserMutable.nodeRefFromName['/compared/chunk0']")
    page.wait_for_function("window.__viserMutable.nodeRefFromName['/floor/compared_map/cells']?.visible")
    assert page.evaluate(COLOUR) is not None
    for title in ("Positions apart, mm", "σ in the plane, mm", "Error against truth, mm"):
        expect(page.locator(".hs-plots figure", has_text=title)).to_be_visible()
    assert SENT.compared == DARK.compared
    page.get_by_label("Beside the shown run, not over it").check()
    page.wait_for_function(f"({APART})() < -1")
    page.wait_for_function(IN_VIEW)
    page.get_by_label("Beside the shown run, not over it").uncheck()
    page.wait_for_function(f"({APART})() === 0")
    rows.nth(0).get_by_role("button", name="Show").click()
    back = until(engine, lambda now: now.shown_run == 1 and now.playback.state == "paused", PATIENCE_S)
    assert back.compared is None
    page.wait_for_function("!window.__viserMutable.nodeRefFromName['/compared/chunk0']")
    cells = node(page, "/floor/compared_map/cells")
    assert cells is not None and not cells["visible"]
    assert "/trajectory/chunk0" in names(page)


def test_a_run_is_renamed_by_a_hand(opened: Opened, open_page: Open) -> None:
    """The name is asked for, and shown as it is; without an answer nothing is done."""
    key = next(each.key for each in opened.engine.mailbox.latest.library if each.name == "kitchen.bag")  # type: ignore[union-attr]
    after(opened.engine, OpenRecording(key), SetSpeed(float("inf")))
    page = open_page(opened.server.url)
    page.get_by_role("tab", name="Runs").click()
    answers = iter([None, "<b>kitchen</b>"])
    page.on("dialog", lambda dialog: dialog.dismiss() if (name := next(answers)) is None else dialog.accept(name))
    shown = page.locator(".hs-run-shown")
    for words in ("run 1", "<b>kitchen</b>"):
        shown.get_by_role("button", name="Rename").click()
        expect(shown.locator("b")).to_have_text(words)
