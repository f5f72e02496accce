"""Figures become rows, and nothing in them is hidden."""

from pathlib import Path

from benchmarks import tables
from benchmarks.accuracy import CorridorOutcome, Outcome, Outcomes, Replay
from benchmarks.cases import Drive, Recording
from benchmarks.ghosts import HallOutcome
from benchmarks.others import KISS, OURS, Judged
from benchmarks.strays import GlassOutcome
from hectorscope.simulation import SceneOptions

DRIVE = Drive("40 Hz", SceneOptions(), 0.02)


def cells(markdown: str) -> list[list[str]]:
    """Rows below the head."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in markdown.splitlines()[2:]]


def seeds(full_raw: list[float], bare_raw: float = 0.1) -> list[Outcomes]:
    """The full method with inertial data varies over the seeds; the others do not."""
    others = Outcome(bare_raw, 0.05)
    kinds = [("paper", True), ("paper", False), ("full", False)]
    return [{("full", True): Outcome(raw, 0.5 * raw), **dict.fromkeys(kinds, others)} for raw in full_raw]


def test_a_table_is_markdown() -> None:
    """A head, a rule, a line a row."""
    assert tables.table(("a", "b"), [("1", "2")]) == "| a | b |\n| --- | --- |\n| 1 | 2 |\n"


def test_a_drive_shows_median_and_worst_in_centimetres() -> None:
    """Rows with inertial data come before those without; paper stands left of full."""
    with_imu, without = cells(tables.drives({DRIVE: seeds([0.010, 0.012, 0.019])}))
    assert with_imu == [
        "40 Hz",
        "yes",
        *["10.00 / 10.00", "5.00 / 5.00"],
        "1.20 / 1.90",
        "0.60 / 0.95",
        "2.0",
        "yes",
    ]
    assert without[1] == "no" and without[-2:] == ["not lost", "yes"]


def test_every_seed_counts_for_the_goal() -> None:
    """One seed beyond the goal is enough to miss it, and is counted; without inertial data lost runs are."""
    with_imu, without = cells(tables.drives({DRIVE: seeds([0.010, 0.012, 0.021], bare_raw=1.1)}))
    assert with_imu[-1] == "2 of 3"
    assert without[-1] == "0 of 3"


def test_the_other_start_is_judged_alike() -> None:
    """Raw and aligned in centimetres by both methods, the goal, and how many hold it."""
    runs = [Outcome(raw, 0.5 * raw) for raw in (0.010, 0.012, 0.021)]
    rows = cells(tables.squares({DRIVE: [(run, Outcome(0.005, 0.001)) for run in runs]}))
    assert rows == [["40 Hz", "1.20 / 2.10", "0.60 / 1.05", "0.50 / 0.50", "0.10 / 0.10", "2.0", "2 of 3", "yes"]]


def test_lost_runs_are_counted() -> None:
    """Beyond a metre a run is lost, also one that came to no number at all."""
    row = cells(tables.drives({DRIVE: seeds([0.01, 1.5, float("nan")])}))[0]
    assert row[4].endswith(", lost 2 of 3")
    assert not Outcome(1.0, 1.0).lost


def test_the_corridor_shows_the_seed_that_held_least() -> None:
    """Errors: the largest is the worst. Share within the claim: the smallest is."""
    runs = [CorridorOutcome(1.0 + i, 0.01, 2.0 + i, 0.5, 1.0, 0.9 - 0.1 * i) for i in range(3)]
    paper, full = cells(tables.corridor([{"paper": run, "full": run} for run in runs]))
    assert paper[1:] == full[1:]
    assert full == ["full", "2.000 / 3.000 m", "3.000 / 4.000 m", "0.010 / 0.010 m", "0.500 / 0.500 m",
                    "100 / 100 %", "80 / 70 %"]  # fmt: skip


def test_a_single_ghost_misses_the_goal() -> None:
    """Median and worst of ghosts and times; one seed with a ghost is enough."""
    clean, haunted = (HallOutcome(Outcome(0.02, 0.01), n, 3.0 + n) for n in (0, 4))
    paper, full = cells(tables.halls([{"paper": haunted, "full": clean}, {"paper": clean, "full": clean}]))
    assert paper == ["paper", "2 / 4", "5.0 / 7.0 s", "no"]
    assert full == ["full", "0 / 0", "3.0 / 3.0 s", "yes"]


def test_what_pulls_a_match_shows_both_methods_side_by_side() -> None:
    """Centimetres, paper before full; the flicker of glass is the median and the worst seed's share."""
    fine, astray = Outcome(0.02, 0.01), Outcome(1.5, 0.5)
    rows = cells(tables.pulled({"dust": [{"paper": astray, "full": fine}, {"paper": fine, "full": fine}]}))
    assert rows == [
        ["dust", "76.00 / 150.00, lost 1 of 2", "25.50 / 50.00", "2.00 / 2.00", "1.00 / 1.00"],
    ]
    seeds = [dict.fromkeys(("paper", "full"), GlassOutcome(fine, fine, share)) for share in (0.2, 0.3, 0.7)]
    assert cells(tables.panes(seeds)) == [["paper", "30 / 70 %"], ["full", "30 / 70 %"]]


def test_recordings_with_and_without_truth_are_apart() -> None:
    """Errors and goal for the one, the way from start to end and what was refused for the other."""
    scored = Replay(9, Outcome(0.02, 0.0144), 0.1, ())
    free = Replay(7, None, 1.25, ("12 x /imu: not in SI units",), returned=0.913)
    results = {
        Recording("with", Path("a"), 0.0143): {"paper": scored, "full": scored},
        Recording("without", Path("b")): {"paper": free, "full": free},
    }
    expected = ["with", "9", "0.0200", "0.0144", "0.0200", "0.0144", "0.0143", "no"]
    assert cells(tables.replays(results)) == [expected]
    assert cells(tables.returns(results)) == [
        ["without", "7", *["1.25 m", "91 %"] * 2, "12 x /imu: not in SI units"]
    ]


def test_medians_of_errors_are_over_the_recordings_with_a_truth() -> None:
    """A row a recording and method, then one a method; without a truth only time and way count."""
    runs = [Judged(0.01 * k, 0.02, 0.01 * k, 0.5, 1.0 * k) for k in (1, 3)]
    free = Judged(None, None, None, 0.25, 9.0)
    results = {
        Recording(name, Path(name)): {OURS: ours, KISS: free}
        for name, ours in zip("abc", [*runs, free], strict=True)
    }
    rows = cells(tables.others(results))
    assert rows[0] == ["a", OURS, "0.0100", "0.0100", "0.0200", "0.50 m", "1.00"]
    assert rows[1] == ["a", KISS, "-", "-", "-", "0.25 m", "9.00"]
    assert rows[6:] == [
        ["median", OURS, "0.0200", "0.0200", "0.0200", "-", "3.00"],
        ["median", KISS, "-", "-", "-", "-", "9.00"],
    ]
