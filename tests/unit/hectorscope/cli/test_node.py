"""What a node prints of the log."""

from dataclasses import replace

from hectorscope.cli.node import Told
from hectorscope.session.snapshot import LogEntry
from tests.page import room_snapshot


def test_each_line_of_the_log_is_told_once() -> None:
    """Also one that reads like a line before it; the lines of before are those of the same objects."""
    told, empty = Told(), room_snapshot()
    first = (LogEntry(0, "begun"), LogEntry(1, "saved"))
    assert told.news(replace(empty, log=first)) == ["begun", "saved"]
    assert told.news(replace(empty, log=first)) == []
    assert told.news(replace(empty, log=(*first, LogEntry(1, "saved")))) == ["saved"]
