"""Figures as Markdown. A pair `a / b` is the median and the worst over the seeds."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from statistics import median
from typing import Any

from benchmarks.accuracy import CorridorOutcome, Outcome, Outcomes, Replay
from benchmarks.cases import METHODS, Drive, Recording
from benchmarks.ghosts import HallOutcome
from benchmarks.inertial import Ride
from benchmarks.others import Judged
from benchmarks.outage import Outage
from benchmarks.strays import GlassOutcome
from benchmarks.whole_map import Finding
from hectorscope.run.metrics import PARTS


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Markdown."""
    lines = [list(head), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def speed(results: Mapping[str, dict[str, Any]]) -> str:
    """Errors and speed of whole runs with default settings, a row a recording."""
    head = ("recording", "scans", "error, aligned", "error, raw", "roll", "pitch", "times real time")
    return table(head, ((name, *_speed_cells(figures)) for name, figures in results.items()))


def _speed_cells(figures: dict[str, Any]) -> Iterator[str]:
    truth = figures["truth"]
    yield str(figures["scans"]["used"])
    yield f"{truth['aligned_rmse_m']:.3f} m"
    yield f"{truth['raw_rmse_m']:.3f} m"
    for angle in ("roll_rms_deg", "pitch_rms_deg"):
        yield f"{truth[angle]:.2f}°" if angle in truth else "-"  # a planar run has neither
    yield f"{figures['realtime_factor']:.0f}"


def times(results: Mapping[str, dict[str, Any]]) -> str:
    """Median microseconds of each part of a scan's step."""
    rows = ((name, *(f"{figures['median_us'][part]:.0f}" for part in PARTS)) for name, figures in results.items())
    return table(("recording", *PARTS), rows)


def drives(results: Mapping[Drive, Sequence[Outcomes]]) -> str:
    """Errors in centimetres in the rooms, with and without inertial data; yes: every seed holds the goal."""
    head = ("drive", "IMU", *_both("raw", "aligned"), "goal, raw", "full holds it")
    return table(
        head, (_drive_row(drive, seeds, imu) for imu in (True, False) for drive, seeds in results.items())
    )


def _drive_row(drive: Drive, seeds: Sequence[Outcomes], imu: bool) -> Iterator[str]:
    yield drive.name
    yield "yes" if imu else "no"
    for method in METHODS:
        runs = [seed[method, imu] for seed in seeds]
        yield spread([100 * run.raw for run in runs], ".2f") + _lost(runs)
        yield spread([100 * run.aligned for run in runs], ".2f")
    full = [seed["full", imu] for seed in seeds]
    yield f"{100 * drive.goal_m:.1f}" if imu else "not lost"
    yield _held([run.raw <= drive.goal_m if imu else not run.lost for run in full])


def squares(results: Mapping[Drive, Sequence[tuple[Outcome, Outcome]]]) -> str:
    """Errors in centimetres of the same drives from another start, by cells alone and by the full method."""
    methods = (f"{method}, {error}" for method in ("cells alone", "full") for error in ("raw", "aligned"))
    head = ("drive", *methods, "goal, raw", "cells alone hold it", "full holds it")
    return table(head, (_square_row(drive, runs) for drive, runs in results.items()))


def _square_row(drive: Drive, seeds: Sequence[tuple[Outcome, Outcome]]) -> Iterator[str]:
    yield drive.name
    yield from _compared(seeds)
    yield f"{100 * drive.goal_m:.1f}"
    for runs in zip(*seeds, strict=True):
        yield _held([run.raw <= drive.goal_m for run in runs])


def localised(results: Mapping[str, Sequence[tuple[Outcome, Outcome]]]) -> str:
    """Errors in centimetres of drives in a map that another one left."""
    head = ("drive", *(f"{method}, {error}" for method in ("cells alone", "full") for error in ("raw", "aligned")))
    return table(head, ((name, *_compared(runs)) for name, runs in results.items()))


def _compared(seeds: Sequence[tuple[Outcome, Outcome]]) -> Iterator[str]:
    for runs in zip(*seeds, strict=True):
        yield spread([100 * run.raw for run in runs], ".2f") + _lost(runs)
        yield spread([100 * run.aligned for run in runs], ".2f")


def corridor(seeds: Sequence[Mapping[str, CorridorOutcome]]) -> str:
    """Errors, sigmas, and how often the sigmas contained the errors, a row a method."""
    sigmas = ("its sigma while open", "within 3 sigma, while open", "within 3 sigma, all")
    head = ("method", "along, rms", "along, at the end", "across, rms", *sigmas)
    return table(head, (_corridor_row(method, [seed[method] for seed in seeds]) for method in seeds[0]))


def _corridor_row(method: str, runs: Sequence[CorridorOutcome]) -> Iterator[str]:
    yield method
    columns: tuple[Callable[[CorridorOutcome], float], ...] = (
        lambda run: run.along,
        lambda run: run.along_end,
        lambda run: run.across,
        lambda run: run.sigma_end,
    )
    for column in columns:
        yield spread([column(run) for run in runs], ".3f") + " m"
    yield _least([run.held_open for run in runs])
    yield _least([run.held for run in runs])


def _least(shares: Sequence[float]) -> str:
    """Median and smallest share of the scans."""
    return f"{100 * median(shares):.0f} / {100 * min(shares):.0f} %"


def outages(results: Mapping[str, Sequence[Outage]]) -> str:
    """Errors in metres around an outage, a row a kind."""
    head = ("what fails", "error at return", "worst after", "largest jump")
    return table(head, ((name, *_outage_cells(runs)) for name, runs in results.items()))


def _outage_cells(runs: Sequence[Outage]) -> Iterator[str]:
    for name in ("at_return", "after", "jump"):
        yield spread([getattr(run, name) for run in runs], ".3f") + " m"


def halls(seeds: Sequence[Mapping[str, HallOutcome]]) -> str:
    """The ghosts that people leave, a row a method."""
    head = ("method", "ghost cells", "longest in sight", "goal held")
    return table(head, (_halls_row(method, [seed[method] for seed in seeds]) for method in METHODS))


def _halls_row(method: str, runs: Sequence[HallOutcome]) -> Iterator[str]:
    yield method
    yield spread([run.ghosts for run in runs], ".0f")
    yield spread([run.longest for run in runs], ".1f") + " s"
    yield _yes(not any(run.ghosts for run in runs))


def pulled(cases: Mapping[str, Sequence[Mapping[str, Outcome]]]) -> str:
    """Errors in centimetres with something in the beams' way, a row a case; each has a list over the seeds."""
    head = ("in the way", *_both("raw", "aligned"))
    return table(head, ((name, *_pulled_cells(seeds)) for name, seeds in cases.items()))


def _pulled_cells(seeds: Sequence[Mapping[str, Outcome]]) -> Iterator[str]:
    for method in METHODS:
        runs = [seed[method] for seed in seeds]
        yield spread([100 * run.raw for run in runs], ".2f") + _lost(runs)
        yield spread([100 * run.aligned for run in runs], ".2f")


def panes(seeds: Sequence[Mapping[str, GlassOutcome]]) -> str:
    """How many of the cells along glass come and go, a row a method."""
    head = ("method", "cells along glass that were occupied again")
    rows = ((method, spread([100 * seed[method].flicker for seed in seeds], ".0f") + " %") for method in METHODS)
    return table(head, rows)


def findings(maps: Sequence[Finding]) -> str:
    """How often a robot was found in a saved map, and how long a search took, a row a map."""
    head = ("map", "size", "found", "wrong", "from elsewhere, taken", "search", "search, from elsewhere")
    return table(head, map(_finding_row, maps))


def _finding_row(finding: Finding) -> Iterator[str]:
    yield finding.name
    yield f"{finding.size[0]:.0f} x {finding.size[1]:.0f} m"
    yield f"{finding.found} of {finding.starts}"
    yield str(finding.wrong)
    yield f"{finding.foreign_taken} of {finding.foreign}"
    yield f"{spread(finding.seconds, '.2f')} s"
    yield f"{spread(finding.foreign_seconds, '.2f')} s"


def replays(results: Mapping[Recording, Mapping[str, Replay]]) -> str:
    """Errors in metres on recordings with a truth."""
    head = ("recording", "scans", *_both("raw", "aligned"), "goal, aligned", "full holds it")
    rows = ((recording, methods) for recording, methods in results.items() if methods["full"].truth)
    return table(head, (_replay_row(recording, methods) for recording, methods in rows))


def _replay_row(recording: Recording, methods: Mapping[str, Replay]) -> Iterator[str]:
    yield recording.name
    yield str(methods["full"].scans)
    for method in METHODS:
        truth = methods[method].truth
        assert truth is not None
        yield f"{truth.raw:.4f}{_lost([truth])}"
        yield f"{truth.aligned:.4f}"
    full, goal = methods["full"].truth, recording.goal_m
    yield "-" if goal is None else f"{goal:.4f}"
    yield "-" if goal is None or full is None else _yes(full.aligned <= goal)


def returns(results: Mapping[Recording, Mapping[str, Replay]]) -> str:
    """Metres from the first pose to the last, and whether a run that came back met the map that it had begun."""
    head = ("recording", "scans", *_both("start to end", "last scans on the first map"), "left out")
    rows = (
        (recording, methods)
        for recording, methods in results.items()
        if methods["full"].truth is None or methods["full"].returned is not None
    )
    return table(head, (_return_row(recording, methods) for recording, methods in rows))


def _return_row(recording: Recording, methods: Mapping[str, Replay]) -> Iterator[str]:
    yield recording.name
    yield str(methods["full"].scans)
    for method in METHODS:
        yield f"{methods[method].start_to_end:.2f} m"
        returned = methods[method].returned
        yield "-" if returned is None else f"{100 * returned:.0f} %"
    yield "; ".join(methods["full"].left_out) or "-"


def others(results: Mapping[Recording, Mapping[str, Judged]]) -> str:
    """What evo says of our trajectories and of another's, a row each, and the medians over those with a truth."""
    head = ("recording", "by", "absolute, aligned", "by our own metric", "relative", "start to end", "ms a scan")
    rows = [(recording.name, by, each) for recording, runs in results.items() for by, each in runs.items()]
    methods = dict.fromkeys(by for _, by, _ in rows)
    return table(
        head,
        [
            *((name, by, *_judged_cells(each)) for name, by, each in rows),
            *(("median", by, *_median_cells([each for _, who, each in rows if who == by])) for by in methods),
        ],
    )


def _judged_cells(run: Judged) -> Iterator[str]:
    for error in (run.ape, run.own, run.rpe):
        yield "-" if error is None else f"{error:.4f}"
    yield f"{run.start_to_end:.2f} m"
    yield f"{run.ms:.2f}"


def _median_cells(runs: Sequence[Judged]) -> Iterator[str]:
    for name in ("ape", "own", "rpe"):
        errors = [getattr(run, name) for run in runs if run.ape is not None]
        yield f"{median(errors):.4f}" if errors else "-"
    yield "-"
    yield f"{median(run.ms for run in runs):.2f}"


def inertial(results: Mapping[Recording, Ride]) -> str:
    """Degrees between ways to tell where up is, a row a device."""
    head = ("device", "samples", "at rest: filter to gravity", "device's own to gravity", "filter to own, rms")
    return table(head, (_inertial_row(recording, ride) for recording, ride in results.items()))


def _inertial_row(recording: Recording, ride: Ride) -> Iterator[str]:
    yield recording.name
    yield str(len(ride.ours))
    for angle in (ride.astray, ride.own_astray, ride.apart):
        yield "-" if angle is None else f"{angle:.1f}°"


def spread(values: Sequence[float], form: str) -> str:
    """Median and largest."""
    return f"{median(values):{form}} / {max(values):{form}}"


def _lost(runs: Sequence[Outcome]) -> str:
    count = sum(run.lost for run in runs)
    return f", lost {count} of {len(runs)}" if count else ""


def _both(*columns: str) -> Iterator[str]:
    return (f"{method}, {column}" for method in METHODS for column in columns)


def _held(runs: Sequence[bool]) -> str:
    return "yes" if all(runs) else f"{sum(runs)} of {len(runs)}"


def _yes(met: bool) -> str:
    return "yes" if met else "no"
