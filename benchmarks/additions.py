"""What each addition of the defaults is worth: switched off alone, over recordings and simulated drives.

    python -m benchmarks.additions [--write] [--seeds N] [--processes N]

Every case is made once and run with the defaults, with each addition off, and with the preset paper. The outcomes
go to build/additions.jsonl, where a later call continues. --write makes docs/beyond-the-paper.md of them.
"""

import argparse
import json
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.accuracy import process
from benchmarks.cases import DEMOS, DRIVES, REAL, Recording
from benchmarks.outage import LASER_FAILS
from benchmarks.turned import angle_of, turned
from benchmarks.wheels import with_wheels
from hectorscope.inputs import Item
from hectorscope.run.metrics import truth_errors
from hectorscope.run.warmup import warm_up
from hectorscope.simulation import ScenarioName, SceneOptions, Simulation
from hectorscope.simulation.sensors import START_NS
from hectorscope.sources import open_source
from slam_core.config import ADDITIONS, SlamConfig, with_values
from slam_core.measurements import Height, Imu, LaserScan, Odometry
from tests.conftest import ROOT

STORE = ROOT / "build" / "additions.jsonl"
SEEDS = 20
SECONDS = 30.0  # of a simulated drive
RANGE_NOISE = 0.003  # m, added to the ranges of a recording
FIRST_SCANS = 20  # up to so many are left out at its start
WILD = 0.02  # share of the wild values where sensors fail
DEFAULTS, PAPER = "defaults", "paper"


@dataclass(frozen=True, slots=True)
class Case:
    """One set of measurements. family: a row group of the table. name, seed: which drive or recording."""

    family: str
    name: str
    seed: int

    @property
    def key(self) -> str:
        """How the store names it."""
        return f"{self.family}/{self.name}/{self.seed}"


def cases(seeds: int) -> list[Case]:
    """All of them, seed by seed: whatever is done first covers every family."""
    simulated = [("rooms", drive.name) for drive in DRIVES] + [
        ("rooms, laser alone", drive.name) for drive in DRIVES
    ]
    simulated += [("scenes", name) for name in ("arena", "littoral", "handheld", "corridor", "people", "glass")]
    simulated += [("scenes, laser alone", name) for name in ("arena", "handheld", "corridor", "people")]
    simulated += [("faults", name) for name in FAULTS]
    recorded = [("recordings", recording.name) for recording in (*DEMOS, *REAL) if recording.path.exists()]
    return [Case(family, name, seed) for seed in range(1, seeds + 1) for family, name in (*simulated, *recorded)]


def items_of(case: Case) -> list[Item]:
    """The measurements of a case."""
    family, name, seed = case.family, case.name, case.seed
    if family == "recordings":
        return list(perturbed(_recording(name), seed))
    if family == "faults":
        return list(FAULTS[name](seed))
    if family.startswith("rooms"):
        options = next(drive.options for drive in DRIVES if drive.name == name)
        items: Iterable[Item] = turned(_simulated("rooms", options, seed), angle_of(seed))
    else:
        items = _simulated(name, SceneOptions(), seed)  # type: ignore[arg-type]
    return [item for item in items if not ("alone" in family and isinstance(item, Imu | Height))]


def _simulated(scene: ScenarioName, options: SceneOptions, seed: int) -> Iterator[Item]:
    return Simulation(scene, replace(options, seed=seed, duration=SECONDS)).items()


@cache
def _recording(name: str) -> tuple[Recording, tuple[Item, ...]]:
    recording = next(each for each in (*DEMOS, *REAL) if each.name == name)
    source = open_source(str(recording.path), recording.options)
    items = tuple(source.items())
    source.close()
    return recording, items


def perturbed(loaded: tuple[Recording, tuple[Item, ...]], seed: int) -> Iterator[Item]:
    """A recording with 3 mm of noise in its ranges and without its first scans; seed 1 is as recorded."""
    rng = np.random.default_rng(seed)
    left_out = 0 if seed == 1 else int(rng.integers(0, FIRST_SCANS + 1))
    for item in loaded[1]:
        if not isinstance(item, LaserScan) or seed == 1:
            yield item
        elif left_out:
            left_out -= 1
        else:
            noise = rng.normal(0.0, RANGE_NOISE, len(item.ranges)).astype(np.float32)
            yield replace(item, ranges=item.ranges + noise)


def _laser_fails(seed: int) -> Iterator[Item]:
    """The boat without scans for ten seconds."""
    begin_ns, end_ns = (START_NS + round(t * 1e9) for t in LASER_FAILS)
    for item in Simulation("littoral", SceneOptions(seed=seed)).items():
        if not (isinstance(item, LaserScan) and begin_ns < item.stamp_ns < end_ns):
            yield item


