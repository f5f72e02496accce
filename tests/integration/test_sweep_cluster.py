"""Sweeps on a real Dask scheduler with workers, all of them processes of their own."""

import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from hectorscope.sweep.executors import ClusterError, executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Table, read
from tests.sweeps import PATIENCE_S, recording, specs_of, timeless, until

pytest.importorskip("distributed")
SIGMAS = tuple(round(0.1 + 0.05 * k, 2) for k in range(8))
LOCAL = "127.0.0.1"


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Half a minute: a run lasts long enough to be killed."""
    return recording(tmp_path_factory.mktemp("cluster"), duration=30.0)


class Cluster:
    """A scheduler and its workers, started as a person would."""

    def __init__(self, folder: Path) -> None:
        self._folder, self.port = folder, 0
        self.processes: list[subprocess.Popen[str]] = []

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        """One process of Dask, `dask_scheduler` or `dask_worker`; it ends with the test."""
        command = [sys.executable, "-m", f"distributed.cli.{arguments[0]}", *arguments[1:]]
        with self.log(len(self.processes)).open("w") as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder, text=True)
        self.processes.append(process)
        return process

    def log(self, k: int) -> Path:
        """What the k-th process says."""
        return self._folder / f"{k}.log"

    def scheduler(self) -> subprocess.Popen[str]:
        """At the same port if it is started again."""
        process = self.start("dask_scheduler", "--host", LOCAL, "--port", str(self.port), "--no-dashboard")
        log = self.log(len(self.processes) - 1)
        found = until(lambda: re.search(rf"Scheduler at:\s+tcp://{LOCAL}:(\d+)", log.read_text()))
        self.port = int(found[1])
        return process

    def worker(self) -> subprocess.Popen[str]:
        """With one thread: a run at a time."""
        flags = ["--nthreads", "1", "--no-dashboard", "--host", LOCAL, "--no-nanny", "--death-timeout", "60"]
        return self.start("dask_worker", self.address, *flags)

    @property
    def address(self) -> str:
        """Of the scheduler."""
        return f"tcp://{LOCAL}:{self.port}"


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler with two workers."""
    folder = tmp_path / "cluster"
    folder.mkdir()
    made = Cluster(folder)
    made.scheduler()
    made.worker()
    made.worker()
    yield made
    for process in made.processes:
        process.kill()
        process.wait()


@contextmanager
def swept(folder: Path, specs: list[RunSpec], address: str = "") -> Iterator[list[Exception]]:
    """A sweep in a thread, while something else happens; it is over afterwards. Its error is in the list."""
    folder.mkdir(exist_ok=True)
    errors: list[Exception] = []

    def whole() -> None:
        table = Table(folder, ["matcher.sigma"])
        try:
            with executor(2, address) as pool:
                sweep(specs, table, pool, Limits())
            table.finish(specs)
        except ClusterError as error:
            errors.append(error)

    thread = threading.Thread(target=whole)
    thread.start()
    yield errors
    thread.join(PATIENCE_S)
    assert not thread.is_alive()


@pytest.mark.slow
def test_a_cluster_gives_the_same_table_when_a_worker_is_killed(bag: Path, tmp_path: Path, cluster: Cluster):
    """Every cell but the times is that of this machine alone; the runs of the killed worker are there."""
    specs = specs_of(bag, sigmas=SIGMAS)
    with swept(tmp_path / "local", specs) as errors:
        pass
    with swept(tmp_path / "remote", specs, cluster.address) as lost:
        until(lambda: len(read(tmp_path / "remote")) >= 2)
        os.kill(cluster.processes[1].pid, signal.SIGKILL)
    assert errors == lost == []
    assert timeless(tmp_path / "remote") == timeless(tmp_path / "local")
    assert {row["status"] for row in read(tmp_path / "remote")} == {"ok"}


@pytest.mark.slow
def test_after_the_scheduler_was_lost_the_rest_is_done(bag: Path, tmp_path: Path, cluster: Cluster):
    """The sweep ends with a message and keeps its rows; on a new scheduler it does those that are missing."""
    specs = specs_of(bag, sigmas=SIGMAS)
    with swept(tmp_path / "out", specs, cluster.address) as errors:
        until(lambda: len(read(tmp_path / "out")) >= 2)
        cluster.processes[0].kill()
    assert [type(error) for error in errors] == [ClusterError]
    assert "start the same command again" in str(errors[0])
    before = {row["key"]: row for row in read(tmp_path / "out")}
    assert 2 <= len(before) < len(specs)
    cluster.scheduler()
    cluster.worker()
    with swept(tmp_path / "out", specs, cluster.address) as errors:
        pass
    after = {row["key"]: row for row in read(tmp_path / "out")}
    assert not errors
    assert len(after) == len(specs)
    assert before.items() <= after.items()
