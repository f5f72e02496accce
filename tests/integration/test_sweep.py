"""Sweeps on this machine: real recordings, real processes, and processes that die."""

import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.exporters import OutputError
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.settings import Settings
from hectorscope.sources import open_source
from hectorscope.sweep.execute import Beginning, execute
from hectorscope.sweep.executors import ClusterError, executor
from hectorscope.sweep.guard import guarded, stop
from hectorscope.sweep.limits import LimitError, Limits
from hectorscope.sweep.spec import RunSpec, RunSummary
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Table, read
from slam_core.config import SlamConfig, with_values
from tests.bags import small_run
from tests.ros_messages import Messages, write_bag
from tests.sweeps import SIGMAS, WITH_TRUTH, children, specs_of, timeless, until

USUAL = Limits()


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


def test_a_row_has_the_figures_of_the_run(short_bag: Path):
    """As `run` would write them: errors against the truth, states, counts; and a picture and a path beside."""
    summary = execute(RunSpec("short.bag", str(short_bag), {"matcher.sigma": 0.2}))
    source = open_source(str(short_bag), RunSpec("", "").source_options())
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


def test_the_beginning_of_a_recording_is_run_alone(short_bag: Path):
    """Half of its time has half of its scans."""
    whole = execute(RunSpec("short.bag", str(short_bag)))
    half = execute(RunSpec("short.bag", str(short_bag), share=0.5))
    assert whole.figures["scans.read"] == 60
    assert 28 <= float(str(half.figures["scans.read"])) <= 32


def test_the_beginning_has_the_same_scans_with_whatever_delay(tmp_path: Path):
    """Settings are compared on the same part of a recording: a delay moves stamps, and not the end."""
    path = write_bag(tmp_path / "run.bag", [entry for entry in small_run(Messages("ros1")) if entry[0] == "/scan"])
    for delay in (0.0, 0.3):
        options = RunSpec("", "", options={"scan_delay": delay}).source_options()
        part = Beginning(CheckedSource(partial(open_source, str(path)), options), 0.5)
        assert len(list(part.items())) == 25


@pytest.mark.slow
def test_every_executor_gives_the_same_table(short_bag: Path, tmp_path: Path):
    """One process, two in the opposite order, and a pool of Python's own: all cells are equal but for times."""
    specs, folders = specs_of(short_bag), [tmp_path / name for name in "abc"]
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


@pytest.mark.slow
def test_a_process_does_many_runs_in_the_same_memory(short_bag: Path, tmp_path: Path):
    """One process loads the kernels once and does all; after 40 runs it takes no more than after a few."""
    specs = specs_of(short_bag, sigmas=tuple(round(0.1 + 0.01 * k, 2) for k in range(40)))
    rows = list(done(tmp_path, specs, 1).rows.values())
    assert len({row["worker"] for row in rows}) == 1
    assert float(rows[-1]["memory_mb"]) < float(rows[7]["memory_mb"]) + 16.0


@pytest.mark.slow
def test_started_again_it_does_what_is_missing(short_bag: Path, tmp_path: Path):
    """Rows that are there are left as they are, times too."""
    specs = specs_of(short_bag)
    done(tmp_path, specs[:2])
    before = read(tmp_path)
    done(tmp_path, specs)
    assert read(tmp_path)[:2] == before
    assert len(read(tmp_path)) == len(specs)


def test_what_breaks_is_a_row_with_its_reason(short_bag: Path, long_bag: Path, tmp_path: Path):
    """A limit of time or memory, a recording that is none, and one that is not there: the others go on."""
    broken = tmp_path / "broken.bag"
    broken.write_bytes(b"no bag at all")
    (slow,) = specs_of(long_bag, sigmas=(0.1,))
    done(tmp_path, [slow], limits=Limits(time_s=0.05))
    done(tmp_path, specs_of(short_bag, sigmas=(0.2,)), limits=Limits(memory_mb=20.0))
    done(tmp_path, specs_of(broken, tmp_path / "missing.bag", short_bag, sigmas=(0.3,)))
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


def test_a_disk_without_room_ends_the_sweep_with_a_message(short_bag: Path, tmp_path: Path):
    """What is done is kept: the table is whole."""
    specs = specs_of(short_bag)
    table = done(tmp_path, specs[:1])
    (tmp_path / "details").rename(tmp_path / "elsewhere")
    (tmp_path / "details").write_text("in the way")
    with pytest.raises(OutputError, match="cannot be written to"), executor(1) as pool:
        sweep(specs, table, pool, Limits())
    assert len(read(tmp_path)) == 1
