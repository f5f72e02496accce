"""Rows of a run beside the checkpoints of its journal."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.run.rows import GrowingRows
from hectorscope.session.journal_files import JournalError
from hectorscope.session.row_files import RowFiles, read_rows


def filled(count: int) -> GrowingRows:
    """Three columns, of which the last is not compared."""
    rows = GrowingRows(3, besides=[2])
    rows.extend(np.arange(3.0 * count).reshape(-1, 3))
    return rows


def test_a_checkpoint_appends_what_is_new(tmp_path: Path) -> None:
    """The file grows by it, and each checkpoint reads its own rows from the same file."""
    rows, files = filled(20_000), RowFiles(tmp_path)
    first = files.append(0, rows.share())
    (path,) = tmp_path.iterdir()
    size, begin = path.stat().st_size, path.read_bytes()[:1000]
    rows.extend(np.ones((5, 3)))
    second = files.append(0, rows.share())
    assert path.stat().st_size == size + 5 * 3 * 8
    assert path.read_bytes()[:1000] == begin
    for kept, count in ((first, 20_000), (second, 20_005)):
        again = read_rows(tmp_path, kept)
        np.testing.assert_array_equal(again.view, rows.view[:count])
        assert again.compared == rows.compared


def test_a_run_that_was_begun_anew_gets_another_file(tmp_path: Path) -> None:
    """The old one is there until the checkpoint that names it is replaced. Other rows have files of their own."""
    files = RowFiles(tmp_path)
    old, other = files.append(0, filled(10)), files.append(1, filled(4))
    new = files.append(0, filled(3))
    assert len({old.name, other.name, new.name}) == 3
    assert len(read_rows(tmp_path, old)) == 10
    files.tidy()
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted((other.name, new.name))
    assert len(read_rows(tmp_path, new)) == 3


def test_rows_that_went_another_way_are_written_anew(tmp_path: Path) -> None:
    """A copy that parted does not continue what was kept, however long it is."""
    rows, files = filled(10), RowFiles(tmp_path)
    parted = rows.share()
    rows.append((1.0, 2.0, 3.0))
    first = files.append(0, rows.share())
    parted.extend(-np.ones((4, 3)))
    second = files.append(0, parted)
    assert first.name != second.name
    np.testing.assert_array_equal(read_rows(tmp_path, second).view, parted.view)


def test_a_disk_that_was_full_for_a_while_spoils_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What stands half in a file is not built upon: the rows get another one."""
    rows, files = filled(10), RowFiles(tmp_path)
    kept = files.append(0, rows.share())
    rows.extend(np.ones((5, 3)))
    with monkeypatch.context() as full:
        full.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        with pytest.raises(OSError, match="No space"):
            files.append(0, rows.share())
    again = files.append(0, rows.share())
    assert len(read_rows(tmp_path, kept)) == 10
    np.testing.assert_array_equal(read_rows(tmp_path, again).view, rows.view)


def test_damaged_rows_are_not_read(tmp_path: Path) -> None:
    """Nor those that are gone: the run is made again from its messages."""
    kept = RowFiles(tmp_path).append(0, filled(100))
    path = tmp_path / kept.name
    content = bytearray(path.read_bytes())
    content[50] ^= 1
    path.write_bytes(content)
    with pytest.raises(JournalError, match="is damaged"):
        read_rows(tmp_path, kept)
    path.unlink()
    with pytest.raises(JournalError, match="cannot be read"):
        read_rows(tmp_path, kept)
