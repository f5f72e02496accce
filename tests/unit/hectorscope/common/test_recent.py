"""The list of the recordings that were opened last."""

import json
import stat
from pathlib import Path

import pytest

from hectorscope.common.recent import MOST, Recent


def made(folder: Path, count: int) -> list[Path]:
    """So many files."""
    paths = [folder / f"{n}.bag" for n in range(count)]
    for path in paths:
        path.touch()
    return paths


def test_the_newest_comes_first_and_once(tmp_path: Path) -> None:
    """One that is opened again moves to the front; the oldest of too many goes; another program sees the same."""
    file, paths = tmp_path / "state" / "recent.json", made(tmp_path, MOST + 2)
    recent = Recent(file)
    for path in (*paths, paths[5]):
        recent.add(path)
    assert Recent(file).paths() == recent.paths()
    assert recent.paths()[:2] == [paths[5], paths[-1]]
    assert len(recent.paths()) == MOST
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert [each.name for each in file.parent.iterdir()] == [file.name]


def test_what_is_gone_is_not_listed(tmp_path: Path) -> None:
    """A recording that was removed meanwhile."""
    first, second = made(tmp_path, 2)
    recent = Recent(tmp_path / "recent.json")
    recent.add(first)
    recent.add(second)
    second.unlink()
    assert recent.paths() == [first]


@pytest.mark.parametrize(
    "content",
    [b"", b"{", b"{}", b"[1, null, []]", b'["relative.bag", "/\\u0000"]', b"\xff", b"[" * 50_000, b'"/etc"'],
)
def test_a_damaged_list_is_an_empty_one(tmp_path: Path, content: bytes) -> None:
    """Whatever stands in the file; the next recording repairs it."""
    file = tmp_path / "recent.json"
    file.write_bytes(content)
    recent, (path,) = Recent(file), made(tmp_path, 1)
    assert recent.paths() == []
    recent.add(path)
    assert json.loads(file.read_text()) == [str(path)]


def test_a_place_that_takes_nothing_is_no_matter(tmp_path: Path) -> None:
    """Where a file stands in the way of the folder nothing is kept; without a home as long as the program runs."""
    (path,) = made(tmp_path, 1)
    for recent, kept in ((Recent(None), [path]), (Recent(path / "recent.json"), [])):
        recent.add(path)
        assert recent.paths() == kept
