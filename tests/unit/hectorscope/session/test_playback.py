import math

import pytest

from hectorscope.session.playback import Pacer, RateMeter, changed_speed

S = 1_000_000_000


class Clock:
    """A clock that moves when told."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        """Seconds."""
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.mark.parametrize("speed", [0.1, 0.5, 1.0, 4.0])
def test_a_scan_is_due_after_its_time_over_the_speed(clock: Clock, speed: float):
    """One recording second takes 1 / speed seconds."""
    pacer = Pacer(speed, clock)
    assert pacer.delay(5 * S) == 0.0
    assert pacer.delay(6 * S) == pytest.approx(1 / speed)


def test_no_waiting_at_infinite_speed(clock: Clock):
    """Inf never waits, and leaving it starts the clock afresh."""
    pacer = Pacer(math.inf, clock)
    assert pacer.delay(0) == pacer.delay(1000 * S) == 0.0
    pacer.speed = 1.0
    assert pacer.delay(2000 * S) == 0.0
    assert pacer.delay(2001 * S) == pytest.approx(1.0)


def test_a_change_of_speed_does_not_jump(clock: Clock):
    """Half a second into a wait of one, doubling the speed halves what is left of it."""
    pacer = Pacer(1.0, clock)
    pacer.delay(0)
    clock.now += 0.5
    pacer.speed = 2.0
    assert pacer.delay(S) == pytest.approx(0.25)


def test_after_a_rest_the_next_scan_is_due_at_once(clock: Clock):
    """A pause, however long, is neither caught up nor waited out."""
    pacer = Pacer(1.0, clock)
    pacer.delay(0)
    pacer.rest()
    clock.now += 60
    assert pacer.delay(S) == 0.0
    assert pacer.delay(2 * S) == pytest.approx(1.0)


def test_a_lag_is_forgiven(clock: Clock):
    """After ten seconds of being busy the recording goes on at its pace, not in a rush."""
    pacer = Pacer(1.0, clock)
    pacer.delay(0)
    clock.now += 10
    assert pacer.delay(S) == 0.0
    assert pacer.delay(2 * S) == pytest.approx(1.0)


def test_a_small_lag_is_caught_up(clock: Clock):
    """Jitter does not accumulate: the scan after a late one comes at its own time."""
    pacer = Pacer(1.0, clock)
    pacer.delay(0)
    clock.now += 1.1
    assert pacer.delay(S) == 0.0
    assert pacer.delay(2 * S) == pytest.approx(0.9)


def test_rates_over_the_last_seconds(clock: Clock):
    """40 scans a recording second at twice real time read as 40 Hz and 2x."""
    meter = RateMeter(clock)
    for i in range(400):
        clock.now += 0.0125
        meter.count(i * 25_000_000)
    assert meter.scan_rate == pytest.approx(40.0)
    assert meter.realtime_factor == pytest.approx(2.0, rel=0.01)


def test_rates_fall_to_zero_when_nothing_happens(clock: Clock):
    """Old scans do not count for ever."""
    meter = RateMeter(clock)
    for i in range(10):
        meter.count(i * S)
    clock.now += 10
    assert meter.realtime_factor == 0.0
    assert meter.scan_rate == 0.0


@pytest.mark.parametrize(
    ("speed", "notches", "changed"),
    [(1.0, 1, 2.0), (1.0, -1, 0.5), (0.1, -1, 0.1), (10.0, 1, math.inf), (math.inf, 1, math.inf), (1.7, 1, 5.0)],
)
def test_a_speed_changes_by_notches(speed: float, notches: int, changed: float) -> None:
    """Among those on offer, from the nearest one; there is nothing beyond the ends."""
    assert changed_speed(speed, notches) == changed
