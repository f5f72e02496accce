import pytest

from hectorscope.session.event_log import LINES, EventLog
from hectorscope.session.snapshot import LogEntry

S = 1_000_000_000


def test_a_drag_is_one_line() -> None:
    """Changes of one setting close together fold into first → last; others stay apart."""
    journal = EventLog()
    for time_ns, text in (
        (0, "fusion.omega: 0.1 → 0.2"),
        (S // 2, "fusion.omega: 0.2 → 0.3"),
        (S, "fusion.omega: 0.3 → 0.4"),
        (S, "map.levels: 3 → 2"),
        (9 * S, "map.levels: 2 → 3"),
        (9 * S, "Started again with an empty map"),
    ):
        journal.add(LogEntry(time_ns, text))
    assert [(e.time_ns, e.text) for e in journal.entries] == [
        (S, "fusion.omega: 0.1 → 0.4"),
        (S, "map.levels: 3 → 2"),
        (9 * S, "map.levels: 2 → 3"),
        (9 * S, "Started again with an empty map"),
    ]


def test_a_long_drag_does_not_push_out_what_happened_before() -> None:
    """It is told anew and not added, however often the hand moved."""
    journal = EventLog()
    journal.add(LogEntry(0, "The pose is lost", "warning"))
    for k in range(2 * LINES):
        journal.add(LogEntry(0, f"fusion.omega: {k} → {k + 1}"))
    assert [entry.text for entry in journal.entries] == ["The pose is lost", f"fusion.omega: 0 → {2 * LINES}"]


@pytest.mark.parametrize("lines", [LINES, LINES + 7])
def test_the_newest_lines_are_kept(lines: int) -> None:
    """The oldest go first."""
    journal = EventLog()
    for k in range(lines):
        journal.add(LogEntry(k, f"line {k}"))
    assert [entry.time_ns for entry in journal.entries] == list(range(lines - LINES, lines))
