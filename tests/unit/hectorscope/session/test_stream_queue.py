"""The hand-over between a source's thread and the engine's."""

import threading

import numpy as np

from hectorscope.session.stream_queue import MOST_ITEMS, StreamQueue
from slam_core.measurements import Height, LaserScan


def scan(stamp_ns: int) -> LaserScan:
    return LaserScan(stamp_ns, np.ones(3, np.float32), 0.0, 0.1)


def drain(queue: StreamQueue) -> list[int]:
    stamps = []
    while (item := queue.get(0.0)) is not None:
        stamps.append(item.stamp_ns)
    return stamps


def test_order_is_kept_and_nothing_dropped_while_there_is_room() -> None:
    """A consumer that keeps up gets everything in order of arrival."""
    queue = StreamQueue(live=True, scans=3)
    for item in [scan(0), Height(1, 0.0), scan(2), scan(3)]:
        queue.put(item)
    assert drain(queue) == [0, 1, 2, 3]
    assert queue.dropped == 0


def test_live_gives_up_the_oldest_scan_and_nothing_else() -> None:
    """A full live queue loses its oldest scans, counts them, and keeps every other measurement in place."""
    queue = StreamQueue(live=True, scans=2)
    for stamp in range(20):
        queue.put(scan(stamp) if stamp % 2 else Height(stamp, 0.0))
    assert drain(queue) == [0, 2, 4, 6, 8, 10, 12, 14, 16, 17, 18, 19]
    assert queue.dropped == 8


def test_a_live_stream_that_nobody_takes_stays_bounded() -> None:
    """As behind a failure: the newest items stay, inertial data among them, and scans that go are counted."""
    queue = StreamQueue(live=True, scans=3)
    queue.put(scan(0))
    for stamp_ns in range(1, MOST_ITEMS + 10):
        queue.put(Height(stamp_ns, 0.0))
    queue.put(scan(MOST_ITEMS + 10))
    queue.finish()
    assert queue.dropped == 1
    assert drain(queue) == list(range(11, MOST_ITEMS + 11))


def test_room_made_by_a_reader_is_used_again() -> None:
    """Scans that were handed out no longer count against the bound."""
    queue = StreamQueue(live=True, scans=2)
    for stamp in range(10):
        queue.put(scan(stamp))
        assert drain(queue) == [stamp]
    assert queue.dropped == 0


def test_recording_waits_for_room_and_loses_nothing() -> None:
    """A recording's reader blocks while the queue is full; the consumer sees every item."""
    queue = StreamQueue(live=False, scans=2)

    def read() -> None:
        for stamp in range(50):
            assert queue.put(scan(stamp))
        queue.finish()

    reader = threading.Thread(target=read)
    reader.start()
    stamps = []
    while not queue.done:
        if (item := queue.get(10.0)) is not None:
            stamps.append(item.stamp_ns)
    reader.join(10.0)
    assert stamps == list(range(50))
    assert queue.dropped == 0


def test_a_reader_without_room_goes_on_when_half_is_taken() -> None:
    """Woken at each scan that is taken, it would read one, and wait again."""
    queue = StreamQueue(live=False, scans=4)
    for stamp in range(4):
        queue.put(scan(stamp))
    done = threading.Event()
    reader = threading.Thread(target=lambda: queue.put(scan(4)) and done.set())
    reader.start()
    queue.get(0.0)
    assert not done.wait(0.2)
    queue.get(0.0)
    assert done.wait(10.0)
    reader.join(10.0)
    assert drain(queue) == [2, 3, 4]


def test_close_lets_a_waiting_reader_and_consumer_go() -> None:
    """Closing frees a blocked reader, tells it to stop, and ends the consumer's wait."""
    queue = StreamQueue(live=False, scans=1)
    queue.put(scan(0))
    accepted: list[bool] = []
    reader = threading.Thread(target=lambda: accepted.append(queue.put(scan(1))))
    reader.start()
    queue.close()
    reader.join(10.0)
    assert accepted == [False]
    assert queue.get(None) is None
    assert queue.done
