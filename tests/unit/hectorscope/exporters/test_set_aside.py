"""What an earlier run left in the folder for results, before another one writes there."""

import os
from pathlib import Path

import pytest

from hectorscope.exporters import OutputError, clear, prepare
from hectorscope.exporters._folder import EARLIER

WHEN_S = 1_795_749_093  # 2026-11-27 03:11:33 UTC
TIME = "20261127T031133Z"


def left(folder: Path, when_s: float = WHEN_S) -> None:
    """An earlier run, of all formats and half a minute of writing, and a file of the person."""
    for number, name in enumerate(("trajectory.tum", "map.npz", "replay.html", "report.html", "plan.txt")):
        (folder / name).write_text(name)
        os.utime(folder / name, (when_s, when_s - 30 * (number != 1)))


def names(folder: Path) -> set[str]:
    """Of the files in a folder."""
    return {path.name for path in folder.iterdir()}


def test_all_results_and_nothing_else_go_to_the_time_of_the_run(tmp_path: Path):
    """Whatever the formats, with what they hold; the sentence names the place; without results there is none."""
    left(tmp_path)
    place = tmp_path / EARLIER / TIME
    assert str(place) in clear(tmp_path)
    assert names(tmp_path) == {"plan.txt", EARLIER}
    assert names(place) == {"trajectory.tum", "map.npz", "replay.html", "report.html"}
    assert (place / "map.npz").read_text() == "map.npz"
    assert not clear(tmp_path)


def test_a_crash_between_two_moves_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The next run moves the rest to the same place."""
    left(tmp_path)
    rename, moved = Path.rename, list[Path]()

    def crashing(path: Path, target: Path) -> Path:
        if len(moved) == 2:
            raise KeyboardInterrupt
        moved.append(path)
        return rename(path, target)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Path, "rename", crashing)
        clear(tmp_path)
    assert len(names(tmp_path / EARLIER / TIME)) == 2
    clear(tmp_path)
    assert names(tmp_path) == {"plan.txt", EARLIER}
    assert names(tmp_path / EARLIER / TIME) == {"trajectory.tum", "map.npz", "replay.html", "report.html"}


def test_two_runs_of_one_second_are_kept_apart(tmp_path: Path):
    """No file that was set aside is ever replaced."""
    for _ in range(2):
        left(tmp_path)
        clear(tmp_path)
    assert names(tmp_path / EARLIER) == {TIME, f"{TIME}-2"}


def test_a_folder_that_cannot_take_earlier_results_is_refused_at_the_start(tmp_path: Path):
    """A file of that name: with the remedy, and left as it is."""
    (tmp_path / EARLIER).write_text("mine")
    with pytest.raises(OutputError, match="earlier takes no earlier results: remove it or give another --out"):
        prepare(tmp_path)
    assert (tmp_path / EARLIER).read_text() == "mine"
