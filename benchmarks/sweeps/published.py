"""Writes docs/benchmark.md: every recording in reach, by a sweep over two methods, and by kiss-icp beside them.

    python -m benchmarks.sweeps.published

Run by `make bench`. kiss-icp (extra `bench`) gets the same scans, as in benchmarks/others.py.
"""

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks import others
from benchmarks.cases import DEMOS, REAL, Recording, present
from benchmarks.others import KISS
from benchmarks.sweeps.cases import EVERY, PUBLISHED, STRETCH, base_of, relations_of, truth_rows
from benchmarks.tables import table
from hectorscope.run.metrics import truth_errors
from hectorscope.run.relations import read_relations, relation_figures
from hectorscope.sources import open_source
from hectorscope.sweep.executors import executor
from hectorscope.sweep.figures import SCORE
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Row, Table
from slam_core.config.presets import PAPER
from slam_core.measurements import LaserScan
from tests.conftest import ROOT

OURS, METHOD = "Hectorscope", "the paper's method"
HEAD = (
    "recording", "scans", "method", "error, aligned", "raw", "translation, relations", "rotation, relations",
    "used", "consistency", "ended",
)  # fmt: skip
INTRODUCTION = f"""# Benchmark

Written by `make bench` (`python -m benchmarks.sweeps.published`), from a [sweep](sweeps.md) over every
recording in reach. *{OURS}* is the defaults, *{METHOD}* the preset `paper`, each with what `hectorscope
inspect` finds of the devices. kiss-icp gets the same scans as flat clouds, without inertial data or wheels,
with the settings of [performance.md](performance.md#side-by-side-with-kiss-icp-judged-by-evo).

Errors are root mean squares over the positions, after the best rigid motion of the plane (aligned) and with the
first poses put on each other (raw). Relations are scored as by Kümmerle et al. (2009): mean ± standard
deviation of |translation| and |rotation| of the motions between two times, without any alignment; `hectorscope
run --relations FILE` gives the same. Relations that somebody published are used where they lie beside the
recordings; else they are taken from the truth of the recording: between poses {STRETCH:g} m of path apart, one
every {EVERY:g} m. The figures of the literature are means over relations of another choice, so that they do not
compare with these. The consistency score is the one of [sweeps.md](sweeps.md#the-consistency-score). A dash:
there is no truth, or the method has no such figure.

"""


@dataclass(frozen=True, slots=True)
class Judged:
    """A recording: rows of the table by method, and where its relations are from."""

    recording: Recording
    figures: Mapping[str, Row]
    relations: str


def specs_of(recording: Recording, relations: str) -> dict[str, RunSpec]:
    """Both methods."""
    base = replace(base_of(recording), relations=relations)
    return {OURS: base, METHOD: replace(base, settings={**PAPER, **base.settings})}


def kiss(recording: Recording, relations: str) -> Row:
    """kiss-icp in the words of the table."""
    source = open_source(str(recording.path), recording.options)
    scans = [item for item in source.items() if isinstance(item, LaserScan)]
    source.close()
    rows, _ = others.kiss_icp(scans, 0)
    truth = truth_rows(recording)
    errors = truth_errors(rows, truth) if len(truth) else None
    scored = relation_figures(rows, 0, read_relations(Path(relations))) if relations else {}
    found = {f"truth.{name}": value for name, value in (errors or {}).items()}
    found |= {f"relations.{name}": value for name, value in scored.items()}
    return {"status": "", "scans.used": str(len(rows)), **{name: str(value) for name, value in found.items()}}


def judge(recordings: Sequence[Recording], folder: Path) -> Iterator[Judged]:
    """Every recording by every method."""
    relations = {each: relations_of(each, folder) for each in recordings}
    files = {each: str(found[0]) if found else "" for each, found in relations.items()}
    specs = {each: specs_of(each, files[each]) for each in recordings}
    rows = Table(folder, [])
    with executor(0) as pool:
        sweep([spec for own in specs.values() for spec in own.values()], rows, pool, Limits())
    for each in recordings:
        print(f"benchmark: {each.name}", flush=True)
        figures = {method: rows.rows[spec.key] for method, spec in specs[each].items()}
        if others.INSTALLED:
            figures[KISS] = kiss(each, files[each])
        found = relations[each]
        yield Judged(each, figures, found[1] if found else "")


def lines(judged: Judged) -> Iterator[list[str]]:
    """A line a method."""
    for method, row in judged.figures.items():
        yield [
            judged.recording.name, row["scans.used"], method,
            figure(row, "truth.aligned_rmse_m", "m"), figure(row, "truth.raw_rmse_m", "m"),
            spread(row, "translation", "m"), spread(row, "rotation", "deg"),
            f"{row['relations.used']}, {judged.relations}" if row.get("relations.used") else "-",
            figure(row, SCORE, ""), row["status"] or "-",
        ]  # fmt: skip


def figure(row: Row, name: str, unit: str) -> str:
    """A figure with its unit, or a dash."""
    return f"{float(row[name]):.3f} {unit}".strip() if row.get(name) else "-"


def spread(row: Row, what: str, unit: str) -> str:
    """Mean and standard deviation."""
    mean, deviation = (row.get(f"relations.{what}_{which}_{unit}") for which in ("mean", "std"))
    return f"{float(mean):.3f} ± {float(deviation):.3f} {unit}" if mean and deviation else "-"


def main() -> None:
    """Run everything and write the page."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    with tempfile.TemporaryDirectory() as made:
        found = list(judge(present((*DEMOS, *REAL)), Path(made)))
    text = INTRODUCTION + table(HEAD, (line for each in found for line in lines(each)))
    if not PUBLISHED.is_dir():
        text += "\nNo published relations lie beside the recordings here.\n"
    (ROOT / "docs" / "benchmark.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
