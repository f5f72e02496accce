"""What a stream gives, to be compared with what is recorded."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import Item, Source, SourceOptions
from hectorscope.sources import open_source

TOPICS = ("--topics", "/tf_static", "/scan", "/imu/data_raw", "/pressure", "/ground_truth")
GIVE_UP_S = 60.0


def plain(value: Any) -> Any:
    """A measurement as something that can be compared, to the last bit."""
    if is_dataclass(value):
        return type(value).__name__, *(plain(getattr(value, f.name)) for f in fields(value))
    return value.tobytes() if isinstance(value, np.ndarray) else value


@contextmanager
def opened(uri: str | Path) -> Iterator[Source]:
    """An open source that ends by itself when a test would otherwise wait for ever."""
    source = open_source(str(uri), SourceOptions())
    watchdog = threading.Timer(GIVE_UP_S, source.close)
    watchdog.start()
    try:
        yield source
    finally:
        watchdog.cancel()
        source.close()


def recorded(path: Path) -> list[Item]:
    with opened(path) as source:
        return list(source.items())


def poses(start_ns: int, rows: NDArray[np.float64]) -> tuple[list[int], bytes]:
    """The nanoseconds of a trajectory and the bytes of its poses; runs may count from different starts."""
    return [start_ns + round(seconds * 1e9) for seconds in rows[:, 0]], rows[:, 1:].tobytes()


def wait_for(condition: Callable[[], bool]) -> None:
    """Until it holds; a test that waits too long fails."""
    done = threading.Event()
    for _ in range(int(GIVE_UP_S / 0.02)):
        if condition():
            return
        done.wait(0.02)
    raise AssertionError("waited in vain")
