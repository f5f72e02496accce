"""What the timeline sends to the browsers, and what it takes from them."""

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hectorscope.common.resources import resource_folder
from hectorscope.page.scene import Scene
from hectorscope.panels import timeline
from hectorscope.panels.timeline import MOST, TimelinePanel, container, marks_script, play_script
from hectorscope.run.marks import TITLES, Mark
from hectorscope.run.series import SERIES_DTYPE, TRACKING
from hectorscope.session.commands import Command, Seek
from hectorscope.session.snapshot import Ahead, PlaybackStatus, Snapshot
from tests.hands import by_hand

S = 10**9
RECORDING = PlaybackStatus("paused", False, 12 * S, 10 * S, 60 * S)


def told(script: str) -> Any:
    """What a script hands to the page."""
    return json.loads(script[script.index("(") + 1 : -1])


def panel_of(scene: Scene, playback: PlaybackStatus) -> tuple[TimelinePanel, list[Command]]:
    sent: list[Command] = []
    scene.send = sent.append
    panel = TimelinePanel(scene)
    panel.draw(Snapshot(playback=playback))
    return panel, sent


def test_a_time_that_a_browser_sends_is_one_of_the_recording(scene: Scene) -> None:
    """Since its start; what lies behind the end is the end."""
    panel, sent = panel_of(scene, RECORDING)
    by_hand(panel._wanted, 30.0)
    by_hand(panel._wanted, 1e7)
    assert sent == [Seek(40 * S), Seek(60 * S)]


def test_a_stream_of_which_nothing_is_kept_has_no_timeline(scene: Scene) -> None:
    """There is nowhere to go to."""
    panel, sent = panel_of(scene, PlaybackStatus("playing", True, 12 * S, 10 * S, None))
    by_hand(panel._wanted, 1.0)
    assert sent == []
    assert not panel._folder.visible


def test_a_stream_has_a_timeline_over_what_is_kept(scene: Scene) -> None:
    """A time that a browser sends is one of those."""
    panel, sent = panel_of(scene, PlaybackStatus("playing", True, 30 * S, 10 * S, kept_ns=(20 * S, 30 * S)))
    assert panel._folder.visible
    by_hand(panel._wanted, 1.0)
    by_hand(panel._wanted, 99.0)
    assert sent == [Seek(20 * S), Seek(30 * S)]


def test_the_page_is_told_where_the_run_is_and_how_far_it_is_known() -> None:
    """In seconds since the start."""
    rows = np.zeros(7, SERIES_DTYPE)
    ahead = Ahead(time_ns=30 * S, whole=True, series=rows)
    now = Snapshot(playback=RECORDING, ahead=ahead, series=rows[:3])
    expected = {"at": 2.0, "begin": 0.0, "end": 50.0, "known": 20.0, "whole": True, "rows": 3, "state": "paused"}
    assert told(play_script(now)) == expected
    assert told(play_script(replace(now, ahead=Ahead())))["known"] == 2.0
    stream = PlaybackStatus("playing", True, 12 * S, 10 * S, kept_ns=(11 * S, 12 * S))
    there = told(play_script(replace(now, playback=stream)))
    assert (there["begin"], there["end"]) == (1.0, 2.0)


def test_a_mark_is_sent_with_a_time_that_reaches_its_scan() -> None:
    """Milliseconds are rounded up; of very many marks some are left out, over the whole run."""
    mark = Mark("bad_match", 10 * S + 1_000_001, 4, "</script>")
    assert told(marks_script((mark,), 10 * S)) == [[0.002, "bad_match", 4, "</script>"]]
    many = tuple(replace(mark, time_ns=i * S) for i in range(2 * MOST + 2))
    some = told(marks_script(many, 0))
    assert len(some) <= MOST
    assert some[-1][0] > 0.99 * len(many)


def test_marks_are_looked_for_as_the_run_grows(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not with each scan, but some times a second, and at once for another run."""
    now = [100.0]
    monkeypatch.setattr(timeline, "monotonic", lambda: now[0])
    panel, _ = panel_of(scene, RECORDING)
    rows = np.zeros(9, SERIES_DTYPE)
    rows["time_s"] = 0.1 * np.arange(9)
    rows["tracking"][[2, 8]] = TRACKING.index("lost")

    def lost(known: int, lineage: int = 0) -> int:
        ahead = Ahead(lineage=(lineage, 0), series=rows[:known])
        script = panel._marks_script(Snapshot(playback=RECORDING, ahead=ahead))
        return sum(kind == "lost" for _, kind, *_ in told(script))

    assert lost(4) == 1
    rows["time_s"][8] = 5.0
    assert lost(9) == 1
    now[0] += 1.0
    assert lost(9) == 2
    assert lost(2, lineage=1) == 0


def test_the_page_knows_the_title_and_the_shape_of_every_kind() -> None:
    """And which column tells the updates of the map."""
    script = (resource_folder("static") / "timeline.js").read_text(encoding="utf-8")
    shapes = script[script.index("const SHAPES") : script.index("const paths")]
    assert set(re.findall(r"^    (\w+): \[", shapes, re.MULTILINE)) == set(TITLES)
    assert all(title in container("a", "b") for title in TITLES.values())
