"""Marks of a run, found in its rows, settings and warnings."""

from collections.abc import Callable

import numpy as np
import pytest

from hectorscope.inputs import Finding, SourceReport
from hectorscope.run.marks import TITLES, Mark, listed, marks
from hectorscope.run.series import SERIES_DTYPE, TRACKING
from hectorscope.run.settings import Settings
from hectorscope.run.wording import diagnostic_text
from slam_core.diagnostics import Diagnostic

START_NS = 5_000_000_000
Series = np.ndarray


@pytest.fixture
def series() -> Series:
    """Ten seconds at ten scans a second in which all is well; every twentieth is written."""
    rows = np.zeros(100, SERIES_DTYPE)
    rows["time_s"] = 0.1 * np.arange(100)
    rows["fit"], rows["weakest_share"] = 0.9, 0.2
    return rows


def found(series: Series, settings: Settings = Settings(), **more: object) -> tuple[Mark, ...]:  # noqa: B008
    return marks(series, START_NS, settings, SourceReport(), **more)  # type: ignore[arg-type]


def state(word: str) -> int:
    return TRACKING.index(word)  # type: ignore[arg-type]


def test_a_run_in_which_all_is_well_has_no_marks(series: Series):
    """Nor has one without a scan."""
    assert found(series) == found(series[:0]) == ()


def lose(series: Series) -> None:
    series["tracking"][40:50], series["tracking"][50] = state("lost"), state("recovered")


def reject(series: Series) -> None:
    series["tracking"][[30, 31, 35, 70]] = state("degraded")
    series["fit"][31], series["fit"][35] = 0.25, np.nan


def blind(series: Series) -> None:
    series["weakest_share"][20:26] = 0.001


def stay_blind(series: Series) -> None:
    series["weakest_share"][20:60], series["weakest_sigma"][20:60] = 0.001, 10.0
    series["tracking"][40:60], series["fused_sigma_x"][40:60] = state("degraded"), 1.5


def cover(series: Series) -> None:
    series["tracking"][30:33], series["weakest_sigma"][30:33] = state("degraded"), 10.0


def run_down_a_corridor(series: Series) -> None:
    series["weakest_share"][20:60], series["weakest_share"][70:80] = 0.04, 0.04


def keep_the_speed(series: Series) -> None:
    run_down_a_corridor(series)
    series["weakest_sigma"][30:40] = 10.0


def pause(series: Series) -> None:
    series["time_s"][60:] += 2.0


CASES: list[tuple[Callable[[Series], None], list[tuple[str, float, int, str]]]] = [
    (
        lose,
        [("lost", 4.0, 41, "the pose is lost for 0.9 s"), ("recovered", 5.0, 51, "the pose is known again")],
    ),
    (
        reject,
        [
            ("bad_match", 3.0, 31, "3 matches rejected: at worst 25% of the points lie on walls"),
            ("bad_match", 7.0, 71, "1 match rejected: at worst 90% of the points lie on walls"),
        ],
    ),
    (blind, [("degenerate", 2.0, 21, "one direction is not observable for 0.5 s: 0.10% of the beams fix it")]),
    (cover, [("bad_match", 3.0, 31, "3 matches rejected: at worst 90% of the points lie on walls")]),
    (
        stay_blind,
        [("degenerate", 2.0, 21, "one direction is not observable for 3.9 s: 0.10% of the beams fix it")],
    ),
    (run_down_a_corridor, [("weak", 2.0, 21, "few beams fix one direction for 3.9 s: at worst 4.0% of them")]),
    (
        keep_the_speed,
        [
            (
                "weak",
                2.0,
                21,
                "few beams fix one direction for 3.9 s: at worst 4.0% of them, and for a time"
                " it counted as unobservable",
            )
        ],
    ),
    (pause, [("gap", 8.0, 61, "no scan was used for 2.1 s")]),
]


@pytest.mark.parametrize(("spoil", "expected"), CASES, ids=[case[0].__name__ for case in CASES])
def test_what_went_wrong_is_one_mark(
    series: Series, spoil: Callable[[Series], None], expected: list[tuple[str, float, int, str]]
):
    """At the scan with which it began, with its duration or its worst figure; scans close together are one."""
    spoil(series)
    there = [(mark.kind, (mark.time_ns - START_NS) / 1e9, mark.scan, mark.text) for mark in found(series)]
    assert [(kind, pytest.approx(when), scan, text) for kind, when, scan, text in expected] == there


def test_the_threshold_of_each_time_tells_what_is_degenerate(series: Series):
    """Switched off half way, the same share of the beams only tells that few fix it."""
    series["weakest_share"] = 0.001
    settings = Settings().changed(START_NS + 5 * 10**9, "matcher.degeneracy_threshold", 0.0)
    first, weak, setting = found(series, settings)
    assert (first.kind, first.text) == (
        "degenerate",
        "one direction is not observable for 4.9 s: 0.10% of the beams fix it",
    )
    assert (setting.kind, setting.scan, setting.text) == ("setting", 50, "matcher.degeneracy_threshold = 0.0")
    assert (weak.kind, weak.scan) == ("weak", 51)


def test_a_short_stretch_with_few_beams_is_no_mark(series: Series):
    """It takes two seconds until a map gets too long; nor is one that is degenerate as a whole a mark twice."""
    series["weakest_share"][20:40] = 0.04
    assert found(series) == ()
    series["weakest_share"][20:60] = 0.001
    assert [mark.kind for mark in found(series)] == ["degenerate"]


def test_settings_changed_at_once_are_one_mark(series: Series):
    """With the name and the value of each."""
    values = {"fusion.omega": 0.3, "map.factor_free": 0.45}
    (mark,) = found(series, Settings().changed_all(START_NS + 10**9, values))
    assert mark == Mark("setting", START_NS + 10**9, 10, "fusion.omega = 0.3, map.factor_free = 0.45")


def test_warnings_and_findings_are_marks(series: Series):
    """A topic that has stopped is a gap; what the sensor check found is at the start; all are in order of time."""
    silent = diagnostic_text(Diagnostic("imu_silent"))
    warned = {"the map is full": (START_NS + 7, 3), silent: (START_NS + 5, 2)}
    report = SourceReport(findings=(Finding("it is upside down", {}),), repaired=(Finding("it is late", {}),))
    there = marks(series, START_NS, Settings(), report, warned)
    assert [(mark.kind, mark.scan) for mark in there] == [
        ("finding", 0), ("finding", 0), ("gap", 2), ("warning", 3),
    ]  # fmt: skip
    assert [mark.text for mark in there[:2]] == ["it is upside down", "repaired: it is late"]
    assert listed(there, START_NS)[2] == (5e-9, TITLES["gap"], silent)
