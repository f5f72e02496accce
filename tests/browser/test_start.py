"""Before the first scan the page shows what is about to be seen."""

from dataclasses import replace

from playwright.sync_api import expect

from hectorscope.inputs import SourceReport
from hectorscope.session.snapshot import PlaybackStatus, Snapshot
from tests.browser.conftest import Open, Show
from tests.page import room_snapshot

HERE = "!!document.querySelector('.hs-run')"
WORDS = "Compiling for the first scan: 48 of 50 functions (first start only)"


def test_the_start_is_a_card_whose_progress_is_not_cut_off(show: Show, open_page: Open) -> None:
    """Name, scans, length and the whole sentence on what is prepared; it goes with the first scan."""
    loading = PlaybackStatus(end_ns=60_000_000_000, preparing=WORDS, prepared=0.96)
    show.engine.show(Snapshot(sequence=1, source="arena.bag", playback=loading, report=SourceReport(scans=2400)))
    page = open_page(show.url, HERE)
    card = page.locator(".hs-start")
    expect(card).to_contain_text("arena.bag")
    expect(card).to_contain_text("2400 scans in 1 min 0 s")
    words = card.locator(".hs-preparing")
    expect(words).to_have_text(WORDS)
    assert words.evaluate("line => line.scrollWidth <= line.clientWidth")
    shown = card.bounding_box()
    assert shown is not None
    assert 0 < shown["y"] < shown["y"] + shown["height"] < 640
    assert card.locator("progress").evaluate("bar => bar.value") == 0.96
    show.engine.show(replace(room_snapshot(), sequence=2))
    expect(card).to_have_count(0)
