import mmap
import pickle
import subprocess
import sys

import numpy as np
import pytest

from hectorscope.run.rows import LARGE, GrowingRows


def test_rows_come_back_in_order_however_many():
    """Growth beyond the first allocation loses nothing."""
    rows = GrowingRows(2)
    for i in range(5000):
        rows.append((i, -i))
    assert len(rows) == 5000
    np.testing.assert_array_equal(rows.view[:, 0], np.arange(5000))
    np.testing.assert_array_equal(rows.view[:, 1], -np.arange(5000))


def test_many_rows_at_once_are_as_good_as_one_by_one():
    """Also none, and more than there was room for."""
    rows = GrowingRows(2)
    block = np.arange(5000.0).reshape(-1, 2)
    for part in (block[:1], block[1:1], block[1:]):
        rows.extend(part)
    rows.append((1.0, 2.0))
    np.testing.assert_array_equal(rows.view, [*block, (1.0, 2.0)])


def test_a_view_keeps_what_it_showed():
    """What was handed out before neither grows nor changes, also across a growth."""
    rows = GrowingRows(1)
    for i in range(1024):
        rows.append((i,))
    before = rows.view
    rows.append((-1.0,))
    assert len(before) == 1024
    assert before[-1, 0] == 1023


def test_a_view_cannot_be_written():
    """Readers in other threads must not be able to spoil the history."""
    rows = GrowingRows(1)
    rows.append((1.0,))
    with pytest.raises(ValueError, match="read-only"):
        rows.view[0, 0] = 2.0
    rows.append((2.0,))
    assert rows.view[:, 0].tolist() == [1.0, 2.0]


def test_copies_share_what_they_have_and_go_on_apart():
    """Whichever is appended to first: neither sees the rows of the other."""
    rows = GrowingRows(1)
    for i in range(10):
        rows.append((i,))
    copy = rows.share()
    assert np.shares_memory(copy.view, rows.view)
    rows.append((10.0,))
    copy.extend(np.array([[20.0], [21.0]]))
    again = copy.share()
    copy.append((22.0,))
    again.append((30.0,))
    assert rows.view[:, 0].tolist() == [*range(10), 10]
    assert copy.view[:, 0].tolist() == [*range(10), 20, 21, 22]
    assert again.view[:, 0].tolist() == [*range(10), 20, 21, 30]


def test_a_copy_that_goes_the_same_way_writes_nothing():
    """It takes what the other one has appended, durations as they were, until a row differs."""
    rows = GrowingRows(2, besides=[1])
    rows.extend(np.array([[0.0, 5.0], [1.0, 6.0]]))
    copy = rows.share()
    rows.extend(np.array([[2.0, 7.0], [np.nan, 8.0], [4.0, 9.0]]))
    copy.append((2.0, 70.0))
    copy.append((np.nan, 80.0))
    assert np.shares_memory(copy.view, rows.view)
    assert copy.view[:, 1].tolist() == [5, 6, 7, 8]
    copy.extend(np.array([[4.0, 90.0], [5.0, 100.0]]))
    rows.append((6.0, 10.0))
    assert copy.view[4:].tolist() == [[4, 90], [5, 100]]
    assert rows.view[4:].tolist() == [[4, 9], [6, 10]]
    copy = rows.share()
    rows.append((7.0, 11.0))
    copy.append((-7.0, 11.0))
    assert (rows.view[-1, 0], copy.view[-1, 0]) == (7, -7)


def test_many_rows_lie_in_a_file_and_read_the_same(tmp_path, monkeypatch):
    """Copies too, and views from before; the array itself is no longer in memory."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    expected = np.arange(3.0 * LARGE / 8).reshape(-1, 4)
    rows = GrowingRows(4)
    for block in np.array_split(expected, 50):
        rows.extend(block)
    early, copy = rows.view, rows.share()
    rows.extend(-expected)
    copy.extend(2.0 * expected)
    np.testing.assert_array_equal(early, expected)
    np.testing.assert_array_equal(rows.view, [*expected, *-expected])
    np.testing.assert_array_equal(copy.view, [*expected, *2.0 * expected])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(rows)).view, rows.view)
    assert in_a_file(rows.view)
    assert in_a_file(copy.view)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("room", [0, LARGE + 1000, 2 * LARGE], ids=["no file", "full at once", "full later"])
def test_rows_stay_in_memory_where_the_disk_has_no_room(room):
    """A full disk loses nothing. The disk is one of a process of its own, by a limit of the system."""
    program = PROGRAM.format(room=room)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("same\n", "")


PROGRAM = """
import resource, signal
import numpy as np
from hectorscope.run.rows import LARGE, GrowingRows
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({room}, {room}))
expected = np.arange(4.0 * LARGE / 8).reshape(-1, 4)
rows = GrowingRows(4)
for block in np.array_split(expected, 99):
    rows.extend(block)
print("same" if np.array_equal(rows.view, expected) else "other rows")
"""


def in_a_file(rows: np.ndarray) -> bool:
    """Whether it is a part of a mapping."""
    while isinstance(rows.base, np.ndarray):
        rows = rows.base
    return isinstance(rows.base, mmap.mmap | memoryview)
