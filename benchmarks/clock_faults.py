"""Recordings whose sensors are stamped by clocks that know nothing of each other."""

import tempfile
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import numpy as np

from benchmarks.broken import Break, Entry, broken_by
from hectorscope.inputs import Item, SourceOptions
from hectorscope.simulation import ScenarioName, SceneOptions, SimulateOptions, simulate
from hectorscope.sources import open_source

BOOTED_S = -1.6999e9  # by which a clock is ahead that counts from its start
DELAY_S = 0.003  # that a message takes longer than it must, in the mean
STALL_SHARE, STALL_S = 0.02, 0.05  # of the messages, and how much longer these take


def apart(field: str, ahead_s: float, drift: float = 0.0, from_s: float = 0.0) -> Break:
    """The clock of the messages that have a field is ahead by so much from so many seconds on.

    drift: seconds a second by which it is too fast.
    """

    def broken(entries: Iterator[Entry], begin_ns: int) -> Iterator[Entry]:
        for topic, message, log_ns in entries:
            since_s = (log_ns - begin_ns) * 1e-9
            if hasattr(message, field) and since_s >= from_s:
                stamp = message.header.stamp
                own_ns = stamp.sec * 10**9 + stamp.nanosec + round(1e9 * (ahead_s + drift * since_s))
                stamp.sec, stamp.nanosec = divmod(own_ns, 10**9)
            yield topic, message, log_ns

    return broken


def delivered(seed: int) -> Break:
    """Messages take longer than they must to the recorder, each by its own."""

    def broken(entries: Iterator[Entry], begin_ns: int) -> Iterator[Entry]:
        rng, late, last = np.random.default_rng([seed, 31]), list[Entry](), dict[str, int]()
        for topic, message, log_ns in entries:
            stall_s = STALL_S if rng.random() < STALL_SHARE else 0.0
            due_ns = log_ns + round(1e9 * (rng.exponential(DELAY_S) + stall_s))
            last[topic] = max(last.get(topic, 0), due_ns)  # those of one topic stay in order
            late.append((topic, message, last[topic]))
        return iter(sorted(late, key=lambda entry: entry[2]))

    return broken


def recorded_by(broken: Break, scene: ScenarioName, options: SceneOptions, seed: int) -> list[Item]:
    """What a reader makes of a drive that was recorded so; messages need some time to the recorder."""
    with tempfile.TemporaryDirectory() as folder:
        whole, apart_by, late = (Path(folder) / f"{name}.bag" for name in ("whole", "apart", "late"))
        given = {each.name: getattr(options, each.name) for each in fields(SceneOptions)}
        simulate(SimulateOptions(scenario=scene, out=whole, **{**given, "seed": seed}))
        broken_by(delivered(seed), broken_by(broken, whole, apart_by), late)
        return list(open_source(str(late), SourceOptions()).items())
