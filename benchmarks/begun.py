"""Recordings that begin in motion: errors in the rooms, by where in the drive the recording begins.

    python -m benchmarks.begun [--seeds 5] [--rates 40 10 5] [--begins 2.7 8.5 ...] [--bare] [--at-once]

Prints centimetres, raw / aligned, seed by seed, and their medians. From 0 s on: begun at rest, to compare.
"""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from statistics import median

from benchmarks.accuracy import Outcome, outcome, process
from benchmarks.turned import angle_of, turned
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.measurements import Imu

BEGINS = {
    0.0: "at rest",
    2.7: "constant acceleration",
    6.25: "turn of 65 degrees/s",
    7.2: "end of a turn",
    8.5: "constant velocity",
    14.1: "begin of a turn",
}
RATES, SWAYS = (40.0, 10.0, 5.0), (0.0, 15.0)
DURATION = 60.0
SEEDS = 5
PROCESSES = 2


def options_of(begin: float, rate: float, sway: float, seed: int, seconds: float = DURATION) -> SceneOptions:
    """A recording of so many seconds."""
    return SceneOptions(
        begin=begin, duration=begin + seconds, scan_rate=rate, sway=sway, sway_frequency=1.2, seed=seed
    )


def run(begin: float, rate: float, sway: float, seed: int, bare: bool, config: SlamConfig) -> Outcome:
    """The outcome of one recording; bare: without its inertial data."""
    items = turned(Simulation("rooms", options_of(begin, rate, sway, seed)).items(), angle_of(seed))
    return outcome(process((each for each in items if not (bare and isinstance(each, Imu))), config))


def lines(
    begins: Sequence[float], rates: Sequence[float], seeds: int, bare: bool, config: SlamConfig
) -> Iterator[str]:
    """One for each kind of recording."""
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:
        jobs = {
            case: [pool.submit(run, *case, seed, bare, config) for seed in range(1, seeds + 1)]
            for case in product(begins, rates, SWAYS)
        }
        for (begin, rate, sway), futures in jobs.items():
            runs = [each.result() for each in futures]
            what = BEGINS.get(begin, f"from {begin:g} s on")
            raw, aligned = (100 * median(getattr(each, key) for each in runs) for key in ("raw", "aligned"))
            each = "  ".join(f"{100 * run.raw:.2f}/{100 * run.aligned:.2f}" for run in runs)
            lost = sum(run.lost for run in runs)
            yield (
                f"{what:>22} | {rate:2.0f} Hz{', sway' if sway else '      '} | {raw:6.2f} / {aligned:5.2f} |"
                f" {max(100 * run.raw for run in runs):6.2f} | lost {lost} | {each}"
            )


def main() -> None:
    """Print a line for each kind of recording."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--begins", nargs="*", type=float, default=list(BEGINS))
    parser.add_argument("--rates", nargs="*", type=float, default=list(RATES))
    parser.add_argument("--bare", action="store_true", help="without inertial data")
    parser.add_argument("--at-once", action="store_true", help="without navigation.start_in_motion")
    args = parser.parse_args()
    config = with_value(SlamConfig(), "navigation.start_in_motion", not args.at_once)
    print(f"{'begins':>22} | scans        | raw / aligned | worst raw | by seed, raw/aligned, cm")
    for line in lines(args.begins, args.rates, args.seeds, args.bare, config):
        print(line, flush=True)


if __name__ == "__main__":
    main()
