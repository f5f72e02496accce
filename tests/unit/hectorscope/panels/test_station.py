"""What the tab of the station asks for and tells."""

import json
from dataclasses import replace

import numpy as np
import pytest

from hectorscope.common.robot_link import RobotLink, TopicLink
from hectorscope.panels._link import link_html
from hectorscope.panels._request import FARTHEST, BadRequest
from hectorscope.panels.station import command, script_of
from hectorscope.run.annotations import LONGEST, Annotation
from hectorscope.session.commands import Configure
from hectorscope.session.station_commands import (
    EditMark,
    PutMark,
    PutPicture,
    Record,
    RemoveMark,
    SetPose,
    ShowReturn,
)
from hectorscope.session.station_state import StationState
from tests.page import room_snapshot

ASKED = {
    '{"mark": ["victim", 1, 2.5, "two"]}': PutMark("victim", 1.0, 2.5, "two"),
    '{"edit": [3, "door", ""]}': EditMark(3, "door", ""),
    '{"picture": [3, "AAEC"]}': PutPicture(3, b"\x00\x01\x02"),
    '{"remove": 3}': RemoveMark(3),
    '{"pose": [1e99, 2, 1]}': SetPose(FARTHEST, 2.0, 1.0),
    '{"way": true}': ShowReturn(True),
    '{"record": false}': Record(False),
    '{"mapping": false}': Configure("map.update", False),
}
REFUSED = (
    '{"mark": ["gold", 1, 2, ""]}', '{"mark": ["note", "1", 2, ""]}', '{"mark": ["note", 1, 2, 3]}',
    '{"mark": ["note", NaN, 2, ""]}', '{"mark": [["note"], 1, 2, ""]}', '{"mark": 1}',
    '{"picture": [3, "../etc"]}',
    '{"picture": [3, null]}', '{"picture": ["a.jpg", "AAEC"]}', '{"remove": 1.5}',
    '{"way": 1}', '{"record": null}', '{"pose": [1, 2]}', '{"pose": [1, 2, Infinity]}', "{}",
)  # fmt: skip


@pytest.mark.parametrize("text", ASKED)
def test_a_request_becomes_a_command(text: str) -> None:
    """With every number in its range."""
    assert command(json.loads(text)) == ASKED[text]


@pytest.mark.parametrize("text", REFUSED)
def test_what_no_script_sends_is_refused(text: str) -> None:
    """Kinds, types and numbers that are none."""
    with pytest.raises(BadRequest):
        command(json.loads(text))


def test_texts_are_cut() -> None:
    """However long the text that a browser sends."""
    made = command({"mark": ["note", 0, 0, "x" * 10_000]})
    assert isinstance(made, PutMark)
    assert len(made.text) == LONGEST


def test_the_page_is_told_in_json() -> None:
    """Marks with their text as text, the way back, and what is recorded."""
    mark = Annotation(1, "note", 0, 1.0, 2.0, (0.0, 0.0, 0.0), '</script>"\\')
    state = StationState((mark,), np.array([[0.0, 0.004]]), True, 2_000_000)
    script = script_of(replace(room_snapshot(), station=state))
    told = json.loads(script.removeprefix("window.hectorscope?.station?.(").removesuffix(")"))
    assert told["marks"] == [[1, "note", 1.0, 2.0, '</script>"\\', ""]]
    assert (told["way"], told["records"], told["recorded"], told["lost"]) == ([[0.0, 0.0]], True, 2.0, False)


def test_the_link_is_a_table_of_topics() -> None:
    """With a word for a topic that is silent; names from outside stay text; nothing without a link."""
    topics = {"/<scan>": TopicLink(40.0, 0.0123, 0.02), "/imu": TopicLink(100.0, 0.5, 4.0)}
    html = link_html(RobotLink(-7200.0, 0.004, topics))
    assert "2.0 h behind" in html
    assert "4 ms" in html
    assert "/&lt;scan&gt;" in html and "<scan>" not in html
    assert "12 ms" in html and "40.0" in html
    assert html.count("<small>silent</small>") == 1
    assert link_html(None) == link_html(RobotLink()) == ""
