"""Sweeps on this machine: real recordings, real processes, and processes that die."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest

from hectorscope.exporters import OutputError
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.settings import Settings
from hectorscope.simulation.sensors import START_NS
from hectorscope.sources import open_source
from hectorscope.sweep.execute import execute
from hectorscope.sweep.executors import ClusterError, executor
from hectorscope.sweep.guard import guarded, stop
from hectorscope.sweep.limits import LimitError, Limits
from hectorscope.sweep.spec import RunSpec, RunSummary
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Table, read
from slam_core.config import SlamConfig, with_values
from tests.sweeps import PATIENCE_S, SIGMAS, WITH_TRUTH, hectorscope, recording, specs_of, timeless

T = TypeVar("T")
USUAL = Limits()


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds, whose run takes a tenth of one."""
    return recording(tmp_path_factory.mktemp("sweep"))


@pytest.fixture(scope="module")
def long_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute and a half: long enough to be stopped."""
    return recording(tmp_path_factory.mktemp("sweep"), "long.bag", duration=90.0)


@pytest.fixture(autouse=True)
def no_processes_left():
    """Each test has workers of its own."""
    yield
    stop()


def done(folder: Path, specs: list[RunSpec], workers: int = 2, limits: Limits = USUAL) -> Table:
    """The table of a whole sweep."""
    table = Table(folder, ["matcher.sigma"])
    with executor(workers) as pool:
        sweep(specs, table, pool, limits)
    table.finish(specs)
    return table


def test_a_row_has_the_figures_of_the_run(bag: Path):
    """As `run` would write them: errors against the truth, states, counts; and a picture and a path beside."""
    summary = execute(RunSpec("short.bag", str(bag), {"matcher.sigma": 0.2}))
    source = open_source(str(bag), RunSpec("", "").source_options())
    config = with_values(SlamConfig(), {"matcher.sigma": 0.2})
    pipeline, _ = run_headless(source, Settings(config))
    wanted = metrics(pipeline, source.report)
    assert summary.status == "ok"
    assert summary.figures[WITH_TRUTH] == wanted["truth"]["aligned_rmse_m"]
    assert summary.figures["occupied_cells"] == wanted["occupied_cells"]
    assert summary.figures["tracking.tracking"] == wanted["tracking"]["tracking"]
    assert 0.5 < float(str(summary.figures["consistency"])) <= 1.0
    np.testing.assert_allclose(summary.path[-1], pipeline.trajectory[-1, :3], atol=1e-4)
    assert summary.picture


def test_the_beginning_of_a_recording_is_run_alone(bag: Path):
    """Half of its time has half of its scans."""
    whole = execute(RunSpec("short.bag", str(bag)))
    half = execute(RunSpec("short.bag", str(bag), share=0.5))
    assert whole.figures["scans.read"] == 60
    assert 28 <= float(str(half.figures["scans.read"])) <= 32


def test_every_executor_gives_the_same_table(bag: Path, tmp_path: Path):
    """One process, two in the opposite order, and a pool of Python's own: all cells are equal but for times."""
    specs, folders = specs_of(bag), [tmp_path / name for name in "abc"]
    for folder in folders:
        folder.mkdir()
    done(folders[0], specs, 1)
    done(folders[1], specs[::-1], 2).finish(specs)
    table = Table(folders[2], ["matcher.sigma"])
    with ProcessPoolExecutor(1) as pool:
        sweep(specs, table, pool, Limits())
    table.finish(specs)
    tables = [timeless(folder) for folder in folders]
    assert tables[0] == tables[1] == tables[2]
    assert [row[2] for row in tables[0][1:]] == [str(sigma) for sigma in SIGMAS]


def test_a_process_does_many_runs_in_the_same_memory(bag: Path, tmp_path: Path):
    """One process loads the kernels once and does all; after 40 runs it takes no more than after a few."""
    specs = specs_of(bag, sigmas=tuple(round(0.1 + 0.01 * k, 2) for k in range(40)))
    rows = list(done(tmp_path, specs, 1).rows.values())
    assert len({row["worker"] for row in rows}) == 1
    assert float(rows[-1]["memory_mb"]) < float(rows[7]["memory_mb"]) + 16.0


def test_started_again_it_does_what_is_missing(bag: Path, tmp_path: Path):
    """Rows that are there are left as they are, times too."""
    specs = specs_of(bag)
    done(tmp_path, specs[:2])
    before = read(tmp_path)
    done(tmp_path, specs)
    assert read(tmp_path)[:2] == before
    assert len(read(tmp_path)) == len(specs)


