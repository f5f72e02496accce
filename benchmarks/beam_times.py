"""After how many seconds scans show when their beams are measured, where messages tell it rightly or wrongly.

    python -m benchmarks.beam_times [--seeds 2]

Each scene is driven at 5 and 10 scans a second, with its messages as they are, without `time_increment`, with
the last beam first, and by a laser that measures all beams at once. The sensor check asks every four seconds.
Prints the seconds after which it is sure, for each seed, and the sweep that it names as a share of the true
one; also the worst errors of whole runs, aligned, in metres. It ends with an error where a right timing is
taken for a wrong one, or a wrong one for another that is off by a third.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

from benchmarks.accuracy import outcome, process
from benchmarks.tables import table
from hectorscope.checks.matched_scans import MatchedScans
from hectorscope.checks.sensor_check import STEP_S
from hectorscope.ros.repairs import with_sweep
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import ScenarioName, SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan

SCENES: tuple[ScenarioName, ...] = ("arena", "rooms", "handheld", "people", "glass", "littoral", "offices")
RATES = 5.0, 10.0
KINDS = "as measured", "without times", "last beam first", "all at once"
DURATION = 60.0
SEEDS = 2
PROCESSES = 2
NEAR = 0.3  # of the true sweep
HEAD = ("scene", "scans a second", *KINDS, "error as measured", "error without times")


def scans(scene: ScenarioName, rate: float, kind: str, seed: int) -> tuple[list[LaserScan], float]:
    """Of a drive, as its messages tell them; and how long a sweep takes, negative if they turn it round."""
    options = SceneOptions(
        scan_rate=rate, seed=seed, beams=361, duration=DURATION, beam_timing=kind != "all at once"
    )
    known = [item for item in Simulation(scene, options).items() if isinstance(item, LaserScan)]
    sweep_s = (known[0].end_ns - known[0].stamp_ns) * 1e-9
    if kind == "last beam first":
        return [with_sweep(scan, -sweep_s) for scan in known], -sweep_s
    if kind == "without times":
        return [replace(scan, time_increment=0.0) for scan in known], sweep_s
    return known, sweep_s


def found(scene: ScenarioName, rate: float, kind: str, seed: int) -> tuple[str, bool]:
    """After how many seconds it is sure, and of what; whether that is right, or nothing was found."""
    matched, steps = MatchedScans(), 1
    drive, sweep_s = scans(scene, rate, kind, seed)
    for scan in drive:
        matched.add(scan)
        time_s = (scan.stamp_ns - drive[0].stamp_ns) * 1e-9
        if time_s < steps * STEP_S:
            continue
        steps += 1
        times = matched.times()
        if times is not None and times.is_sure:
            share = times.sweep_s / sweep_s if sweep_s else 0.0
            told = f"{time_s:.0f} s" + (f" ({share:.2f})" if times.are_wrong else "")
            right = abs(share - 1.0) < NEAR if sweep_s else not times.are_wrong
            return told, right
    return "-", True


def error(scene: ScenarioName, rate: float, seed: int, *, timed: bool) -> float:
    """Of a run with all sensors. timed: whether the messages time the beams."""
    drive = Simulation(scene, SceneOptions(scan_rate=rate, seed=seed, beams=361, duration=DURATION)).items()
    items = (
        item if timed or not isinstance(item, LaserScan) else replace(item, time_increment=0.0) for item in drive
    )
    return outcome(process(items, SlamConfig())).aligned


def main() -> None:
    """The table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seeds", type=int, default=SEEDS)
    seeds = range(1, parser.parse_args().seeds + 1)
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:
        asked = {
            (scene, rate): [[pool.submit(found, scene, rate, kind, seed) for seed in seeds] for kind in KINDS]
            for scene in SCENES
            for rate in RATES
        }
        runs = {
            case: [[pool.submit(error, *case, seed, timed=t) for seed in seeds] for t in (True, False)]
            for case in asked
        }
        outcomes = {case: [[each.result() for each in kind] for kind in kinds] for case, kinds in asked.items()}
        errors = {case: [max(each.result() for each in kind) for kind in kinds] for case, kinds in runs.items()}
    rows = [
        (
            scene,
            f"{rate:g}",
            *(", ".join(told for told, _ in kind) for kind in kinds),
            *(f"{metres:.3f}" for metres in errors[scene, rate]),
        )
        for (scene, rate), kinds in outcomes.items()
    ]
    print(table(HEAD, rows))
    if not all(right for kinds in outcomes.values() for kind in kinds for _, right in kind):
        raise SystemExit("a timing was taken for another")


if __name__ == "__main__":
    main()
