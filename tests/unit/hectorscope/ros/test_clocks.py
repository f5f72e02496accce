"""Which clocks are apart from that of the scans."""

import numpy as np
import pytest

from hectorscope.ros.clocks import CALM_NS, WINDOW_NS, Clocks

MS, SECOND = 1_000_000, 1_000_000_000
START = 1_700_000_000 * SECOND


class Streams:
    """Scans of 10 Hz and inertial data of 100 Hz, recorded by one computer.

    behind: seconds by which the clock of the inertial data is. way: seconds that its messages take. pace: stamps
    count time by it.
    """

    def __init__(self) -> None:
        self.clocks = Clocks("/scan")
        self.ns = 0
        self.waited = 0

    def go(
        self, seconds: float, behind: float = 0.0, way: float = 0.001, jitter: float = 0.0, pace: float = 1.0
    ) -> int:
        """So much time passes; what is added to the stamps of the inertial data behind it."""
        rng = np.random.default_rng(1)
        for _ in range(round(100 * seconds)):
            self.ns += 10 * MS
            late_ns = round(1e9 * (way + jitter * rng.random()))
            stamp_ns = START + round(pace * self.ns) - late_ns - round(1e9 * behind)
            self.clocks.note("/imu", stamp_ns, 0, START + self.ns)
            if self.ns % (100 * MS) == 0:
                self.clocks.note("/scan", START + round(pace * self.ns) - 76 * MS, 75 * MS, START + self.ns)
            self.waited += self.clocks.waits
        return self.clocks.shift_ns("/imu")


@pytest.mark.parametrize("behind", [0.7, -0.7, 30.0, -30.0, 1.7e9, -3600.0])
def test_a_clock_that_is_apart_is_put_beside_that_of_the_scans(behind: float) -> None:
    """Within what messages take, and only the other one; messages wait for a window and no longer."""
    streams = Streams()
    assert streams.go(3.0, behind) == pytest.approx(behind * 1e9, abs=MS)
    assert streams.clocks.shifts_ns.keys() == {"/imu"}
    assert 0.9 * WINDOW_NS < streams.waited * 10 * MS < 1.2 * WINDOW_NS


@pytest.mark.parametrize(
    ("behind", "way", "jitter"), [(0.0, 0.001, 0.0), (0.2, 0.2, 0.0), (0.0, 0.3, 1.5), (0.4, 0.0, 0.3)]
)
def test_messages_that_are_late_are_by_the_same_clock(behind: float, way: float, jitter: float) -> None:
    """By a little always, or by much now and then."""
    assert Streams().go(10.0, behind, way, jitter) == 0


def test_messages_wait_only_for_the_first_scan_where_clocks_agree() -> None:
    """Ten samples come before it."""
    streams = Streams()
    streams.go(5.0)
    assert streams.waited == 9


def test_where_no_scan_comes_messages_wait_for_a_window() -> None:
    """Somebody may look at the attitude of a robot whose laser is broken."""
    clocks = Clocks("/scan")
    waits = []
    for k in range(300):
        clocks.note("/imu", START + k * 10 * MS, 0, START + k * 10 * MS)
        waits.append(clocks.waits)
    assert sum(waits) == WINDOW_NS // (10 * MS)


def test_without_scans_nothing_waits() -> None:
    """There is no clock to keep to."""
    clocks = Clocks(None)
    clocks.note("/imu", START, 0, START)
    assert not clocks.waits


def test_a_clock_that_drifts_is_followed() -> None:
    """200 parts in a million are 0.12 s in ten minutes."""
    streams = Streams()
    streams.go(3.0, 30.0)
    for k in range(600):
        shift_ns = streams.go(1.0, 30.0 + 2e-4 * k)
    assert shift_ns == pytest.approx(30.12e9, abs=5 * MS)


def test_a_longer_way_is_not_taken_for_a_clock_at_once() -> None:
    """A link that is slow for 10 s moves the stamps by 5 ms, and not by the 100 ms that it takes."""
    streams = Streams()
    streams.go(4.0, 30.0)
    assert streams.go(10.0, 30.0, way=0.1) == pytest.approx(30e9, abs=6 * MS)
    assert streams.go(4.0, 30.0) == pytest.approx(30e9, abs=MS)


@pytest.mark.parametrize("before", [0.0, 40.0])
@pytest.mark.parametrize("after", [0.0, -20.0, 3600.0])
def test_a_clock_that_is_set_is_measured_again(before: float, after: float) -> None:
    """Messages wait meanwhile; clocks that agree from then on need no help."""
    streams = Streams()
    streams.go(5.0, before)
    waited = streams.waited
    streams.go(CALM_NS * 1e-9, before)
    assert streams.waited == waited
    assert streams.go(3.0, after) == pytest.approx(after * 1e9, abs=MS)
    assert (streams.waited > waited) == (before != after)


@pytest.mark.parametrize("pace", [0.1, 10.0])
def test_a_simulation_by_a_time_of_its_own_does_not_wait_again_and_again(pace: float) -> None:
    """Stamps that count another time than the recorder tell nothing about clocks."""
    streams = Streams()
    assert streams.go(60.0, pace=pace) == 0
    assert streams.waited * 10 * MS < 1.2 * WINDOW_NS


def test_where_the_receipt_does_not_count_time_messages_wait_for_a_moment_only() -> None:
    """Some servers send a constant in its place."""
    clocks = Clocks("/scan")
    waits = []
    for k in range(3000):
        clocks.note("/imu", START + k * 10 * MS, 0, 1)
        if k % 10 == 5:
            clocks.note("/scan", START + 30 * SECOND + k * 10 * MS, 0, 1)
        waits.append(clocks.waits)
    assert sum(waits) * 10 * MS < 3 * WINDOW_NS and not clocks.shifts_ns


def test_all_stamps_by_a_clock_of_their_own_stay() -> None:
    """As of a recording that is played back and recorded again."""
    clocks = Clocks("/scan")
    for k in range(500):
        ns = k * 10 * MS
        clocks.note("/imu", ns, 0, START + ns)
        if k % 10 == 0:
            clocks.note("/scan", ns - 75 * MS, 75 * MS, START + ns)
    assert not clocks.shifts_ns


def test_single_wrong_stamps_do_not_move_the_others() -> None:
    """One message in ten is stamped an hour ahead."""
    clocks = Clocks("/scan")
    for k in range(500):
        ns = START + k * 10 * MS
        clocks.note("/imu", ns + 3600 * SECOND * (k % 10 == 3), 0, ns)
        if k % 10 == 0:
            clocks.note("/scan", ns - 75 * MS, 75 * MS, ns)
    assert not clocks.shifts_ns


def test_a_slow_sensor_may_send_what_it_measured_with_the_next() -> None:
    """Of a truth of 1 Hz every pose comes a second late."""
    clocks = Clocks("/scan")
    for k in range(600):
        ns = START + k * 10 * MS
        if k % 100 == 0:
            clocks.note("/truth", ns - SECOND, 0, ns)
        if k % 10 == 0:
            clocks.note("/scan", ns - 75 * MS, 75 * MS, ns)
    assert not clocks.shifts_ns
