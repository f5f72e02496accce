import math
from dataclasses import replace

import numpy as np
import pytest

from hectorscope.inputs import SourceReport
from hectorscope.page.scene import Display
from hectorscope.panels._dials import turn_css
from hectorscope.panels.attitude import is_planar, numbers_html
from hectorscope.panels.log import answers, log_html
from hectorscope.panels.match import legend_html, match_html, sigmas_html
from hectorscope.panels.status import REASONS_SHOWN, losses_html, run_html
from hectorscope.panels.transport import clock_html, name_of_speed, undo_words
from hectorscope.run.marks import WEAK
from hectorscope.session.snapshot import LogEntry, PlaybackState, PlaybackStatus, Snapshot, UndoOffer
from hectorscope.session.transport import PAUSED
from slam_core.diagnostics import NO_ATTITUDE
from slam_core.results import Verdict
from tests.page import room_snapshot, without_filter

S = 1_000_000_000


def test_the_status_tells_where_the_run_is() -> None:
    """Source, state, time since the start, scan rate and real-time factor."""
    playback = PlaybackStatus("playing", False, 70 * S, 10 * S, 100 * S, 1.0, 1.5, 39.96)
    html = run_html(Snapshot(source="arena.bag", playback=playback))
    for part in ("arena.bag", ">playing<", "01:00.0", "40.0 Hz", "×1.50"):
        assert part in html


@pytest.mark.parametrize("state", ["paused", "ended", "failed", "waiting"])
def test_a_run_that_stands_has_no_rates(state: PlaybackState) -> None:
    """No scans a second and no speed, whatever was measured last."""
    html = run_html(Snapshot(playback=PlaybackStatus(state, True, scan_rate=40.0, realtime_factor=1.0)))
    assert f">{state}<" in html
    assert "40.0 Hz" not in html
    assert html.count("</small>–<") == 2


@pytest.mark.parametrize(
    ("report", "state", "words"),
    [
        (SourceReport(connected=True), "playing", "✓ robot"),
        (SourceReport(connected=True), "waiting", "… robot: no scans"),
        (SourceReport(connected=True, waiting="no laser"), "loading", "… robot: no scans"),
        (SourceReport(connected=False, waiting="gone"), "waiting", "✕ robot: no link"),
    ],
)
def test_the_two_links_are_told_apart(report: SourceReport, state: PlaybackState, words: str) -> None:
    """That of the page to the server, and that of the server to the robot, by symbols and words."""
    html = run_html(Snapshot(report=report, playback=PlaybackStatus(state, live=True)))
    assert f">{words}</span>" in html
    assert "✓ server" in html
    assert "robot:" not in run_html(Snapshot(report=SourceReport()))


def test_the_status_tells_of_a_saved_map() -> None:
    """The mode beside the state, or that and why the robot is still sought; nothing of either in a plain run."""
    saved = Snapshot(playback=PlaybackStatus("playing"), mode="localise")
    assert ">localise<" in run_html(saved)
    html = run_html(replace(saved, searching="the scan fits in 2 places of the map alike"))
    for part in (">searching<", "fits in 2 places"):
        assert part in html
    plain = run_html(Snapshot(playback=PlaybackStatus("playing")))
    assert "localise" not in plain
    assert "searching" not in plain


def test_nothing_from_outside_becomes_html() -> None:
    """Names of files, reasons and log lines are escaped wherever they are shown."""
    bad = "<script>"
    shown = [
        run_html(Snapshot(source=bad, playback=PlaybackStatus("failed", detail=bad))),
        losses_html(SourceReport({}, {bad: 1}, 0), {bad: bad}),
        log_html((LogEntry(0, bad),), 0),
    ]
    assert all(bad not in html and "&lt;script&gt;" in html for html in shown)


