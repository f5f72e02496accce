"""Where runs are done: processes of this machine, or whatever a Dask scheduler has. No scheduler of our own."""

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from typing import Any, cast

from hectorscope.sweep.guard import stop
from slam_core.errors import SlamError

PATIENCE_S = 10.0  # until a scheduler answers


class ClusterError(SlamError):
    """The cluster cannot be used, or was lost."""


@contextmanager
def executor(workers: int, cluster: str = "") -> Iterator[Executor]:
    """An executor for `guarded`; ClusterError if the cluster cannot be reached.

    workers: processes of this machine, 0 for one a processor: each is watched by a thread, so that it may die
    without breaking the pool. cluster: the address of a Dask scheduler, in the place of them.
    """
    with _cluster(cluster) if cluster else _processes(workers) as made:
        yield made


@contextmanager
def _processes(workers: int) -> Iterator[Executor]:
    if workers < 0:
        raise ClusterError(f"--workers is {workers}: give a number of processes, or 0 for one a processor")
    pool = ThreadPoolExecutor(workers or len(os.sched_getaffinity(0)), thread_name_prefix="sweep")
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        stop()


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    try:
        dask: Any = import_module("distributed")  # an extra
    except ImportError as error:
        raise ClusterError("--cluster needs Dask: run pip install 'hectorscope[cluster]'") from error
    try:
        client = dask.Client(address, timeout=PATIENCE_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {address} ({type(error).__name__}): start one, or leave --cluster out"
        ) from error
    try:
        # Not pure: two runs of the same spec are two runs.
        yield cast(Executor, client.get_executor(pure=False))
    finally:
        client.close(timeout=PATIENCE_S)