def test_what_breaks_is_a_row_with_its_reason(bag: Path, long_bag: Path, tmp_path: Path):
    """A limit of time or memory, a recording that is none, and one that is not there: the others go on."""
    broken = tmp_path / "broken.bag"
    broken.write_bytes(b"no bag at all")
    (slow,) = specs_of(long_bag, sigmas=(0.1,))
    done(tmp_path, [slow], limits=Limits(time_s=0.05))
    done(tmp_path, specs_of(bag, sigmas=(0.2,)), limits=Limits(memory_mb=20.0))
    done(tmp_path, specs_of(broken, tmp_path / "missing.bag", bag, sigmas=(0.3,)))
    rows = {(row["recording"], row["matcher.sigma"]): row for row in read(tmp_path)}
    assert [(row["status"]) for row in rows.values()].count("ok") == 1
    for place, status, reason in (
        (("long.bag", "0.1"), "timeout", "it took more than 0.05 s (--time-limit)"),
        (("short.bag", "0.2"), "memory", "it took more than 20 MiB (--memory-limit)"),
        (("broken.bag", "0.3"), "refused", "broken.bag"),
        (("missing.bag", "0.3"), "refused", "does not exist"),
    ):
        assert rows[place]["status"] == status
        assert reason in rows[place]["reason"]
    assert rows["short.bag", "0.3"]["status"] == "ok"


def children(process: int | str = "self") -> set[int]:
    """The processes that one has started and that live."""
    lists = Path(f"/proc/{process}/task").glob("*/children")
    return {int(pid) for each in lists for pid in each.read_text().split()}


def until(found: Callable[[], T]) -> T:
    """What `found` gives once that is something."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if there := found():
            return there
        time.sleep(0.005)
    raise AssertionError("never happened")


@pytest.mark.parametrize(("kills", "status"), [(1, "ok"), (2, "crashed")])
def test_a_process_that_dies_is_a_row_in_the_end(long_bag: Path, kills: int, status: str):
    """A run whose process was killed once is done again in another one; killed twice it is given up."""
    spec, answers = specs_of(long_bag, sigmas=(0.1,))[0].as_json(), list[str]()
    seen = children()
    thread = threading.Thread(target=lambda: answers.append(guarded(spec, Limits())))
    thread.start()
    for _ in range(kills):
        (victim,) = until(lambda: children() - seen)
        seen.add(victim)
        os.kill(victim, signal.SIGKILL)
    thread.join()
    summary = RunSummary.from_json(answers[0])
    assert summary.status == status
    assert summary.reason == ("its process was ended by signal 9 (SIGKILL)" if kills == 2 else "")


def test_a_worker_ends_with_whoever_asked(tmp_path: Path):
    """A sweep that is killed leaves no process behind."""
    script = (
        f"import sys; sys.path[:] = {sys.path!r}; from hectorscope.sweep.guard import Worker;"
        " print(Worker()._process.pid, flush=True); sys.stdin.read()"
    )
    asking = subprocess.Popen(
        [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert asking.stdout is not None
    worker = int(asking.stdout.readline())
    assert Path(f"/proc/{worker}").exists()
    asking.kill()
    asking.wait()

    def gone() -> bool:
        try:
            return Path(f"/proc/{worker}/stat").read_text().split()[2] == "Z"
        except OSError:
            return True

    until(gone)


def test_a_bad_number_of_workers_is_refused():
    """Before anything is started."""
    with pytest.raises(ClusterError, match="--workers is -1"), executor(-1):
        pass


def test_limits_are_checked():
    """Below nothing, or no number."""
    for limits in (Limits(time_s=-1.0), Limits(memory_mb=float("nan"))):
        with pytest.raises(LimitError, match="give a number above 0"):
            limits.check()


# --------------------------------------------------------------------------------------------- command line


def test_the_command_makes_the_product_and_goes_on(bag: Path, tmp_path: Path):
    """Twice: the second time nothing is run; a third time more values are, and the best settings are printed."""
    flags = ["sweep", bag, "--out", tmp_path, "--workers", 2, "--fusion.omega", 0.05, "--parquet"]
    first = hectorscope(*flags, "--vary", "matcher.sigma=0.1,0.4", "--vary", "map.levels=2:3:2")
    assert first.returncode == 0, first.stderr
    assert "4 runs: 4 ok" in first.stdout
    assert "Best settings by truth.aligned_rmse_m" in first.stdout
    content = (tmp_path / "runs.csv").read_bytes()
    again = hectorscope(*flags, "--vary", "matcher.sigma=0.1,0.4", "--vary", "map.levels=2:3:2")
    assert again.returncode == 0, again.stderr
    assert (tmp_path / "runs.csv").read_bytes() == content
    assert hectorscope(*flags, "--vary", "matcher.sigma=0.1:0.4:3", "--vary", "map.levels=2,3").returncode == 0
    assert len(read(tmp_path)) == 6
    assert (tmp_path / "runs.parquet").exists()
    spec = json.loads(next((tmp_path / "details").iterdir()).read_text())["spec"]
    assert spec["settings"]["fusion.omega"] == 0.05


def test_a_search_by_halving_ends_with_whole_runs_of_the_best(bag: Path, tmp_path: Path):
    """Nine settings on a ninth of the time, three on a third, one on all of it: the best of those before."""
    flags = ["sweep", bag, "--out", tmp_path, "--search", 9, "--halving", "--workers", 2]
    found = hectorscope(*flags, "--vary", "fusion.omega=0.001:0.9:log", "--target", "consistency")
    assert found.returncode == 0, found.stderr
    rows = read(tmp_path)
    shares = [float(row["share"]) for row in rows]
    assert [shares.count(share) for share in sorted(set(shares))] == [9, 3, 1]
    thirds = [row for row in rows if 0.2 < float(row["share"]) < 0.5]
    best = max(thirds, key=lambda row: (row["status"] == "ok", float(row["consistency"])))
    assert rows[-1]["fusion.omega"] == best["fusion.omega"]


def test_a_recording_by_address_is_run_as_that_on_the_disk(bag: Path, tmp_path: Path):
    """Fsspec brings it; figures are equal, and the table has the address."""
    flags = ["--vary", "matcher.sigma=0.1", "--workers", 1]
    assert hectorscope("sweep", bag.as_uri(), "--out", tmp_path / "a", *flags).returncode == 0
    assert hectorscope("sweep", bag, "--out", tmp_path / "b", *flags).returncode == 0
    (by_address,), (by_path,) = read(tmp_path / "a"), read(tmp_path / "b")
    assert by_address["recording"] == bag.as_uri()
    assert by_address[WITH_TRUTH] == by_path[WITH_TRUTH] != ""


def test_an_interrupted_sweep_ends_at_once_and_keeps_its_rows(bag: Path, long_bag: Path, tmp_path: Path):
    """Exit code 130, no process left, the short run in the table and not the one that was stopped."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "sweep", bag, long_bag, "--out", tmp_path]
    flags = ["--workers", "1", "--vary", "matcher.sigma=0.1", "--time-limit", "0"]
    begun = subprocess.Popen([*map(str, command), *flags], stderr=subprocess.PIPE, text=True)
    until(lambda: (tmp_path / "runs.csv").exists() and read(tmp_path))
    workers = children(begun.pid)
    assert workers
    begun.send_signal(signal.SIGINT)
    begun.communicate(timeout=PATIENCE_S)
    assert begun.returncode == 130
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)
    assert [row["recording"] for row in read(tmp_path)] == [str(bag)]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ([], "--out is missing"),
        (["--out", "OUT"], "there is no recording"),
        (["BAG", "--out", "OUT", "--vary", "matcher.sigmo=1"], "did you mean matcher.sigma?"),
        (["BAG", "--out", "OUT", "--halving"], "--halving is a way to search"),
        (["BAG", "--out", "OUT", "--search", "-1"], "--search -1 is less than nothing"),
        (["BAG", "--out", "OUT", "--runs", "BAG", "--vary", "matcher.sigma=1"], "leave --vary and --search out"),
        (["BAG", "--out", "OUT", "--target", "speed"], "--target speed is no figure"),
        (["BAG", "--out", "OUT", "--time-limit", "-1"], "--time-limit is -1"),
        (["BAG", "--out", "OUT", "--cluster", "tcp://127.0.0.1:9"], "no Dask scheduler answers"),
        (["BAG", "--out", "OUT", "--relations", "BAG"], "--relations"),
        (["--show", "OUT"], "has no runs.csv"),
    ],
)
def test_mistakes_are_named_before_anything_is_run(flags: list[str], message: str, bag: Path, tmp_path: Path):
    """One line, exit code 2, no row."""
    names = {"BAG": str(bag), "OUT": str(tmp_path / "out")}
    refused = hectorscope("sweep", *(names.get(flag, flag) for flag in flags))
    assert refused.returncode == 2, refused.stderr
    assert "Traceback" not in refused.stderr
    assert message in refused.stderr
    assert not (tmp_path / "out" / "runs.csv").exists()


