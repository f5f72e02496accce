"""Damages recordings, maps and settings of every format, and counts what the readers make of them.

    python -m benchmarks.damaged [--each 350] [--seed 1]

A damaged file is read as far as it goes, with a warning, or refused with a message. Nothing else may come out.
"""

import argparse
import gzip
import shutil
import signal
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np

from benchmarks.tables import table
from hectorscope.checks.inspect import inspect_bag
from hectorscope.exporters.occupancy import pgm
from hectorscope.inputs import SourceOptions
from hectorscope.maps.saved_map import load_map, to_npz
from hectorscope.ros.recorder import Recorder
from hectorscope.run.settings import Settings
from hectorscope.run.settings_file import read_toml, to_toml
from hectorscope.sources import open_source
from hectorscope.sources.coreslam import FIRST_BEAM
from slam_core.config import MapConfig
from slam_core.errors import SlamError
from slam_core.localization.prior_map import SavedLevel
from tests.bags import messages_for, small_run
from tests.ros_messages import START

EACH, SEED = 350, 1
PATIENCE_S = 20  # a reading that takes longer hangs
SCANS = 12
ROOM = MapConfig(levels=1, resolution=0.5)
OUTCOMES = ("read", "warned", "refused", "hangs", "traceback")

Read = Callable[[Path], bool]
"""Reads a file; whether it warns of something."""


@dataclass(frozen=True)
class Format:
    """What is damaged: `make` leaves it at a path, `read` is the program's way to read it."""

    name: str
    make: Callable[[Path], Path]
    read: Read


def read_recording(path: Path) -> bool:
    """As `run` and `inspect` do."""
    source = open_source(str(path), SourceOptions())
    try:
        list(source.items())
        report = source.report
    finally:
        source.close()
    inspect_bag(path, SourceOptions())
    return bool(report.skipped or report.warnings or any("damaged" in note for note in report.notes))


def read_map(path: Path) -> bool:
    """As `--map` does."""
    load_map(path, ROOM)
    return False


def read_settings(path: Path) -> bool:
    """As `--config` does."""
    read_toml(path)
    return False


def bag(path: Path) -> Path:
    """A recording of some scans with inertial data, packed if its name says so."""
    with Recorder(path, compress="packed" in path.name) as recorder:
        for topic, message, time_ns in small_run(messages_for(path.name), SCANS):
            recorder.write(topic, message, START + time_ns)
    return path


def database(path: Path) -> Path:
    """The database of a folder alone."""
    (found,) = bag(path.with_suffix("")).glob("*.db3")
    return found.replace(path)


def carmen(path: Path) -> Path:
    """A CARMEN log, packed or not."""
    beams = " ".join(f"{2.0 + 0.01 * k:.2f}" for k in range(181))
    lines = (f"FLASER 181 {beams} 0 0 0 0 0 0 {0.1 * k:.2f} host {0.1 * k:.2f}\n" for k in range(1, SCANS))
    text = "".join(lines).encode()
    path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)
    return path


def tinyslam(path: Path) -> Path:
    """A tinySLAM log."""
    ranges = " ".join(["2000"] * 682)
    lines = (
        " ".join([str(100 * k), "0", str(k), str(k), *["0"] * (FIRST_BEAM - 4), ranges]) for k in range(1, SCANS)
    )
    path.write_text("\n".join(lines))
    return path


def image_map(path: Path) -> Path:
    """A map of another tool: the description is damaged, or its image."""
    cells = np.zeros((8, 8), np.uint8)
    cells[0], cells[1:] = 2, 1
    path.mkdir()
    (path / "map.pgm").write_bytes(pgm(cells))
    (path / "map.yaml").write_text("image: map.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n")
    return path


def cell_map(path: Path) -> Path:
    """Our own."""
    log_odds = np.full((8, 8), -1.0, np.float32)
    path.write_bytes(to_npz((SavedLevel(0.5, np.zeros(2, np.int64), log_odds, np.zeros((8, 8), np.uint32)),)))
    return path