def _wild_heights(seed: int) -> Iterator[Item]:
    """A walk with heights that are off by metres now and then."""
    rng = np.random.default_rng(seed)
    for item in _simulated("handheld", SceneOptions(), seed):
        wild = isinstance(item, Height) and rng.random() < WILD
        yield replace(item, height=item.height + float(rng.normal(0.0, 20.0))) if wild else item  # type: ignore[type-var]


def _slipping_wheels(seed: int) -> Iterator[Item]:
    """Rooms with inertial data and wheels, which spin freely now and then."""
    rng = np.random.default_rng(seed)
    for item in with_wheels(list(_simulated("rooms", SceneOptions(scan_rate=10.0), seed)), seed):
        wild = isinstance(item, Odometry) and rng.random() < WILD
        yield replace(item, velocity=item.velocity + rng.normal(0.0, 2.0, 2)) if wild else item  # type: ignore[type-var]


def _wheels_alone(seed: int) -> Iterator[Item]:
    """Rooms with wheels and without inertial data, at 5 Hz."""
    items = _simulated("rooms", SceneOptions(scan_rate=5.0), seed)
    return iter(with_wheels([item for item in items if not isinstance(item, Imu | Height)], seed))


def _carried_away(seed: int) -> Iterator[Item]:
    """Rooms, laser alone; no scans come for four seconds in the middle."""
    for item in _simulated("rooms", SceneOptions(scan_rate=20.0), seed):
        t = (item.stamp_ns - START_NS) * 1e-9
        if not isinstance(item, Imu | Height) and not (isinstance(item, LaserScan) and 15.0 < t < 19.0):
            yield item


FAULTS = {
    "littoral, laser fails for 10 s": _laser_fails,
    "handheld, wild heights": _wild_heights,
    "rooms, wheels spin": _slipping_wheels,
    "rooms, wheels without IMU, 5 Hz": _wheels_alone,
    "rooms, laser alone fails for 4 s": _carried_away,
}


def configurations(case: Case) -> dict[str, SlamConfig]:
    """The defaults, each addition off, the paper; by name, with the settings that a recording needs."""
    needed = dict(_recording(case.name)[0].settings) if case.family == "recordings" else {}
    off = {key(addition.values): addition.values for addition in ADDITIONS}
    return {
        DEFAULTS: with_values(SlamConfig(), needed),
        **{name: with_values(SlamConfig(), {**needed, **values}) for name, values in off.items()},
        PAPER: with_values(SlamConfig.paper(), needed),
    }


def key(values: Iterable[str]) -> str:
    """How the store names an addition: by its settings."""
    return " ".join(values)


def measure(case: Case) -> tuple[str, dict[str, list[float | None]]]:
    """Raw and aligned error, and distance from the first pose to the last, metres, by configuration."""
    items, outcomes = items_of(case), {}
    for name, config in configurations(case).items():
        pipeline = process(items, config)
        errors = truth_errors(pipeline) if len(pipeline.truth) else None
        raw, aligned = (errors["raw_rmse_m"], errors["aligned_rmse_m"]) if errors else (None, None)
        first, last = pipeline.trajectory[[0, -1], 1:3]
        outcomes[name] = [raw, aligned, float(np.hypot(*(last - first)))]
    return case.key, outcomes


def stored() -> dict[str, dict[str, list[float | None]]]:
    """The outcomes so far."""
    if not STORE.exists():
        return {}
    rows = (json.loads(line) for line in STORE.read_text(encoding="utf-8").splitlines())
    return {row["case"]: row["outcomes"] for row in rows}


def run(seeds: int, processes: int) -> None:
    """Measure every case that is not stored yet."""
    STORE.parent.mkdir(exist_ok=True)
    done = stored()
    waiting = [case for case in cases(seeds) if case.key not in done]
    with ProcessPoolExecutor(processes, initializer=_prepare) as pool, STORE.open("a", encoding="utf-8") as store:
        for future in as_completed([pool.submit(measure, case) for case in waiting]):
            name, outcomes = future.result()
            store.write(json.dumps({"case": name, "outcomes": outcomes}) + "\n")
            store.flush()
            print(name, flush=True)


def _prepare() -> None:
    os.nice(10)
    warm_up()


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the document from what is stored")
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--processes", type=int, default=2)
    chosen = parser.parse_args()
    if not chosen.write:
        run(chosen.seeds, chosen.processes)
        return
    from benchmarks.additions_document import document  # noqa: PLC0415

    Path(ROOT / "docs" / "beyond-the-paper.md").write_text(document(stored()), encoding="utf-8")


if __name__ == "__main__":
    main()
