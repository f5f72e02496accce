"""Recordings that go on at any item."""

import random
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hectorscope.inputs import Item, Rereadable, Seekable, SourceOptions
from hectorscope.sources import open_source
from tests.bags import CONTAINERS, messages_for, open_run, small_run
from tests.conftest import ROOT
from tests.ros_messages import write_bag
from tests.unit.hectorscope.sources.test_text_logs import RANGES, flaser, write


def values(item: Any) -> Iterator[Any]:
    """Everything in a measurement, to the byte."""
    yield type(item)
    for field in fields(item):
        value = getattr(item, field.name)
        if is_dataclass(value):
            yield from values(value)
        else:
            yield value.tobytes() if isinstance(value, np.ndarray) else value


def listed(items: Iterator[Item]) -> list[list[Any]]:
    return [list(values(item)) for item in items]


def check_places(source: Seekable, seed: int) -> None:
    """At random items, what `items_from` gives is what `items` went on with, and so are the counters."""
    whole, report = listed(source.items()), source.report
    assert whole
    for count in random.Random(seed).choices(range(1, len(whole) + 1), k=8):
        for _ in islice(source.items(), count):
            pass
        place = source.place()
        for _ in range(2):  # a place is not used up
            assert listed(source.items_from(place)) == whole[count:]
            assert source.report == report


def check_again(source: Seekable) -> None:
    """Two readings in turn give the same items, with counters of their own; a place of one holds in the other."""
    whole, report = listed(source.items()), source.report
    assert isinstance(source, Rereadable)
    other = source.again()
    assert other is not None
    here, there = source.items(), other.items()
    assert listed(islice(here, 3)) == whole[:3]
    assert listed(islice(there, len(whole) // 2)) == whole[: len(whole) // 2]
    place = other.place()
    assert listed(here) == whole[3:]
    assert source.report == report
    other.close()
    assert listed(source.items_from(place)) == whole[len(whole) // 2 :]


@pytest.mark.parametrize("name", CONTAINERS)
def test_every_container_goes_on_at_any_item(tmp_path: Path, name: str) -> None:
    """With index and without, the items behind a place are the same to the byte, with the same counters."""
    source = open_run(write_bag(tmp_path / name, small_run(messages_for(name))))
    assert isinstance(source, Seekable)
    check_places(source, 1)
    check_again(source)


def test_a_bag_without_an_index_goes_on_at_any_item(tmp_path: Path) -> None:
    """One that was cut off is read by scanning."""
    path = write_bag(tmp_path / "run.bag", small_run(messages_for("run.bag")))
    path.write_bytes(path.read_bytes()[: 3 * path.stat().st_size // 4])
    source = open_run(path)
    assert isinstance(source, Seekable)
    check_places(source, 2)


@pytest.mark.parametrize("name", ["arena.bag", "littoral.mcap"])
def test_a_demo_goes_on_in_its_middle(name: str) -> None:
    """Also with tf, aids and a truth."""
    source = open_source(str(ROOT / "demo_bags" / name), SourceOptions())
    assert isinstance(source, Seekable)
    reading = source.items()
    for _ in islice(reading, 7000):
        pass
    place = source.place()
    assert listed(islice(source.items_from(place), 500)) == listed(islice(reading, 500))


def test_a_text_log_goes_on_at_any_item(tmp_path: Path) -> None:
    """Also between the wheels and the scan of one line."""
    lines = [flaser(0.2 * i, RANGES, wheels=(0.1 * i, 0, 0)) for i in range(12)]
    source = open_source(write(tmp_path / "a.log", lines), SourceOptions())
    assert isinstance(source, Seekable)
    check_places(source, 3)
    check_again(source)
