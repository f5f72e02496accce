"""The document that is made of the tables."""

import math
from pathlib import Path

import numpy as np

from benchmarks.accuracy import CorridorOutcome, Outcome, Replay
from benchmarks.cases import METHODS, Drive, Recording
from benchmarks.document import Accuracy, document, judged_anew, judgement, processor, side_by_side, timed_anew
from benchmarks.ghosts import HallOutcome
from benchmarks.inertial import Ride
from benchmarks.others import INSTALLED, OURS, Judged
from benchmarks.outage import Outage
from benchmarks.performance import MARKS
from benchmarks.strays import GlassOutcome, Struck
from benchmarks.whole_map import Finding
from hectorscope.run.metrics import PARTS
from hectorscope.simulation import SceneOptions
from slam_core.config.presets import PAPER
from slam_core.results import NavigationState
from tests.conftest import ROOT

SPEED = {
    "arena": {
        "scans": {"used": 2381},
        "truth": {"aligned_rmse_m": 0.0061, "raw_rmse_m": 0.0072, "roll_rms_deg": 0.11, "pitch_rms_deg": 0.15},
        "realtime_factor": 36.4,
        "median_us": dict.fromkeys(PARTS, 99.6),
    }
}


def leaning(angle: float) -> Ride:
    """Three samples at rest whose up is that many degrees off; the device has no opinion."""
    up = np.tile([0.0, 0.0, 1.0], (3, 1))
    lean = np.tile([math.sin(math.radians(angle)), 0.0, math.cos(math.radians(angle))], (3, 1))
    start = NavigationState(0, np.eye(1, 19)[0], np.eye(15))
    return Ride(lean, up, np.empty((0, 3)), np.ones(3, bool), start)


def accuracy() -> Accuracy:
    near = Outcome(0.01, 0.005)
    end = CorridorOutcome(1.0, 0.01, 2.0, 0.5, 1.0, 0.9)
    drive = Drive("40 Hz", SceneOptions(), 0.02)
    return Accuracy(
        {drive: [{(method, imu): near for method in METHODS for imu in (True, False)}]},
        {drive: [(near, near)]},
        {"rooms, sway": [(near, near)]},
        [dict.fromkeys(METHODS, end)],
        [dict.fromkeys(METHODS, HallOutcome(near, 0, 2.5))],
        [dict.fromkeys(METHODS, near)],
        [dict.fromkeys(METHODS, GlassOutcome(near, near, 0.42))],
        [{Struck(40.0, 0.1, missing=False): dict.fromkeys(METHODS, near)}],
        {"satellites": [Outage(0.03, 0.04, 0.01)]},
        {Recording("jackal", Path("a"), 0.0143): dict.fromkeys(METHODS, Replay(414, near, 1.0, ()))},
        {Recording("jarvis", Path("c")): {OURS: Judged(0.0141, 0.03, 0.0142, 1.6, 0.43)}} if INSTALLED else {},
        {Recording("razor", Path("b")): leaning(2.5)},
    )


def test_the_document_holds_every_table_and_says_what_paper_means() -> None:
    """A row of each table is there, with the machine and each setting that makes the method of the paper."""
    found = Finding("site", (100.0, 99.6), 93, 0, 100, 1, 100, [0.5, 0.7, 1.7], [0.9])
    given = "| its reading |\n", "| a start |\n", "| a part |\n", "| a step |\n", "| its growth |\n"
    text = document(SPEED, *given, [found]) + judgement(accuracy())
    for row in (
        "| arena | 2381 |",
        "| arena | 100 |",
        *(row.strip() for row in given),
        "| site | 100 x 100 m | 93 of 100 | 0 | 1 of 100 | 0.70 / 1.70 s | 0.90 / 0.90 s |",
        "| 40 Hz | yes | 1.00",
        "| 40 Hz | 1.00 / 1.00 |",
        "| rooms, sway | 1.00 / 1.00 | 0.50 / 0.50 | 1.00 / 1.00 | 0.50 / 0.50 |",
        "| full | 1.000",
        "| full | 0 / 0 | 2.5 / 2.5 s | yes |",
        "| people | 1.00 / 1.00 |",
        "| stray beams, 10% at 40 Hz | 1.00",
        "| full | 42 / 42 % |",
        "| satellites | 0.030",
        "| jackal | 414 |",
        "| razor | 3 | 2.5° | - | - |",
        "| jarvis | Hectorscope | 0.0141 |" if INSTALLED else "Not measured",
    ):
        assert row in text
    assert processor() in text
    assert all(f"`{name}`" in text for name in PAPER)


def test_what_was_measured_of_speed_outlives_another_judgement() -> None:
    """Speed belongs to a machine: whoever judges again elsewhere replaces the second part alone, or the first."""
    speed = document(SPEED, *["| a row |\n"] * 5, [])
    once = judged_anew(speed + judgement(accuracy()).replace("jackal", "nobody"), accuracy())
    assert once == judged_anew(once, accuracy()) == speed + judgement(accuracy())
    assert timed_anew(once.replace("a row", "a slow row"), speed) == once


def test_without_the_others_the_document_says_how_to_get_them() -> None:
    """Where nothing was compared there is no table, but the command that installs what is missing."""
    assert "pip install -e '.[bench]'" in side_by_side({})


def test_the_readme_has_one_place_for_results() -> None:
    """The block between the marks can be replaced, and nothing around it."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    written, count = MARKS.subn("new\n", readme)
    assert count == 1
    before, after = readme.split(MARKS.findall(readme)[0])
    assert written == f"{before}new\n{after}"
