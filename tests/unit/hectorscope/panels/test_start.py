"""What stands over the scene before the first scan."""

from dataclasses import replace

import pytest

from hectorscope.inputs import SourceReport
from hectorscope.panels.start import start_html
from hectorscope.session.snapshot import PlaybackStatus, Snapshot

BEGIN_NS = 1_000_000_000
LOADING = Snapshot(
    source="<arena>",
    playback=PlaybackStatus(
        start_ns=BEGIN_NS, end_ns=BEGIN_NS + 97_400_000_000, preparing="Compiling: 3 of 6", prepared=0.5
    ),
    report=SourceReport(scans=2400),
)


def test_a_recording_is_named_before_it_is_drawn() -> None:
    """Its name, escaped, its scans and its length, what is prepared, in full, and how far that is."""
    html = start_html(LOADING)
    assert "&lt;arena&gt;" in html
    assert "A recording of 2400 scans in 1 min 37 s." in html
    assert "Compiling: 3 of 6<" in html
    assert 'value="0.500"' in html


def test_what_is_not_known_is_not_made_up() -> None:
    """Without a number of scans the length alone; without a share a bar that only moves."""
    playback = replace(LOADING.playback, preparing="", prepared=None)
    html = start_html(replace(LOADING, playback=playback, report=SourceReport()))
    assert "A recording of 1 min 37 s." in html
    assert '<progress class="hs-progress"></progress>' in html
    assert "Reading the first scans" in html


def test_a_run_that_waits_later_says_so_in_a_line() -> None:
    """The picture that is there already stays in view."""
    html = start_html(replace(LOADING, scans=1))
    assert "hs-start-line" in html
    assert "Compiling: 3 of 6" in html
    assert "arena" not in html


def test_without_a_recording_one_can_be_opened() -> None:
    """The card has the button of the list, and says that a file can be dropped."""
    html = start_html(Snapshot(playback=PlaybackStatus(state="empty")))
    assert 'data-hs-do="recordings"' in html
    assert "drop a file" in html


@pytest.mark.parametrize("state", ["playing", "paused", "waiting", "failed", "ended"])
def test_a_run_that_waits_for_nothing_shows_the_scene(state: str) -> None:
    """Nothing lies over it."""
    playback = replace(LOADING.playback, state=state)  # type: ignore[arg-type]
    assert start_html(replace(LOADING, playback=playback)) == ""