def test_relations_score_a_run(bag: Path, tmp_path: Path):
    """`run --relations` prints them and leaves them in metrics.json; a sweep has the same figures in its table."""
    path = tmp_path / "some.relations"
    pairs = [
        (START_NS / 1e9 + begin, START_NS / 1e9 + end) for begin, end in ((1.0, 2.0), (1.5, 2.5), (90.0, 91.0))
    ]
    path.write_text("".join(f"{begin:.3f} {end:.3f} 1 0 0 0 0 0\n" for begin, end in pairs))
    done = hectorscope("run", bag, "--out", tmp_path / "run", "--relations", path)
    assert done.returncode == 0, done.stderr
    assert "over 2 of 3" in done.stdout
    found = json.loads((tmp_path / "run" / "metrics.json").read_text())["relations"]
    assert (found["given"], found["used"]) == (3, 2)
    assert hectorscope("sweep", bag, "--out", tmp_path / "sweep", "--relations", path).returncode == 0
    (row,) = read(tmp_path / "sweep")
    for name, value in found.items():
        assert float(row[f"relations.{name}"]) == value


def test_a_disk_without_room_ends_the_sweep_with_a_message(bag: Path, tmp_path: Path):
    """What is done is kept: the table is whole."""
    specs = specs_of(bag)
    table = done(tmp_path, specs[:1])
    (tmp_path / "details").rename(tmp_path / "elsewhere")
    (tmp_path / "details").write_text("in the way")
    with pytest.raises(OutputError, match="cannot be written to"), executor(1) as pool:
        sweep(specs, table, pool, Limits())
    assert len(read(tmp_path)) == 1
