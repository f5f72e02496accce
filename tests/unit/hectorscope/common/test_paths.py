"""Paths that lead nowhere: what a message says of them."""

from pathlib import Path

import pytest

from hectorscope.common.paths import absence, exists
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.sources import open_source


def test_a_mistyped_path_gets_the_nearest_one(tmp_path: Path) -> None:
    """The first part that is missing is put right: a file or a folder."""
    (tmp_path / "bags").mkdir()
    (tmp_path / "bags" / "kitchen.bag").touch()
    (tmp_path / "bags" / "hall.bag").touch()
    right = tmp_path / "bags" / "kitchen.bag"
    assert absence(right) == ""
    assert absence(right.with_name("kitchne.bag")) == f"does not exist (did you mean {right}?)"
    assert absence(tmp_path / "bgas" / "hall.bag") == f"does not exist (did you mean {tmp_path / 'bags'}?)"
    assert absence(tmp_path / "bags" / "0.mcap") == "does not exist"


def test_what_cannot_be_reached_is_not_there(tmp_path: Path) -> None:
    """With the reason of the system, and nothing proposed."""
    path = tmp_path / ("a" * 300)
    assert not exists(path)
    assert absence(path).startswith("cannot be reached (")


@pytest.mark.parametrize("name", ["kitchne.bag", "kitchen.gab", "kitchn"])
def test_a_mistyped_recording_gets_the_nearest_one(tmp_path: Path, name: str) -> None:
    """Whether or not its ending is that of a recording."""
    (tmp_path / "kitchen.bag").touch()
    with pytest.raises(SourceError, match=r"does not exist \(did you mean .*kitchen\.bag\?\)"):
        open_source(str(tmp_path / name), SourceOptions())