def settings(path: Path) -> Path:
    """Every setting."""
    path.write_text(to_toml(Settings()), encoding="utf-8")
    return path


FORMATS = (
    *(
        Format(name, bag, read_recording)
        for name in ("run.bag", "packed.bag", "run.mcap", "packed.mcap", "folder", "packed")
    ),
    Format("run.db3", database, read_recording),
    *(Format(name, carmen, read_recording) for name in ("run.clf", "run.clf.gz")),
    Format("run.dat", tinyslam, read_recording),
    Format("map", image_map, read_map),
    Format("map.npz", cell_map, read_map),
    Format("config.toml", settings, read_settings),
)


def damage(data: bytes, rng: np.random.Generator) -> bytes:
    """The same bytes with one kind of damage: as of a disk, a cut link, or a hand that meant harm."""
    out = bytearray(data)
    size = len(out)
    begin, other = (int(each) for each in rng.integers(0, max(size, 1), 2))
    length = int(min(size - begin, 1 + rng.exponential(40.0)))
    match int(rng.integers(0, 7)):
        case 0:
            return bytes(out[:begin])
        case 1:
            out[begin : begin + length] = bytes(length)
        case 2:
            out[begin : begin + length] = b"\xff" * length
        case 3:
            out[begin:begin] = out[other : other + length]
        case 4:
            del out[begin : begin + length]
        case 5:
            out[begin : begin + length] = rng.bytes(length)
        case _:
            for at in rng.integers(0, max(size, 1), int(rng.integers(1, 20))):
                out[at] ^= 1 << int(rng.integers(0, 8))
    return bytes(out)


@contextmanager
def patience(seconds: int) -> Iterator[None]:
    """TimeoutError after so many seconds; on the main thread."""

    def ring(_number: int, _frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def outcome(kind: Format, whole: Path, folder: Path, seed: int) -> tuple[str, str]:
    """What reading a damaged copy of `whole` comes to, and the last lines of a traceback."""
    rng, path = np.random.default_rng([seed, sum(kind.name.encode())]), folder / kind.name
    shutil.rmtree(path, ignore_errors=True)
    path.unlink(missing_ok=True)
    if whole.is_dir():
        shutil.copytree(whole, path)
    else:
        shutil.copy(whole, path)
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    spoilt = files[int(rng.integers(0, len(files)))]
    spoilt.write_bytes(damage(spoilt.read_bytes(), rng))
    try:
        with patience(PATIENCE_S):
            return ("warned" if kind.read(path) else "read"), ""
    except SlamError:
        return "refused", ""
    except TimeoutError:
        return "hangs", ""
    except Exception:
        return "traceback", "".join(traceback.format_exc().splitlines(keepends=True)[-3:])


def run(kind: Format, seeds: range, folder: Path) -> tuple[Counter[str], dict[int, str]]:
    """Outcomes over seeds, and what failed."""
    counts: Counter[str] = Counter()
    failed: dict[int, str] = {}
    with tempfile.TemporaryDirectory(dir=folder) as made:
        whole = kind.make(Path(made) / kind.name)
        kind.read(whole)
        for seed in seeds:
            result, lines = outcome(kind, whole, folder, seed)
            counts[result] += 1
            if result in ("hangs", "traceback"):
                failed[seed] = lines
    return counts, failed


def main() -> int:
    """All formats; 1 if anything but reading and refusing came out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--each", type=int, default=EACH, help="damaged files a format")
    parser.add_argument("--seed", type=int, default=SEED, help="the first seed")
    args = parser.parse_args()
    rows, bad = [], 0
    with tempfile.TemporaryDirectory() as made:
        for kind in FORMATS:
            counts, failed = run(kind, range(args.seed, args.seed + args.each), Path(made))
            rows.append([kind.name, *(str(counts[name]) for name in OUTCOMES)])
            bad += len(failed)
            for seed, lines in failed.items():
                print(f"{kind.name}, seed {seed}: {lines or 'hangs'}", file=sys.stderr)
    print(table(["format", *OUTCOMES], rows))
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
