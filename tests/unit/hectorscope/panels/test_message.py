"""The message over the scene: the most urgent fact, and nothing while all is well."""

from dataclasses import replace

import pytest

from hectorscope.inputs import SourceReport
from hectorscope.panels._message import SYMBOLS, Kind, message
from hectorscope.panels.message import script_of
from hectorscope.session.snapshot import PlaybackState, PlaybackStatus, Snapshot
from slam_core.results import Rejection, Verdict
from tests.page import room_snapshot

UP, DOWN = (
    SourceReport(connected=True, scan_topic="/scan"),
    SourceReport(connected=False, waiting="nothing listens"),
)


def stream(state: PlaybackState, report: SourceReport = UP, *, scans: int = 0, detail: str = "") -> Snapshot:
    """A live run in some state."""
    return Snapshot(playback=PlaybackStatus(state, live=True, detail=detail), report=report, scans=scans)


@pytest.mark.parametrize(
    ("snapshot", "kind", "title", "detail"),
    [
        (stream("waiting", DOWN), "error", "No connection to the robot", "Nothing listens"),
        (stream("waiting", DOWN, scans=9), "error", "Connection to the robot lost", "Nothing listens"),
        (
            stream("loading", replace(UP, waiting="none is a LaserScan")),
            "error",
            "No laser",
            "None is a LaserScan",
        ),
        (stream("waiting"), "warning", "Waiting for the first scan", "nothing comes from /scan"),
        (stream("waiting", scans=9), "error", "No scans from the robot", "nothing comes from /scan"),
        (stream("loading", replace(UP, skipped={"all NaN": 3})), "warning", "that can be used", "All NaN"),
        (stream("paused", scans=9), "warning", "Paused", "go by unused"),
        (stream("failed", DOWN, detail="IMU in degrees"), "error", "The run has stopped", "IMU in degrees"),
        (stream("playing", scans=9, detail="Catching up: 40"), "busy", "Please wait", "Catching up: 40"),
        (Snapshot(playback=PlaybackStatus("loading", detail="3 of 5")), "busy", "Getting ready", "3 of 5"),
        (stream("loading", detail="48 of 119"), "busy", "Getting ready", "48 of 119"),
        (Snapshot(playback=PlaybackStatus("seeking", detail="Up to 9 s")), "busy", "Please wait", "Up to 9 s"),
        (replace(room_snapshot(), searching="Two places"), "warning", "not found in the map", "Two places"),
    ],
)
def test_the_scene_says_what_is_the_matter(snapshot: Snapshot, kind: Kind, title: str, detail: str) -> None:
    """Each state has its words: what is missing, from where, and what to do."""
    told = message(snapshot)
    assert told is not None
    assert (told.kind, title in told.title, detail in told.detail) == (kind, True, True)


def test_a_lost_pose_is_told_with_its_reason() -> None:
    """Why the matches are rejected, or that a pose found again is not confirmed yet."""
    snapshot = room_snapshot()
    assert snapshot.result is not None
    verdict = Verdict("lost", Rejection("inlier_ratio", 0.2, 0.9), accepted=False)
    told = message(replace(snapshot, result=snapshot.result._replace(verdict=verdict)))
    assert told is not None
    assert told.title == "Tracking lost"
    assert "20% of its points lie on walls" in told.detail
    found = Verdict("lost", confirmed=False)
    told = message(replace(snapshot, result=snapshot.result._replace(verdict=found)))
    assert told is not None
    assert "further scans have to confirm it" in told.detail


def test_nothing_is_told_while_all_is_well() -> None:
    """A recording may rest, its end is no trouble, and a stream may compile while its scans are drawn."""
    for snapshot in (
        stream("loading", replace(UP, skipped={"all NaN": 3}), scans=1),
        room_snapshot(),
        Snapshot(),
        stream("playing", scans=9),
        replace(room_snapshot(), playback=PlaybackStatus("ended")),
    ):
        assert message(snapshot) is None
    assert script_of(None) == "window.hectorscope?.tell?.()"


def test_words_from_outside_stay_words() -> None:
    """A message is data in the script, whatever a robot calls its topics."""
    told = message(stream("failed", detail='");alert(1)//</script>'))
    script = script_of(told)
    assert '\\");alert(1)' in script
    assert f'"symbol": "\\u{ord(SYMBOLS["error"]):04x}"' in script
