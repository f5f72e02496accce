"""Runs specs in processes that may die: the one that asks lives on, and gets a summary in any case.

`guarded` is what executors carry, to threads of this process or to another machine.
"""

import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time

from hectorscope.sweep.limits import Limits, resident_mb
from hectorscope.sweep.spec import RunSummary
from hectorscope.sweep.worker import READY

WATCH_S = 0.05
START_S = 1800.0  # on a first start all kernels are compiled
TRIES = 2  # of a run whose process dies: it may have been killed by chance
SERVE = "import sys; sys.path[:] = {!r}; from hectorscope.sweep.worker import serve; serve()"
ALONE = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
)  # each process has one processor


class Pool:
    """The processes of this one: those that run something, and those that wait for the next run."""

    def __init__(self) -> None:
        self._idle: list[Worker] = []
        self._busy: set[Worker] = set()
        self._lock = threading.Lock()
        self._round = 0

    def run(self, spec: str, limits: Limits) -> RunSummary:
        """One run; again in another process if its own died, but not because all were stopped."""
        begun, summary = self._round, RunSummary("crashed", "the sweep was stopped")
        for _ in range(TRIES):
            worker = self._taken(begun)
            if worker is None:
                break
            summary = worker.run(spec, limits)
            self._left(worker)
            if summary.status != "crashed":
                break
        return summary

    def _taken(self, begun: int) -> "Worker | None":
        """A process for a run; None if all were stopped since it was begun."""
        with self._lock:
            if self._round != begun:
                return None
            worker = self._idle.pop() if self._idle else Worker()
            self._busy.add(worker)
            return worker

    def _left(self, worker: "Worker") -> None:
        with self._lock:
            self._busy.discard(worker)
            if worker.alive:
                self._idle.append(worker)

    def stop(self) -> None:
        """End all of them, whatever they do."""
        with self._lock:
            self._round += 1
            workers, self._idle = [*self._idle, *self._busy], []
        for worker in workers:
            worker.stop()


_pool = Pool()
stop = _pool.stop


def guarded(spec: str, limits: Limits) -> str:
    """The summary of a run, whatever becomes of its process. spec, summary: as JSON."""
    return _pool.run(spec, limits).as_json()


class Worker:
    """A process that serves, and what it has answered."""

    def __init__(self) -> None:
        command = [sys.executable, "-c", SERVE.format(sys.path)]
        pipe, self._errors = subprocess.PIPE, tempfile.TemporaryFile()  # noqa: SIM115  as long as the process
        self._process = subprocess.Popen(
            command,
            stdin=pipe,
            stdout=pipe,
            stderr=self._errors,
            text=True,
            encoding="utf-8",
            start_new_session=True,  # an interrupt at the terminal is not for it
            env={**dict.fromkeys(ALONE, "1"), **os.environ},
        )
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._listen, name="answers", daemon=True).start()
        self._begun = False

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._answers.put(line)
        self._answers.put("")

    @property
    def alive(self) -> bool:
        """Whether it takes another run."""
        return self._process.poll() is None

    def run(self, spec: str, limits: Limits) -> RunSummary:
        """One run within its limits; a process that breaks one is killed."""
        if not self._begun:
            started = self._wait(Limits(START_S))
            if isinstance(started, RunSummary):
                return started
            self._begun = started.strip() == READY
        assert self._process.stdin is not None
        begin = time.perf_counter()
        try:
            self._process.stdin.write(f"{spec}\n")
            self._process.stdin.flush()
        except OSError:  # it died while it was idle: the answer says so
            pass
        answer = self._wait(limits)
        if isinstance(answer, str):
            return RunSummary.from_json(answer)
        return _timed(answer, time.perf_counter() - begin)

    def _wait(self, limits: Limits) -> str | RunSummary:
        """The next answer, or why there is none."""
        begin = time.monotonic()
        while True:
            try:
                line = self._answers.get(timeout=WATCH_S)
            except queue.Empty:
                pass
            else:
                return line or RunSummary("crashed", self._ending())
            if limits.time_s and time.monotonic() - begin > limits.time_s:
                self.stop()
                return RunSummary("timeout", f"it took more than {limits.time_s:g} s (--time-limit)")
            if limits.memory_mb and resident_mb(self._process.pid) > limits.memory_mb:
                self.stop()
                return RunSummary("memory", f"it took more than {limits.memory_mb:g} MiB (--memory-limit)")

    def _ending(self) -> str:
        """How the process ended, with the last line of its errors."""
        code = self._process.wait()
        how = (
            f"was ended by signal {-code} ({signal.Signals(-code).name})"
            if code < 0
            else f"ended with code {code}"
        )
        self._errors.seek(0)
        said = self._errors.read().decode("utf-8", "replace").split("\n")
        last = next((line.strip() for line in reversed(said) if line.strip()), "")
        return f"its process {how}" + (f": {last[:200]}" if last else "")

    def stop(self) -> None:
        """Kill it."""
        self._process.kill()
        self._process.wait()


def _timed(summary: RunSummary, seconds: float) -> RunSummary:
    return RunSummary(summary.status, summary.reason, wall_s=round(seconds, 3))
