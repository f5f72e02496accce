"""What every panel promises, found in the folder: a new one is held to it too."""

from dataclasses import replace

import pytest

from hectorscope.inputs import SourceReport
from hectorscope.page.scene import Scene
from hectorscope.panels import Panel, panel_classes
from hectorscope.session.snapshot import LogEntry, Snapshot
from tests.page import restarted, room_snapshot, without_filter

PANELS = pytest.mark.parametrize("panel", panel_classes(), ids=lambda panel: panel.__name__)


def messages(scene: Scene) -> int:
    """How many messages were ever queued for browsers."""
    return int(scene.server._websock_server._broadcast_buffer.message_counter)


def test_titles_and_places_are_unique() -> None:
    """No two panels share a title or a place in the order, and they come in that order."""
    panels = panel_classes()
    assert len({panel.title for panel in panels}) == len({panel.order for panel in panels}) == len(panels)
    assert [panel.order for panel in panels] == sorted(panel.order for panel in panels)


@PANELS
def test_it_draws_whatever_a_run_shows(panel: type[Panel], scene: Scene) -> None:
    """Nothing yet, a first scan, a full picture, a run begun again, a live one, a failed one: no error."""
    made = panel(scene)
    full = room_snapshot()
    live = replace(full, playback=replace(full.playback, live=True, end_ns=None))
    failed = replace(
        full,
        playback=replace(full.playback, state="failed", detail="disk <gone>"),
        log=(LogEntry(0, "disk <gone>", "error"),),
        report=SourceReport({"/scan": 2}, {"/scan: <NaN>": 1}, 3),
    )
    for snapshot in (Snapshot(), without_filter(full), full, restarted(full), live, failed, full):
        made.draw(snapshot)


@PANELS
def test_it_sends_nothing_when_nothing_changed(panel: type[Panel], scene: Scene) -> None:
    """Drawing the same snapshot again costs no bytes."""
    made, snapshot = panel(scene), room_snapshot()
    made.draw(snapshot)
    made.draw(snapshot)
    before = messages(scene)
    made.draw(snapshot)
    assert messages(scene) == before
