"""Runs every case whose outcome can be judged and writes what came out into docs/performance.md and the README.

    python -m benchmarks.performance [--accuracy | --speed]

--accuracy judges anew and leaves what was measured of speed, which is another matter on another machine; --speed
is the opposite. Nothing but this script writes those figures. The real recordings lie beside the project and are
left out where they are missing. Speed is measured with nothing beside it, accuracy on two processes.
"""

import argparse
import re
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from typing import Any

from benchmarks import kernels, others, reading, start, tables, whole_map
from benchmarks.accuracy import corridor, drive, replay, square
from benchmarks.cases import (
    COMPARED,
    CORRIDOR,
    DEMOS,
    DRIVE_SEEDS,
    DRIVES,
    GLASS,
    HALL_SEEDS,
    HALLS,
    INERTIAL,
    REAL,
    SEEDS,
    STRAYS,
    TIMED,
    present,
)
from benchmarks.document import Accuracy, document, judged_anew, timed_anew
from benchmarks.ghosts import crowd, nobody
from benchmarks.inertial import ride
from benchmarks.localising import SCENES, localised
from benchmarks.outage import OUTAGE_SEEDS, OUTAGES
from benchmarks.strays import glass, struck
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.sources import open_source
from tests.conftest import ROOT

PROCESSES = 2
SOURCE = "Written by `make bench`; more in [docs/performance.md](docs/performance.md)."
MARKS = re.compile(r"(?<=<!-- results: filled by make bench -->\n).*?(?=<!-- /results -->)", re.DOTALL)


def measure_speed(fastest: dict[str, dict[str, Any]]) -> None:
    """The metrics of headless runs with default settings, reading included, by name; kept where one is faster."""
    for recording in present(TIMED):
        print(f"speed: {recording.name}", flush=True)
        source = open_source(str(recording.path), recording.options)
        pipeline, effort = run_headless(source, Settings())
        found = metrics(pipeline, source.report, effort)
        fastest[recording.name] = max(fastest.get(recording.name, found), found, key=_factor)


def _factor(figures: dict[str, Any]) -> float:
    return float(figures["realtime_factor"])


def measure_accuracy() -> Accuracy:
    """All cases by both methods."""
    with ProcessPoolExecutor(PROCESSES) as pool:
        compared = present(COMPARED) if others.INSTALLED else []
        beside = {recording: pool.submit(others.compare, recording) for recording in compared}
        drives = {case: [pool.submit(drive, case.options, seed) for seed in DRIVE_SEEDS] for case in DRIVES}
        squares = {case: [pool.submit(square, case.options, seed) for seed in DRIVE_SEEDS] for case in DRIVES}
        again = {name: [pool.submit(localised, name, seed) for seed in SEEDS] for name in SCENES}
        bare = [pool.submit(corridor, CORRIDOR, seed) for seed in SEEDS]
        crowded = [pool.submit(crowd, HALLS, seed) for seed in SEEDS]
        empty = [pool.submit(nobody, HALLS, seed) for seed in HALL_SEEDS]
        panes = [pool.submit(glass, GLASS, seed) for seed in HALL_SEEDS]
        strays = [pool.submit(struck, STRAYS, seed) for seed in SEEDS]
        lost = {name: [pool.submit(run, seed) for seed in OUTAGE_SEEDS] for name, run in OUTAGES.items()}
        replays = {recording: pool.submit(replay, recording) for recording in present((*DEMOS, *REAL))}
        begun: dict[Future[Any], str] = {future: case.name for case in drives for future in drives[case]}
        names = begun | {future: f"{case.name}, square" for case in squares for future in squares[case]}
        names |= {future: f"{name}, in a saved map" for name in again for future in again[name]}
        names |= {future: name for name, futures in lost.items() for future in futures}
        names |= dict.fromkeys(bare, "corridor") | dict.fromkeys([*crowded, *empty], "people")
        names |= dict.fromkeys(panes, "glass") | dict.fromkeys(strays, "stray beams")
        names |= {future: each.name for each, future in replays.items()}
        names |= {future: f"{each.name}, side by side" for each, future in beside.items()}
        for done, future in enumerate(as_completed(names), start=1):
            print(f"accuracy {done}/{len(names)}: {names[future]}", flush=True)
        return Accuracy(
            {case: [future.result() for future in futures] for case, futures in drives.items()},
            {case: [future.result() for future in futures] for case, futures in squares.items()},
            {name: [future.result() for future in futures] for name, futures in again.items()},
            [future.result() for future in bare],
            [future.result() for future in crowded],
            [future.result() for future in empty],
            [future.result() for future in panes],
            [future.result() for future in strays],
            {name: [future.result() for future in futures] for name, futures in lost.items()},
            {recording: future.result() for recording, future in replays.items()},
            {recording: future.result() for recording, future in beside.items()},
            {recording: ride(recording) for recording in present(INERTIAL)},
        )


def measure_times() -> str:
    """The document, and the table of the README. Whole runs are timed in between: a machine has slow minutes."""
    speed: dict[str, dict[str, Any]] = {}
    measure_speed(speed)
    print("speed: reading and starting", flush=True)
    reading_alone, starts = reading.table(present(TIMED)), start.measure()
    measure_speed(speed)
    print("speed: kernels", flush=True)
    (parts, steps), growth = kernels.tables(kernels.looks()), kernels.scaling()
    measure_speed(speed)
    findings = whole_map.measure()
    measure_speed(speed)
    readme = ROOT / "README.md"
    shown = f"{tables.speed(speed)}\n{SOURCE}\n"
    readme.write_text(MARKS.sub(lambda _: shown, readme.read_text(encoding="utf-8")), encoding="utf-8")
    return document(speed, reading_alone, starts, parts, steps, growth, findings)


def main() -> None:
    """Measure, write, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    only = parser.add_mutually_exclusive_group()
    only.add_argument("--accuracy", action="store_true")
    only.add_argument("--speed", action="store_true")
    args, path = parser.parse_args(), ROOT / "docs" / "performance.md"
    load_everything()
    text = path.read_text(encoding="utf-8")
    if not args.accuracy:
        text = timed_anew(text, measure_times())
    if not args.speed:
        text = judged_anew(text, measure_accuracy())
    path.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