def test_losses_are_counted_and_explained() -> None:
    """Skipped counts add up, each reason is named, too many are summed up, and a clean run says nothing more."""
    html = losses_html(SourceReport({}, {"/scan: all NaN": 3, "/imu: late": 4}, 2), {})
    assert ">skipped</small>7<" in html
    assert ">dropped</small>2<" in html
    assert "3 × /scan: all NaN" in html
    many = {f"reason {i}": 1 for i in range(REASONS_SHOWN + 5)}
    assert "and 5 more reasons" in losses_html(SourceReport({}, many, 0), {})
    assert "<ul" not in losses_html(SourceReport(), {})


def test_the_initial_alignment_is_no_alarm() -> None:
    """Nor is a pause: scans are counted and explained, but only what is skipped besides stands out."""
    html = losses_html(SourceReport({}, {NO_ATTITUDE: 19, PAUSED: 80}, 0), {})
    assert ">skipped</small>99<" in html
    assert "hs-bad" not in html
    assert "hs-bad" in losses_html(SourceReport({}, {NO_ATTITUDE: 19, "/scan: all NaN": 1}, 0), {})


def test_warnings_come_first_among_the_losses() -> None:
    """What is wrong at this moment is counted, and told before what was skipped; escaped."""
    html = losses_html(SourceReport({}, {"/scan: all NaN": 3}, 0), {}, ("no inertial data comes", "<b>"))
    assert ">warnings</small>! 2<" in html
    assert html.index("no inertial data comes") < html.index("/scan: all NaN")
    assert "<b>" not in html


def test_a_view_that_broke_is_named() -> None:
    """What was switched off is told on the page."""
    assert "Scan is switched off: ValueError" in losses_html(SourceReport(), {"Scan": "ValueError"})


def test_the_log_shows_the_newest_first() -> None:
    """With times since the start of the recording and the number of the scan."""
    html = log_html((LogEntry(5 * S, "one"), LogEntry(7 * S, "two", "warning", scans=81)), 5 * S)
    assert html.index("two") < html.index("one")
    assert "00:02.0<small>scan 81</small>" in html
    assert "scan 0" not in html
    assert "button" not in html


def test_a_time_in_the_log_leads_there() -> None:
    """It carries its seconds, rounded up, so that the scan of that moment is reached."""
    html = log_html((LogEntry(7 * S + 1_234_001, "lost"),), 5 * S, jumps=True)
    assert 'data-hs-seconds="2.002"' in html


def test_an_answer_is_told_once() -> None:
    """What was there before is not told again, nor what answers nobody."""
    first, second = LogEntry(S, "Saved a", answer=True), LogEntry(2 * S, "Saved b", answer=True)
    log = (LogEntry(0, "The pose is lost"), first, second)
    assert answers(log, ()) == [first, second]
    assert answers(log, log[:2]) == [second]
    assert answers(log, log) == []


def test_what_nobody_measures_is_a_dash() -> None:
    """Without a filter, a run whose roll, pitch and height never left zero is planar."""
    snapshot = room_snapshot()
    assert not is_planar(snapshot)
    level = without_filter(snapshot)
    assert is_planar(level)
    tilted = level.series.copy()
    tilted["roll"][-1] = 0.1  # told by tf
    assert not is_planar(replace(level, series=tilted))
    pose = dict.fromkeys(("x", "y", "z", "roll", "pitch", "yaw"), 0.0)
    assert "</small>0.00 m" in numbers_html(pose, planar=True)
    assert numbers_html(pose, planar=True).count("–") == 3
    assert "–" not in numbers_html(pose)


def test_the_legend_names_what_is_there() -> None:
    """No truth where there is none, no ellipsoid without a filter, no residuals where nothing shows them."""
    full, display = room_snapshot(), Display()
    for part in ("trajectory", "truth", "position", "ellipses of 200 σ", "residual", "unexpected"):
        assert part in legend_html(full, display)
    bare = replace(without_filter(full), truth=np.empty((0, 8)))
    html = legend_html(bare, Display(points="plain"))
    assert [part for part in ("truth", "position", "residual", "unexpected") if part in html] == []
    assert 'data-hs-layer="trajectory"' in html


