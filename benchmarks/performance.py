"""Runs every recording whose truth is known and writes what came out into docs/performance.md and the README.

    python -m benchmarks.performance

Nothing but this script writes those figures. The real recordings lie beside the project and are left out where
they are missing.
"""

import os
import platform
import re
from collections.abc import Iterable, Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any, get_args

from app.cli import Scene, demo_bag
from app.metrics import PARTS, metrics
from app.runner import run_headless
from app.settings import Settings
from app.sources import SourceOptions, open_source
from app.warmup import warm_up
from tests.conftest import ROOT

BESIDE = ROOT.parent / "shared" / "data"
REAL = {
    "jackal_vicon 15-54-31": "jackal_vicon/test_2026-02-17-15-54-31.bag",
    "jarvis_nav350 circular": "jarvis_nav350/jarvis_circular_path_fast.bag",
}
SOURCE = "Written by `make bench`; more in [docs/performance.md](docs/performance.md)."
MARKS = re.compile(r"(?<=<!-- results: filled by make bench -->\n).*?(?=<!-- /results -->)", re.DOTALL)


def recordings() -> Iterator[tuple[str, Path]]:
    """Name and path: the demos, and what lies beside the project."""
    for scene in get_args(Scene):
        yield f"{scene} (simulated)", demo_bag(scene)
    for name, path in REAL.items():
        if (BESIDE / path).exists():
            yield name, BESIDE / path


def measure(path: Path) -> dict[str, Any]:
    """The metrics of a headless run with default settings, reading included."""
    source = open_source(str(path), SourceOptions())
    pipeline, effort = run_headless(source, Settings())
    return metrics(pipeline, source.report, effort)


def accuracy_table(results: dict[str, dict[str, Any]]) -> str:
    """Errors and speed, a row a recording."""
    head = ("recording", "scans", "error, aligned", "error, raw", "roll", "pitch", "times real time")
    return table(head, ((name, *accuracy(figures)) for name, figures in results.items()))


def accuracy(figures: dict[str, Any]) -> Iterator[str]:
    """The cells of a row after its name; a planar run has no roll and pitch."""
    truth = figures["truth"]
    yield str(figures["scans"]["used"])
    yield f"{truth['aligned_rmse_m']:.3f} m"
    yield f"{truth['raw_rmse_m']:.3f} m"
    for angle in ("roll_rms_deg", "pitch_rms_deg"):
        yield f"{truth[angle]:.2f}°" if angle in truth else "-"
    yield f"{figures['realtime_factor']:.0f}"


def times_table(results: dict[str, dict[str, Any]]) -> str:
    """Median microseconds of each part of a scan's step."""
    rows = ((name, *(f"{figures['median_us'][part]:.0f}" for part in PARTS)) for name, figures in results.items())
    return table(("recording", *PARTS), rows)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Markdown."""
    lines = [list(head), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def document(results: dict[str, dict[str, Any]]) -> str:
    """docs/performance.md."""
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "rosbags", "mcap"))
    return f"""# Performance

Written by `make bench` (`benchmarks/performance.py`); do not edit.

Default settings; {os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}, {libraries}.

## Accuracy and speed

Root mean square of the error against the truth: raw starts at the first pose, aligned takes the best rigid motion
out. Speed is the length of the recording over the wall time of the whole run, reading and decoding included.

{accuracy_table(results)}
## Median time of each part of a step, microseconds

The update counts only the scans that were written into the map.

{times_table(results)}"""


def main() -> None:
    """Measure, write, and print the table."""
    warm_up()
    results = {}
    for name, path in recordings():
        print(f"{name} ...", flush=True)
        results[name] = measure(path)
    (ROOT / "docs" / "performance.md").write_text(document(results), encoding="utf-8")
    readme = ROOT / "README.md"
    shown = f"{accuracy_table(results)}\n{SOURCE}\n"
    readme.write_text(MARKS.sub(lambda _: shown, readme.read_text(encoding="utf-8")), encoding="utf-8")
    print(shown)


if __name__ == "__main__":
    main()
