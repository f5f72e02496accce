import pytest

from hectorscope.session.event_log import LINES, EventLog
from hectorscope.session.snapshot import LogEntry

S = 1_000_000_000


class Clock:
    """Seconds of a person's time, set by the test."""

    now = 0.0

    def __call__(self) -> float:
        """Now."""
        return self.now


def test_a_drag_is_one_line() -> None:
    """Changes of one setting at nearly the same time of the person fold into first → last; others stay apart."""
    clock = Clock()
    journal = EventLog(clock)
    for clock.now, time_ns, text in (
        (0.0, 0, "fusion.omega: 0.1 → 0.2"),
        (0.5, S // 2, "fusion.omega: 0.2 → 0.3"),
        (1.0, S, "fusion.omega: 0.3 → 0.4"),
        (1.0, S, "map.levels: 3 → 2"),
        (9.0, 9 * S, "map.levels: 2 → 3"),
        (9.0, 9 * S, "Started again with an empty map"),
    ):
        journal.add(LogEntry(time_ns, text))
    assert [(e.time_ns, e.text) for e in journal.entries] == [
        (S, "fusion.omega: 0.1 → 0.4"),
        (S, "map.levels: 3 → 2"),
        (9 * S, "map.levels: 2 → 3"),
        (9 * S, "Started again with an empty map"),
    ]


def test_what_happens_while_the_recording_rests_is_not_one_drag() -> None:
    """Neither do changes fold that a person makes one after the other, nor one that takes the last one back."""
    clock = Clock()
    journal = EventLog(clock)
    texts = ["fusion.omega: 0.02 → 0.5", "fusion.omega: 0.5 → 0.3", "fusion.omega: 0.3 → 0.5"]
    for clock.now, text in zip((0.0, 5.0, 5.1), texts, strict=True):
        journal.add(LogEntry(0, text))
    assert [entry.text for entry in journal.entries] == texts


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