def test_the_match_says_whether_it_converged_and_is_believed() -> None:
    """Mean residual, iterations, outcome, state, weakest direction, beams left out; a first scan has no match."""
    snapshot = room_snapshot()
    result = snapshot.result
    assert result is not None
    assert result.match is not None
    html = match_html(result, snapshot)
    for part in ("Converged", "3 · 4 · 4", "0.500", "</small>✓ tracking", "weakest σ</small>2.0 mm"):
        assert part in html
    assert "left out" not in html
    two = np.array([0, 2])
    assert "2 beams on objects that may move were left out." in match_html(
        result._replace(match=result.match._replace(left_out=two)), snapshot
    )
    slow = result._replace(match=result.match._replace(converged=False), verdict=Verdict("lost"))
    assert "Out of steps" in match_html(slow, snapshot)
    assert "</small>✕ lost" in match_html(slow, snapshot)
    assert "first scan" in match_html(result._replace(match=None), snapshot)


def test_support_by_few_beams_is_worth_a_worry() -> None:
    """And where so few do that the match leaves it to the prediction, that is said instead."""
    snapshot = room_snapshot()
    assert snapshot.result is not None
    assert snapshot.result.match is not None
    for share, unobservable, words in (
        (0.04, (0.0, 0.0), "Few beams fix the position along a direction now"),
        (0.001, (0.0, 1.0), "Too few beams fix the position along a direction now"),
    ):
        match = snapshot.result.match._replace(weakest_share=share, unobservable=np.array(unobservable))
        html = match_html(snapshot.result._replace(match=match), snapshot)
        assert f'hs-bad" title="{words}.' in html
    assert "along a direction now" not in match_html(snapshot.result, snapshot)
    assert f"Worry below {100 * WEAK:.0f} %" in match_html(snapshot.result, snapshot)


def test_sigmas_are_millimetres_and_degrees() -> None:
    """A missing covariance is a dash."""
    row = room_snapshot().series[-1].copy()
    row["match_sigma_x"], row["match_sigma_yaw"], row["prior_sigma_x"] = 0.0123, math.radians(0.5), math.nan
    html = sigmas_html(row)
    assert "<td>12.3</td>" in html
    assert "<td>0.50</td>" in html
    assert "<td>–</td>" in html


def test_the_horizon_turns_against_the_robot() -> None:
    """Right side down (roll > 0) turns the horizon left; nose down (pitch > 0) lifts it; NaN keeps it level."""
    assert "--hs-roll:-10.0deg" in turn_css("hs-attitude", math.radians(10), 0.0, 0.0)
    assert "--hs-lift:-16.0px" in turn_css("hs-attitude", 0.0, math.radians(10), 0.0)
    assert "--hs-yaw:-90.0deg" in turn_css("hs-attitude", 0.0, 0.0, math.pi / 2)
    assert "--hs-roll:0.0deg" in turn_css("hs-attitude", math.nan, math.nan, math.nan)


@pytest.mark.parametrize(
    ("speed", "name"), [(1.0, "1×"), (0.1, "0.1×"), (math.inf, "max"), (1.9, "2×"), (1e9, "10×"), (0.0, "0.1×")]
)
def test_a_speed_shows_as_the_nearest_on_offer(speed: float, name: str) -> None:
    """The command line may ask for any speed."""
    assert name_of_speed(speed) == name


def test_the_clock_of_a_stream_has_no_end() -> None:
    """A recording shows its length, a stream says live."""
    assert "/ 00:58.0" in clock_html(PlaybackStatus(end_ns=58 * S))
    assert "live" in clock_html(PlaybackStatus(live=True))


def test_an_undo_says_what_it_takes_back_and_for_how_long() -> None:
    """Whole seconds, rounded up, and no more than fits into the bar."""
    assert undo_words(UndoOffer("restart", 160.0), 117.3) == "Undo restart · 43 s"
    assert undo_words(UndoOffer("x" * 99, 100.0), 200.0) == f"Undo {27 * 'x'}… · 0 s"
